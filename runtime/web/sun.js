// The light: as on maps, at a date and time with play, or from a point; and the shadows it casts.

import { crossing, noon, subSolar } from './almanac.js';
import { $, choices, fill, show } from './elements.js';
import { clamp, wrap180 } from './vector.js';

const MINUTE_MS = 60_000;
const DAY_MINUTES = 1440;
/** Minutes of the sun in a second of play. */
const SPEEDS = [[1, '1 min/s'], [10, '10 min/s'], [60, '1 h/s'], [360, '6 h/s'], [1440, '1 day/s']];
/** High enough to light the ground, low enough for long shadows. */
const LOW_SUN_DEG = 4;
const FIRST_HOUR_AFTER_NOON_MS = 4 * 3_600_000;
const LIGHTS = {
  map: ['Map', 'From the north-west, 45 degrees high'],
  time: ['Time', 'The sun at a date and time'],
  point: ['Sun', 'Where the sun stands'],
};

export class Sun {
  constructor(state, notices) {
    Object.assign(this, { state, notices, playing: false });
    this.chosenShadow = choices($('shadow'), [
      ['hard', 'Hard'], ['soft', 'Soft', 'The sun is a disk'], ['off', 'Off'],
    ], (shadow) => state.change({ shadow }));
    $('speed').replaceChildren(...SPEEDS.map(([value, label]) => new Option(label, value)));
    $('speed').value = 60;
    $('play').onclick = () => this.play(!this.playing);
    $('date').onchange = () => this.typed();
    $('time').oninput = () => this.typed();
    $('sun-x').oninput = () => state.change({ sun: [Number($('sun-x').value), state.sun[1]] });
    $('sun-y').oninput = () => state.change({ sun: [state.sun[0], Number($('sun-y').value)] });
    for (const button of document.querySelectorAll('[data-sun]')) {
      button.onclick = () => this.setSun(button.dataset.sun);
    }
    state.addEventListener('change', ({ detail }) => {
      if (detail.has('planet')) this.arrive();
      if (['planet', 'light', 'time_ms', 'sun', 'shadow'].some((key) => detail.has(key))) this.show();
    });
  }

  /** Another planet: other ways to light it. */
  arrive() {
    const { planet } = this.state;
    const ways = planet.has_time ? ['map', 'time', 'point'] : ['map', 'point'];
    this.chosenLight = choices($('light'), ways.map((way) => [way, ...LIGHTS[way]]), (light) => this.choose(light));
    const [x, y] = planet.plane
      ? [['Azimuth', 0, 360], ['Elevation', -10, 90]]
      : [['Sub-solar longitude', -180, 180], ['Sub-solar latitude', -90, 90]];
    for (const [id, [name, min, max]] of [['sun-x', x], ['sun-y', y]]) {
      $(`${id}-name`).textContent = name;
      Object.assign($(id), { min, max });
    }
    if (!planet.has_time) this.play(false);
  }

  choose(light) {
    const { state } = this;
    const fields = { light };
    // A first time with the place in the light of an afternoon.
    if (light === 'time' && !state.time_ms) {
      const now = noon(Date.now(), state.pose.x) + FIRST_HOUR_AFTER_NOON_MS;
      fields.time_ms = Math.round(now / MINUTE_MS) * MINUTE_MS;
    }
    if (light === 'point' && state.light === 'time') fields.sun = subSolar(state.time_ms);
    if (light !== 'time') this.play(false);
    state.change(fields);
  }

  /** The date or the slider was changed. */
  typed() {
    const day_ms = Date.parse(`${$('date').value}T00:00:00Z`);
    if (Number.isFinite(day_ms)) this.state.change({ time_ms: day_ms + Number($('time').value) * MINUTE_MS });
  }

  /** Sunrise, noon or sunset at the middle of the picture. */
  setSun(which) {
    const { state } = this;
    const { x, y } = state.pose;
    const time_ms = which === 'noon'
      ? noon(state.time_ms, x)
      : crossing(state.time_ms, [x, y], which, LOW_SUN_DEG);
    if (time_ms === null) {
      this.notices.say({
        what: `No sun${which} on this day at a latitude of ${y.toFixed(1)}°`,
        rule: 'Near the poles the sun stays up or down for months',
        remedy: 'Choose another date',
      });
      return;
    }
    this.play(false);
    state.change({ time_ms: Math.round(time_ms / 1000) * 1000 });
  }

  play(playing) {
    this.playing = playing && this.state.planet.has_time;
    if (this.playing && this.state.light !== 'time') this.choose('time');
    $('play').setAttribute('aria-pressed', this.playing);
    $('play').setAttribute('aria-label', this.playing ? 'Stop' : 'Play');
    $('play').querySelector('use').setAttribute('href', this.playing ? '#i-pause' : '#i-play');
  }

  tick(seconds) {
    if (!this.playing) return;
    const step_ms = Number($('speed').value) * MINUTE_MS * Math.min(seconds, 0.5);
    this.state.change({ time_ms: this.state.time_ms + step_ms });
  }

  show() {
    const { state } = this;
    this.chosenLight(state.light);
    this.chosenShadow(state.shadow);
    show($('light-time'), state.light === 'time');
    show($('light-point'), state.light === 'point');
    if (state.light === 'time') {
      const said = new Date(state.time_ms).toISOString();
      $('date').value = said.slice(0, -14);
      $('clock').textContent = `${said.slice(-13, -8)} UTC`;
      $('time').value = Math.floor(state.time_ms / MINUTE_MS) % DAY_MINUTES;
      fill($('time'));
    }
    const [x, y] = state.sun;
    const low = Number($('sun-x').min);
    $('sun-x').value = low < 0 ? wrap180(x) : x;
    $('sun-y').value = clamp(y, Number($('sun-y').min), 90);
    $('sun-x-said').textContent = `${Number($('sun-x').value).toFixed(1)}°`;
    $('sun-y-said').textContent = `${Number($('sun-y').value).toFixed(1)}°`;
    fill($('sun-x'));
    fill($('sun-y'));
  }
}
