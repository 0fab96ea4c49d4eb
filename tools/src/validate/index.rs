//! The tile index: order, ranges, the tree of tiles.

use relief_formats::file::index::{Digest, ENTRY_BYTES, Entry};
use relief_formats::file::section::{INDEX, TILES};
use relief_formats::file::{Plane, Relief};
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;

use super::check::Check;
use super::finding::{Findings, Place};

/// Bytes of the four corners that a coarsest tile's nodes start with.
const ROOT_CORNERS: u32 = 16;

/// Checks all that the index says without decoding a tile.
pub(super) fn index(relief: &Relief, findings: &Findings) {
    let (grid, body) = (relief.grid(), relief.body());
    let root = grid.root_level();
    let (mut last, mut end) = (None, 0);
    let (mut min_q, mut max_q) = (i32::MAX, i32::MIN);
    let mut sound = true;
    for n in 0..relief.tile_count() {
        let entry = match relief.entry(n) {
            Ok(entry) => entry,
            Err(error) => {
                findings.add(Check::IndexEntry, Place::default(), format!("entry {n}: {error}"));
                sound = false;
                continue;
            }
        };
        let add = |check, what: String| findings.add(check, Place::tile(body, &grid, entry.key), what);
        if !reserved_is_zero(relief, n, &entry) {
            add(Check::IndexEntry, format!("entry {n} has reserved bytes that are not zero"));
        }
        if last.is_some_and(|last| last >= Entry::sort_key(entry.key)) {
            add(Check::IndexOrder, format!("entry {n} does not sort after the one before"));
            sound = false;
        }
        last = Some(Entry::sort_key(entry.key));
        if entry.offset != end {
            add(
                Check::TileBytes,
                format!("its bytes start at {} of the section, the last tile's end at {end}", entry.offset),
            );
        }
        end = entry.offset + entry.bytes();
        (min_q, max_q) = (min_q.min(entry.min_q), max_q.max(entry.max_q));
        if entry.min_q > entry.max_q {
            add(Check::IndexEntry, format!("smallest height {} above largest {}", entry.min_q, entry.max_q));
        }
        let mip = Plane::Mip as usize;
        if entry.key.level == 0 && (entry.lengths[mip] != 0 || entry.digests[mip] != Digest::default()) {
            add(Check::PlaneLengths, "a mip plane at level 0".into());
        }
        if entry.key.level == root && entry.lengths[Plane::Nodes as usize] < ROOT_CORNERS {
            add(Check::PlaneLengths, "the nodes' plane is shorter than its corners".into());
        }
    }
    let section = relief.section_bytes(TILES).map_or(0, <[u8]>::len) as u64;
    if end != section {
        findings.add(
            Check::TileBytes,
            Place::default(),
            format!("the tiles end at {end} of the section's {section} bytes"),
        );
    }
    if sound {
        tree(relief, findings);
    }
    let header = relief.header();
    if relief.tile_count() > 0 && (header.min_q, header.max_q) != (min_q, max_q) {
        let what = format!("header {} to {}, index {min_q} to {max_q} steps", header.min_q, header.max_q);
        findings.add(Check::IndexRange, Place::default(), what);
    }
}

fn reserved_is_zero(relief: &Relief, n: usize, entry: &Entry) -> bool {
    let index = relief.section_bytes(INDEX).unwrap_or_default();
    index.chunks_exact(ENTRY_BYTES).nth(n).is_some_and(|bytes| entry.encode() == *bytes)
}

/// Roots and ancestors; the index is known to be sorted.
fn tree(relief: &Relief, findings: &Findings) {
    let (grid, body) = (relief.grid(), relief.body());
    let root = grid.root_level();
    let present = |key: TileKey| matches!(relief.find(key), Ok(Some(_)));
    for y in 0..grid.tiles_y(root) {
        for x in 0..grid.tiles_x(root) {
            let key = TileKey::new(root, x, y);
            if !present(key) {
                findings.add(Check::RootTiles, Place::tile(body, &grid, key), "missing");
            }
        }
    }
    for key in relief.entries().flatten().map(|entry| entry.key).filter(|key| key.level < root) {
        let add = |check, what: String| findings.add(check, Place::tile(body, &grid, key), what);
        if !present(key.parent()) {
            add(Check::Ancestors, format!("its parent of level {} is missing", key.level + 1));
        } else if key.level + 1 < root
            && let Some(missing) = touched(grid, key).into_iter().flatten().find(|&tile| !present(tile))
        {
            add(
                Check::TileNeighbours,
                format!("tile ({}, {}) of level {} is missing", missing.x, missing.y, missing.level),
            );
        }
    }
}

/// The tiles of the level above that lie beside and across the corner of a tile's parent where the
/// tile touches them; none beyond a pole or a plane's edge.
fn touched(grid: Grid, key: TileKey) -> [Option<TileKey>; 3] {
    let (parent, (east, north)) = (key.parent(), key.quadrant());
    let level = parent.level;
    let beside = |at: u32, far: bool, count: u32, wraps: bool| {
        let at = if far { at + 1 } else { at.wrapping_sub(1) };
        if wraps { Some(at & (count - 1)) } else { (at < count).then_some(at) }
    };
    let x = beside(parent.x, east == 1, grid.tiles_x(level), !grid.plane);
    let y = beside(parent.y, north == 1, grid.tiles_y(level), false);
    [
        x.map(|x| TileKey::new(level, x, parent.y)),
        y.map(|y| TileKey::new(level, parent.x, y)),
        x.zip(y).map(|(x, y)| TileKey::new(level, x, y)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_touches_what_lies_on_its_side_of_its_parent() {
        let globe = Grid::new(11, false);
        let key = |x, y| Some(TileKey::new(1, x, y));
        assert_eq!(touched(globe, TileKey::new(0, 5, 6)), [key(3, 3), key(2, 2), key(3, 2)]);
        assert_eq!(touched(globe, TileKey::new(0, 0, 1)), [key(7, 0), key(0, 1), key(7, 1)]);
        assert_eq!(touched(globe, TileKey::new(0, 15, 0)), [key(0, 0), None, None]);
        assert_eq!(touched(Grid::new(11, true), TileKey::new(0, 0, 7)), [None, None, None]);
    }
}
