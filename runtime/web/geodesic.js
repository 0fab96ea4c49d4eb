// Geodesics on an ellipsoid from their start: T. Vincenty, Direct and inverse solutions of geodesics
// on the ellipsoid with application of nested equations, Survey Review 23 (1975), equations 1 to 11.
// The direct problem converges everywhere, to less than a millimetre. Lengths come from the daemon.

import { deg, rad, wrap180 } from './vector.js';

/** The end of a geodesic: [longitude, latitude, azimuth there], degrees. */
export function direct({ a_m, b_m }, lon_deg, lat_deg, azimuth_deg, distance_m) {
  const f = 1 - b_m / a_m;
  const [sin_az, cos_az] = [Math.sin(rad(azimuth_deg)), Math.cos(rad(azimuth_deg))];
  const tan_u = (1 - f) * Math.tan(rad(lat_deg));
  const cos_u = 1 / Math.hypot(1, tan_u);
  const sin_u = tan_u * cos_u;
  const sigma_1 = Math.atan2(tan_u, cos_az);
  const sin_alpha = cos_u * sin_az;
  const cos2_alpha = 1 - sin_alpha * sin_alpha;
  const u2 = cos2_alpha * ((a_m / b_m) ** 2 - 1);
  const a = 1 + (u2 / 16384) * (4096 + u2 * (-768 + u2 * (320 - 175 * u2)));
  const b = (u2 / 1024) * (256 + u2 * (-128 + u2 * (74 - 47 * u2)));
  let sigma = distance_m / (b_m * a);
  let [sin_s, cos_s, cos_2m] = [0, 1, 1];
  for (let k = 0; k < 20; k += 1) {
    [sin_s, cos_s, cos_2m] = [Math.sin(sigma), Math.cos(sigma), Math.cos(2 * sigma_1 + sigma)];
    const inner = (b / 6) * cos_2m * (4 * sin_s * sin_s - 3) * (4 * cos_2m * cos_2m - 3);
    const change = b * sin_s * (cos_2m + (b / 4) * (cos_s * (2 * cos_2m * cos_2m - 1) - inner));
    const next = distance_m / (b_m * a) + change;
    const done = Math.abs(next - sigma) < 1e-13;
    sigma = next;
    if (done) break;
  }
  [sin_s, cos_s, cos_2m] = [Math.sin(sigma), Math.cos(sigma), Math.cos(2 * sigma_1 + sigma)];
  const towards = sin_u * sin_s - cos_u * cos_s * cos_az;
  const lat = Math.atan2(
    sin_u * cos_s + cos_u * sin_s * cos_az,
    (1 - f) * Math.hypot(sin_alpha, towards),
  );
  const lambda = Math.atan2(sin_s * sin_az, cos_u * cos_s - sin_u * sin_s * cos_az);
  const c = (f / 16) * cos2_alpha * (4 + f * (4 - 3 * cos2_alpha));
  const bent = cos_2m + c * cos_s * (2 * cos_2m * cos_2m - 1);
  const lon = lambda - (1 - c) * f * sin_alpha * (sigma + c * sin_s * bent);
  return [wrap180(lon_deg + deg(lon)), deg(lat), deg(Math.atan2(sin_alpha, -towards))];
}
