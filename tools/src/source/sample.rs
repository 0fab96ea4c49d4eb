//! Sampling one source at the nodes of a window.

use relief_formats::grid::Grid;

use super::fill::pull_push;
use super::geoid::Reference;
use super::open::no_coarser;
use super::options::{Fill, Resample, SourceOptions};
use super::raster::Raster;
use super::{DATA, FILLED, HeightBlock, Mapping, NodeWindow, Source, VOID};
use crate::resample::axis::Axis;
use crate::resample::bounds::Bounds;
use crate::resample::kernel::Kernel;
use crate::resample::lattice::{Lattice, Positions};
use crate::resample::projection::Projection;
use crate::resample::scattered::Scattered;
use crate::resample::separable::Separable;
use relief_front::error::ToolError;

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
        let bounds = match &self.mapping {
            Mapping::LonLat { columns, rows } => lon_lat_bounds(columns, rows),
            Mapping::Projected(projection) => projection.bounds,
            Mapping::Plane(place) => return place.covers(&self.raster, grid, window),
        };
        let spacing_deg = grid.spacing_deg(window.level);
        let lat_deg = |j: usize| grid.lat_deg(window.level, window.y0 + j as i64);
        let span_deg = spacing_deg * window.nx.saturating_sub(1) as f64;
        window.nx * window.ny > 0
            && bounds.meet(lon_deg(grid, window.level, window.x0), span_deg, lat_deg(0), lat_deg(window.ny - 1))
    }

    /// True where `step_deg` is finer than the finest nodes this source is sampled at.
    fn is_finer(&self, grid: &Grid, step_deg: f64) -> bool {
        !no_coarser(grid.spacing_deg(self.finest_level(grid)), step_deg)
    }

    /// The kernel for samples `step_deg` apart: chosen by the finest nodes this source is sampled
    /// at, so that a node's height is the same at every level.
    fn kernel(&self, resample: Resample, grid: &Grid, step_deg: f64) -> Kernel {
        let mean = || Kernel::Box { width: grid.spacing_deg(self.finest_level(grid)) / step_deg.abs() };
        match resample {
            Resample::Nearest => Kernel::Nearest,
            Resample::Bilinear => Kernel::Bilinear,
            Resample::Cubic => Kernel::Cubic,
            Resample::Lanczos => Kernel::Lanczos,
            Resample::Average => mean(),
            Resample::Auto if self.is_finer(grid, step_deg.abs()) => mean(),
            Resample::Auto => Kernel::Cubic,
        }
    }

    /// See [`super::SourceSet::sample`].
    pub(super) fn sample(
        &self,
        options: &SourceOptions,
        grid: &Grid,
        window: &NodeWindow,
    ) -> Result<HeightBlock, ToolError> {
        let fill = options.fill == Fill::Interpolate;
        if let Mapping::Plane(place) = &self.mapping {
            let filled = if fill { Some(self.filled()?) } else { None };
            return place.sample(&self.raster, filled, grid, window);
        }
        let mut heights_m = self.on_globe(&self.raster, options.resample, grid, window)?;
        let mut state: Vec<u8> = heights_m.iter().map(|height| if height.is_nan() { VOID } else { DATA }).collect();
        if fill && state.contains(&VOID) && self.covers(grid, window) {
            let filled_m = self.on_globe(self.filled()?, Resample::Bilinear, grid, window)?;
            for ((height_m, state), filled_m) in heights_m.iter_mut().zip(&mut state).zip(filled_m) {
                if *state == VOID && !filled_m.is_nan() {
                    (*height_m, *state) = (filled_m, FILLED);
                }
            }
        }
        if let Reference::Geoid(geoid) = &self.reference {
            geoid.add(grid, window, &mut heights_m)?;
        }
        let height_m = heights_m.iter().map(|height| if height.is_nan() { 0.0 } else { *height as f32 }).collect();
        Ok(HeightBlock { height_m, state })
    }

    /// Heights of `raster`, this source's or one of its shape; metres, NaN where void.
    fn on_globe(
        &self,
        raster: &Raster,
        resample: Resample,
        grid: &Grid,
        window: &NodeWindow,
    ) -> Result<Vec<f64>, ToolError> {
        let mut heights_m = vec![f64::NAN; window.nx * window.ny];
        match &self.mapping {
            Mapping::LonLat { columns, rows } => {
                self.lon_lat(raster, (columns, rows), resample, grid, window, &mut heights_m)?;
            }
            Mapping::Projected(projection) => {
                self.projected(raster, projection, resample, grid, window, &mut heights_m)?;
            }
            Mapping::Plane(_) => {}
        }
        Ok(heights_m)
    }

    fn lon_lat(
        &self,
        raster: &Raster,
        (columns, rows): (&Axis, &Axis),
        resample: Resample,
        grid: &Grid,
        window: &NodeWindow,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let kernels = (self.kernel(resample, grid, columns.step_deg), self.kernel(resample, grid, rows.step_deg));
        let separable = Separable { raster, columns, rows, kernels };
        let us = (0..window.nx as i64).map(|i| columns.longitude_position(lon_deg(grid, window.level, window.x0 + i)));
        let lat = |j: usize| grid.lat_deg(window.level, window.y0 + j as i64);
        // Pole rows are set apart: one height each.
        let vs = (0..window.ny).map(|j| (lat(j).abs() < 90.0).then(|| rows.position(lat(j))).flatten());
        separable.sample(us, vs, heights_m)?;
        for j in (0..window.ny).filter(|j| lat(*j).abs() >= 90.0) {
            let Some(v) = rows.position(lat(j)) else {
                continue;
            };
            let row = rows.stored(rows.home(v));
            let mean_m = match std::ptr::eq(raster, &self.raster) {
                false => row_mean_m(raster, row, columns)?,
                true => {
                    let kept = &self.poles[usize::from(lat(j) > 0.0)];
                    match kept.get() {
                        Some(mean_m) => *mean_m,
                        None => {
                            let mean_m = row_mean_m(raster, row, columns)?;
                            *kept.get_or_init(|| mean_m)
                        }
                    }
                }
            };
            heights_m[j * window.nx..][..window.nx].fill(mean_m);
        }
        Ok(())
    }

    fn projected(
        &self,
        raster: &Raster,
        projection: &Projection,
        resample: Resample,
        grid: &Grid,
        window: &NodeWindow,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        if !self.covers(grid, window) {
            return Ok(());
        }
        // Positions count half steps of level 0, so that footprints have corners.
        let (step, half) = (2_i64 << window.level, 1_i64 << self.finest_level(grid));
        let circle = 2 * i64::from(grid.width(0));
        let mut lattice = Lattice::new(projection.transformer()?, circle, 2 * half);
        let lat = |j: usize| grid.lat_deg(window.level, window.y0 + j as i64);
        let lon = |i: usize| lon_deg(grid, window.level, window.x0 + i as i64);
        let rows: Vec<bool> = (0..window.ny).map(|j| projection.bounds.has_latitude(lat(j))).collect();
        let columns: Vec<bool> = (0..window.nx).map(|i| projection.bounds.has_longitude(lon(i))).collect();
        let at = |di: i64, dj: i64| Positions {
            first: (window.x0 * step + di, window.y0 * step + dj),
            step,
            columns: &columns,
            rows: &rows,
        };
        let points = lattice.pixels(at(0, 0));
        let kernel = match self.kernel(resample, grid, self.spacing) {
            Kernel::Box { .. } => None,
            kernel => Some(kernel),
        };
        let footprints = kernel.is_none().then(|| {
            let around = [(-half, -half), (half, -half), (half, half), (-half, half)];
            let corners = around.map(|(di, dj)| lattice.pixels(at(di, dj)));
            let mut quads: Vec<[[f64; 2]; 4]> =
                (0..points.len()).map(|n| [0, 1, 2, 3].map(|corner| corners[corner][n])).collect();
            // A pole has no cell of its own.
            for j in (0..window.ny).filter(|j| lat(*j).abs() >= 90.0) {
                quads[j * window.nx..][..window.nx].fill([[f64::NAN; 2]; 4]);
            }
            quads
        });
        let scattered = Scattered {
            raster,
            kernel: kernel.unwrap_or(Kernel::Cubic),
            points: &points,
            nx: window.nx,
            footprints: footprints.as_deref(),
        };
        scattered.sample(heights_m)
    }

    /// The raster with its voids interpolated.
    fn filled(&self) -> Result<&Raster, ToolError> {
        if let Some(filled) = self.filled.get() {
            return Ok(filled);
        }
        let whole = self.raster.whole()?;
        let (nx, ny) = (self.raster.width, self.raster.height);
        let wraps = matches!(&self.mapping, Mapping::LonLat { columns, .. } if columns.period == Some(nx));
        // A thread that comes second waits here for the first.
        Ok(self.filled.get_or_init(|| Raster::ready(&self.raster.path, (nx, ny), pull_push(&whole, nx, wraps))))
    }
}

/// Where a lon/lat raster has samples.
fn lon_lat_bounds(columns: &Axis, rows: &Axis) -> Bounds {
    let ([west_deg, east_deg], [south_deg, north_deg]) = (columns.range_deg(), rows.range_deg());
    let span_deg = if columns.period.is_some() { 360.0 } else { east_deg - west_deg };
    Bounds { west_deg, span_deg, south_deg, north_deg }
}

/// The mean of a row, each meridian once; NaN where all of it is void.
fn row_mean_m(raster: &Raster, row: (usize, bool), columns: &Axis) -> Result<f64, ToolError> {
    let all: Vec<_> = (0..columns.period.unwrap_or(columns.n)).collect();
    let row = raster.gather(&[row], &all, None)?;
    let valid = || row.pixels.iter().filter(|height| !height.is_nan());
    // Without data 0 / 0 is the NaN that says so.
    Ok(valid().map(|height| f64::from(*height)).sum::<f64>() / valid().count() as f64)
}

/// Longitude of a node column, wrapped to [-180, 180).
pub(super) fn lon_deg(grid: &Grid, level: u32, i: i64) -> f64 {
    grid.lon_deg(level, i.rem_euclid(i64::from(grid.width(level))))
}
