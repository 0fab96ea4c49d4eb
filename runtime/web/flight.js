// An animated flight from pose to pose: up, across and down again, along the great circle.

import { clamp, wrap180, wrap360 } from './vector.js';

const ease = (t) => t * t * t * (t * (6 * t - 15) + 10);

export class Flight {
  /** From one pose to another above a body; heights above `ground_m` fall and rise evenly in their logarithm. */
  constructor(body, start, end, ground_m) {
    Object.assign(this, { start, end, ground_m });
    this.way = body.way([start.x, start.y], [end.x, end.y]);
    this.low = [start, end].map((pose) => Math.log(Math.max(pose.height_m - ground_m, 2)));
    // As high as the way is long, so that both ends are seen from the middle.
    const top = Math.log(clamp(0.5 * this.way.distance_m, 2, 0.8 * body.highest_m));
    const level = (this.low[0] + this.low[1]) / 2;
    this.rise = Math.max(0, top - Math.max(level, Math.max(...this.low) - 1));
    const travelled = Math.abs(this.low[1] - this.low[0]) + 2 * this.rise;
    const calm = window.matchMedia?.('(prefers-reduced-motion: reduce)').matches;
    this.duration_s = calm ? 0 : clamp(1.2 + 0.28 * travelled, 1.2, 5);
    this.elapsed_s = 0;
  }

  /** The pose after some more seconds. */
  tick(seconds) {
    this.elapsed_s += seconds;
    if (this.done) return this.end;
    const { start, end } = this;
    const t = ease(this.elapsed_s / this.duration_s);
    const [x, y] = this.way.between(t);
    const log = this.low[0] + (this.low[1] - this.low[0]) * t + this.rise * 4 * t * (1 - t);
    const turn = (from, to) => from + wrap180(to - from) * t;
    return {
      x,
      y,
      height_m: this.ground_m + Math.exp(log),
      heading_deg: wrap360(turn(start.heading_deg, end.heading_deg)),
      pitch_deg: turn(start.pitch_deg, end.pitch_deg),
    };
  }

  get done() {
    return this.elapsed_s >= this.duration_s;
  }
}
