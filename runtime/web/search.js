// The search field: coordinates in, a flight there.

import { CoordinateError, parse, typed, written } from './coordinates.js';
import { $, show } from './elements.js';

export class Search {
  constructor(state, pilot, questions) {
    Object.assign(this, { state, pilot, questions });
    const field = $('place');
    $('search').onsubmit = (event) => {
      event.preventDefault();
      this.go(field.value);
    };
    field.oninput = () => {
      show($('place-clear'), field.value !== '');
      this.say('');
    };
    field.onkeydown = (event) => {
      if (event.key === 'Escape') {
        event.stopPropagation();
        this.clear();
        $('view').focus();
      }
    };
    $('place-clear').onclick = () => {
      this.clear();
      field.focus();
    };
    state.addEventListener('change', ({ detail }) => {
      if (detail.has('planet')) this.invite();
    });
  }

  invite() {
    const wide = innerWidth > 560;
    const [long, short] = this.state.body.plane ? ['Go to X, Y', 'X, Y'] : ['Go to latitude, longitude', 'Lat, lon'];
    $('place').placeholder = wide ? long : short;
  }

  clear() {
    $('place').value = '';
    show($('place-clear'), false);
    this.say('');
  }

  async go(text) {
    const { body, planet } = this.state;
    try {
      const place = parse(text, body);
      this.say('');
      const ground_m = await this.questions.height(planet, place).catch(() => Math.max(0, planet.min_m));
      this.pilot.visit(place, ground_m ?? 0);
      this.found = place;
      $('place').value = typed(place, body);
      $('place').title = written(place, body, 6);
      $('view').focus();
    } catch (error) {
      if (!(error instanceof CoordinateError)) throw error;
      this.say(error.message);
    }
  }

  say(text) {
    $('place-said').textContent = text;
    show($('place-said'), text !== '');
    $('place').setAttribute('aria-invalid', text !== '');
  }
}
