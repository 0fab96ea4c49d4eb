// Shapes of bodies: the globe and the plane, with the same methods.
//
// A place is x, y (longitude and latitude in degrees; on a plane units of its CRS) and a height in
// metres; a point is a vector in metres: ECEF, or metres east and north of the plane's south-west
// corner and up.

import { direct } from './geodesic.js';
import { add, clamp, deg, dot, rad, scale, unit, wrap180 } from './vector.js';

/** The shape of a planet of the welcome. */
export const bodyOf = (planet) => (planet.plane ? new Plane(planet) : new Globe(planet));

/** Smaller root above 0 of a t^2 + 2 b t + c, or null. */
function firstRoot(a, b, c) {
  const square = b * b - a * c;
  if (square < 0) return null;
  const root = Math.sqrt(square);
  const near = (-b - root) / a;
  const far = (-b + root) / a;
  if (near > 0) return near;
  return far > 0 ? far : null;
}

class Globe {
  constructor(planet) {
    this.plane = false;
    this.a_m = planet.a_m;
    this.b_m = planet.b_m;
    this.e2 = 1 - (this.b_m / this.a_m) ** 2;
    this.highest_m = 3 * this.a_m;
    const [west, south, east, north] = planet.bounds;
    const extent_deg = Math.max((east - west) / 2, north - south);
    /** How much there is to see, metres. */
    this.extent_m = Math.min(rad(extent_deg) * this.a_m, 2.2 * this.a_m);
    this.centre = east - west > 300 ? [15, 20] : [(west + east) / 2, (south + north) / 2];
  }

  /** The point of a place. */
  point([x, y, height_m]) {
    const [lon, lat] = [rad(x), rad(y)];
    const n_m = this.a_m / Math.sqrt(1 - this.e2 * Math.sin(lat) ** 2);
    const across_m = (n_m + height_m) * Math.cos(lat);
    return [
      across_m * Math.cos(lon),
      across_m * Math.sin(lon),
      (n_m * (1 - this.e2) + height_m) * Math.sin(lat),
    ];
  }

  /** The place of a point (Bowring's formula, iterated). */
  place([px, py, pz]) {
    const across_m = Math.hypot(px, py);
    const second_e2 = (this.a_m / this.b_m) ** 2 - 1;
    let reduced = Math.atan2(pz * this.a_m, across_m * this.b_m);
    let lat = 0;
    for (let k = 0; k < 4; k += 1) {
      lat = Math.atan2(
        pz + second_e2 * this.b_m * Math.sin(reduced) ** 3,
        across_m - this.e2 * this.a_m * Math.cos(reduced) ** 3,
      );
      reduced = Math.atan2(this.b_m * Math.sin(lat), this.a_m * Math.cos(lat));
    }
    const w = Math.sqrt(1 - this.e2 * Math.sin(lat) ** 2);
    const height_m = across_m * Math.cos(lat) + pz * Math.sin(lat) - this.a_m * w;
    return [deg(Math.atan2(py, px)), deg(lat), height_m];
  }

