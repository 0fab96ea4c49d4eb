// Moves the camera: grabs, zooms, turns and flies. Pixels are CSS pixels of the main canvas.

import { ground, ray, stand } from './camera.js';
import { Flight } from './flight.js';
import { dragged, from, looked, orbited, risen, walked, zoomed } from './moves.js';
import { add, clamp, length, scale, sub } from './vector.js';

/** Share of a zoom that is still to come which a sixtieth of a second takes. */
const ZOOM_SHARE = 0.22;
const DEG_PER_PIXEL = 0.25;
const NEAREST_M = 3;

export class Pilot {
  constructor(state, canvas, groundBelow) {
    Object.assign(this, { state, canvas, ground: groundBelow });
    /** The place that the pointer showed last: {pixel, height_m}. */
    this.hovered = null;
    this.stop();
  }

  /** Ends every motion. */
  stop() {
    this.flight = null;
    this.grabbed = null;
    this.zoom = null;
    this.drift = null;
  }

  get lens() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return { fov_deg: this.state.fov_deg, width: Math.max(width, 1), height: Math.max(height, 1) };
  }

  get centre() {
    return [this.lens.width / 2, this.lens.height / 2];
  }

  /** The point that a pixel shows, as far as the page knows; null in the sky. */
  at(pixel) {
    const { body, pose } = this.state;
    const near = this.hovered && Math.hypot(this.hovered.pixel[0] - pixel[0], this.hovered.pixel[1] - pixel[1]) < 24;
    const height_m = near ? this.hovered.height_m : this.ground.guess_m();
    return ground(body, stand(body, pose), this.lens, pixel, height_m);
  }

  /** A point ahead in the sky. */
  towards(pixel) {
    const { body, pose } = this.state;
    const camera = stand(body, pose);
    const ahead_m = Math.max(5 * this.ground.above_m(pose), 50);
    return add(camera.at, scale(ray(camera, this.lens, pixel), ahead_m));
  }

  put(pose) {
    this.state.change({ pose: this.ground.above(pose) });
  }

  /** Begins a drag. */
  grab(pixel) {
    this.stop();
    this.grabbed = { point: this.at(pixel), pixel };
  }

  /** The pointer that dragged is at a pixel now. */
  drag(pixel) {
    const { body, pose } = this.state;
    if (!this.grabbed) return;
    const [dx, dy] = [pixel[0] - this.grabbed.pixel[0], pixel[1] - this.grabbed.pixel[1]];
    this.grabbed.pixel = pixel;
    if (this.grabbed.point) {
      this.put(dragged(body, pose, this.lens, this.grabbed.point, pixel));
    } else {
      const slope = this.state.fov_deg / this.lens.height;
      this.put(looked(pose, -dx * slope, dy * slope));
    }
  }

  drop() {
    this.grabbed = null;
  }

  /** Begins to turn about the point under a pixel. */
  pivot(pixel) {
    this.stop();
    const point = this.at(pixel);
    this.pivoted = { point, pixel };
  }

  /** Turned by so many degrees about the pivot, or on the spot where that is the sky. */
  turn(heading_deg, pitch_deg) {
    const { body, pose } = this.state;
    const { point, pixel } = this.pivoted ?? { point: null };
    this.put(point
      ? orbited(body, pose, this.lens, point, pixel, heading_deg, pitch_deg)
      : looked(pose, heading_deg, pitch_deg));
  }

  /** As `turn`, by a way of the pointer. */
  turnBy(dx, dy) {
    this.turn(dx * DEG_PER_PIXEL, -dy * DEG_PER_PIXEL);
  }

  /** Nearer to the point under a pixel by a factor, at once; away from the sky is up. */
  zoomNow(pixel, factor, target = this.at(pixel)) {
    const { body, pose } = this.state;
    if (!target && factor > 1) {
      this.put(risen(body, pose, this.ground.above_m(pose), factor));
      return;
    }
    const point = target ?? this.towards(pixel);
    const distance_m = length(sub(point, stand(body, pose).at));
    const least = Math.min(1, NEAREST_M / distance_m);
    this.put(zoomed(body, pose, this.lens, point, pixel, Math.max(factor, least)));
  }

  /** Nearer by a factor, over the next moments. */
  zoomBy(pixel, factor) {
    const same = this.zoom && Math.hypot(this.zoom.pixel[0] - pixel[0], this.zoom.pixel[1] - pixel[1]) < 3;
    if (!same) {
      this.stop();
      this.zoom = { pixel, point: this.at(pixel), left: 0 };
    }
    this.zoom.left = clamp(this.zoom.left + Math.log(factor), -3, 3);
  }

  /** Over the ground by shares of the height above it: to the right and ahead in the picture. */
  go(right, ahead) {
    const { body, pose } = this.state;
    const way_m = Math.hypot(right, ahead) * Math.max(this.ground.above_m(pose), 4);
    const azimuth_deg = pose.heading_deg + (Math.atan2(right, ahead) * 180) / Math.PI;
    this.put(walked(body, pose, azimuth_deg, Math.min(way_m, 0.5 * body.extent_m)));
  }

  /** Turned on the spot; from high above, about the centre of the picture. */
  lookBy(heading_deg, pitch_deg) {
    this.flight = null;
    this.pivot(this.centre);
    this.turn(heading_deg, pitch_deg);
  }

  /** Flies to a pose; `ground_m` is the ground's height there. */
  fly(pose, ground_m = this.ground.guess_m()) {
    this.stop();
    this.flight = new Flight(this.state.body, this.state.pose, pose, ground_m);
    this.tick(0);
  }

  /** Flies to where a place is in the middle of the picture. */
  visit([x, y], ground_m) {
    const { body, planet, pose } = this.state;
    const distance_m = clamp(25 * planet.spacing_m, 4000, 0.6 * body.extent_m);
    const pitch_deg = -40;
    const heading_deg = body.plane ? pose.heading_deg : 0;
    const over = { x, y, height_m: ground_m + distance_m, heading_deg, pitch_deg };
    const point = body.point([x, y, ground_m]);
    const aimed = from(body, over, this.lens, point, this.centre, distance_m) ?? over;
    this.fly(aimed, ground_m);
  }

  /** North up, or home. */
  north() {
    const { pose } = this.state;
    this.fly({ ...pose, heading_deg: 0 });
  }

  home() {
    this.fly(this.state.home());
  }

  /** Some seconds go by. */
  tick(seconds) {
    if (this.flight) {
      const { flight } = this;
      const pose = flight.tick(seconds);
      if (flight.done) {
        this.flight = null;
        this.ground.height_m = flight.ground_m;
      }
      this.state.change({ pose });
    }
    if (this.zoom) {
      const { zoom } = this;
      const part = 1 - (1 - ZOOM_SHARE) ** (seconds * 60);
      const step = Math.abs(zoom.left) < 0.004 ? zoom.left : zoom.left * part;
      zoom.left -= step;
      this.zoomNow(zoom.pixel, Math.exp(step), zoom.point);
      if (zoom.left === 0) this.zoom = null;
    }
    this.ground.follow(() => !this.flight);
  }
}
