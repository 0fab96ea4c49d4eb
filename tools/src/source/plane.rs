//! Flat maps: nodes are the source's pixels, in its own CRS.

use relief_formats::body::Body;
use relief_formats::grid::Grid;

use super::georef::Georef;
use super::raster::Raster;
use super::{DATA, FILLED, HeightBlock, NodeWindow, VOID};
use relief_front::error::ToolError;

/// Pixels by which rasters may miss each other's grid.
const MISFIT_PX: f64 = 0.01;

/// Where a raster lies on the plane's level-0 nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PlanePlace {
    /// Node of the raster's south-western pixel.
    pub first: (i64, i64),
    /// Stored east to west.
    pub flip_x: bool,
    /// Stored north to south.
    pub flip_y: bool,
    /// Nodes that all rasters together cover.
    pub whole: (i64, i64),
}

/// Fits the rasters onto one plane.
///
/// # Errors
/// [`ToolError::Source`] for a rotated raster, [`ToolError::Usage`] for rasters on different grids.
pub(crate) fn fit(rasters: &[(&str, (usize, usize), &Georef)]) -> Result<(Body, Vec<PlanePlace>), ToolError> {
    let (first_path, _, first) = rasters[0];
    let (dx, dy) = (first.transform[1].abs(), first.transform[5].abs());
    let wkt = |georef: &Georef| georef.crs.as_ref().map_or_else(String::new, |crs| crs.wkt.clone());
    // Centres of south-western pixels.
    let mut corners = Vec::new();
    for (path, (nx, ny), georef) in rasters {
        if !georef.axis_aligned() {
            return Err(ToolError::source(
                *path,
                format!("its geotransform is rotated: {:?}", georef.transform),
                "on a plane rows and columns run along the axes of the CRS",
                "warp it onto its axes with gdalwarp",
            ));
        }
        let t = &georef.transform;
        let misfit = |a: f64, b: f64, n: usize| (a.abs() / b - 1.0).abs() * *[n].iter().max().unwrap_or(&n) as f64;
        if wkt(georef) != wkt(first) || misfit(t[1], dx, *nx) > MISFIT_PX || misfit(t[5], dy, *ny) > MISFIT_PX {
            return Err(unlike(first_path, path, "CRS and spacing"));
        }
        let x = t[0] + t[1] * if t[1] > 0.0 { 0.5 } else { *nx as f64 - 0.5 };
        let y = t[3] + t[5] * if t[5] > 0.0 { 0.5 } else { *ny as f64 - 0.5 };
        corners.push((x, y));
    }
    let x0 = corners.iter().map(|corner| corner.0).fold(f64::INFINITY, f64::min);
    let y0 = corners.iter().map(|corner| corner.1).fold(f64::INFINITY, f64::min);
    let mut places = Vec::new();
    for ((path, _, georef), (x, y)) in rasters.iter().zip(&corners) {
        let (i, j) = ((x - x0) / dx, (y - y0) / dy);
        if (i - i.round()).abs() > MISFIT_PX || (j - j.round()).abs() > MISFIT_PX {
            return Err(unlike(first_path, path, "pixel grid"));
        }
        places.push(PlanePlace {
            first: (i.round() as i64, j.round() as i64),
            flip_x: georef.transform[1] < 0.0,
            flip_y: georef.transform[5] < 0.0,
            whole: (0, 0),
        });
    }
    let end = |axis: fn(&PlanePlace) -> i64, size: fn(&(usize, usize)) -> usize| {
        let ends = places.iter().zip(rasters).map(|(place, (_, n, _))| axis(place) + size(n) as i64);
        ends.max().unwrap_or(0)
    };
    let whole = (end(|place| place.first.0, |n| n.0), end(|place| place.first.1, |n| n.1));
    places.iter_mut().for_each(|place| place.whole = whole);
    Ok((Body::Plane { crs_wkt: wkt(first), x0, y0, dx, dy }, places))
}

