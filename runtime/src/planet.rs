//! A planet: a mapped file, its decoded tiles, and its numbers as the kernels see them.

mod units;

use std::path::Path;
use std::sync::Arc;

use relief_formats::body::Body;
use relief_formats::file::{FormatError, Relief};
use relief_formats::geodesy::{Ellipsoid, lat_deg, lon_deg};
use relief_formats::grid::Grid;
use relief_formats::surface::Surface;
use relief_formats::tiles::Tiles;
use relief_shaders::planet as shared;

/// Decoded samples kept in RAM unless the caller says otherwise.
pub const CACHE_BYTES: u64 = 256 << 20;

/// A file that cannot be opened as a planet.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The file, or the disk it lies on.
    #[error(transparent)]
    File(#[from] FormatError),
    /// The file is good, but its numbers lie outside what f32 kernels can hold.
    #[error("{what} of {value} m: a view needs {rule}")]
    Range {
        /// Which number.
        what: &'static str,
        /// Its value, metres.
        value: f64,
        /// What it must be.
        rule: &'static str,
    },
}

/// An open planet; shared by any number of resident sets and threads.
pub struct Planet {
    surface: Surface<'static>,
    grid: Grid,
    ellipsoid: Option<Ellipsoid>,
    uniform: shared::Planet,
}

impl Planet {
    /// Maps a file. Nothing is decoded yet.
    ///
    /// # Errors
    /// [`OpenError::File`] for a file that is missing, damaged or too new.
    pub fn open(path: &Path) -> Result<Arc<Self>, OpenError> {
        Self::new(Relief::open(path)?, CACHE_BYTES)
    }

    /// A planet over an open file, keeping up to `cache_bytes` of decoded samples in RAM.
    ///
    /// # Errors
    /// [`OpenError::Range`] for a body that f32 cannot hold.
    pub fn new(relief: Relief, cache_bytes: u64) -> Result<Arc<Self>, OpenError> {
        let (header, grid) = (relief.header(), relief.grid());
        let ellipsoid = Ellipsoid::of(&header.body);
        let step_m = header.step_m();
        let mut uniform = shared::Planet {
            m: header.m,
            plane: u32::from(grid.plane),
            root_level: grid.root_level(),
            step_m: step_m as f32,
            min_m: (f64::from(header.min_q) * step_m) as f32,
            max_m: (f64::from(header.max_q) * step_m) as f32,
            ..shared::Planet::default()
        };
        match (&header.body, ellipsoid) {
            (&Body::Plane { dx, dy, .. }, _) => {
                let [x_m, y_m] = units::metres_per_unit(&header.body, grid);
                let side_units = f64::from(1u32 << 31);
                let cells = f64::from(grid.width(0));
                uniform.unit_x_m = in_range("width", dx * x_m * cells)? / side_units as f32;
                uniform.unit_y_m = in_range("height", dy * y_m * cells)? / side_units as f32;
            }
            (_, Some(e)) => {
                uniform.a_m = in_range("equatorial semi-axis", e.a_m)?;
                uniform.b_m = in_range("polar semi-axis", e.b_m)?;
                uniform.e2 = e.e2() as f32;
            }
            _ => {}
        }
        let surface = Surface::over(Tiles::shared(Arc::new(relief), cache_bytes));
        Ok(Arc::new(Self { surface, grid, ellipsoid, uniform }))
    }

    /// The file.
    #[must_use]
    pub fn relief(&self) -> &Relief {
        self.surface.relief()
    }

    /// Its decoded tiles.
    #[must_use]
    pub fn tiles(&self) -> &Tiles<'static> {
        self.surface.tiles()
    }

    /// Its heights in f64, from the same decoded tiles.
    #[must_use]
    pub fn surface(&self) -> &Surface<'static> {
        &self.surface
    }

    /// Its grid of nodes.
    #[must_use]
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Its ellipsoid; none for a plane.
    #[must_use]
    pub fn ellipsoid(&self) -> Option<Ellipsoid> {
        self.ellipsoid
    }

    /// What the kernels are told; the sizes of the page table and of the record of pages asked
    /// for are zero until a resident set fills them in.
    #[must_use]
    pub fn uniform(&self) -> shared::Planet {
        self.uniform
    }

    /// Longitude and latitude, degrees, of a fixed-point place (a plane: X and Y in its CRS's units).
    #[must_use]
    pub fn place_of(&self, [s, t]: [u32; 2]) -> [f64; 2] {
        match *self.relief().body() {
            Body::Plane { x0, y0, dx, dy, .. } => {
                let along = |first: f64, step: f64, cells: u32, v: u32| {
                    first + step * f64::from(cells) * (f64::from(v) / f64::from(1u32 << 31))
                };
                [along(x0, dx, self.grid.width(0), s), along(y0, dy, self.grid.height(0), t)]
            }
            Body::Ellipsoid { .. } => [lon_deg(s), lat_deg(t)],
        }
    }

    /// Metres in a unit of the CRS of a plane, along X and Y; none for a globe.
    #[must_use]
    pub fn metres_per_unit(&self) -> Option<[f64; 2]> {
        self.grid.plane.then(|| units::metres_per_unit(self.relief().body(), self.grid))
    }

    /// Metres between level-0 nodes along a meridian (a plane: northwards).
    #[must_use]
    pub fn spacing_m(&self) -> f64 {
        let units = f64::from(1u32 << (31 - self.grid.m));
        match self.ellipsoid {
            Some(e) => units * relief_formats::geodesy::UNIT_RAD * e.a_m,
            None => units * f64::from(self.uniform.unit_y_m),
        }
    }
}

/// Sizes whose squares, with heights on top, stay far inside f32.
fn in_range(what: &'static str, value: f64) -> Result<f32, OpenError> {
    if (1e-3..=1e12).contains(&value) {
        Ok(value as f32)
    } else {
        Err(OpenError::Range { what, value, rule: "a millimetre to 1e12 m" })
    }
}

#[cfg(test)]
mod tests;
