// How many pixels to ask for: all of the screen's when nothing moves, and as many as come at about
// fifteen pictures a second while it does.

const AIM_MS = 66;
const LEAST_SHARE = 0.2;

export class Resolution {
  constructor() {
    /** Of the full width and height, while moving. */
    this.share = 0.6;
    /** Round trip of a moving view, smoothed. */
    this.trip_ms = AIM_MS;
  }

  /** Pixels to ask for: the canvas's CSS sides, and the most pixels that the daemon draws. */
  size(width, height, most, moving) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const fit = Math.min(1, Math.sqrt(most / (width * height * ratio * ratio)));
    const scale = fit * (moving ? Math.min(this.share * ratio, ratio) : ratio);
    return [Math.max(1, Math.floor(width * scale)), Math.max(1, Math.floor(height * scale))];
  }

  /** A view of a moving camera took so long from its request to its picture. */
  took(trip_ms) {
    this.trip_ms = 0.7 * this.trip_ms + 0.3 * trip_ms;
    // Time goes with the pixels, the square of the share, beside a part that stays.
    const change = Math.min(Math.max((AIM_MS / trip_ms) ** 0.35, 0.75), 1.15);
    this.share = Math.min(Math.max(this.share * change, LEAST_SHARE), 1);
  }
}
