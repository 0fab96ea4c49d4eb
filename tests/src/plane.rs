//! A small plane with square cells.

use relief_formats::body::Body;
use relief_formats::grid::Grid;

use crate::sample_file::Sample;

/// Side of a cell of [`plane`], metres.
pub const SPACING_M: f64 = 30.0;

/// A plane of 256 x 256 cells from (1000, 2000), steps of 2^-4 m, with heights in steps from `q`.
pub fn plane(q: fn(Grid, u32, u32) -> i32) -> Sample {
    let body = Body::Plane { crs_wkt: String::new(), x0: 1000.0, y0: 2000.0, dx: SPACING_M, dy: SPACING_M };
    Sample { q, ..Sample::new(body, 8) }
}
