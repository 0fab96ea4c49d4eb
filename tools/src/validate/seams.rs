//! What tiles must agree on: edges between neighbours, poles, a plane's border, filled nodes.

use rayon::prelude::*;
use relief_formats::file::{FormatError, Relief};
use relief_formats::grid::Grid;
use relief_formats::tile::{TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

use super::check::Check;
use super::finding::{Findings, Place};

const LAST: usize = TILE_NODES - 1;

/// Checks all tiles; `step` is called once for each.
///
/// # Errors
/// When a tile does not decode.
pub(super) fn seams(
    relief: &Relief,
    tiles: &Tiles<'_>,
    findings: &Findings,
    step: impl Fn() + Sync,
) -> Result<(), FormatError> {
    let seams = Seams { relief, tiles, grid: relief.grid(), findings };
    (0..relief.tile_count()).into_par_iter().try_for_each(|n| {
        let key = relief.entry(n)?.key;
        seams.neighbours(key)?;
        seams.borders(key)?;
        seams.filled_as_parent(key)?;
        step();
        Ok(())
    })
}

struct Seams<'a> {
    relief: &'a Relief,
    tiles: &'a Tiles<'a>,
    grid: Grid,
    findings: &'a Findings,
}

/// A tile's side.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    West,
    East,
    South,
    North,
}

impl Side {
    const ALL: [Self; 4] = [Self::West, Self::East, Self::South, Self::North];

    /// The k-th node of the side, from its western or southern end.
    fn node(self, k: usize) -> (usize, usize) {
        match self {
            Self::West => (0, k),
            Self::East => (LAST, k),
            Self::South => (k, 0),
            Self::North => (k, LAST),
        }
    }

    fn opposite(self) -> Self {
        match self {
            Self::West => Self::East,
            Self::East => Self::West,
            Self::South => Self::North,
            Self::North => Self::South,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::West => "western",
            Self::East => "eastern",
            Self::South => "southern",
            Self::North => "northern",
        }
    }
}

fn at<T: Copy>(samples: &[T], (i, j): (usize, usize)) -> T {
    samples[j * TILE_NODES + i]
}

impl Seams<'_> {
    /// The tile on the other side; none beyond a pole or a plane's border.
    fn neighbour(&self, key: TileKey, side: Side) -> Option<TileKey> {
        let (columns, rows) = (self.grid.tiles_x(key.level), self.grid.tiles_y(key.level));
        let wraps = !self.grid.plane;
        let (x, y) = match side {
            Side::West if key.x > 0 || wraps => ((key.x + columns - 1) % columns, key.y),
            Side::East if key.x + 1 < columns || wraps => ((key.x + 1) % columns, key.y),
            Side::South if key.y > 0 => (key.x, key.y - 1),
            Side::North if key.y + 1 < rows => (key.x, key.y + 1),
            _ => return None,
        };
        Some(TileKey::new(key.level, x, y))
    }

    fn neighbours(&self, key: TileKey) -> Result<(), FormatError> {
        for side in Side::ALL {
            let Some(other) = self.neighbour(key, side) else { continue };
            let present = self.relief.find(other)?.is_some();
            if present && matches!(side, Side::West | Side::South) {
                continue; // compared from the other tile
            }
            let (ours, theirs) = (self.tiles.nodes(key)?, self.tiles.nodes(other)?);
            let check = if present { Check::Seams } else { Check::AbsentEdges };
            self.edge(check, key, side, |k| {
                let (a, b) = (at(&ours, side.node(k)), at(&theirs, side.opposite().node(k)));
                (a != b).then(|| format!("{a} against {b} steps"))
            });
            if present {
                let (ours, theirs) = (self.tiles.filled(key)?, self.tiles.filled(other)?);
                self.edge(Check::FilledSeams, key, side, |k| {
                    let (a, b) = (at(&ours, side.node(k)), at(&theirs, side.opposite().node(k)));
                    (a != b).then(|| format!("filled: {a} against {b}"))
                });
            }
        }
        Ok(())
    }

    /// One finding for an edge, at its first bad node.
    fn edge(&self, check: Check, key: TileKey, side: Side, fault: impl Fn(usize) -> Option<String>) {
        let mut faults = (0..TILE_NODES).filter_map(|k| Some((k, fault(k)?)));
        if let Some((k, what)) = faults.next() {
            let count = 1 + faults.count();
            let place = Place::node(self.relief.body(), &self.grid, key, side.node(k));
            self.findings.add(check, place, format!("{what} on the {} edge ({count} nodes)", side.name()));
        }
    }

    /// Pole rows of a globe; last row, last column and corners of a plane.
    fn borders(&self, key: TileKey) -> Result<(), FormatError> {
        let header = self.relief.header();
        let (first, last) = (key.y == 0, key.y + 1 == self.grid.tiles_y(key.level));
        if !self.grid.plane {
            for (here, side, pole_q) in
                [(first, Side::South, header.south_pole_q), (last, Side::North, header.north_pole_q)]
            {
                if here {
                    let nodes = self.tiles.nodes(key)?;
                    self.edge(Check::Poles, key, side, |k| {
                        let q = at(&nodes, side.node(k));
                        (q != pole_q).then(|| format!("{q} steps, the header's pole has {pole_q}"))
                    });
                }
            }
            return Ok(());
        }
        let east = key.x + 1 == self.grid.tiles_x(key.level);
        let nodes = self.tiles.nodes(key)?;
        if key.level == 0 {
            for (here, side) in [(last, Side::North), (east, Side::East)] {
                let inner = |k| match side {
                    Side::North => (k, LAST - 1),
                    _ => (LAST - 1, k),
                };
                if here {
                    self.edge(Check::PlaneEdges, key, side, |k| {
                        let (a, b) = (at(&nodes, side.node(k)), at(&nodes, inner(k)));
                        (a != b).then(|| format!("{a} steps, the one before has {b}"))
                    });
                }
            }
        }
        let corners =
            [(key.x == 0 && first, (0, 0), header.south_pole_q), (east && last, (LAST, LAST), header.north_pole_q)];
        for (_, node, corner_q) in corners.into_iter().filter(|(here, ..)| *here) {
            let q = at(&nodes, node);
            if q != corner_q {
                let place = Place::node(self.relief.body(), &self.grid, key, node);
                self.findings.add(Check::PlaneEdges, place, format!("{q} steps, the header's corner has {corner_q}"));
            }
        }
        Ok(())
    }

    /// A child's even nodes are its parent's, and so are their marks.
    fn filled_as_parent(&self, key: TileKey) -> Result<(), FormatError> {
        if key.level == self.grid.root_level() {
            return Ok(());
        }
        let (ours, parent) = (self.tiles.filled(key)?, self.tiles.filled(key.parent())?);
        let (x0, y0) = (key.quadrant().0 * LAST / 2, key.quadrant().1 * LAST / 2);
        let nodes = (0..=LAST / 2).flat_map(|j| (0..=LAST / 2).map(move |i| (i, j)));
        let mut odd = nodes.filter(|&(i, j)| at(&ours, (2 * i, 2 * j)) != at(&parent, (x0 + i, y0 + j)));
        if let Some((i, j)) = odd.next() {
            let what = format!("marked differently from level {} ({} nodes)", key.level + 1, 1 + odd.count());
            self.findings.add(
                Check::FilledParent,
                Place::node(self.relief.body(), &self.grid, key, (2 * i, 2 * j)),
                what,
            );
        }
        Ok(())
    }
}
