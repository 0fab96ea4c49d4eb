// The camera: where it stands, which way it looks, and what of the picture lies where.
//
// A pose is {x, y, height_m, heading_deg, pitch_deg}: heading clockwise from north, pitch 0 at the
// horizontal and -90 straight down. A lens is {fov_deg, width, height}: vertical field of view and
// the picture's sides in CSS pixels.

import { add, combine, dot, rad, scale, sub, unit } from './vector.js';

/** Where a pose's camera is and its unit vectors to the right, up and forward, as points. */
export function stand(body, pose) {
  const place = [pose.x, pose.y, pose.height_m];
  const [east, north, zenith] = body.horizon(place);
  const [h, p] = [rad(pose.heading_deg), rad(pose.pitch_deg)];
  const [sin_h, cos_h, sin_p, cos_p] = [Math.sin(h), Math.cos(h), Math.sin(p), Math.cos(p)];
  return {
    at: body.point(place),
    right: combine(cos_h, east, -sin_h, north, 0, zenith),
    up: combine(-sin_h * sin_p, east, -cos_h * sin_p, north, cos_p, zenith),
    forward: combine(sin_h * cos_p, east, cos_h * cos_p, north, sin_p, zenith),
  };
}

/** Pixels from the centre that stand for a slope of 1. */
const focal = (lens) => lens.height / (2 * Math.tan(rad(lens.fov_deg) / 2));

/** Unit vector through a pixel. */
export function ray(camera, lens, [px, py]) {
  const f = focal(lens);
  const [across, down] = [(px - lens.width / 2) / f, (py - lens.height / 2) / f];
  return unit(combine(1, camera.forward, across, camera.right, -down, camera.up));
}

/** The pixel of a point, or null behind the camera. */
export function project(camera, lens, point) {
  const d = sub(point, camera.at);
  const ahead = dot(d, camera.forward);
  if (ahead <= 0) return null;
  const f = focal(lens) / ahead;
  return [lens.width / 2 + f * dot(d, camera.right), lens.height / 2 - f * dot(d, camera.up)];
}

/** The point of the ground at a height that a pixel shows, or null in the sky. */
export function ground(body, camera, lens, pixel, height_m) {
  const direction = ray(camera, lens, pixel);
  const along_m = body.hit(camera.at, direction, height_m);
  return along_m === null ? null : add(camera.at, scale(direction, along_m));
}

/** Metres that a pixel is wide at a point. */
export function pixelWidth(camera, lens, point) {
  return dot(sub(point, camera.at), camera.forward) / focal(lens);
}

/** A pose as the protocol has it. */
export const poseList = (pose) => [pose.x, pose.y, pose.height_m, pose.heading_deg, pose.pitch_deg, 0];
