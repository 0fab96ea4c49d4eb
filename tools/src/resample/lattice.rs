//! Pixel coordinates of many nodes from few exact ones.
//!
//! Positions are counted in half steps of level-0 nodes. Cells of 64, 16 and 4 nodes of the
//! finest level a source is sampled at are tried in turn: where fifth-order interpolation over the 6 x 6 exact corners
//! around a cell meets the exact value at three test points, the cell's nodes are interpolated,
//! else each is transformed exactly. Cells and corners lie at fixed positions and corners are
//! exact either way, so a node has the same coordinates at every level and in every window.

use std::collections::HashMap;
use std::ops::Range;

use super::projection::Transformer;

/// Largest disagreement at a test point, pixels.
const TOLERANCE_PX: f64 = 2e-7;
/// Cell sizes in nodes of the finest level sampled.
const CELL_NODES: [i64; 3] = [64, 16, 4];
/// Corners on each axis.
const TAPS: usize = 6;
const OFF: [f64; 2] = [f64::NAN; 2];

/// Exact and interpolated pixel coordinates over one planet.
pub(crate) struct Lattice<'a> {
    transformer: Transformer<'a>,
    /// Units in a full circle.
    circle: i64,
    /// Units of each cell size.
    sizes: [i64; 3],
    exact: HashMap<(i64, i64), [f64; 2]>,
}

/// A rectangle of positions: `first + k step`, in units; j = 0 at the South Pole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Positions<'a> {
    pub first: (i64, i64),
    pub step: i64,
    /// For each column, whether it is wanted.
    pub columns: &'a [bool],
    /// For each row, whether it is wanted.
    pub rows: &'a [bool],
}

/// Columns and rows of a part of some positions.
type Part = (Range<usize>, Range<usize>);

impl<'a> Lattice<'a> {
    /// A lattice with `circle` units to the full circle and `node_units` from node to node of the
    /// finest level sampled, both powers of two.
    pub fn new(transformer: Transformer<'a>, circle: i64, node_units: i64) -> Self {
        Self { transformer, circle, sizes: CELL_NODES.map(|nodes| nodes * node_units), exact: HashMap::new() }
    }

    /// Pixel coordinates of every position, row by row; NaN where it is not wanted or the CRS
    /// does not reach.
    pub fn pixels(&mut self, at: Positions<'_>) -> Vec<[f64; 2]> {
        let mut pixels = vec![OFF; at.columns.len() * at.rows.len()];
        self.cells(&at, 0, (0..at.columns.len(), 0..at.rows.len()), &mut pixels);
        pixels
    }

    /// Splits a part of the positions into cells of one size and fills them in.
    fn cells(&mut self, at: &Positions<'_>, size_index: usize, (xs, ys): Part, pixels: &mut [[f64; 2]]) {
        let size = self.sizes[size_index];
        let split = |first: i64, range: Range<usize>, wanted: &[bool]| {
            let mut parts = Vec::new();
            let mut from = range.start;
            while from < range.end {
                let cell = (first + from as i64 * at.step).div_euclid(size);
                let beyond = ((cell + 1) * size - first + at.step - 1).div_euclid(at.step) as usize;
                let to = beyond.clamp(from + 1, range.end);
                if wanted[from..to].contains(&true) {
                    parts.push((cell * size, from..to));
                }
                from = to;
            }
            parts
        };
        let columns = split(at.first.0, xs, at.columns);
        for (j, ys) in split(at.first.1, ys, at.rows) {
            for (i, xs) in &columns {
                self.cell(at, size_index, (*i, j), (xs.clone(), ys.clone()), pixels);
            }
        }
    }

