// About where the sun stands, to choose times by: good to a few hundredths of a degree between 1950
// and 2050 (The Astronomical Almanac, low-precision formulas). The daemon works out the light itself.

import { deg, rad, wrap180 } from './vector.js';

const DAY_MS = 86_400_000;
const J2000_MS = Date.UTC(2000, 0, 1, 12);

/** The sub-solar point at a time: [longitude, latitude], degrees. */
export function subSolar(time_ms) {
  const days = (time_ms - J2000_MS) / DAY_MS;
  const anomaly = rad(357.528 + 0.985_600_3 * days);
  const mean_deg = 280.46 + 0.985_647_4 * days;
  const ecliptic = rad(mean_deg + 1.915 * Math.sin(anomaly) + 0.02 * Math.sin(2 * anomaly));
  const tilt = rad(23.439 - 4e-7 * days);
  const ascension_deg = deg(Math.atan2(Math.cos(tilt) * Math.sin(ecliptic), Math.cos(ecliptic)));
  const latitude_deg = deg(Math.asin(Math.sin(tilt) * Math.sin(ecliptic)));
  const sidereal_deg = 280.460_618 + 360.985_647_4 * days;
  return [wrap180(ascension_deg - sidereal_deg), latitude_deg];
}

/** The sun above the horizon of a place, degrees. */
export function elevation(time_ms, [lon_deg, lat_deg]) {
  const [sun_lon, sun_lat] = subSolar(time_ms);
  const [a, b, hour] = [rad(lat_deg), rad(sun_lat), rad(lon_deg - sun_lon)];
  return deg(Math.asin(Math.sin(a) * Math.sin(b) + Math.cos(a) * Math.cos(b) * Math.cos(hour)));
}

/** The time within twelve hours at which it is noon at a longitude. */
export function noon(time_ms, lon_deg) {
  const towards = (at_ms) => (wrap180(subSolar(at_ms)[0] - lon_deg) / 360) * DAY_MS;
  const near = time_ms + towards(time_ms);
  return near + towards(near);
}

/**
 * The time of that day at which the sun climbs (`rise`) or sinks (`set`) through an elevation; null
 * where it does not on that day.
 */
export function crossing(time_ms, place, which, elevation_deg) {
  const middle = noon(time_ms, place[0]);
  const other = middle + (which === 'rise' ? -0.5 : 0.5) * DAY_MS;
  let [above, below] = [middle, other];
  if (elevation(above, place) < elevation_deg || elevation(below, place) > elevation_deg) return null;
  for (let k = 0; k < 30; k += 1) {
    const half = (above + below) / 2;
    if (elevation(half, place) > elevation_deg) above = half;
    else below = half;
  }
  return above;
}
