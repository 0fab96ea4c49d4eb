//! Sampling rasters whose columns are meridians and whose rows are parallels.

use relief_formats::grid::Grid;

use super::options::Resample;
use super::raster::Raster;
use super::sample::lon_deg;
use super::{NodeWindow, Source};
use crate::resample::axis::Axis;
use crate::resample::cylindrical::Rows;
use crate::resample::kernel::Kernel;
use crate::resample::projection::{Bounds, Projection};
use crate::resample::separable::{Position, Separable};
use relief_front::error::ToolError;

/// What is asked of a raster.
pub(super) struct Request<'a> {
    pub raster: &'a Raster,
    pub resample: Resample,
    pub grid: &'a Grid,
    pub window: &'a NodeWindow,
}

impl Source {
    /// Heights of the window's nodes into `heights_m`: metres, NaN where void.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub(super) fn lon_lat(
        &self,
        request: &Request<'_>,
        columns: &Axis,
        rows: &Rows,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let &Request { raster, resample, grid, window } = request;
        let kernel = |step_deg: f64| self.kernel(resample, grid, step_deg);
        let lon_deg = |i: usize| lon_deg(grid, window.level, window.x0 + i as i64);
        let lat_deg = |j: usize| grid.lat_deg(window.level, window.y0 + j as i64);
        let pole = |j: usize| lat_deg(j).abs() >= 90.0;
        let lats_deg: Vec<f64> = (0..window.ny).map(lat_deg).collect();
        let (axis, across, vs) = match rows {
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
        let us: Vec<_> =
            (0..window.nx).map(|i| Some(Position::new(columns.longitude_position(lon_deg(i))?, across))).collect();
        // Pole rows are set apart: one height each.
        let set_apart: Vec<_> = vs.iter().enumerate().map(|(j, v)| v.filter(|_| !pole(j))).collect();
        let separable = Separable { raster, columns, rows: axis, mixed_rows: matches!(rows, Rows::Uneven { .. }) };
        separable.sample(&us, &set_apart, heights_m)?;
        for (j, v) in vs.iter().enumerate().filter(|(j, _)| pole(*j)) {
            if let Some(v) = v {
                let mean_m = self.pole_m(raster, columns, axis.stored(axis.home(v.at)), lat_deg(j) > 0.0)?;
                heights_m[j * window.nx..][..window.nx].fill(mean_m);
            }
        }
        Ok(())
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
