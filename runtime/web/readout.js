// What lies under the pointer: place, height and the sun's elevation, asked of the daemon as often
// as it answers, at most ten times a second.

import { metres, written } from './coordinates.js';
import { $ } from './elements.js';

const PAUSE_MS = 100;

export class Readout {
  constructor(state, frames, pointer, pilot) {
    Object.assign(this, { state, frames, pointer, pilot });
    this.asked = '';
    this.asked_ms = 0;
    this.busy = false;
    /** Clicks that wait for an answer. */
    this.taken = 0;
    /** The last answer: {pixel, view, place}. */
    this.last = null;
    this.show(null);
  }

  /** The pixel of the latest view that a pixel of the canvas is. */
  viewPixel([x, y]) {
    const { size } = this.frames.latest.view;
    const { width, height } = this.pilot.lens;
    return [(x / width) * size[0], (y / height) * size[1]];
  }

  /** What a pixel of the canvas shows: a place of the protocol, null in the sky, undefined if unknown. */
  async ask(pixel) {
    if (!this.frames.latest) return undefined;
    const place = await this.frames.connection.pick(this.frames.name, ...this.viewPixel(pixel));
    if (place) this.pilot.hovered = { pixel, height_m: place.height_m };
    return place;
  }

  /** As `ask`, and the pointer does not ask in between. */
  async pick(pixel) {
    this.taken += 1;
    try {
      return await this.ask(pixel);
    } finally {
      this.taken -= 1;
    }
  }

  async tick() {
    const pixel = this.pointer.over ?? this.pilot.centre;
    const key = `${pixel} ${this.frames.number} ${this.frames.shown?.header.seq}`;
    const dragging = this.pointer.down.size > 0;
    const now = performance.now();
    if (this.busy || this.taken || dragging || key === this.asked || now - this.asked_ms < PAUSE_MS || !this.frames.latest) return;
    Object.assign(this, { asked: key, asked_ms: now, busy: true });
    const view = this.frames.number;
    const place = await this.ask(pixel);
    this.busy = false;
    if (place === undefined) return;
    this.last = { pixel, view, place };
    this.show(place, this.pointer.over === null);
  }

  show(place, centre) {
    const box = $('readout');
    const parts = place
      ? [
        written([place.x, place.y], this.state.body),
        metres(place.height_m, 1),
        `sun ${place.sun_elevation_deg.toFixed(1).replace('-', '−')}°`,
      ]
      : ['Sky'];
    box.replaceChildren(...parts.map((text) => Object.assign(document.createElement('span'), { textContent: text })));
    box.title = centre ? 'At the middle of the picture' : 'Under the pointer';
    box.hidden = !place;
  }
}
