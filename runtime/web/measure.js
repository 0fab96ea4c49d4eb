// The length of the geodesic between two places, clicked or typed; the daemon works it out.

import { CoordinateError, grouped, metres, parse, typed } from './coordinates.js';
import { $, show } from './elements.js';
import { wrap360 } from './vector.js';

const POINTS = 128;

export class Measure {
  /** `readout` says what is under a click, `changed` is told when the line is another. */
  constructor(state, readout, questions, changed) {
    Object.assign(this, { state, readout, questions, changed, active: false });
    this.clear();
    $('measure').onclick = () => this.open(!this.active);
    $('ruler-close').onclick = () => this.open(false);
    $('ruler-form').onsubmit = (event) => {
      event.preventDefault();
      this.read();
    };
    for (const id of ['ruler-from', 'ruler-to']) $(id).onchange = () => this.read();
    state.addEventListener('change', ({ detail }) => {
      if (detail.has('planet')) this.open(false);
    });
  }

  /** Forgets both ends. */
  clear() {
    /** Ends: {place, height_m}. */
    this.ends = [];
    /** Places and heights along the line. */
    this.line = [];
    this.result = null;
    $('ruler-from').value = '';
    $('ruler-to').value = '';
    this.say('Click two points, or type them.');
    this.changed();
  }

  open(active) {
    this.active = active;
    show($('ruler'), active);
    $('measure').setAttribute('aria-pressed', active);
    $('view').classList.toggle('measuring', active);
    this.clear();
  }

  /** A click on the canvas; a third one begins anew. */
  async tap(pixel) {
    if (!this.active) return;
    const place = await this.readout.pick(pixel);
    if (place === undefined) return;
    if (place === null) {
      this.say('That is the sky. Click the ground.');
      return;
    }
    if (this.ends.length === 2) this.clear();
    this.ends.push({ place: [place.x, place.y], height_m: place.height_m });
    this.fill();
    await this.work();
  }

  fill() {
    const { body } = this.state;
    $('ruler-from').value = this.ends[0] ? typed(this.ends[0].place, body) : '';
    $('ruler-to').value = this.ends[1] ? typed(this.ends[1].place, body) : '';
  }

  /** The ends were typed. */
  async read() {
    const { body, planet } = this.state;
    const texts = [$('ruler-from').value, $('ruler-to').value].filter((text) => text.trim());
    try {
      const places = texts.map((text) => parse(text, body));
      this.ends = await Promise.all(places.map(async (place) => {
        const height_m = await this.questions.height(planet, place).catch(() => 0);
        return { place, height_m: height_m ?? 0 };
      }));
      await this.work();
    } catch (error) {
      if (!(error instanceof CoordinateError)) throw error;
      this.say(error.message);
    }
  }

  /** Asks for the distance and lays the line. */
  async work() {
    this.line = [];
    this.result = null;
    this.changed();
    if (this.ends.length < 2) {
      this.say(this.ends.length === 1 ? 'And the other end?' : 'Click two points, or type them.');
      return;
    }
    const [from, to] = this.ends;
    try {
      const ends = this.ends;
      const result = await this.questions.distance(this.state.planet, from.place, to.place);
      if (ends !== this.ends) return;
      const line = await this.laid(from, to, result);
      if (ends !== this.ends) return;
      Object.assign(this, { result, line });
      const azimuth = (deg) => `${wrap360(deg).toFixed(2)}°`;
      this.say(`${this.exact(result.distance_m)} · sets out at ${azimuth(result.azimuth_from_deg)}, `
        + `arrives at ${azimuth(result.azimuth_to_deg)}`);
    } catch (error) {
      this.say(error.message);
    }
    this.changed();
  }

  exact(distance_m) {
    return distance_m >= 1000 ? `${grouped(distance_m / 1000, 6)} km` : metres(distance_m, 3);
  }

  /** The line over the relief, or straight between the ends where heights are not to be had. */
  async laid(from, to, { distance_m, azimuth_from_deg }) {
    const { body, planet } = this.state;
    const shares = Array.from({ length: POINTS + 1 }, (_, k) => k / POINTS);
    const points = shares.map((t) => body.walk(...from.place, azimuth_from_deg, t * distance_m).slice(0, 2));
    const straight = () => shares.map((t) => from.height_m + (to.height_m - from.height_m) * t);
    const heights_m = await this.questions.heights(planet, points).catch(straight);
    return points.map(([x, y], k) => [x, y, heights_m[k]]);
  }

  say(text) {
    $('ruler-said').textContent = text;
  }
}
