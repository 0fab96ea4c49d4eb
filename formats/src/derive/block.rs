//! All derived planes of one block of the map, level by level.
//!
//! The map is worked off in blocks that fit in memory and share nothing, so a caller runs them in
//! parallel. A block has its core and [`padding`] nodes around it, filled by the caller with the
//! neighbours (wrapped at the seam, mirrored over the poles, or the edge repeated). A first stage
//! starts from level 0; a second one starts at the level where the first ended, from its summaries.

use super::deviation::{CellDistances, Sources, cell_distances, centres, deviations};
use super::extremes::{Extremes, extremes_from_nodes, extremes_next};
use super::field::{Field, Window};
use super::interval::{Interval, intervals_into};
use super::lanes::SPAN;
use super::mip::mip_into;
use super::virtual_cells::virtual_centres;

/// What is known at the level where a stage starts, and what a stage hands on. All windows but
/// `extremes` include the padding.
#[derive(Clone, Debug)]
pub struct Base {
    /// The level.
    pub level: u32,
    /// Nodes of the level, in height units.
    pub nodes: Field<i32>,
    /// Filtered heights at the same nodes; `None` at level 0, where they are the nodes themselves.
    pub mip: Option<Field<i32>>,
    /// What lies below, unless this is level 0.
    pub below: Option<Below>,
}

/// What a stage above level 0 must know of the levels below it.
#[derive(Clone, Debug)]
pub struct Below {
    /// I of the level, for each of its cells.
    pub intervals: Field<Interval>,
    /// H_ext of level - 1, for each cell of the level. Only the core is used.
    pub extremes: Field<Extremes>,
    /// Deviation codes of level - 1 at the centres of the level's cells.
    pub centres: Field<u8>,
    /// Distances of levels `level`, `level` + 1, ..., one entry for each cell of the level above
    /// it. Three, if the stage below could have them (its core divides by 2^(levels + 3));
    /// without them the nodes of `level` must do, and the bounds are looser. Entries outside the map
    /// may be 0, as may those of `intervals` and `centres`.
    pub distances: Vec<Field<CellDistances>>,
}

/// The planes of one level over a block's core. All but `extremes` reach beyond it, into what is
/// left of the padding: not a bound of anything there, for the caller to crop.
#[derive(Clone, Debug)]
pub struct LevelPlanes {
    /// The level.
    pub level: u32,
    /// The nodes.
    pub nodes: Field<i32>,
    /// Filtered heights; `None` at level 0, where they are the nodes themselves.
    pub mip: Option<Field<i32>>,
    /// H_ext, for the core's cells of the next coarser level.
    pub extremes: Field<Extremes>,
    /// Deviation codes at the nodes, 0 at (even, even) ones.
    pub deviations: Field<u8>,
}

/// What [`derive_block`] makes.
#[derive(Clone, Debug)]
pub struct Block {
    /// One entry for each level, the finest first.
    pub levels: Vec<LevelPlanes>,
    /// The core's share of the next stage's [`Base`], without padding; blocks tile it (nodes and
    /// filtered heights on a common border are equal).
    pub next: Base,
}

/// Tells whether the tile of a level that owns a node is absent; see [`derive_block`].
pub type Absent<'a> = dyn Fn(u32, i32, i32) -> bool + 'a;

/// Nodes, cells and codes of padding, in units of the base level, that `levels` levels need.
#[must_use]
pub const fn padding(levels: u32) -> i32 {
    1 << levels
}