fn unlike(a: &str, b: &str, what: &str) -> ToolError {
    ToolError::usage(
        format!("{a} and {b} differ in {what}"),
        "inputs of one plane share CRS, spacing and pixel grid",
        "bring them onto one grid with gdalwarp -tap, or bake them apart",
    )
}

impl PlanePlace {
    /// False only if no node of the window can have data from this raster.
    pub fn covers(&self, raster: &Raster, grid: &Grid, window: &NodeWindow) -> bool {
        let meets = |n: usize, at: &dyn Fn(usize) -> (i64, bool), size: usize| {
            n > 0 && at(n - 1).0 >= 0 && at(0).0 < size as i64
        };
        meets(window.nx, &|i| self.column(grid, window, i), raster.width)
            && meets(window.ny, &|j| self.row(grid, window, j), raster.height)
    }

    /// The raster's column (from the west) at a node column, and whether that is padding.
    fn column(&self, grid: &Grid, window: &NodeWindow, i: usize) -> (i64, bool) {
        let last = i64::from(grid.width(0)) - 1;
        place((window.x0 + i as i64) << window.level, last, self.whole.0, self.first.0)
    }

    fn row(&self, grid: &Grid, window: &NodeWindow, j: usize) -> (i64, bool) {
        let last = i64::from(grid.height(0)) - 1;
        place((window.y0 + j as i64) << window.level, last, self.whole.1, self.first.1)
    }

    /// Heights at the window's nodes; void pixels come from `filled` where there is one.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub fn sample(
        &self,
        raster: &Raster,
        filled: Option<&Raster>,
        grid: &Grid,
        window: &NodeWindow,
    ) -> Result<HeightBlock, ToolError> {
        let count = window.nx * window.ny;
        let mut block = HeightBlock { height_m: vec![0.0; count], state: vec![VOID; count] };
        let inside = |at: (i64, bool), n: usize, flip: bool| {
            let stored = if flip { n as i64 - 1 - at.0 } else { at.0 };
            (0..n as i64).contains(&at.0).then_some((stored as usize, at.1))
        };
        let columns: Vec<_> = (0..window.nx)
            .filter_map(|i| Some((i, inside(self.column(grid, window, i), raster.width, self.flip_x)?)))
            .collect();
        let rows: Vec<_> = (0..window.ny)
            .filter_map(|j| Some((j, inside(self.row(grid, window, j), raster.height, self.flip_y)?)))
            .collect();
        if columns.is_empty() || rows.is_empty() {
            return Ok(block);
        }
        let stored_columns: Vec<_> = columns.iter().map(|column| column.1.0).collect();
        let stored_rows: Vec<_> = rows.iter().map(|row| (row.1.0, false)).collect();
        let patch = raster.gather(&stored_rows, &stored_columns, None)?;
        let spare = filled.map(|filled| filled.gather(&stored_rows, &stored_columns, None)).transpose()?;
        for (at_row, (j, (_, padded_row))) in rows.iter().enumerate() {
            for (at_column, (i, (_, padded_column))) in columns.iter().enumerate() {
                let (from, to) = (at_row * patch.nx + at_column, j * window.nx + i);
                let (height_m, state) = match (patch.pixels[from], &spare) {
                    (height, Some(spare)) if height.is_nan() => (spare.pixels[from], FILLED),
                    (height, None) if height.is_nan() => (0.0, VOID),
                    (height, _) => (height, DATA),
                };
                block.height_m[to] = height_m;
                block.state[to] = match state {
                    DATA if *padded_row || *padded_column => FILLED,
                    other => other,
                };
            }
        }
        Ok(block)
    }
}

/// A node's pixel counted from the raster's first, and whether the node lies beyond them all.
fn place(node: i64, last: i64, whole: i64, first: i64) -> (i64, bool) {
    let node = node.clamp(0, last);
    (node.min(whole - 1) - first, node >= whole)
}
