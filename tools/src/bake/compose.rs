//! Heights in steps at any nodes of any level, composed from all sources.
//!
//! At each place the last source with data wins. At levels finer than the winner's own it is not
//! sampled: the nodes lie between those of the level above, so that a finer level holds nothing
//! that no source has seen.

use relief_formats::derive::{Field, Window};

use super::plan::Plan;
use crate::source::{DATA, FILLED, Fill, NodeWindow, SourceSet, VOID};
use relief_front::error::ToolError;

/// Nodes of a window: heights in steps and whether they are filled rather than measured.
pub struct Composed {
    /// Heights in steps.
    pub q: Field<i32>,
    /// Filled nodes.
    pub filled: Field<bool>,
}

impl Composed {
    /// Another window, each of whose nodes stands where `home` says.
    fn taken(&self, window: Window, home: impl Fn(i32, i32) -> (i32, i32)) -> Self {
        let from = |x, y| home(x, y);
        Self {
            q: Field::from_fn(window, |x, y| self.q.at(from(x, y).0, from(x, y).1)),
            filled: Field::from_fn(window, |x, y| self.filled.at(from(x, y).0, from(x, y).1)),
        }
    }
}

/// Samples sources for a plan.
pub struct Composer<'a> {
    /// The inputs.
    pub sources: &'a SourceSet,
    /// The grid and tiles.
    pub plan: &'a Plan,
    /// Height of nodes without data, in steps.
    pub void_q: i32,
}

/// Where a node's height comes from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    /// No source has data there.
    Void,
    /// Sampled at this level.
    Sampled,
    /// The winning source is coarser than this level.
    Coarser,
}

impl<'a> Composer<'a> {
    /// # Errors
    /// A fill height that the step cannot hold.
    pub fn new(sources: &'a SourceSet, plan: &'a Plan, fill: Fill) -> Result<Self, ToolError> {
        let void_q = match fill {
            Fill::Constant(height_m) => plan.quantize(height_m)?,
            Fill::None | Fill::Interpolate => 0,
        };
        Ok(Self { sources, plan, void_q })
    }

    /// Nodes of a window that may run over the seam, the poles and a plane's edges.
    ///
    /// # Errors
    /// What the sources answer, or a height out of range.
    pub fn window(&self, level: u32, window: Window) -> Result<Composed, ToolError> {
        let grid = &self.plan.grid;
        let height = grid.height(level) as i32;
        if window.y0 >= 0 && window.y1() <= height + 1 && (!grid.plane || self.on_plane(level, &window)) {
            return self.rows(level, window);
        }
        if grid.plane {
            let home = |x, y| grid.home_node(level, x, y);
            let columns = || (window.x0..window.x1()).map(|x| home(x, 0).0);
            let rows = || (window.y0..window.y1()).map(|y| home(0, y).1);
            let span = |low: Option<i32>, high: Option<i32>| (low.unwrap_or(0), high.unwrap_or(0) + 1);
            let (x0, x1) = span(columns().min(), columns().max());
            let (y0, y1) = span(rows().min(), rows().max());
            return Ok(self.rows(level, Window::between(x0, x1, y0, y1))?.taken(window, home));
        }
        // A globe's rows beyond a pole are rows of the other side, half a turn on.
        let half = grid.width(level) as i32 / 2;
        let inner = Window::between(window.x0, window.x1(), window.y0.max(0), window.y1().min(height + 1));
        let mut parts = vec![(inner, self.rows(level, inner)?)];
        for (rows, pole) in [(window.y0..inner.y0, 0), (inner.y1()..window.y1(), height)] {
            if !rows.is_empty() {
                let (south, north) = (2 * pole - (rows.end - 1), 2 * pole - rows.start);
                let mirror = Window::between(window.x0 + half, window.x1() + half, south, north + 1);
                let across = self.rows(level, mirror)?;
                let beyond = Window::between(window.x0, window.x1(), rows.start, rows.end);
                parts.push((beyond, across.taken(beyond, |x, y| (x + half, 2 * pole - y))));
            }
        }
        let mut whole = Composed { q: Field::new(window), filled: Field::new(window) };
        for (part, composed) in &parts {
            for y in part.y0..part.y1() {
                let at = (y - window.y0) as usize * window.nx;
                whole.q.data_mut()[at..][..window.nx].copy_from_slice(composed.q.row(y, window.x0, window.nx));
                whole.filled.data_mut()[at..][..window.nx]
                    .copy_from_slice(composed.filled.row(y, window.x0, window.nx));
            }
        }
        Ok(whole)
    }

