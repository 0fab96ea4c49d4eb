//! What every kernel is told of the planet and of the view.

use bytemuck::{Pod, Zeroable};

/// The planet: `struct Planet` of `wgsl/lib/planet.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Planet {
    /// The map exponent.
    pub m: u32,
    /// 1 for a plane, 0 for a globe.
    pub plane: u32,
    /// The coarsest stored level, m - 8.
    pub root_level: u32,
    /// The page table has 2^`table_bits` entries.
    pub table_bits: u32,
    /// Equatorial semi-axis, metres; 0 for a plane.
    pub a_m: f32,
    /// Polar semi-axis, metres; 0 for a plane.
    pub b_m: f32,
    /// First eccentricity squared; negative for a prolate body.
    pub e2: f32,
    /// Metres of one height unit: a power of two.
    pub step_m: f32,
    /// Least height of the planet, metres.
    pub min_m: f32,
    /// Greatest height of the planet, metres.
    pub max_m: f32,
    /// A plane's metres in one unit of S (its side is 2^31 units).
    pub unit_x_m: f32,
    /// A plane's metres in one unit of T.
    pub unit_y_m: f32,
    /// 2^`seen_bits` entries record which pages were asked for.
    pub seen_bits: u32,
    /// Zero.
    pub padding: [u32; 3],
}

/// One camera and its sun: `struct View` of `wgsl/lib/planet.wgsl`.
///
/// Directions are in the camera's frame. On a globe that is its meridian frame: x outwards from
/// the polar axis in the plane of the equator, y east, z along the axis to the north; on a plane
/// x east, y north, z up.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct View {
    /// The camera's place in fixed point.
    pub camera_s: u32,
    /// The camera's place in fixed point.
    pub camera_t: u32,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The camera's height, metres, rounded to f32.
    pub camera_h_hi_m: f32,
    /// What the rounding left.
    pub camera_h_lo_m: f32,
    /// Sine of the camera's latitude.
    pub sin_lat: f32,
    /// Cosine of the camera's latitude.
    pub cos_lat: f32,
    /// Prime vertical radius N at the camera's latitude, metres.
    pub n0_m: f32,
    /// w = sqrt(1 - e2 sin^2 psi) at the camera's latitude.
    pub w0: f32,
    /// Tangent of half the horizontal field of view.
    pub tan_x: f32,
    /// Tangent of half the vertical field of view.
    pub tan_y: f32,
    /// Unit vector to the right of the picture; fourth: focal length in pixels.
    pub right: [f32; 4],
    /// Unit vector up the picture; fourth: the threshold `pixel_error`.
    pub up: [f32; 4],
    /// Unit vector of sight; fourth: distance of the near plane, metres.
    pub forward: [f32; 4],
    /// Unit vector to the sun; fourth: radius of its disk in radians, 0 for a hard edge.
    pub sun: [f32; 4],
}
