//! Cameras, and positions relative to them, in f64.

use relief_shaders::planet::View;

use super::planet::TestPlanet;

pub const UNIT_RAD: f64 = std::f64::consts::TAU / 4_294_967_296.0;

#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub s: u32,
    pub t: u32,
    pub height_m: f64,
    /// Clockwise from north.
    pub heading_deg: f64,
    pub pitch_deg: f64,
    pub roll_deg: f64,
    /// Vertical.
    pub fov_deg: f64,
    pub size: [u32; 2],
    pub pixel_error: f64,
    pub near_m: f64,
}

pub type Vec3 = [f64; 3];

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

pub fn wide(v: [f32; 3]) -> Vec3 {
    v.map(f64::from)
}

fn mix(a: Vec3, x: f64, b: Vec3, y: f64) -> Vec3 {
    [0, 1, 2].map(|i| a[i] * x + b[i] * y)
}

impl Camera {
    pub fn tan_y(&self) -> f64 {
        (self.fov_deg.to_radians() / 2.0).tan()
    }

    pub fn tan_x(&self) -> f64 {
        self.tan_y() * f64::from(self.size[0]) / f64::from(self.size[1])
    }

    pub fn focal_px(&self) -> f64 {
        f64::from(self.size[1]) / 2.0 / self.tan_y()
    }

    fn latitude(&self) -> f64 {
        (f64::from(self.t) - 2f64.powi(30)) * UNIT_RAD
    }

    /// Right, up, forward.
    pub fn axes(&self, planet: &TestPlanet) -> [Vec3; 3] {
        let (sin, cos) = self.latitude().sin_cos();
        let (east, north, up) = if planet.plane {
            ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
        } else {
            ([0.0, 1.0, 0.0], [-sin, 0.0, cos], [cos, 0.0, sin])
        };
        let (sh, ch) = self.heading_deg.to_radians().sin_cos();
        let (sp, cp) = self.pitch_deg.to_radians().sin_cos();
        let (sr, cr) = self.roll_deg.to_radians().sin_cos();
        let ahead = mix(north, ch, east, sh);
        let (right, forward) = (mix(east, ch, north, -sh), mix(ahead, cp, up, sp));
        let above = mix(up, cp, ahead, -sp);
        [mix(right, cr, above, -sr), mix(above, cr, right, sr), forward]
    }

    pub fn view(&self, planet: &TestPlanet) -> View {
        let (sin, cos) = self.latitude().sin_cos();
        let four = |v: Vec3, w: f64| [v[0] as f32, v[1] as f32, v[2] as f32, w as f32];
        let [right, up, forward] = self.axes(planet);
        let high = self.height_m as f32;
        let mut view = View {
            camera_s: self.s,
            camera_t: self.t,
            width: self.size[0],
            height: self.size[1],
            camera_h_hi_m: high,
            camera_h_lo_m: (self.height_m - f64::from(high)) as f32,
            tan_x: self.tan_x() as f32,
            tan_y: self.tan_y() as f32,
            right: four(right, self.focal_px()),
            up: four(up, self.pixel_error),
            forward: four(forward, self.near_m),
            sun: [0.0; 4],
            ..View::default()
        };
        if !planet.plane {
            let (a, b) = (planet.a_m, planet.b_m);
            let e2 = (a - b) * (a + b) / (a * a);
            view.sin_lat = sin as f32;
            view.cos_lat = if self.t == 0 || self.t == 1 << 31 { 0.0 } else { cos as f32 };
            view.w0 = (1.0 - e2 * sin * sin).sqrt() as f32;
            view.n0_m = (a / (1.0 - e2 * sin * sin).sqrt()) as f32;
        }
        view
    }

    /// (S, T, height) in the camera's frame, metres.
    pub fn relative_m(&self, planet: &TestPlanet, s: f64, t: f64, height_m: f64) -> Vec3 {
        if planet.plane {
            let d = |v: f64, c: u32| (v - f64::from(c)) * planet.unit_m;
            return [d(s, self.s), d(t, self.t), height_m - self.height_m];
        }
        let here = meridian(planet, (t - 2f64.powi(30)) * UNIT_RAD, height_m);
        let eye = meridian(planet, self.latitude(), self.height_m);
        let (sin, cos) = ((s - f64::from(self.s)) * UNIT_RAD).sin_cos();
        [here[0] * cos - eye[0], here[0] * sin, here[1] - eye[1]]
    }

    /// (S, T, height) of a point in the camera's frame; S may be any number of turns off.
    pub fn geodetic(&self, planet: &TestPlanet, p: Vec3) -> [f64; 3] {
        if planet.plane {
            let u = |v: f64, c: u32| v / planet.unit_m + f64::from(c);
            return [u(p[0], self.s), u(p[1], self.t), p[2] + self.height_m];
        }
        let body = relief_formats::geodesy::Ellipsoid { a_m: planet.a_m, b_m: planet.b_m };
        let eye = meridian(planet, self.latitude(), self.height_m);
        let at = body.geodetic_from_ecef([p[0] + eye[0], p[1], p[2] + eye[1]]);
        [at.lon_rad / UNIT_RAD + f64::from(self.s), at.lat_rad / UNIT_RAD + 2f64.powi(30), at.height_m]
    }

    /// Pixels right and up of the middle, and depth in metres.
    pub fn project(&self, axes: &[Vec3; 3], p: Vec3) -> [f64; 3] {
        let [x, y, z] = axes.map(|axis| dot(axis, p));
        [self.focal_px() * x / z, self.focal_px() * y / z, z]
    }

    /// True when a projected point is in the picture.
    pub fn sees(&self, [x, y, z]: [f64; 3]) -> bool {
        z >= self.near_m && x.abs() <= f64::from(self.size[0]) / 2.0 && y.abs() <= f64::from(self.size[1]) / 2.0
    }
}

/// Distance from the axis, and along it.
fn meridian(planet: &TestPlanet, lat_rad: f64, height_m: f64) -> [f64; 2] {
    let (sin, cos) = lat_rad.sin_cos();
    let (a, b) = (planet.a_m, planet.b_m);
    let n = a * a / (a * cos).hypot(b * sin);
    [(n + height_m) * cos, (n * (b / a) * (b / a) + height_m) * sin]
}
