// What is looked at: the one state that all parts of the page read and change, as a view of the
// protocol and as the bookmark in the address.

import { bodyOf } from './body.js';
import { poseList } from './camera.js';
import { clamp, wrap360 } from './vector.js';

export const OVERLAYS = ['none', 'wireframe', 'lod', 'pages', 'error'];
export const SHADOWS = ['soft', 'hard', 'off'];
export const LEAST_PIXEL_ERROR = 0.25;
export const MOST_PIXEL_ERROR = 16;
const MOTION = ['pose', 'time_ms', 'sun', 'pixel_error'];
const MILLISECONDS_OF_YEARS = [Date.UTC(1, 0), Date.UTC(2999, 11, 31)];

export class ViewState extends EventTarget {
  constructor() {
    super();
    this.planet = null;
    this.body = null;
    this.pose = null;
    this.fov_deg = 60;
    /** `map`: from the north-west, as on maps; `time`; `point`: sub-solar point or azimuth, elevation. */
    this.light = 'map';
    this.time_ms = 0;
    this.sun = [0, 0];
    this.shadow = 'hard';
    this.overlay = 'none';
    this.pixel_error = 1;
    /** When what is looked at last moved, as it does many times a second. */
    this.moved_ms = 0;
  }

  /** Sets fields and tells all listeners; what did not change is not told. */
  change(fields) {
    const changed = Object.keys(fields).filter((key) => fields[key] !== this[key]);
    if (changed.length === 0) return;
    Object.assign(this, fields);
    if (changed.some((key) => MOTION.includes(key))) this.moved_ms = performance.now();
    this.dispatchEvent(new CustomEvent('change', { detail: new Set(changed) }));
  }

  /** Looks at a planet of the welcome from where all of it is seen. */
  visit(planet) {
    const body = bodyOf(planet);
    const light = this.light === 'time' && !planet.has_time ? 'map' : this.light;
    const sun = planet.plane ? [315, 35] : [body.centre[0] - 50, 15];
    this.change({ planet, body, light, sun, pose: home(planet, body) });
  }

  /** The same planet from a daemon that came back, or from a new file. */
  renew(planet) {
    this.change({ planet, body: bodyOf(planet) });
  }

  /** The pose that sees all of the planet. */
  home() {
    return home(this.planet, this.body);
  }

  /** The fields of a view that all cameras share. */
  shared() {
    const view = {
      pixel_error: this.pixel_error,
      overlay: this.overlay,
      shadow: this.shadow === 'off' ? 'none' : 'exact',
      soft: this.shadow === 'soft',
    };
    if (this.light === 'time') view.time = new Date(this.time_ms).toISOString();
    if (this.light === 'point') view.sun = this.sun;
    return view;
  }

  /** The view of the main camera. */
  view() {
    return { pose: poseList(this.pose), fov: this.fov_deg, ...this.shared() };
  }

  /** The bookmark, without its #. */
  bookmark() {
    const { pose } = this;
    const places = this.body.plane ? 3 : 7;
    const list = [pose.x.toFixed(places), pose.y.toFixed(places), pose.height_m.toPrecision(8)];
    list.push(pose.heading_deg.toFixed(2), pose.pitch_deg.toFixed(2));
    const fields = { planet: this.planet.name, at: list.map(Number).join(',') };
    if (this.fov_deg !== 60) fields.fov = this.fov_deg;
    if (this.light === 'time') fields.time = new Date(this.time_ms).toISOString().replace('.000Z', 'Z');
    if (this.light === 'point') fields.sun = this.sun.map((angle) => Number(angle.toFixed(4))).join(',');
    if (this.shadow !== 'hard') fields.shadow = this.shadow;
    if (this.overlay !== 'none') fields.overlay = this.overlay;
    if (this.pixel_error !== 1) fields.error = this.pixel_error;
    const said = ([key, value]) => `${key}=${encodeURIComponent(value).replaceAll('%2C', ',').replaceAll('%3A', ':')}`;
    return Object.entries(fields).map(said).join('&');
  }

  /** Takes what a bookmark says, as far as it can be understood. */
  restore(bookmark) {
    const said = new URLSearchParams(bookmark.replace(/^#/, ''));
    const fields = {};
    const number = (key, low, high, set) => {
      const value = Number(said.get(key));
      if (said.get(key) && Number.isFinite(value)) set(clamp(value, low, high));
    };
    const numbers = (key, count) => {
      const list = (said.get(key) ?? '').split(',').map(Number);
      return list.length === count && list.every(Number.isFinite) ? list : null;
    };
    const at = numbers('at', 5);
    if (at) {
      const [x, y] = this.body.tidy(at);
      const height_m = clamp(at[2], this.planet.min_m - 10, this.body.highest_m);
      fields.pose = { x, y, height_m, heading_deg: wrap360(at[3]), pitch_deg: clamp(at[4], -90, 90) };
    }
    number('fov', 1, 120, (fov_deg) => { fields.fov_deg = fov_deg; });
    number('error', LEAST_PIXEL_ERROR, MOST_PIXEL_ERROR, (pixel_error) => { fields.pixel_error = pixel_error; });
    const time_ms = Date.parse(said.get('time') ?? '');
    const sun = numbers('sun', 2);
    if (this.planet.has_time && Number.isFinite(time_ms)) {
      Object.assign(fields, { light: 'time', time_ms: clamp(time_ms, ...MILLISECONDS_OF_YEARS) });
    } else if (sun) {
      Object.assign(fields, { light: 'point', sun: [sun[0], clamp(sun[1], -90, 90)] });
    }
    if (OVERLAYS.includes(said.get('overlay'))) fields.overlay = said.get('overlay');
    if (SHADOWS.includes(said.get('shadow'))) fields.shadow = said.get('shadow');
    this.change(fields);
  }
}

/** The pose that sees all. */
function home(planet, body) {
  const [x, y] = body.centre;
  if (body.plane) {
    const back = (0.62 * body.extent_m) / body.unit_y_m;
    const height_m = planet.max_m + 0.5 * body.extent_m;
    return { x, y: Math.max(y - back, body.south), height_m, heading_deg: 0, pitch_deg: -45 };
  }
  // As far as the narrower side of the window needs.
  const wide = Math.max(1, innerHeight / innerWidth);
  const height_m = Math.min(0.75 * body.extent_m * wide, body.highest_m);
  return { x, y, height_m, heading_deg: 0, pitch_deg: -90 };
}
