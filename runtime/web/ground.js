// The height of the relief under the camera, which stays two metres above it.

export const LEAST_ABOVE_M = 2;
const PAUSE_MS = 80;

export class Ground {
  constructor(state, questions) {
    Object.assign(this, { state, questions });
    this.forget();
  }

  /** Of another planet. */
  forget() {
    this.height_m = null;
    this.asked = null;
    this.asked_ms = 0;
    this.busy = false;
  }

  /** The best guess of the ground's height around the camera, metres. */
  guess_m() {
    return this.height_m ?? Math.max(0, this.state.planet.min_m);
  }

  /** Metres of a pose above the ground below it, at least a little. */
  above_m(pose) {
    return Math.max(pose.height_m - this.guess_m(), LEAST_ABOVE_M / 2);
  }

  /** The pose, lifted out of the ground. */
  above(pose) {
    if (this.height_m === null) return pose;
    const least_m = this.height_m + LEAST_ABOVE_M;
    return pose.height_m < least_m ? { ...pose, height_m: least_m } : pose;
  }

  /** Asks for the height under the camera where it has moved; `lift` says whether it may be lifted. */
  async follow(lift) {
    const { pose, planet } = this.state;
    const key = `${pose.x.toPrecision(9)} ${pose.y.toPrecision(9)}`;
    if (this.busy || key === this.asked || performance.now() - this.asked_ms < PAUSE_MS) return;
    // Far above all mountains a rough figure does.
    if (this.height_m !== null && pose.height_m > 20 * (planet.max_m - planet.min_m) + planet.max_m) return;
    this.busy = true;
    this.asked = key;
    this.asked_ms = performance.now();
    try {
      const height_m = await this.questions.height(planet, [pose.x, pose.y]);
      if (planet !== this.state.planet) return;
      if (Number.isFinite(height_m)) this.height_m = height_m;
      if (lift()) this.state.change({ pose: this.above(this.state.pose) });
    } catch {
      // The daemon is away, or off the map: asked again when the camera moves.
    } finally {
      this.busy = false;
    }
  }
}