    fn on_plane(&self, level: u32, window: &Window) -> bool {
        window.x0 >= 0 && window.x1() <= self.plan.grid.width(level) as i32 + 1
    }

    /// Nodes of rows 0..=H.
    fn rows(&self, level: u32, window: Window) -> Result<Composed, ToolError> {
        let mut q = Field::new(window);
        let mut filled = Field::new(window);
        let mut origin = vec![Origin::Void; window.len()];
        self.sample(level, window, &mut q, &mut filled, &mut origin)?;
        let coarser = origin.contains(&Origin::Coarser);
        let void = origin.contains(&Origin::Void);
        if coarser || (void && !self.plan.is_dense() && level < self.plan.grid.root_level()) {
            self.interpolate(level, window, &mut q, &mut filled, &origin)?;
        } else if void {
            let voids = origin.iter().zip(q.data_mut().iter_mut().zip(filled.data_mut()));
            voids.filter(|(o, _)| **o == Origin::Void).for_each(|(_, (q, f))| (*q, *f) = (self.void_q, true));
        }
        Ok(Composed { q, filled })
    }

    fn sample(
        &self,
        level: u32,
        window: Window,
        q: &mut Field<i32>,
        filled: &mut Field<bool>,
        origin: &mut [Origin],
    ) -> Result<(), ToolError> {
        let grid = &self.plan.grid;
        let request =
            NodeWindow { level, x0: i64::from(window.x0), y0: i64::from(window.y0), nx: window.nx, ny: window.ny };
        let finest = &self.plan.finest;
        for s in (0..self.sources.len()).rev() {
            // A coarser source matters here only where it hides a finer one named before it.
            let own_level = finest[s] <= level;
            let hides = finest[..s].iter().any(|&f| f <= level);
            if !(own_level || hides) || !self.sources.covers(s, grid, &request) {
                continue;
            }
            let mut largest = 0_f32;
            self.sources.visit(s, grid, &request, |row, height_m, state| {
                let part = row * window.nx..row * window.nx + state.len();
                let (origin, q, filled) =
                    (&mut origin[part.clone()], &mut q.data_mut()[part.clone()], &mut filled.data_mut()[part]);
                if own_level {
                    take(height_m, state, self.plan.step_m(), (origin, q, filled), &mut largest);
                } else {
                    let places = origin.iter_mut().zip(state);
                    places.filter(|(o, s)| **o == Origin::Void && **s != VOID).for_each(|(o, _)| *o = Origin::Coarser);
                }
            })?;
            self.plan.quantize(f64::from(largest))?;
            if !origin.contains(&Origin::Void) {
                break;
            }
        }
        // What no finer source has may still lie on a coarser one.
        if (0..self.sources.len()).any(|s| finest[s] > level && self.sources.covers(s, grid, &request)) {
            for o in origin.iter_mut().filter(|o| **o == Origin::Void) {
                *o = Origin::Coarser;
            }
        }
        Ok(())
    }

    /// Fills what this level does not sample from the level above, like a reader does for an
    /// absent tile; nodes without any data keep the void height where the tile is present.
    fn interpolate(
        &self,
        level: u32,
        window: Window,
        q: &mut Field<i32>,
        filled: &mut Field<bool>,
        origin: &[Origin],
    ) -> Result<(), ToolError> {
        let (x0, x1) = (window.x0.div_euclid(2), (window.x1() - 1).div_euclid(2) + 2);
        let (y0, y1) = (window.y0.div_euclid(2), (window.y1() - 1).div_euclid(2) + 2);
        let above = self.window(level + 1, Window::between(x0, x1, y0, y1))?;
        let nx = window.nx;
        // A row's tiles and those of the row south of it, each remembered from node to node.
        let [here, south] = [self.plan.absent_by_row(), self.plan.absent_by_row()];
        let inside = |x: i32, y: i32| {
            !(here(level, x, y) || here(level, x - 1, y) || south(level, x, y - 1) || south(level, x - 1, y - 1))
        };
        for k in (0..window.len()).filter(|&k| origin[k] != Origin::Sampled) {
            let (x, y) = (window.x0 + (k % nx) as i32, window.y0 + (k / nx) as i32);
            let (w, s) = (x.div_euclid(2), y.div_euclid(2));
            let (e, n) = (w + (x & 1), s + (y & 1));
            let corners = [(w, s), (e, s), (w, n), (e, n)];
            let fill = corners.iter().any(|&(x, y)| above.filled.at(x, y));
            let even = x & 1 == 0 && y & 1 == 0;
            let void = !even && origin[k] == Origin::Void;
            // A void is marked even where all around it is measured.
            filled.data_mut()[k] = fill || void;
            // Void where all tiles that share the node are present.
            q.data_mut()[k] = if void && inside(x, y) {
                self.void_q
            } else {
                // With one or both indices even, corners repeat and the sum is 4 or 2 times theirs:
                // the same rounding as (a + b + 1) >> 1.
                (corners.iter().map(|&(x, y)| above.q.at(x, y)).sum::<i32>() + 2) >> 2
            };
        }
        Ok(())
    }
}

