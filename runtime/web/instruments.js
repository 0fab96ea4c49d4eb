// The compass, the scale bar and the line that says what is shown.

import { pixelWidth, stand } from './camera.js';
import { metres } from './coordinates.js';
import { $, show } from './elements.js';

const MOST_BAR_PX = 130;

export class Instruments {
  constructor(state, pilot) {
    Object.assign(this, { state, pilot });
    $('compass').onclick = () => pilot.north();
    state.addEventListener('change', ({ detail }) => {
      if (detail.has('planet')) this.attribute();
      if (detail.has('pose')) $('compass').style.setProperty('--heading', `${-state.pose.heading_deg}deg`);
    });
  }

  /** A round length and its bar, at the middle of the picture. */
  tick() {
    const { state, pilot } = this;
    const point = pilot.at(pilot.centre);
    show($('scale'), point !== null);
    if (!point) return;
    const metre_px = 1 / pixelWidth(stand(state.body, state.pose), pilot.lens, point);
    const most_m = MOST_BAR_PX / metre_px;
    const decade = 10 ** Math.floor(Math.log10(most_m));
    const length_m = decade * [5, 2, 1].find((digit) => digit * decade <= most_m);
    const said = length_m >= 1000 ? `${length_m / 1000} km` : metres(length_m);
    if ($('scale-said').textContent !== said) $('scale-said').textContent = said;
    $('scale').style.setProperty('--bar', `${(length_m * metre_px).toFixed(1)}px`);
  }

  spacing(spacing_m) {
    return spacing_m < 1000 ? metres(spacing_m, 1) : `${(spacing_m / 1000).toFixed(1)} km`;
  }

  attribute() {
    const { planet } = this.state;
    const name = planet.plane ? planet.name : planet.body || planet.name;
    const said = name.charAt(0).toUpperCase() + name.slice(1);
    $('attribution').textContent = `${said} · ${this.spacing(planet.spacing_m)} between nodes · ${planet.backend}`;
    document.title = `${said} · relief`;
  }
}
