// How a pose changes so that a point of the ground stays under a pixel. Pure: poses in, poses out.

import { project, ray, stand } from './camera.js';
import { add, clamp, combine, cross, deg, dot, length, rad, scale, sub, turned, unit, wrap180, wrap360 } from './vector.js';

/** Nearer to a pole the picture turns about the globe's centre, and heading follows. */
const POLAR_DEG = 80;
export const LEAST_PITCH_DEG = -90;
export const MOST_PITCH_DEG = 60;

/** A pose moved to a point at its own height, with heading, pitch and all else kept. */
function movedTo(body, pose, point) {
  const [x, y] = body.tidy(body.place(point));
  return { ...pose, x, y };
}

/** Sets out over the ground: azimuth in degrees, distance in metres. */
export function walked(body, pose, azimuth_deg, distance_m) {
  const [far_x, far_y, there_deg] = body.walk(pose.x, pose.y, azimuth_deg, distance_m);
  const [x, y] = body.tidy([far_x, far_y]);
  // Near the poles a heading means nothing: what is ahead stays ahead.
  const polar = Math.abs(pose.y) > POLAR_DEG && !body.plane;
  const turn_deg = polar ? there_deg - azimuth_deg : 0;
  return { ...pose, x, y, heading_deg: wrap360(pose.heading_deg + turn_deg) };
}

/** The pose at the same height, heading and pitch that shows a point at a pixel, or null. */
export function held(body, pose, lens, point, pixel) {
  if (body.plane) return heldOnPlane(body, pose, lens, point, pixel);
  let now = pose;
  const miss = (of) => {
    const seen = project(stand(body, of), lens, point);
    return seen && [seen[0] - pixel[0], seen[1] - pixel[1]];
  };
  const most_m = 2 * length(sub(point, stand(body, pose).at));
  let walked_m = 0;
  for (let k = 0; k < 12; k += 1) {
    const off = miss(now);
    if (!off) return null;
    if (Math.hypot(...off) < 0.05) return walked_m < most_m ? now : null;
    const { at } = stand(body, now);
    const [east, north] = body.horizon([now.x, now.y]);
    const step_m = 1e-4 * length(sub(point, at));
    const eastOff = miss(movedTo(body, now, add(at, scale(east, step_m))));
    const northOff = miss(movedTo(body, now, add(at, scale(north, step_m))));
    if (!eastOff || !northOff) return null;
    const [a, b] = [(eastOff[0] - off[0]) / step_m, (northOff[0] - off[0]) / step_m];
    const [c, d] = [(eastOff[1] - off[1]) / step_m, (northOff[1] - off[1]) / step_m];
    const area = a * d - b * c;
    if (Math.abs(area) < 1e-6 * (a * a + b * b + c * c + d * d)) return null;
    let [e_m, n_m] = [(b * off[1] - d * off[0]) / area, (c * off[0] - a * off[1]) / area];
    const slow = Math.min(1, (0.3 * most_m) / Math.hypot(e_m, n_m));
    [e_m, n_m] = [e_m * slow, n_m * slow];
    walked_m += Math.hypot(e_m, n_m);
    now = movedTo(body, now, combine(1, at, e_m, east, n_m, north));
  }
  return null;
}

function heldOnPlane(body, pose, lens, point, pixel) {
  const camera = stand(body, pose);
  const direction = ray(camera, lens, pixel);
  const along_m = (point[2] - camera.at[2]) / direction[2];
  // Above the horizon, or so near it that a pixel is a country.
  if (!(along_m > 0) || along_m > 20 * length(sub(point, camera.at))) return null;
  const seen = add(camera.at, scale(direction, along_m));
  return movedTo(body, pose, add(camera.at, sub(point, seen)));
}

/** The globe turned about its centre until a point lies under a pixel; pitch and height stay. */
export function spun(body, pose, lens, point, pixel) {
  if (body.plane) return pose;
  const camera = stand(body, pose);
  const direction = ray(camera, lens, pixel);
  const height_m = body.place(point)[2];
  const along_m = body.hit(camera.at, direction, height_m);
  const seen = along_m === null
    ? body.nearest(camera.at, direction, height_m)
    : add(camera.at, scale(direction, along_m));
  const [from, to] = [unit(seen), unit(point)];
  const axis = cross(from, to);
  const sine = length(axis);
  if (sine < 1e-12) return pose;
  const angle = Math.atan2(sine, dot(from, to));
  const turn = (v) => turned(v, scale(axis, 1 / sine), angle);
  return oriented(body, pose, turn(camera.at), turn(camera.forward), turn(camera.up));
}

