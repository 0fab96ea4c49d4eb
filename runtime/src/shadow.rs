//! The sunlight of nodes, as masks of windows of a level, and of points.

use std::time::{Duration, Instant};

use relief_shaders::shadow::mask::shadow_mask;
use relief_shaders::shadow::shadow_points;

use crate::residency::{Ram, Resident, Store};
use crate::view::Sun;

pub use relief_shaders::shadow::mask::{ShadowWindow, WindowCounts};
pub use relief_shaders::shadow::{PointSun, SunlitPoint};

/// How much of the sun the nodes of a window see.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Visible part of the sun, 0 to 255, row by row from the south.
    pub lit: Vec<u8>,
    /// What the rays fetched.
    pub counts: WindowCounts,
    /// Pages that rays lacked to the end; coarser ones stood in.
    pub lacking: usize,
}

/// Height and sunlight of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SunlitPoints {
    /// In the order of the places.
    pub points: Vec<SunlitPoint>,
    /// Pages that were lacked to the end; coarser ones stood in.
    pub lacking: usize,
}

/// The sun of a [`ShadowWindow`] or a [`PointSun`]: its direction, and the radius of its disk in radians.
#[must_use]
pub fn sun_of(sun: &Sun, radius_deg: f64) -> [f32; 4] {
    let ([x, y, z], radius_rad) = match *sun {
        Sun::Ecef(v) | Sun::Local(v) => (v.map(|c| c as f32), radius_deg.to_radians() as f32),
    };
    [x, y, z, radius_rad]
}

/// The sunlight of a window's nodes by the kernel's twin; again and again until no page lacks, the
/// atlas is full or `time` is over.
pub fn mask_in_ram(resident: &mut Resident<Ram>, window: &ShadowWindow, time: Duration) -> Mask {
    let deadline = Instant::now() + time;
    loop {
        let (lit, counts) = shadow_mask(&resident.pages(), window);
        let lacking = resident.ask_seen();
        if lacking == 0 || !resident.load_more(deadline) {
            return Mask { lit, counts, lacking };
        }
    }
}

/// Height and sunlight at fixed-point places (S, T) by the kernel's twin; again and again until no
/// page lacks, the atlas is full or `time` is over.
pub fn points_in_ram(
    resident: &mut Resident<Ram>,
    sun: &PointSun,
    places: &[[u32; 2]],
    time: Duration,
) -> SunlitPoints {
    let deadline = Instant::now() + time;
    let mut points: Vec<SunlitPoint> =
        places.iter().map(|&[s, t]| SunlitPoint { s, t, ..SunlitPoint::default() }).collect();
    loop {
        shadow_points(&resident.pages(), sun, &mut points);
        let lacking = resident.ask_seen();
        if lacking == 0 || !resident.load_more(deadline) {
            return SunlitPoints { points, lacking };
        }
    }
}

impl<S: Store> Resident<S> {
    /// Loads pages that were asked for until the deadline; false when no more will come.
    pub fn load_more(&mut self, deadline: Instant) -> bool {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return false;
        }
        let progress = self.update(left);
        !(progress.full && progress.loaded == 0)
    }
}