    fn cell(
        &mut self,
        at: &Positions<'_>,
        size_index: usize,
        origin: (i64, i64),
        (xs, ys): Part,
        pixels: &mut [[f64; 2]],
    ) {
        let (nx, size) = (at.columns.len(), self.sizes[size_index]);
        let position = |x: usize, y: usize| (at.first.0 + x as i64 * at.step, at.first.1 + y as i64 * at.step);
        let only_corner = xs.len() == 1 && ys.len() == 1 && position(xs.start, ys.start) == origin;
        let smooth = if only_corner { None } else { self.smooth_cell(origin, size) };
        let Some(corners) = smooth else {
            if !only_corner && size_index + 1 < self.sizes.len() {
                return self.cells(at, size_index + 1, (xs, ys), pixels);
            }
            for y in ys.filter(|y| at.rows[*y]) {
                for x in xs.clone().filter(|x| at.columns[*x]) {
                    let (i, j) = position(x, y);
                    pixels[y * nx + x] = self.exact(i, j);
                }
            }
            return;
        };
        let weights: Vec<[f64; TAPS]> =
            xs.clone().map(|x| lagrange(fraction(position(x, 0).0 - origin.0, size))).collect();
        for y in ys.filter(|y| at.rows[*y]) {
            let j = position(xs.start, y).1;
            let line = mix(&corners, lagrange(fraction(j - origin.1, size)));
            for (x, w) in xs.clone().zip(&weights).filter(|(x, _)| at.columns[*x]) {
                pixels[y * nx + x] = match j {
                    // A pole is one point: interpolation would give each column its own rounding.
                    _ if j == 0 || j == self.circle / 2 => self.exact(0, j),
                    _ => [0, 1].map(|axis| (0..TAPS).map(|k| w[k] * line[k][axis]).sum()),
                };
            }
        }
    }

    /// The 6 x 6 exact corners around a cell, rows south to north, if interpolation holds there.
    fn smooth_cell(&mut self, (i0, j0): (i64, i64), size: i64) -> Option<[[[f64; 2]; TAPS]; TAPS]> {
        let mut corners = [[OFF; TAPS]; TAPS];
        for (row, line) in corners.iter_mut().enumerate() {
            for (column, corner) in line.iter_mut().enumerate() {
                *corner = self.exact(i0 + (column as i64 - 2) * size, j0 + (row as i64 - 2) * size);
                if corner[0].is_nan() {
                    return None;
                }
            }
        }
        let holds = [(size / 2, 0), (0, size / 2), (size / 2, size / 2)].into_iter().all(|(di, dj)| {
            let exact = self.exact(i0 + di, j0 + dj);
            let line = mix(&corners, lagrange(fraction(dj, size)));
            let w = lagrange(fraction(di, size));
            // A NaN fails, too.
            [0, 1].into_iter().all(|axis| {
                let value: f64 = (0..TAPS).map(|k| w[k] * line[k][axis]).sum();
                (value - exact[axis]).abs() <= TOLERANCE_PX
            })
        });
        holds.then_some(corners)
    }

    fn exact(&mut self, i: i64, j: i64) -> [f64; 2] {
        // Beyond a pole the surface goes on half a turn away.
        let half = self.circle / 2;
        let (i, j) = match j {
            _ if j < 0 => (i + half, -j),
            _ if j > half => (i + half, 2 * half - j),
            _ => (i, j),
        };
        let i = if j == 0 || j == half { 0 } else { i.rem_euclid(self.circle) };
        if let Some(pixel) = self.exact.get(&(i, j)) {
            return *pixel;
        }
        let degrees = 360.0 / self.circle as f64;
        let (lon_deg, lat_deg) = (-180.0 + i as f64 * degrees, -90.0 + j as f64 * degrees);
        let pixel = self.transformer.pixel(lon_deg, lat_deg).unwrap_or(OFF);
        self.exact.insert((i, j), pixel);
        pixel
    }
}

fn fraction(units: i64, size: i64) -> f64 {
    units as f64 / size as f64
}

fn mix(corners: &[[[f64; 2]; TAPS]; TAPS], w: [f64; TAPS]) -> [[f64; 2]; TAPS] {
    std::array::from_fn(|column| [0, 1].map(|axis| (0..TAPS).map(|row| w[row] * corners[row][column][axis]).sum()))
}

/// Lagrange's polynomial through the values at -2, -1, 0, 1, 2, 3.
fn lagrange(t: f64) -> [f64; TAPS] {
    let (p, q, r, s, u) = (t + 2.0, t + 1.0, t - 1.0, t - 2.0, t - 3.0);
    [
        -q * t * r * s * u / 120.0,
        p * t * r * s * u / 24.0,
        -p * q * r * s * u / 12.0,
        p * q * t * s * u / 12.0,
        -p * q * t * r * u / 24.0,
        p * q * t * r * s / 120.0,
    ]
}