/** A pose with a place and directions; its height and pitch are kept. */
function oriented(body, pose, at, forward, up) {
  const [x, y] = body.tidy(body.place(at));
  const [east, north] = body.horizon([x, y]);
  const p = rad(pose.pitch_deg);
  // Along the heading, whatever the pitch.
  const level = add(scale(forward, Math.cos(p)), scale(up, -Math.sin(p)));
  return { ...pose, x, y, heading_deg: wrap360(deg(Math.atan2(dot(level, east), dot(level, north)))) };
}

/** Shares of the pointer's way, tried where the whole of it leads off the globe. */
const SHARES = [1, 0.6, 0.3, 0.1];

/** A drag: the point that was grabbed follows the pointer, as far as there is a way. */
export function dragged(body, pose, lens, point, pixel) {
  if (body.plane) return held(body, pose, lens, point, pixel) ?? pose;
  const polar = Math.abs(pose.y) > POLAR_DEG || Math.abs(body.place(point)[1]) > POLAR_DEG - 10;
  if (polar) {
    const turned = spun(body, pose, lens, point, pixel);
    return held(body, turned, lens, point, pixel) ?? turned;
  }
  const seen = project(stand(body, pose), lens, point) ?? pixel;
  for (const share of SHARES) {
    const target = [0, 1].map((k) => seen[k] + share * (pixel[k] - seen[k]));
    const moved = held(body, pose, lens, point, target);
    if (moved) return moved;
  }
  return pose;
}

/**
 * The pose that looks at a point through a pixel from a distance in metres, heading and pitch kept;
 * null where there is none, as around a pole.
 */
export function from(body, pose, lens, point, pixel, distance_m) {
  let now = pose;
  // The slower, the farther the point: by three quarters from three radii.
  for (let k = 0; k < 90; k += 1) {
    const direction = ray(stand(body, now), lens, pixel);
    const [far_x, far_y, height_m] = body.place(sub(point, scale(direction, distance_m)));
    const [x, y] = body.tidy([far_x, far_y]);
    const moved = Math.abs(wrap180(x - now.x)) + Math.abs(y - now.y);
    now = { ...now, x, y, height_m };
    if (moved < 1e-10) return now;
  }
  return null;
}

/** Closer to a point by a factor, which stays under its pixel; above 1 farther, as high as there is. */
export function zoomed(body, pose, lens, point, pixel, factor) {
  const camera = stand(body, pose);
  const offset = sub(camera.at, point);
  const distance_m = length(offset) * factor;
  if (factor <= 1) {
    return from(body, pose, lens, point, pixel, distance_m)
      ?? straight(body, pose, camera, add(point, scale(offset, factor)));
  }
  const aim = lowered(body, pose, factor);
  const now = from(body, aim, lens, point, pixel, distance_m);
  const seen = now && body.sees(stand(body, now).at, point) && now.height_m > pose.height_m;
  if (!seen) return risen(body, pose, pose.height_m - body.place(point)[2], factor);
  return now.height_m > body.highest_m ? pose : now;
}

/** Straight up, to a factor of the height above the ground. */
export function risen(body, pose, above_m, factor) {
  const height_m = pose.height_m + Math.max(above_m, 1) * (factor - 1);
  return { ...lowered(body, pose, factor), height_m: Math.max(pose.height_m, Math.min(height_m, body.highest_m)) };
}

/** Looking down the more, the higher: so that a camera that rises has the body in its picture. */
function lowered(body, pose, factor) {
  const high = Math.max(pose.height_m, 0) / (body.plane ? 10 * body.extent_m : body.a_m);
  const aim_deg = -90 * (1 - Math.exp(-12 * high));
  const way_deg = Math.min(aim_deg - pose.pitch_deg, 0);
  return { ...pose, pitch_deg: pose.pitch_deg + way_deg * (1 - factor ** -1.5) };
}

/** Moved in a straight line, directions kept; heading follows. */
function straight(body, pose, camera, to) {
  const height_m = body.place(to)[2];
  return oriented(body, { ...pose, height_m }, to, camera.forward, camera.up);
}

/** Turned about a point that stays under its pixel at its distance. */
export function orbited(body, pose, lens, point, pixel, heading_deg, pitch_deg) {
  const distance_m = length(sub(point, stand(body, pose).at));
  const aim = looked(pose, heading_deg, pitch_deg);
  return from(body, aim, lens, point, pixel, distance_m) ?? aim;
}

/** Turned on the spot. */
export function looked(pose, heading_deg, pitch_deg) {
  return {
    ...pose,
    heading_deg: wrap360(pose.heading_deg + heading_deg),
    pitch_deg: clamp(pose.pitch_deg + pitch_deg, LEAST_PITCH_DEG, MOST_PITCH_DEG),
  };
}
