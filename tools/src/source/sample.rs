//! Sampling one source at the nodes of a window.

use relief_formats::grid::Grid;

use super::open::no_coarser;
use super::options::{Resample, SourceOptions};
use super::{DATA, HeightBlock, Mapping, NodeWindow, Source, VOID};
use crate::error::ToolError;
use crate::resample::axis::Axis;
use crate::resample::kernel::Kernel;
use crate::resample::separable::Separable;

impl Source {
    /// See [`super::SourceSet::finest_level`].
    pub(super) fn finest_level(&self, grid: &Grid) -> u32 {
        if grid.plane {
            return 0;
        }
        (1..=grid.root_level()).take_while(|level| no_coarser(grid.spacing_deg(*level), self.spacing)).count() as u32
    }

    /// See [`super::SourceSet::covers`].
    pub(super) fn covers(&self, grid: &Grid, window: &NodeWindow) -> bool {
        match &self.mapping {
            Mapping::LonLat { columns, rows } => {
                let lats = (0..window.ny as i64).map(|j| grid.lat_deg(window.level, window.y0 + j));
                if !lats.clone().any(|lat| rows.position(lat).is_some()) {
                    return false;
                }
                let mut lons = (0..window.nx as i64).map(|i| lon_deg(grid, window.level, window.x0 + i));
                lons.any(|lon| columns.longitude_position(lon).is_some())
                    || lats.into_iter().any(|lat| lat.abs() == 90.0)
            }
        }
    }

    /// The kernels of both axes: chosen by the spacing of the finest nodes this source is
    /// sampled at, so that a node's height is the same at every level.
    fn kernels(&self, options: &SourceOptions, grid: &Grid, steps_deg: (f64, f64)) -> (Kernel, Kernel) {
        let nodes_deg = grid.spacing_deg(self.finest_level(grid));
        let finer = |step_deg: f64| !no_coarser(nodes_deg, step_deg);
        let mean = |step_deg: f64| Kernel::Box { width: nodes_deg / step_deg };
        let (x, y) = (steps_deg.0.abs(), steps_deg.1.abs());
        let both = |kernel| (kernel, kernel);
        match options.resample {
            Resample::Nearest => both(Kernel::Nearest),
            Resample::Bilinear => both(Kernel::Bilinear),
            Resample::Cubic => both(Kernel::Cubic),
            Resample::Lanczos => both(Kernel::Lanczos),
            Resample::Average => (mean(x), mean(y)),
            Resample::Auto => {
                let pick = |step| if finer(step) { mean(step) } else { Kernel::Cubic };
                (pick(x), pick(y))
            }
        }
    }

    /// See [`super::SourceSet::sample`].
    pub(super) fn sample(
        &self,
        options: &SourceOptions,
        grid: &Grid,
        window: &NodeWindow,
    ) -> Result<HeightBlock, ToolError> {
        let mut heights_m = vec![f64::NAN; window.nx * window.ny];
        match &self.mapping {
            Mapping::LonLat { columns, rows } => self.sample_lon_lat(columns, rows, options, grid, window, &mut heights_m)?,
        }
        let state = heights_m.iter().map(|height| if height.is_nan() { VOID } else { DATA }).collect();
        let height_m = heights_m.iter().map(|height| if height.is_nan() { 0.0 } else { *height as f32 }).collect();
        Ok(HeightBlock { height_m, state })
    }

    fn sample_lon_lat(
        &self,
        columns: &Axis,
        rows: &Axis,
        options: &SourceOptions,
        grid: &Grid,
        window: &NodeWindow,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let kernels = self.kernels(options, grid, (columns.step_deg, rows.step_deg));
        let separable = Separable { raster: &self.raster, columns, rows, kernels };
        let us = (0..window.nx as i64).map(|i| columns.longitude_position(lon_deg(grid, window.level, window.x0 + i)));
        let lat = |j: i64| grid.lat_deg(window.level, window.y0 + j);
        // Pole rows are set apart: one height each.
        let vs = (0..window.ny as i64).map(|j| (lat(j).abs() < 90.0).then(|| rows.position(lat(j))).flatten());
        separable.sample(us, vs, heights_m)?;
        for j in (0..window.ny).filter(|j| lat(*j as i64).abs() >= 90.0) {
            let height_m = self.pole(rows, columns, lat(j as i64))?;
            heights_m[j * window.nx..][..window.nx].fill(height_m);
        }
        Ok(())
    }

    /// The one height of a pole: the mean of the row that holds it.
    fn pole(&self, rows: &Axis, columns: &Axis, lat_deg: f64) -> Result<f64, ToolError> {
        let Some(v) = rows.position(lat_deg) else { return Ok(f64::NAN) };
        let kept = &self.poles[usize::from(lat_deg > 0.0)];
        if let Some((height_m, _)) = kept.get() {
            return Ok(*height_m);
        }
        let all: Vec<_> = (0..columns.period.unwrap_or(columns.n)).collect();
        let row = self.raster.gather(&[rows.stored(rows.home(v))], &all, None)?;
        let valid = || row.pixels.iter().filter(|height| !height.is_nan());
        // Without data 0 / 0 is the NaN that says so.
        let mean_m = valid().map(|height| f64::from(*height)).sum::<f64>() / valid().count() as f64;
        Ok(kept.get_or_init(|| (mean_m, DATA)).0)
    }
}

/// Longitude of a node column, wrapped to [-180, 180).
pub(super) fn lon_deg(grid: &Grid, level: u32, i: i64) -> f64 {
    grid.lon_deg(level, i.rem_euclid(i64::from(grid.width(level))))
}