/// The planes of `levels` levels from `base.level` on, over `core`, cells of the base level.
///
/// `absent(k, x, y)` says whether the file lacks the level-k tile that owns level-k node (x, y):
/// there the filtered height of level k + 1 is the node itself. `None`: all tiles are present.
///
/// # Panics
/// When core's corner or size is not a multiple of 2^`levels` cells, `levels` is 0, or the base
/// (all but the core's extremes) does not cover `core.expand(padding(levels))`.
#[must_use]
pub fn derive_block(base: Base, core: Window, levels: u32, absent: Option<&Absent<'_>>) -> Block {
    let step = 1i32 << levels;
    assert!(levels > 0, "at least one level");
    assert!(
        [core.x0, core.y0, core.nx as i32, core.ny as i32].iter().all(|v| v % step == 0),
        "core {core:?} is not made of whole cells {levels} levels up"
    );
    let first = base.level;
    let (mut intervals, lowest, mut centre_codes, known) = match base.below {
        Some(below) => (vec![Some(below.intervals)], Some(below.extremes), Some(below.centres), below.distances),
        None => {
            let codes = virtual_centres(&base.nodes, core.expand(padding(levels) - 1));
            (vec![None], None, Some(codes), Vec::new())
        }
    };
    let mut nodes = vec![base.nodes];
    let mut mips = vec![base.mip];
    let mut extremes: Vec<Field<Extremes>> = Vec::new();
    let mut codes = Vec::new();
    for index in 0..levels as usize {
        let coarse = shift(core, index + 1);
        // Each level's codes are the children of the next one's on a border of one cell more; the
        // filter, too, eats one node a level.
        let border = (1 << (levels as usize - 1 - index)) - 1;
        let sources = sources(index, &nodes, &intervals, &known, centre_codes.as_ref());
        let plane = deviations(&sources, coarse.expand(border));
        centre_codes = Some(centres(&plane));
        codes.push(plane);
        let mut ext = Field::new(coarse);
        match extremes.last().or(lowest.as_ref()) {
            Some(finer) => extremes_next(finer, coarse, ext.data_mut()),
            None => extremes_from_nodes(&nodes[index], coarse, ext.data_mut()),
        }
        extremes.push(ext);
        let mut interval = Field::new(coarse.expand(padding(levels) >> (index + 1)));
        let finer = (index + 1).saturating_sub(SPAN as usize);
        let span = (index + 1 - finer) as u32;
        intervals_into(&nodes[finer], intervals[finer].as_ref(), span, interval.window(), interval.data_mut());
        intervals.push(Some(interval));
        let mut filtered = Field::new(coarse.nodes().expand(border));
        mip_into(mips[index].as_ref().unwrap_or(&nodes[index]), filtered.window(), filtered.data_mut());
        if let Some(absent) = absent {
            unfilter(&mut filtered, &nodes[index], |x, y| absent(first + index as u32, 2 * x, 2 * y));
        }
        mips.push(Some(filtered));
        nodes.push(nodes[index].decimate());
    }
    // The next stage has no finer nodes than its first level's: what those cannot show.
    let whole = |up: usize| (core.x0 | core.y0 | core.nx as i32 | core.ny as i32).trailing_zeros() as usize >= up;
    let handed = (levels as usize..)
        .take(SPAN as usize)
        .take_while(|&index| whole(index + 1))
        .map(|index| cell_distances(&sources(index, &nodes, &intervals, &known, None), shift(core, index + 1)));
    let handed = handed.collect();
    let top = shift(core, levels as usize);
    let below = match (intervals.pop().flatten(), extremes.last(), centre_codes) {
        (Some(intervals), Some(extremes), Some(codes)) => Some(Below {
            intervals: intervals.crop(top),
            extremes: extremes.clone(),
            centres: codes.crop(top),
            distances: handed,
        }),
        _ => None,
    };
    let next = Base {
        level: first + levels,
        nodes: nodes[levels as usize].crop(top.nodes()),
        mip: mips[levels as usize].as_ref().map(|m| m.crop(top.nodes())),
        below,
    };
    let planes = nodes.into_iter().zip(mips).zip(extremes.into_iter().zip(codes));
    let levels = (first..).zip(planes).map(|(level, ((nodes, mip), (extremes, deviations)))| LevelPlanes {
        level,
        nodes,
        mip,
        extremes,
        deviations,
    });
    Block { levels: levels.collect(), next }
}

/// Where the deviations of level base + `index` come from.
fn sources<'a>(
    index: usize,
    nodes: &'a [Field<i32>],
    intervals: &'a [Option<Field<Interval>>],
    known: &'a [Field<CellDistances>],
    children: Option<&'a Field<u8>>,
) -> Sources<'a> {
    let sample = index.saturating_sub(SPAN as usize);
    Sources {
        nodes: &nodes[sample],
        intervals: intervals[sample].as_ref(),
        children,
        span: (index - sample) as u32,
        distances: known.get(index),
    }
}

/// Puts nodes in place of filtered heights where `absent` says so; `finer` has the nodes at twice
/// the indices.
fn unfilter(filtered: &mut Field<i32>, finer: &Field<i32>, absent: impl Fn(i32, i32) -> bool) {
    let window = filtered.window();
    for (y, row) in (window.y0..).zip(filtered.data_mut().chunks_exact_mut(window.nx)) {
        for (x, value) in (window.x0..).zip(row) {
            if absent(x, y) {
                *value = finer.at(2 * x, 2 * y);
            }
        }
    }
}

/// A window of base-level cells, in cells `levels` levels up.
fn shift(core: Window, levels: usize) -> Window {
    Window::new(core.x0 >> levels, core.y0 >> levels, core.nx >> levels, core.ny >> levels)
}
