// Vectors of three numbers, as arrays.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scale(a, 1 / length(a));

/** a * x + b * y + c * z, where x, y and z are vectors. */
export const combine = (a, x, b, y, c, z) => add(add(scale(x, a), scale(y, b)), scale(z, c));

/** v turned about a unit axis (Rodrigues' formula), counter-clockwise seen from its tip. */
export function turned(v, axis, angle_rad) {
  const [s, c] = [Math.sin(angle_rad), Math.cos(angle_rad)];
  return combine(c, v, s, cross(axis, v), (1 - c) * dot(axis, v), axis);
}

export const rad = (deg) => (deg * Math.PI) / 180;
export const deg = (rad) => (rad * 180) / Math.PI;
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
/** An angle in -180 (included) to 180 degrees. */
export const wrap180 = (angle_deg) => angle_deg - 360 * Math.floor((angle_deg + 180) / 360);
/** An angle in 0 (included) to 360 degrees. */
export const wrap360 = (angle_deg) => angle_deg - 360 * Math.floor(angle_deg / 360);
