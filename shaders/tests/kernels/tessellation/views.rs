//! Cameras: random ones and the hard cases of a planet: poles, seam, horizon, ground, far away, long lens.

use super::camera::Camera;
use super::planet::{TestPlanet, hash};

const BASE: Camera = Camera {
    s: 0x8123_4567,
    t: 0x5000_1234,
    height_m: 0.0,
    heading_deg: 30.0,
    pitch_deg: -20.0,
    roll_deg: 0.0,
    fov_deg: 50.0,
    size: [640, 360],
    pixel_error: 2.0,
    near_m: 0.1,
};

/// Named views of a globe.
pub fn hard(planet: &TestPlanet) -> Vec<(&'static str, Camera)> {
    let above = |s: u32, t: u32, h: f64| planet.height_m(f64::from(s), f64::from(t)) + h;
    let a = planet.a_m;
    let far = 1e-3 * a;
    let (s, t) = (BASE.s, BASE.t);
    let north = 1 << 31;
    vec![
        ("over the south pole", Camera { t: 0, height_m: above(s, 0, far), pitch_deg: -90.0, ..BASE }),
        ("over the north pole", Camera { t: north, height_m: above(s, north, far), pitch_deg: -60.0, ..BASE }),
        ("near a pole", Camera { t: north - 0x10_0003, height_m: above(s, north - 0x10_0003, far), ..BASE }),
        (
            "at the antimeridian",
            Camera { s: 5, height_m: above(5, t, far), pitch_deg: -40.0, heading_deg: 270.0, ..BASE },
        ),
        ("on the seam", Camera { s: 0, height_m: above(0, t, 10.0 * far), pitch_deg: -90.0, roll_deg: 25.0, ..BASE }),
        ("horizon", Camera { height_m: above(s, t, far), pitch_deg: 0.0, ..BASE }),
        ("one metre up", Camera { height_m: above(s, t, 1.0), pitch_deg: -5.0, ..BASE }),
        ("one metre up, down", Camera { height_m: above(s, t, 1.0), pitch_deg: -90.0, ..BASE }),
        ("inside the ground", Camera { height_m: above(s, t, -5.0), pitch_deg: 10.0, ..BASE }),
        ("ten radii", Camera { height_m: 9.0 * a, pitch_deg: -90.0, fov_deg: 15.0, ..BASE }),
        ("lens", Camera { height_m: above(s, t, 100.0 * far), pitch_deg: -70.0, fov_deg: 0.01, ..BASE }),
        ("lens at the limb", Camera { height_m: 9.0 * a, pitch_deg: -84.29, fov_deg: 0.01, near_m: 1000.0, ..BASE }),
        ("wide", Camera { height_m: above(s, t, 3.0 * far), pitch_deg: -30.0, fov_deg: 120.0, roll_deg: 80.0, ..BASE }),
    ]
}

/// Random views: places, heights over many scales, directions mostly downwards.
pub fn random(planet: &TestPlanet, n: u64, seed: u64) -> Camera {
    let unit = |k: u64| (hash(n, k, seed) % 1_000_001) as f64 / 1e6;
    // A plane's camera may not lie on its western or southern edge.
    let (s, t) = (hash(n, 1, seed) as u32, (hash(n, 2, seed) as u32 >> 1).max(1));
    let s = if planet.plane { (s >> 1).max(1) } else { s };
    let size = if planet.plane { planet.unit_m * 2f64.powi(31) } else { planet.a_m };
    let up = size * 10f64.powf(-5.5 + 5.5 * unit(3));
    let height_m = planet.height_m(f64::from(s), f64::from(t)) + up;
    Camera {
        s,
        t,
        height_m,
        heading_deg: 360.0 * unit(4),
        pitch_deg: 20.0 - 110.0 * unit(5),
        roll_deg: 360.0 * unit(6),
        fov_deg: 10f64.powf(2.0 * unit(7)),
        near_m: (up * 1e-3).max(0.1),
        ..BASE
    }
}