  /** Unit vectors east, north and up. */
  horizon([x, y]) {
    const [lon, lat] = [rad(x), rad(y)];
    const [sin_lon, cos_lon, sin_lat, cos_lat] = [Math.sin(lon), Math.cos(lon), Math.sin(lat), Math.cos(lat)];
    return [
      [-sin_lon, cos_lon, 0],
      [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
      [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
    ];
  }

  /** Metres along a ray to the surface at a height, or null. */
  hit(origin, direction, height_m) {
    const [a, b] = [this.a_m + height_m, this.b_m + height_m];
    const squash = ([x, y, z]) => [x / a, y / a, z / b];
    const [o, d] = [squash(origin), squash(direction)];
    return firstRoot(dot(d, d), dot(o, d), dot(o, o) - 1);
  }

  /** The point at a height nearest to a ray that misses the surface: on the limb. */
  nearest(origin, direction, height_m) {
    const along = -dot(origin, direction) / dot(direction, direction);
    const closest = add(origin, scale(direction, Math.max(along, 0)));
    const [x, y] = this.place(closest);
    return this.point([x, y, height_m]);
  }

  /** True where the ground's curve does not hide a point from a camera. */
  sees(camera, point) {
    const squash = ([x, y, z]) => [x / this.a_m, y / this.a_m, z / this.b_m];
    const [c, p] = [squash(camera), squash(point)];
    const d = [p[0] - c[0], p[1] - c[1], p[2] - c[2]];
    const t = clamp(-dot(c, d) / dot(d, d), 0, 1);
    const nearest = add(c, scale(d, t));
    // A ray may graze: places of the sea lie below the ellipsoid.
    return t === 1 || dot(nearest, nearest) > 0.9995;
  }

  /** Ends of geodesics: [x, y, azimuth there]. */
  walk(x, y, azimuth_deg, distance_m) {
    return direct(this, x, y, azimuth_deg, distance_m);
  }

  /** Metres between places, and the azimuth to set out in; on the sphere, for flights. */
  way([x0, y0], [x1, y1]) {
    const [[, , p], [, , q]] = [this.horizon([x0, y0]), this.horizon([x1, y1])];
    const [east, north] = this.horizon([x0, y0]);
    const arc = Math.acos(clamp(dot(p, q), -1, 1));
    const azimuth_deg = deg(Math.atan2(dot(east, q), dot(north, q)));
    return { distance_m: arc * this.a_m, azimuth_deg, between: (t) => this.between(p, q, arc, t) };
  }

  between(p, q, arc, t) {
    if (arc < 1e-9) return this.ofNormal(q);
    const s = Math.sin(arc);
    if (s < 1e-9) return this.ofNormal(t < 0.5 ? p : q);
    return this.ofNormal(unit(add(scale(p, Math.sin((1 - t) * arc) / s), scale(q, Math.sin(t * arc) / s))));
  }

  ofNormal([x, y, z]) {
    return [deg(Math.atan2(y, x)), deg(Math.asin(clamp(z, -1, 1)))];
  }

  /** A place with its longitude in -180 to 180. */
  tidy([x, y]) {
    return [wrap180(x), clamp(y, -90, 90)];
  }
}

class Plane {
  constructor(planet) {
    this.plane = true;
    [this.west, this.south, this.east, this.north] = planet.bounds;
    [this.unit_x_m, this.unit_y_m] = planet.metres_per_unit ?? [1, 1];
    this.centre = [(this.west + this.east) / 2, (this.south + this.north) / 2];
    this.extent_m = Math.max((this.east - this.west) * this.unit_x_m, (this.north - this.south) * this.unit_y_m);
    this.highest_m = 4 * this.extent_m;
  }

  point([x, y, height_m]) {
    return [(x - this.west) * this.unit_x_m, (y - this.south) * this.unit_y_m, height_m];
  }

  place([px, py, pz]) {
    return [this.west + px / this.unit_x_m, this.south + py / this.unit_y_m, pz];
  }

  horizon() {
    return [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ];
  }

  hit(origin, direction, height_m) {
    const t = (height_m - origin[2]) / direction[2];
    return t > 0 && Number.isFinite(t) ? t : null;
  }

  nearest() {
    return null;
  }

  sees() {
    return true;
  }

  walk(x, y, azimuth_deg, distance_m) {
    const azimuth = rad(azimuth_deg);
    return [
      x + (distance_m * Math.sin(azimuth)) / this.unit_x_m,
      y + (distance_m * Math.cos(azimuth)) / this.unit_y_m,
      azimuth_deg,
    ];
  }

  way([x0, y0], [x1, y1]) {
    const [east_m, north_m] = [(x1 - x0) * this.unit_x_m, (y1 - y0) * this.unit_y_m];
    return {
      distance_m: Math.hypot(east_m, north_m),
      azimuth_deg: deg(Math.atan2(east_m, north_m)),
      between: (t) => [x0 + (x1 - x0) * t, y0 + (y1 - y0) * t],
    };
  }

  /** A camera stands on the map. */
  tidy([x, y]) {
    return [clamp(x, this.west, this.east), clamp(y, this.south, this.north)];
  }
}
