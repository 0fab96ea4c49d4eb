//! Sampling one source at the nodes of a window.

use relief_formats::grid::Grid;

use super::fill::pull_push;
use super::geoid::Reference;
use super::lon_lat::{self, Lines};
use super::open::no_coarser;
use super::options::{Fill, Resample, SourceOptions};
use super::raster::Raster;
use super::{DATA, FILLED, Mapping, NodeWindow, Source, VOID};
use crate::resample::kernel::Kernel;
use crate::resample::lattice::{Lattice, Positions};
use crate::resample::projection::Projection;
use crate::resample::scattered::Scattered;
use relief_front::error::ToolError;

/// What is asked of a raster, a source's own or one of its shape.
#[derive(Clone, Copy)]
pub(super) struct Request<'a> {
    pub raster: &'a Raster,
    pub resample: Resample,
    pub grid: &'a Grid,
    pub window: &'a NodeWindow,
}

/// A globe's raster ready to be sampled over a window.
enum Sampler<'a> {
    Lines(Lines<'a>),
    Bent(&'a Source, &'a Projection, Request<'a>),
    Nothing,
}

/// Rows of nodes sampled at a time: what is made of them stays in the cache.
const STRIP_ROWS: usize = 128;

impl Sampler<'_> {
    /// Rows that [`Sampler::sample`] takes.
    fn rows_at_once(&self, window: &NodeWindow) -> usize {
        match self {
            Self::Lines(_) => STRIP_ROWS,
            // Neighbouring nodes share what the projection said: it is asked for all of them at once.
            Self::Bent(..) | Self::Nothing => window.ny.max(1),
        }
    }

    /// Heights of some rows of the window; metres, NaN where void.
    fn sample(&self, rows: std::ops::Range<usize>, heights_m: &mut [f64]) -> Result<(), ToolError> {
        match self {
            Self::Lines(lines) => lines.sample(rows, heights_m),
            Self::Bent(source, projection, request) => source.projected(projection, request, heights_m),
            Self::Nothing => Ok(()),
        }
    }
}

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
            Mapping::LonLat { columns, rows } => lon_lat::bounds(columns, rows),
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
    pub(super) fn kernel(&self, resample: Resample, grid: &Grid, step_deg: f64) -> Kernel {
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

    /// See [`super::SourceSet::visit`].
    pub(super) fn visit(
        &self,
        options: &SourceOptions,
        grid: &Grid,
        window: &NodeWindow,
        mut visit: impl FnMut(usize, &[f32], &[u8]),
    ) -> Result<(), ToolError> {
        let fill = options.fill == Fill::Interpolate;
        if let Mapping::Plane(place) = &self.mapping {
            let filled = if fill { Some(self.filled()?) } else { None };
            let block = place.sample(&self.raster, filled, grid, window)?;
            visit(0, &block.height_m, &block.state);
            return Ok(());
        }
        let request = Request { raster: &self.raster, resample: options.resample, grid, window };
        let sampler = self.sampler(&request)?;
        let (mut exact_m, mut height_m, mut state) = (Vec::new(), Vec::new(), Vec::new());
        for first in (0..window.ny).step_by(sampler.rows_at_once(window)) {
            let ny = sampler.rows_at_once(window).min(window.ny - first);
            let part = NodeWindow { y0: window.y0 + first as i64, ny, ..*window };
            exact_m.clear();
            exact_m.resize(part.nx * ny, f64::NAN);
            sampler.sample(first..first + ny, &mut exact_m)?;
            state.clear();
            state.extend(exact_m.iter().map(|height| if height.is_nan() { VOID } else { DATA }));
            if fill && state.contains(&VOID) && self.covers(grid, &part) {
                self.fill_in(&part, grid, &mut exact_m, &mut state)?;
            }
            if let Reference::Geoid(geoid) = &self.reference {
                geoid.add(grid, &part, &mut exact_m)?;
            }
            height_m.clear();
            height_m.extend(exact_m.iter().map(|height| if height.is_nan() { 0.0 } else { *height as f32 }));
            visit(first, &height_m, &state);
        }
        Ok(())
    }

    /// Interpolated heights where there are none.
    fn fill_in(
        &self,
        window: &NodeWindow,
        grid: &Grid,
        heights_m: &mut [f64],
        state: &mut [u8],
    ) -> Result<(), ToolError> {
        let request = Request { raster: self.filled()?, resample: Resample::Bilinear, grid, window };
        let mut filled_m = vec![f64::NAN; heights_m.len()];
        self.sampler(&request)?.sample(0..window.ny, &mut filled_m)?;
        for ((height_m, state), filled_m) in heights_m.iter_mut().zip(state).zip(filled_m) {
            if *state == VOID && !filled_m.is_nan() {
                (*height_m, *state) = (filled_m, FILLED);
            }
        }
        Ok(())
    }

    fn sampler<'a>(&'a self, request: &Request<'a>) -> Result<Sampler<'a>, ToolError> {
        Ok(match &self.mapping {
            Mapping::LonLat { columns, rows } => Sampler::Lines(self.lines(request, columns, rows)?),
            Mapping::Projected(projection) => Sampler::Bent(self, projection, *request),
            Mapping::Plane(_) => Sampler::Nothing,
        })
    }

    fn projected(
        &self,
        projection: &Projection,
        &Request { raster, resample, grid, window }: &Request<'_>,
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
            points,
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

/// Longitude of a node column, wrapped to [-180, 180).
pub(super) fn lon_deg(grid: &Grid, level: u32, i: i64) -> f64 {
    grid.lon_deg(level, i.rem_euclid(i64::from(grid.width(level))))
}
