//! Sampling rasters whose columns are meridians and whose rows are parallels.

use std::ops::Range;

use super::Source;
use super::raster::Raster;
use super::sample::{Request, lon_deg};
use crate::resample::axis::Axis;
use crate::resample::bounds::Bounds;
use crate::resample::cylindrical::Rows;
use crate::resample::kernel::Kernel;
use crate::resample::projection::Projection;
use crate::resample::separable::{Position, Separable, Taps};
use relief_front::error::ToolError;

/// A raster and where a window's columns and rows lie on it.
pub(super) struct Lines<'a> {
    source: &'a Source,
    separable: Separable<'a>,
    columns: Taps,
    /// Rows of nodes; poles apart, which have one height each.
    rows: Vec<Option<Position>>,
    /// Rows at a pole: which one, whether it is the North Pole, and its place.
    poles: Vec<(usize, bool, Position)>,
}

impl Lines<'_> {
    /// Heights of some of the window's rows into `heights_m`: metres, NaN where void.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub fn sample(&self, rows: Range<usize>, heights_m: &mut [f64]) -> Result<(), ToolError> {
        let nx = self.columns.len();
        self.separable.sample(&self.columns, &self.rows[rows.clone()], heights_m)?;
        for (row, north, place) in self.poles.iter().filter(|(row, ..)| rows.contains(row)) {
            let Separable { raster, columns, rows: axis, .. } = self.separable;
            let mean_m = self.source.pole_m(raster, columns, axis.stored(axis.home(place.at)), *north)?;
            heights_m[(row - rows.start) * nx..][..nx].fill(mean_m);
        }
        Ok(())
    }
}

impl Source {
    /// Where the columns and rows of the window lie.
    ///
    /// # Errors
    /// Those of [`Projection::transformer`].
    pub(super) fn lines<'a>(
        &'a self,
        &Request { raster, resample, grid, window }: &Request<'a>,
        columns: &'a Axis,
        rows: &'a Rows,
    ) -> Result<Lines<'a>, ToolError> {
        let kernel = |step_deg: f64| self.kernel(resample, grid, step_deg);
        let lats_deg: Vec<f64> = (0..window.ny).map(|j| grid.lat_deg(window.level, window.y0 + j as i64)).collect();
        let (axis, across, mut places) = match rows {
            Rows::Even(axis) => {
                let down = kernel(axis.step_deg);
                let place = |&lat_deg: &f64| Some(Position::new(axis.position(lat_deg)?, down));
                (axis, kernel(columns.step_deg), lats_deg.iter().map(place).collect::<Vec<_>>())
            }
            Rows::Uneven { axis, along, lon_deg } => {
                let one = kernel(self.spacing);
                let half_deg = 0.5 * grid.spacing_deg(self.finest_level(grid));
                let across = match one {
                    Kernel::Box { .. } => Kernel::Box { width: 2.0 * half_deg / columns.step_deg.abs() },
                    kernel => kernel,
                };
                (axis, across, uneven(axis, (along, *lon_deg), one, half_deg, &lats_deg)?)
            }
        };
        let place = |i: i64| columns.longitude_position(lon_deg(grid, window.level, window.x0 + i));
        let across: Vec<_> = (0..window.nx as i64).map(|i| Some(Position::new(place(i)?, across))).collect();
        let mut poles = Vec::new();
        for (row, lat_deg) in lats_deg.iter().enumerate().filter(|(_, lat_deg)| lat_deg.abs() >= 90.0) {
            poles.extend(places[row].take().map(|place| (row, *lat_deg > 0.0, place)));
        }
        let separable = Separable { raster, columns, rows: axis, mixed_rows: matches!(rows, Rows::Uneven { .. }) };
        Ok(Lines { source: self, separable, columns: Taps::new(columns, &across, 1), rows: places, poles })
    }

    /// The one height of a pole: the mean of the row that holds it.
    fn pole_m(&self, raster: &Raster, columns: &Axis, row: (usize, bool), north: bool) -> Result<f64, ToolError> {
        if !std::ptr::eq(raster, &self.raster) {
            return row_mean_m(raster, row, columns);
        }
        let kept = &self.poles[usize::from(north)];
        if let Some(mean_m) = kept.get() {
            return Ok(*mean_m);
        }
        let mean_m = row_mean_m(raster, row, columns)?;
        Ok(*kept.get_or_init(|| mean_m))
    }
}

/// Rows of latitudes among rows that a projection spaces; for a mean each with a footprint that
/// reaches `half_deg` to either side.
fn uneven(
    axis: &Axis,
    (projection, lon_deg): (&Projection, f64),
    kernel: Kernel,
    half_deg: f64,
    lats_deg: &[f64],
) -> Result<Vec<Option<Position>>, ToolError> {
    let transformer = projection.transformer()?;
    let row = |lat_deg: f64| Some(transformer.pixel(lon_deg, lat_deg)?[1]);
    let place = |&lat_deg: &f64| {
        let at = axis.position(row(lat_deg)?)?;
        let edges = match kernel {
            Kernel::Box { .. } if lat_deg.abs() < 90.0 => row(lat_deg - half_deg).zip(row(lat_deg + half_deg)),
            Kernel::Box { .. } => None,
            kernel => return Some(Position::new(at, kernel)),
        };
        let Some((a, b)) = edges else { return Some(Position::new(at, Kernel::Cubic)) };
        Some(Position { at, centre: 0.5 * (a + b) - 0.5, kernel: Kernel::Box { width: (b - a).abs() } })
    };
    Ok(lats_deg.iter().map(place).collect())
}

/// Where a raster has samples.
pub(super) fn bounds(columns: &Axis, rows: &Rows) -> Bounds {
    match rows {
        Rows::Even(rows) => {
            let ([west_deg, east_deg], [south_deg, north_deg]) = (columns.range_deg(), rows.range_deg());
            let span_deg = if columns.period.is_some() { 360.0 } else { east_deg - west_deg };
            Bounds { west_deg, span_deg, south_deg, north_deg }
        }
        Rows::Uneven { along, .. } => along.bounds,
    }
}

/// The mean of a row, each meridian once; NaN where all of it is void.
fn row_mean_m(raster: &Raster, row: (usize, bool), columns: &Axis) -> Result<f64, ToolError> {
    let all: Vec<_> = (0..columns.period.unwrap_or(columns.n)).collect();
    let row = raster.gather(&[row], &all, None)?;
    let valid = || row.pixels.iter().filter(|height| !height.is_nan());
    // Without data 0 / 0 is the NaN that says so.
    Ok(valid().map(|height| f64::from(*height)).sum::<f64>() / valid().count() as f64)
}
