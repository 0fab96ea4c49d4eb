//! Shadows of the relief (paper 001).
//!
//! `exact` casts one ray through the pyramid of extremes and is the twin of
//! `wgsl/lib/shadow.wgsl`; `sweep` shades all nodes of a plane at once; `paper` is the paper's own
//! kernel. `dense` holds a whole level in RAM.

pub mod cell;
pub mod dense;
pub mod exact;
pub mod mask;
pub mod pages;
pub mod paper;
pub mod points;
pub mod square;
pub mod sun;
pub mod sweep;

pub use exact::{Relief, Sunlight, shadow_exact};
pub use mask::{ShadowWindow, WindowCounts, shadow_mask, shadow_mask_of};
pub use pages::PagedRelief;
pub use points::{PointSun, SunlitPoint, shadow_points};

/// What a ray fetched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Heights of nodes: four for a patch.
    pub heights: u32,
    /// Pairs of extremes.
    pub extremes: u32,
    /// Squares entered.
    pub steps: u32,
}

impl Counts {
    /// All fetches.
    #[must_use]
    pub fn fetches(&self) -> u32 {
        self.heights + self.extremes
    }
}

/// The factor of a shaded point's light, paper 001 eq. 1 with a visible part of the sun between 0
/// and 1 in place of the flag: k_dark + (k_bright - k_dark) (s . n) in full shadow, 1 in the light.
/// `cos_sun` is s . n with n the normal of the ellipsoid, `dark` and `bright` lie in 0..=1.
#[must_use]
pub fn k_shadow(visible: f32, cos_sun: f32, dark: f32, bright: f32) -> f32 {
    let shaded = dark + (bright - dark) * cos_sun.max(0.0);
    shaded + (1.0 - shaded) * visible
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k_shadow_is_equation_1_at_both_ends() {
        assert_eq!(k_shadow(1.0, 0.3, 0.2, 0.6), 1.0);
        assert!((k_shadow(0.0, 0.5, 0.2, 0.6) - 0.4).abs() < 1e-7);
        assert_eq!(k_shadow(0.0, -0.5, 0.2, 0.6), 0.2);
    }
}
