//! Rasters in a projection whose columns are meridians and whose rows are parallels, such as
//! Equidistant Cylindrical or Mercator: found by trying, whatever the projection is called.

use super::axis::Axis;
use super::projection::{Projection, Transformer};
use crate::source::quiet;
use relief_front::error::ToolError;

/// Most that a position may be off the axes found, pixels: ten times the rounding of the
/// coordinates of the largest rasters, a thousandth of what a kernel could show.
const TOLERANCE_PX: f64 = 1e-6;
/// Meridians and parallels at whose crossings the projection is tried.
const TRIED: (usize, usize) = (48, 32);

/// How rows follow latitude.
pub(crate) enum Rows {
    /// Equally spaced, in degrees.
    Even(Axis),
    /// As the projection says, the same along every meridian; the axis is in pixels.
    Uneven { axis: Axis, along: Box<Projection>, lon_deg: f64 },
}

/// The columns and rows of a raster of `size` pixels; the projection itself where it bends them.
///
/// # Errors
/// Those of [`Projection::transformer`].
pub(crate) fn straighten(
    projection: Projection,
    size: (usize, usize),
) -> Result<Result<(Axis, Rows), Projection>, ToolError> {
    let middle = projection.lon_lats(&[[0.5 * size.0 as f64, 0.5 * size.1 as f64]])?;
    let Some(middle) = middle.first().copied().flatten() else { return Ok(Err(projection)) };
    let found = find(&projection, &projection.transformer()?, middle, size);
    quiet::drain();
    Ok(match found {
        Some((columns, Some(rows))) => Ok((columns, Rows::Even(rows))),
        Some((columns, None)) => {
            let rows = Rows::Uneven { axis: Axis::pixels(size.1), along: Box::new(projection), lon_deg: middle[0] };
            Ok((columns, rows))
        }
        None => Err(projection),
    })
}

/// The axes of columns and, where they are equally spaced, of rows; none where either depends on
/// the other coordinate, or columns are not equally spaced in longitude.
fn find(
    projection: &Projection,
    transformer: &Transformer<'_>,
    [lon0_deg, lat0_deg]: [f64; 2],
    (nx, ny): (usize, usize),
) -> Option<(Axis, Option<Axis>)> {
    let bounds = projection.bounds;
    let [column0, row0] = transformer.pixel(lon0_deg, lat0_deg)?;
    let columns_per_deg = columns_per_deg(transformer, [lon0_deg, lat0_deg], column0, bounds.span_deg)?;
    let turn = 360.0 * columns_per_deg.abs();
    let lats_deg: Vec<f64> =
        spread(TRIED.1).map(|t| bounds.south_deg + t * (bounds.north_deg - bounds.south_deg)).collect();
    let along: Vec<Option<f64>> =
        lats_deg.iter().map(|lat_deg| Some(transformer.pixel(lon0_deg, *lat_deg)?[1])).collect();
    for t in spread(TRIED.0) {
        let lon_deg = bounds.west_deg + t * bounds.span_deg;
        for (lat_deg, row) in lats_deg.iter().zip(&along) {
            let (row, [column, row_here]) = match (row, transformer.pixel(lon_deg, *lat_deg)) {
                (Some(row), Some(pixel)) => (row, pixel),
                (None, None) => continue,
                _ => return None,
            };
            let off = column - column0 - columns_per_deg * (lon_deg - lon0_deg);
            let off = off - turn * (off / turn).round();
            // A NaN is off, too.
            if !(off.abs() <= TOLERANCE_PX && (row_here - row).abs() <= TOLERANCE_PX) {
                return None;
            }
        }
    }
    let extent = |n: usize| [-0.5, n as f64 - 0.5];
    let first_deg = lon0_deg + (0.5 - column0) / columns_per_deg;
    let columns = Axis::meridians(nx, first_deg, 1.0 / columns_per_deg, extent(nx));
    let known: Vec<(f64, f64)> = lats_deg.iter().zip(&along).filter_map(|(lat, row)| Some((*lat, (*row)?))).collect();
    let &[(south_deg, south), .., (north_deg, north)] = known.as_slice() else { return None };
    let rows_per_deg = (north - south) / (north_deg - south_deg);
    let even = |&(lat_deg, row): &(f64, f64)| (row - row0 - rows_per_deg * (lat_deg - lat0_deg)).abs() <= TOLERANCE_PX;
    let rows = (known.len() == lats_deg.len() && known.iter().all(even)).then(|| {
        let first_deg = lat0_deg + (0.5 - row0) / rows_per_deg;
        Axis::latitude(ny, first_deg, 1.0 / rows_per_deg, extent(ny), columns.period.is_some())
    });
    Some((columns, rows))
}

/// Columns to a degree of longitude, from a step that the projection's own seam does not cut.
fn columns_per_deg(
    transformer: &Transformer<'_>,
    [lon_deg, lat_deg]: [f64; 2],
    column: f64,
    span_deg: f64,
) -> Option<f64> {
    let step = |by_deg: f64| Some((transformer.pixel(lon_deg + by_deg, lat_deg)?[0] - column) / by_deg);
    // The longest step is the most exact; one across the seam has a rate of its own.
    let close_deg = (span_deg / 1024.0).min(0.01);
    let (a, b) = (step(close_deg)?, step(-close_deg)?);
    let rough = if a.abs() < b.abs() { a } else { b };
    let far_deg = (span_deg / 2.0).min(170.0);
    let exact = [far_deg, -far_deg].into_iter().filter_map(step).find(|rate| (rate / rough - 1.0).abs() < 1e-3)?;
    (exact.is_finite() && exact != 0.0).then_some(exact)
}

/// `n` fractions from just above 0 to just below 1, at no regular spacing: poles and seams are
/// nobody's, and nothing that repeats can hide between them.
fn spread(n: usize) -> impl Iterator<Item = f64> + Clone {
    (0..n).map(move |at| {
        let jitter = (at as f64 * 0.618_033_988_749_895).fract();
        (at as f64 + 0.02 + 0.96 * jitter) / n as f64
    })
}