/// Takes a source's heights where nothing has been taken yet. `largest` becomes the one furthest
/// from 0 that was taken.
fn take(
    height_m: &[f32],
    state: &[u8],
    step_m: f64,
    (origin, q, filled): (&mut [Origin], &mut [i32], &mut [bool]),
    largest: &mut f32,
) {
    // Added to a number below 2^31 this leaves the nearest integer, ties to even, in the low bits.
    const INTEGERS: f64 = 6_755_399_441_055_744.0;
    // The step is a power of two, so the product is exact and rounding is the only loss.
    let inverse = (1.0 / step_m) as f32;
    let steps = |h: f32| (f64::from(h * inverse) + INTEGERS).to_bits() as i32;
    let further = |a: f32, b: f32| if b.abs() > a.abs() { b } else { a };
    if origin.iter().all(|o| *o == Origin::Void) && state.iter().all(|s| *s == DATA) {
        q.iter_mut().zip(height_m).for_each(|(q, h)| *q = steps(*h));
        filled.fill(false);
        origin.fill(Origin::Sampled);
        *largest = further(*largest, furthest(height_m));
        return;
    }
    let places = origin.iter_mut().zip(q.iter_mut().zip(filled));
    for ((origin, (q, filled)), (&h, &state)) in places.zip(height_m.iter().zip(state)) {
        if *origin == Origin::Void && state != VOID {
            debug_assert!(state == DATA || state == FILLED);
            *largest = further(*largest, h);
            (*q, *filled, *origin) = (steps(h), state == FILLED, Origin::Sampled);
        }
    }
}

/// The number furthest from 0.
fn furthest(numbers: &[f32]) -> f32 {
    // In eight lanes: one would wait for its own last comparison every time.
    let mut ends = [[0_f32; 8]; 2];
    let chunks = numbers.chunks_exact(8);
    let rest = chunks.remainder();
    for chunk in chunks {
        for k in 0..8 {
            ends[0][k] = if chunk[k] < ends[0][k] { chunk[k] } else { ends[0][k] };
            ends[1][k] = if chunk[k] > ends[1][k] { chunk[k] } else { ends[1][k] };
        }
    }
    let all = ends.iter().flatten().chain(rest);
    all.fold(0.0, |a, &b| if b.abs() > a.abs() { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_rounded_and_the_furthest_is_found() {
        let heights_m: Vec<f32> =
            (0..1000).map(|k| (k * 7919 % 1999 - 999) as f32 * 0.25).chain([4_194_303.5, -8_388_607.0, 0.0]).collect();
        let count = heights_m.len();
        for (at, before) in [(None, Origin::Void), (Some(17), Origin::Sampled)] {
            let (mut origin, mut q, mut filled) = (vec![Origin::Void; count], vec![i32::MIN; count], vec![true; count]);
            origin[at.unwrap_or(0)] = before;
            let mut largest = 1.0;
            take(&heights_m, &vec![DATA; count], 0.5, (&mut origin, &mut q, &mut filled), &mut largest);
            for (k, h) in heights_m.iter().enumerate().filter(|(k, _)| Some(*k) != at) {
                assert_eq!((q[k], filled[k]), ((2.0 * h).round_ties_even() as i32, false), "{h}");
            }
            assert_eq!(at.map(|k| (q[k], filled[k])), at.map(|_| (i32::MIN, true)));
            assert_eq!(largest, -8_388_607.0);
        }
        assert_eq!(furthest(&[]), 0.0);
        assert_eq!(furthest(&[1.0, 2.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.5]), -3.0);
    }
}
