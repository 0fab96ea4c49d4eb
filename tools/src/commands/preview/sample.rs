//! A plane resampled onto the pixels of a picture.

use rayon::prelude::*;
use relief_formats::file::{FormatError, Relief};
use relief_formats::geodesy::Ellipsoid;

use crate::lattice::{Bounds, Lattice, PlaneChoice, Rectangle};
use crate::source::SeaLevel;
use relief_front::error::ToolError;

/// Where the samples of a picture lie. They are centres of pixels; row 0 is in the north.
pub struct Canvas {
    bounds: Bounds,
    width: u32,
    height: u32,
    ellipsoid: Option<Ellipsoid>,
}

/// What was drawn.
pub struct Raster {
    pub width: usize,
    pub height: usize,
    /// Metres, NaN where void.
    pub values: Vec<f32>,
    /// Width of a pixel of each row, metres.
    pub cell_east_m: Vec<f64>,
    /// Height of a pixel, metres.
    pub cell_north_m: f64,
    pub wraps: bool,
}

/// Rows that are read together.
const BAND: u32 = 128;
/// Most samples of a picture: 16384 x 16384.
const MOST_SAMPLES: u64 = 1 << 28;

impl Canvas {
    /// `size` pixels across and as many down as the window is high, each of `supersample` samples
    /// across and down.
    pub fn new(relief: &Relief, bounds: Bounds, size: u32, supersample: u32) -> Result<Self, ToolError> {
        let aspect = (bounds.north - bounds.south) / (bounds.east - bounds.west);
        let down = (f64::from(size) * aspect).round().max(1.0);
        let samples = f64::from(size) * down * f64::from(supersample * supersample);
        if samples > MOST_SAMPLES as f64 {
            return Err(ToolError::usage(
                format!("a picture of {size} x {down} pixels"),
                "a picture has at most 2^28 samples (four a pixel up to --size 8192)",
                "give a smaller --size or a wider --window",
            ));
        }
        let (width, height) = (size * supersample, down as u32 * supersample);
        Ok(Self { bounds, width, height, ellipsoid: Ellipsoid::of(relief.body()) })
    }

    /// The coarsest level whose nodes are no further apart than the samples.
    pub fn level(&self, relief: &Relief) -> u32 {
        let sample = (self.bounds.east - self.bounds.west) / f64::from(self.width);
        let node = match relief.body() {
            relief_formats::body::Body::Plane { dx, .. } => *dx,
            relief_formats::body::Body::Ellipsoid { .. } => relief.grid().spacing_deg(0),
        };
        // A hair more: equal spacings are equal whatever their rounding.
        let levels = (sample / node * (1.0 + 1e-9)).log2().floor();
        (levels.max(0.0) as u32).min(relief.grid().root_level())
    }

    /// Reads the lattice band by band and samples it: heights bilinearly, extremes by the cell,
    /// deviations and fills as the largest of the four nodes around.
    pub fn draw(&self, lattice: &Lattice<'_>) -> Result<Raster, FormatError> {
        let (width, height) = (self.width as usize, self.height as usize);
        let [x0, y0, dx, dy] = lattice.samples().frame;
        let Bounds { west, south, east, north } = self.bounds;
        let column = |x: usize| (west + (east - west) * (x as f64 + 0.5) / width as f64 - x0) / dx;
        let latitude = |y: usize| north - (north - south) * (y as f64 + 0.5) / height as f64;
        let row = |y: usize| (latitude(y) - y0) / dy;
        let mut values = vec![f32::NAN; width * height];
        let columns = Span::of(column(0), column(width - 1), lattice.samples().columns, lattice.samples().wraps);
        for (band, out) in values.chunks_mut(width * BAND as usize).enumerate() {
            let first = band * BAND as usize;
            let rows = Span::of(row(first + out.len() / width - 1), row(first), lattice.samples().rows, false);
            let rectangle = Rectangle {
                column: columns.first,
                row: rows.first as u32,
                columns: columns.count as u32,
                rows: rows.count as u32,
            };
            let samples = lattice.read(rectangle)?;
            let sampler = Sampler { samples: &samples, columns, rows, plane: lattice.plane() };
            out.par_chunks_mut(width).enumerate().for_each(|(y, line)| {
                for (x, out) in line.iter_mut().enumerate() {
                    *out = sampler.at(column(x), row(first + y));
                }
            });
        }
        let down = (north - south) / height as f64;
        let across = (east - west) / width as f64;
        let (cell_east_m, cell_north_m) = match self.ellipsoid {
            None => (vec![across; height], down),
            Some(e) => {
                let radius_m = f64::midpoint(e.a_m, e.b_m);
                let parallel = |y| latitude(y).to_radians().cos().max(1e-6) * e.a_m * across.to_radians();
                ((0..height).map(parallel).collect(), radius_m * down.to_radians())
            }
        };
        let wraps = lattice.samples().wraps && east - west >= 360.0;
        Ok(Raster { width, height, values, cell_east_m, cell_north_m, wraps })
    }
}

impl Canvas {
    /// Lowers heights above the ellipsoid to heights above the sea, so that shores are shores.
    pub fn above_sea(&self, raster: &mut Raster, sea: &SeaLevel) {
        let Bounds { west, south, east, north } = self.bounds;
        let (width, height) = (self.width as usize, self.height as usize);
        raster.values.par_chunks_mut(width).enumerate().for_each(|(y, line)| {
            let lat_deg = north - (north - south) * (y as f64 + 0.5) / height as f64;
            for (x, value) in line.iter_mut().enumerate() {
                let lon_deg = west + (east - west) * (x as f64 + 0.5) / width as f64;
                *value -= sea.height_m(lon_deg, lat_deg).unwrap_or(0.0) as f32;
            }
        });
    }
}

/// Indices along one axis that samples between two coordinates need.
#[derive(Clone, Copy)]
struct Span {
    first: i64,
    count: i64,
}

impl Span {
    fn of(low: f64, high: f64, count: u32, wraps: bool) -> Self {
        let (mut first, mut last) = (low.floor() as i64, high.floor() as i64 + 1);
        if !wraps {
            let end = i64::from(count) - 1;
            (first, last) = (first.clamp(0, end), last.clamp(0, end));
        }
        Self { first, count: last - first + 1 }
    }

    /// The two indices around a coordinate, within the span, and the share of the second.
    fn around(&self, at: f64) -> (usize, usize, f32) {
        let floor = at.floor();
        let index = |i: i64| (i - self.first).clamp(0, self.count - 1) as usize;
        (index(floor as i64), index(floor as i64 + 1), (at - floor) as f32)
    }
}

struct Sampler<'a> {
    samples: &'a [f32],
    columns: Span,
    rows: Span,
    plane: PlaneChoice,
}

impl Sampler<'_> {
    fn at(&self, x: f64, y: f64) -> f32 {
        let ((west, east, u), (south, north, v)) = (self.columns.around(x), self.rows.around(y));
        let at = |i: usize, j: usize| self.samples[j * self.columns.count as usize + i];
        let corners = [at(west, south), at(east, south), at(west, north), at(east, north)];
        match self.plane {
            PlaneChoice::Nodes | PlaneChoice::Mip => {
                let (below, above) = (corners[0] * (1.0 - u) + corners[1] * u, corners[2] * (1.0 - u) + corners[3] * u);
                below * (1.0 - v) + above * v
            }
            PlaneChoice::HextMin | PlaneChoice::HextMax => corners[usize::from(u >= 0.5) + 2 * usize::from(v >= 0.5)],
            PlaneChoice::Deviation | PlaneChoice::Filled => corners.into_iter().fold(0.0, f32::max),
        }
    }
}
