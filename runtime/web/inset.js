// The second camera in a corner: a map from higher up, or a telephoto lens. It is a camera of its own
// on the same connection.

import { poseList, project, stand } from './camera.js';
import { $, choices, show } from './elements.js';
import { Frames } from './frames.js';
import { clamp } from './vector.js';

const MAP_TIMES = 6;
const TELE_TIMES = 6;
const PAUSE_MS = 250;
const FOV_DEG = 50;

export class Inset {
  constructor(state, connection, pilot) {
    Object.assign(this, { state, connection, pilot, frames: null, kind: 'map', wanted_ms: 0 });
    this.chosen = choices($('inset-kind'), [
      ['map', 'Map', 'From above, north up'], ['tele', 'Telephoto', 'The middle of the picture, nearer'],
    ], (kind) => this.choose(kind));
    $('inset-toggle').onclick = () => this.open(!this.frames);
    $('inset-close').onclick = () => this.open(false);
    state.addEventListener('change', ({ detail }) => {
      this.stale = true;
      if (detail.has('planet')) this.attach();
    });
    new ResizeObserver(() => { this.stale = true; }).observe($('inset'));
    this.corners();
  }

  open(opened) {
    show($('inset'), opened);
    $('inset-toggle').setAttribute('aria-pressed', opened);
    if (!opened) {
      this.frames?.detach();
      this.frames = null;
    } else if (!this.frames) {
      this.frames = new Frames(this.connection, 'inset', $('inset-view'), { quality: 85 });
      this.frames.addEventListener('shown', ({ detail }) => this.mark(detail.note));
      this.choose(this.kind);
      this.attach();
    }
  }

  attach() {
    this.frames?.attach(this.state.planet);
    this.stale = true;
  }

  choose(kind) {
    this.kind = kind;
    this.chosen(kind);
    this.stale = true;
  }

  view() {
    const { pose, fov_deg, body } = this.state;
    if (this.kind === 'tele') return { pose, fov_deg: fov_deg / TELE_TIMES };
    const above_m = this.pilot.ground.above_m(pose);
    const most_m = body.plane ? 1.4 * body.extent_m : 1.6 * body.a_m;
    const height_m = clamp(MAP_TIMES * above_m, 2000, Math.max(most_m, pose.height_m));
    return { pose: { ...pose, height_m: height_m + this.pilot.ground.guess_m(), heading_deg: 0, pitch_deg: -90 }, fov_deg: FOV_DEG };
  }

  /** Asks for its picture, seldom while the main one moves. */
  tick(moving) {
    const now = performance.now();
    if (!this.frames || !this.stale || (moving && now - this.wanted_ms < PAUSE_MS)) return;
    const canvas = $('inset-view');
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    Object.assign(this, { stale: false, wanted_ms: now });
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const { pose, fov_deg } = this.view();
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    const view = { ...this.state.shared(), pose: poseList(pose), fov: fov_deg, size };
    this.frames.request(view, { pose, kind: this.kind, main: this.state.pose, lens: { fov_deg, width: size[0], height: size[1] } });
  }

  /** The main camera on the map: where it is and which way it looks. */
  mark({ kind, pose, main, lens }) {
    if (kind !== 'map') return;
    const { body } = this.state;
    const at = project(stand(body, pose), lens, body.point([main.x, main.y, this.pilot.ground.guess_m()]));
    if (!at) return;
    const ink = $('inset-view').getContext('2d', { alpha: false });
    const size = lens.height / 26;
    ink.save();
    ink.translate(...at);
    ink.rotate((main.heading_deg * Math.PI) / 180);
    ink.beginPath();
    for (const [x, y] of [[0, -1.5], [1, 1], [0, 0.5], [-1, 1]]) ink.lineTo(x * size, y * size);
    ink.closePath();
    Object.assign(ink, { fillStyle: '#ffd166', strokeStyle: '#10243d', lineWidth: size / 5, lineJoin: 'round' });
    ink.fill();
    ink.stroke();
    ink.restore();
  }

  /** The bar drags the inset into another corner; arrow keys do, too. */
  corners() {
    const [inset, bar] = [$('inset'), $('inset-bar')];
    let began = null;
    bar.onpointerdown = (event) => {
      if (event.target.closest('button')) return;
      began = [event.clientX, event.clientY];
      bar.setPointerCapture(event.pointerId);
    };
    bar.onpointermove = (event) => {
      if (began) inset.style.translate = `${event.clientX - began[0]}px ${event.clientY - began[1]}px`;
    };
    bar.onpointerup = () => {
      if (!began) return;
      began = null;
      const box = inset.getBoundingClientRect();
      const vertical = box.top + box.height / 2 < innerHeight / 2 ? 'top' : 'bottom';
      const horizontal = box.left + box.width / 2 < innerWidth / 2 ? 'left' : 'right';
      inset.style.translate = '';
      inset.dataset.corner = `${vertical}-${horizontal}`;
    };
    bar.onpointercancel = bar.onpointerup;
    bar.addEventListener('keydown', (event) => {
      if (event.target !== bar) return;
      const [vertical, horizontal] = inset.dataset.corner.split('-');
      const moved = {
        ArrowUp: ['top', horizontal], ArrowDown: ['bottom', horizontal],
        ArrowLeft: [vertical, 'left'], ArrowRight: [vertical, 'right'],
      }[event.key];
      if (!moved) return;
      event.preventDefault();
      event.stopPropagation();
      inset.dataset.corner = moved.join('-');
    });
  }
}
