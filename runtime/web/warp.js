// Between two pictures the last one is moved and stretched to where the camera is by now, so that
// a drag is smooth however long a picture takes.

import { ground, project, stand } from './camera.js';

/** Where the picture is compared, as shares of its sides. */
const SHARES = [[0.5, 0.5], [0.3, 0.35], [0.7, 0.35], [0.3, 0.7], [0.7, 0.7], [0.5, 0.8]];
const MOST_STRETCH = 4;

/**
 * The affine map of pixels, [a, b, c, d, e, f] as a canvas has it, that takes points to where they
 * are seen now; least squares. Null with fewer than three points, or where it tears the picture.
 */
export function affine(from, to) {
  const n = from.length;
  if (n < 3) return null;
  const mean = (points, k) => points.reduce((sum, point) => sum + point[k], 0) / n;
  const [mx, my, ux, uy] = [mean(from, 0), mean(from, 1), mean(to, 0), mean(to, 1)];
  let [xx, xy, yy, xu, yu, xv, yv] = [0, 0, 0, 0, 0, 0, 0];
  from.forEach(([px, py], k) => {
    const [x, y, u, v] = [px - mx, py - my, to[k][0] - ux, to[k][1] - uy];
    [xx, xy, yy] = [xx + x * x, xy + x * y, yy + y * y];
    [xu, yu, xv, yv] = [xu + x * u, yu + y * u, xv + x * v, yv + y * v];
  });
  const area = xx * yy - xy * xy;
  if (area < 1e-6 * (xx + yy) ** 2) return null;
  const [a, c] = [(xu * yy - yu * xy) / area, (yu * xx - xu * xy) / area];
  const [b, d] = [(xv * yy - yv * xy) / area, (yv * xx - xv * xy) / area];
  const stretch = a * d - b * c;
  if (!(stretch > 1 / MOST_STRETCH && stretch < MOST_STRETCH)) return null;
  return [a, b, c, d, ux - a * mx - c * my, uy - b * mx - d * my];
}

export class Warp {
  constructor(state, frames, pilot, marks) {
    Object.assign(this, { state, frames, pilot, marks, pose: null, shown: null });
    frames.addEventListener('shown', () => this.tick());
  }

  tick() {
    const { state, frames } = this;
    const { shown } = frames;
    if (!shown || (shown === this.shown && state.pose === this.pose)) return;
    Object.assign(this, { shown, pose: state.pose });
    const map = this.map(shown.note);
    frames.paint(map ?? undefined);
    this.marks.draw(map ? state.pose : shown.note.pose);
  }

  /** The map of the canvas's own pixels; null where the picture stays as it is. */
  map({ pose, lens, planet }) {
    const { state, frames: { canvas } } = this;
    const now = this.pilot.lens;
    const same = lens.width === now.width && lens.height === now.height && planet === state.planet.name;
    if (!same || pose === state.pose) return null;
    const [then, here] = [stand(state.body, pose), stand(state.body, state.pose)];
    const height_m = this.pilot.ground.guess_m();
    const pairs = SHARES.map(([x, y]) => {
      const pixel = [x * lens.width, y * lens.height];
      const point = ground(state.body, then, lens, pixel, height_m);
      const seen = point && state.body.sees(here.at, point) && project(here, lens, point);
      return seen ? [pixel, seen] : null;
    }).filter(Boolean);
    const scaled = (k) => pairs.map((pair) => [
      (pair[k][0] / lens.width) * canvas.width, (pair[k][1] / lens.height) * canvas.height,
    ]);
    return affine(scaled(0), scaled(1));
  }
}
