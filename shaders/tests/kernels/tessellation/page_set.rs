//! Pages filled from a test planet, as the residency would.

use relief_shaders::pages::{BLOCKS, BOUND_WORDS, NODES, USABLE, key};

use super::deviation::deviations;
use super::planet::TestPlanet;
use crate::page_set::PageSet;

/// How pages may be wrong, to see that the checks notice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    None,
    /// Deviations of single nodes, not of all below them.
    Unsaturated,
    /// No deviations.
    Forgotten,
}

impl PageSet {
    /// Pages of all tiles.
    pub fn whole(planet: &TestPlanet) -> Self {
        Self::of(planet, Fault::None, |_, _, _| true)
    }

    /// Pages of the tiles (level, column, row) that are `present`.
    pub fn of(planet: &TestPlanet, fault: Fault, present: impl Fn(u32, u32, u32) -> bool) -> Self {
        let root = planet.m - 8;
        let devs = deviations(planet, fault != Fault::Unsaturated);
        let extremes = extremes_m(planet);
        let tiles = |k: u32| ((planet.cells_x() >> k >> 8) as u32, (planet.cells_y() >> k >> 8) as u32);
        let mut set = Self::empty(planet.planet());
        let mut usable: Vec<Vec<bool>> = vec![Vec::new(); root as usize + 1];
        for k in (0..=root).rev() {
            let (tx, ty) = tiles(k);
            for y in 0..ty {
                for x in 0..tx {
                    let here = k == root || present(k, x, y);
                    let parents = k == root
                        || touching(planet.plane, tiles(k + 1), x, y).into_iter().all(|p| usable[k as usize + 1][p]);
                    usable[k as usize].push(here && parents);
                    if here {
                        let word =
                            if parents { USABLE } else { 0 } | set.fill(planet, fault, &devs, &extremes, k, x, y);
                        set.insert(key(k, x, y), word);
                    }
                }
            }
        }
        set
    }

    pub fn push_codes(&mut self, codes: impl Iterator<Item = u32>) {
        let codes: Vec<u32> = codes.collect();
        for four in codes.chunks(4) {
            self.bounds.push(four.iter().rev().fold(0, |word, code| word << 8 | code));
        }
        assert_eq!(self.bounds.len() as u32, self.slots() * BOUND_WORDS);
    }

    #[allow(clippy::too_many_arguments, reason = "one caller")]
    fn fill(
        &mut self,
        planet: &TestPlanet,
        fault: Fault,
        devs: &[Vec<f64>],
        extremes: &[Vec<[f32; 2]>],
        k: u32,
        x: u32,
        y: u32,
    ) -> u32 {
        let slot = self.slots();
        let w = planet.cells_x() >> k;
        let columns = if planet.plane { w + 1 } else { w };
        let mut codes = vec![0u32; NODES as usize * NODES as usize];
        for r in 0..NODES {
            for c in 0..NODES {
                let (i, j) = (i64::from(256 * x + c), i64::from(256 * y + r));
                self.heights.push((f64::from(planet.node(i << k, j << k)) * planet.step_m) as f32);
                // The coarsest pages have the codes of the levels above.
                let up = if k == planet.m - 8 { (i | j).trailing_zeros().min(31) } else { 0 };
                let i = if planet.plane { i } else { i % w } >> up;
                let columns = if planet.plane { columns >> up | 1 } else { columns >> up };
                let deviation =
                    devs.get((k + up) as usize).map_or(0.0, |d| d[((j >> up) * columns + i) as usize]) / planet.step_m;
                let deviation = if fault == Fault::Forgotten { 0.0 } else { deviation };
                codes[(r * NODES + c) as usize] = code(deviation);
            }
        }
        let blocks = w / 2;
        for r in 0..BLOCKS {
            for c in 0..BLOCKS {
                let at = i64::from(BLOCKS * y + r) * blocks + i64::from(BLOCKS * x + c);
                self.bounds.extend(extremes[k as usize][at as usize].map(f32::to_bits));
            }
        }
        self.push_codes(codes.into_iter());
        slot
    }
}

/// The smallest code not below a deviation in steps (SPEC, "Deviations").
fn code(deviation: f64) -> u32 {
    let value = |c: u32| 2f64.powi((c as i32 - 1) / 4) * f64::from(4 + (c - 1) % 4) / 32.0;
    if deviation == 0.0 { 0 } else { (1..).find(|&c| value(c) >= deviation).unwrap() }
}

/// Indices of the coarser tiles that touch tile (x, y).
fn touching(plane: bool, (tx, ty): (u32, u32), x: u32, y: u32) -> Vec<usize> {
    let range = |v: u32| (i64::from(v) - 1).div_euclid(2)..=(i64::from(v) + 1).div_euclid(2);
    let mut out = Vec::new();
    for py in range(y) {
        for px in range(x) {
            let px = if plane { px } else { px.rem_euclid(i64::from(tx)) };
            if (0..i64::from(tx)).contains(&px) && (0..i64::from(ty)).contains(&py) {
                out.push((py * i64::from(tx) + px) as usize);
            }
        }
    }
    out
}

/// H_ext of each level, metres.
fn extremes_m(planet: &TestPlanet) -> Vec<Vec<[f32; 2]>> {
    let mut levels: Vec<Vec<[f32; 2]>> = Vec::new();
    for k in 0..=planet.m - 8 {
        let (w, h) = (planet.cells_x() >> (k + 1), planet.cells_y() >> (k + 1));
        let join = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let level = (0..w * h)
            .map(|n| {
                let (x, y) = (n % w, n / w);
                let mut out = [f32::INFINITY, f32::NEG_INFINITY];
                if k > 0 {
                    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        out = join(out, levels[k as usize - 1][((2 * y + dy) * 2 * w + 2 * x + dx) as usize]);
                    }
                } else {
                    for (dx, dy) in (0..9).map(|n| (n % 3, n / 3)) {
                        let height = (f64::from(planet.node(2 * x + dx, 2 * y + dy)) * planet.step_m) as f32;
                        out = join(out, [height; 2]);
                    }
                }
                out
            })
            .collect();
        levels.push(level);
    }
    levels
}
