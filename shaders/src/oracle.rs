//! The truth about a ray, in f64, without a pyramid: every cell border along the ray, the
//! bilinear surface between them. Shares no code with the kernels.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use relief_formats::geodesy::{Ellipsoid, Geodetic};

/// Heights at the nodes of a map, and what it lies on.
pub struct World {
    /// What it is.
    pub name: &'static str,
    /// The map exponent.
    pub m: u32,
    /// None: a plane.
    pub ellipsoid: Option<Ellipsoid>,
    /// Metres between a plane's nodes.
    pub spacing_m: [f64; 2],
    /// (columns + 1) x (rows + 1), south row first.
    pub nodes_m: Vec<f32>,
}

/// The largest elevation angle of the relief along a ray, less the sun's.
#[derive(Clone, Copy, Debug)]
pub struct Margin {
    /// Radians; positive: shadow.
    pub angle_rad: f64,
    /// Distance of the highest point, metres.
    pub distance_m: f64,
}

impl Margin {
    /// Half the width of the band in which a kernel may differ, radians.
    #[must_use]
    pub fn tolerance_rad(&self) -> f64 {
        1e-4 + 0.002 / self.distance_m
    }

    /// True within the band.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        self.angle_rad.abs() <= self.tolerance_rad()
    }
}

type Vector = [f64; 3];

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn along(a: Vector, b: Vector, t: f64) -> Vector {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

/// A ray in Cartesian coordinates (a plane: x, y, z metres from its south-west node).
struct Line {
    start: Vector,
    direction: Vector,
    up: Vector,
    sun_elevation_rad: f64,
    eastwards: f64,
}

/// Where a point is: cells from the south-west, height, normal.
struct At {
    x: f64,
    y: f64,
    height_m: f64,
    normal: Vector,
}

impl World {
    /// Rows of cells.
    #[must_use]
    pub fn rows(&self) -> usize {
        1 << self.m
    }

    /// Columns of cells.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.rows() << u32::from(self.ellipsoid.is_some())
    }

    /// The greatest height, metres.
    #[must_use]
    pub fn max_m(&self) -> f64 {
        self.nodes_m.iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b)).into()
    }

    /// S_0 in cell (i, j) at coordinates in cells, which may lie beyond the cell's border.
    fn patch_m(&self, i: i64, j: i64, x: f64, y: f64) -> f64 {
        let stride = self.columns() + 1;
        let node = |i: i64, j: i64| f64::from(self.nodes_m[j as usize * stride + i as usize]);
        let (u, v) = ((x - i as f64).clamp(0.0, 1.0), (y - j as f64).clamp(0.0, 1.0));
        let south = node(i, j) * (1.0 - u) + node(i + 1, j) * u;
        let north = node(i, j + 1) * (1.0 - u) + node(i + 1, j + 1) * u;
        south * (1.0 - v) + north * v
    }

    fn cells(&self, s: u32, t: u32) -> [f64; 2] {
        let unit = f64::from(31 - self.m).exp2();
        [f64::from(s) / unit, f64::from(t) / unit]
    }

    /// S_0 at fixed-point (S, T), metres.
    #[must_use]
    pub fn height_m(&self, s: u32, t: u32) -> f64 {
        let [x, y] = self.cells(s, t);
        let i = (x as i64).min(self.columns() as i64 - 1);
        let j = (y as i64).min(self.rows() as i64 - 1);
        self.patch_m(i, j, x, y)
    }

    fn line(&self, s: u32, t: u32, sun: [f64; 3]) -> Line {
        let height_m = self.height_m(s, t);
        let [x, y] = self.cells(s, t);
        let [e, n, u] = sun;
        let sun_elevation_rad = u.atan2(e.hypot(n));
        let Some(ellipsoid) = self.ellipsoid else {
            return Line {
                start: [x * self.spacing_m[0], y * self.spacing_m[1], height_m],
                direction: sun,
                up: [0.0, 0.0, 1.0],
                sun_elevation_rad,
                eastwards: e,
            };
        };
        let (lon, lat) = (x / self.columns() as f64 * TAU - PI, y / self.rows() as f64 * PI - FRAC_PI_2);
        let ((sl, cl), (sp, cp)) = (lon.sin_cos(), lat.sin_cos());
        let (east, north, up) = ([-sl, cl, 0.0], [-sp * cl, -sp * sl, cp], [cp * cl, cp * sl, sp]);
        Line {
            start: ellipsoid.ecef_m(Geodetic { lon_rad: lon, lat_rad: lat, height_m }),
            direction: along(along(east.map(|v| v * e), north, n), up, u),
            up,
            sun_elevation_rad,
            eastwards: e,
        }
    }

    fn at(&self, line: &Line, distance_m: f64) -> At {
        let point = along(line.start, line.direction, distance_m);
        let Some(ellipsoid) = self.ellipsoid else {
            let [x, y] = [point[0] / self.spacing_m[0], point[1] / self.spacing_m[1]];
            return At { x, y, height_m: point[2], normal: line.up };
        };
        let g = ellipsoid.geodetic_from_ecef(point);
        let ((sl, cl), (sp, cp)) = (g.lon_rad.sin_cos(), g.lat_rad.sin_cos());
        At {
            x: (g.lon_rad + PI) / TAU * self.columns() as f64,
            y: (g.lat_rad + FRAC_PI_2) / PI * self.rows() as f64,
            height_m: g.height_m,
            normal: [cp * cl, cp * sl, sp],
        }
    }

    /// Elevation of a point at a height above or below the ray at a distance, less the sun's.
    fn angle_rad(&self, line: &Line, distance_m: f64, at: &At, height_m: f64) -> f64 {
        let offset = along(line.direction.map(|v| v * distance_m), at.normal, height_m - at.height_m);
        let up = dot(offset, line.up);
        let flat = along(offset, line.up, -up);
        up.atan2(dot(flat, flat).sqrt()) - line.sun_elevation_rad
    }

    /// Distance at which the ray crosses the meridian of column `i`.
    fn meridian_m(&self, line: &Line, i: i64) -> f64 {
        if self.ellipsoid.is_none() {
            return (i as f64 * self.spacing_m[0] - line.start[0]) / line.direction[0];
        }
        let (sin, cos) = (i as f64 / self.columns() as f64 * TAU - PI).sin_cos();
        let normal = [-sin, cos, 0.0];
        let distance_m = -dot(line.start, normal) / dot(line.direction, normal);
        let point = along(line.start, line.direction, distance_m);
        if point[0] * cos + point[1] * sin > 0.0 { distance_m } else { f64::INFINITY }
    }

    /// The margin of a ray from S_0 at (S, T) towards the sun (east, north, up), exact while it is
    /// within `range_rad`; beyond, only its sign and its being beyond are.
    #[must_use]
    pub fn margin(&self, s: u32, t: u32, sun: [f64; 3], range_rad: f64) -> Margin {
        self.margin_under(self.max_m(), s, t, sun, range_rad)
    }

    /// [`World::margin`] for callers with many rays, who know the greatest height.
    #[must_use]
    pub fn margin_under(&self, max_m: f64, s: u32, t: u32, sun: [f64; 3], range_rad: f64) -> Margin {
        let line = self.line(s, t, sun);
        if sun[0].hypot(sun[1]) < 1e-9 {
            return Margin { angle_rad: -sun[2] * FRAC_PI_2, distance_m: 1.0 };
        }
        let cell_m = match self.ellipsoid {
            Some(ellipsoid) => ellipsoid.a_m * PI / self.rows() as f64,
            None => self.spacing_m[0].min(self.spacing_m[1]),
        };
        let (columns, rows) = (self.columns() as i64, self.rows() as i64);
        let plane = self.ellipsoid.is_none();
        let near_m = 0.01 * cell_m;
        // The cell is that of a point a hair ahead, nearer than which no border is told apart.
        let hair_m = 1e-7 * cell_m;
        let axis_m = -(line.start[0] * line.direction[0] + line.start[1] * line.direction[1])
            / line.direction[0].hypot(line.direction[1]).powi(2);
        let mut from_m = 0.0;
        let mut best = Margin { angle_rad: -PI, distance_m: near_m };
        loop {
            let ahead = self.at(&line, from_m + hair_m);
            let off = |v: f64, cells: i64| v < 0.0 || v > cells as f64;
            if plane && (off(ahead.x, columns) || off(ahead.y, rows)) {
                return best;
            }
            // The far edges belong to the map.
            let (i, j) = ((ahead.x as i64).min(columns - 1), (ahead.y as i64).min(rows - 1));
            // Short at first: the angle varies with the ratio of distances.
            let mut to_m = (from_m + 0.5 * cell_m).min((1.25 * from_m).max(2.0 * near_m));
            let mut meet = |border_m: f64| {
                if border_m > from_m + hair_m && border_m < to_m {
                    to_m = border_m;
                }
            };
            if line.eastwards != 0.0 {
                meet(self.meridian_m(&line, i + i64::from(line.eastwards > 0.0)));
            }
            if !plane {
                // Past a pole the longitude may jump.
                meet(axis_m);
            }
            let row = |distance_m: f64| self.at(&line, distance_m).y;
            let y = row(to_m);
            if y < j as f64 || y > (j + 1) as f64 {
                let up = y > j as f64;
                let border = (j + i64::from(up)) as f64;
                let (mut low, mut high) = (from_m + hair_m, to_m);
                while high - low > 1e-2 * hair_m {
                    let middle = 0.5 * (low + high);
                    if (row(middle) > border) == up { high = middle } else { low = middle }
                }
                to_m = high;
            }
            let angle = |distance_m: f64| {
                let at = self.at(&line, distance_m);
                // The longitude as seen from this cell.
                let x = at.x + ((i as f64 + 0.5 - at.x) / columns as f64).round() * columns as f64 * f64::from(!plane);
                self.angle_rad(&line, distance_m, &at, self.patch_m(i, j, x, at.y))
            };
            if to_m > near_m {
                let (a, b) = (from_m.max(near_m), to_m);
                let (fa, fm, fb) = (angle(a), angle(0.5 * (a + b)), angle(b));
                let (p, q) = (4.0 * fm - 3.0 * fa - fb, 2.0 * (fa + fb) - 4.0 * fm);
                let vertex = if q < 0.0 { (-0.5 * p / q).clamp(0.0, 1.0) } else { 0.0 };
                let peak = a + vertex * (b - a);
                for (angle_rad, distance_m) in [(fa, a), (fb, b), (fm, 0.5 * (a + b)), (angle(peak), peak)] {
                    if angle_rad > best.angle_rad {
                        best = Margin { angle_rad, distance_m };
                    }
                }
                if best.angle_rad > range_rad.max(2.0 * best.tolerance_rad()) {
                    return best;
                }
                let at = self.at(&line, b);
                let rising = dot(at.normal, line.direction) > 0.0;
                let rest_rad = self.angle_rad(&line, b, &at, max_m);
                if rising && (rest_rad < best.angle_rad || rest_rad < -range_rad) || b > 1e8 {
                    return best;
                }
            }
            from_m = to_m;
        }
    }
}
