//! All derived planes of one block of the map, level by level.
//!
//! The map is worked off in blocks that fit in memory and share nothing, so a caller runs them in
//! parallel. A block has its core and [`padding`] nodes around it, filled by the caller with the
//! neighbours (wrapped at the seam, mirrored over the poles, or the edge repeated). A first stage
//! starts from level 0; a second one starts at the level where the first ended, from its summaries.

use super::deviation::{Sources, centres, deviations, sample_level};
use super::extremes::{Extremes, extremes_from_nodes, extremes_next};
use super::field::{Field, Window};
use super::interval::{Interval, interval_next};
use super::mip::mip_into;

/// What is known at the level where a stage starts, and what a stage hands on. All windows but
/// `extremes` include the padding.
#[derive(Clone, Debug)]
pub struct Base {
    /// The level.
    pub level: u32,
    /// Nodes of the level, in height units.
    pub nodes: Field<i32>,
    /// Filtered heights at the same nodes; at level 0 the nodes themselves.
    pub mip: Field<i32>,
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
}

/// The planes of one level over a block's core, which has X x Y cells at this level.
#[derive(Clone, Debug)]
pub struct LevelPlanes {
    /// The level.
    pub level: u32,
    /// (X + 1) x (Y + 1) nodes.
    pub nodes: Field<i32>,
    /// Filtered heights at these nodes.
    pub mip: Field<i32>,
    /// H_ext, X/2 x Y/2 cells.
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
    let (mut intervals, mut extremes, mut codes) = match base.below {
        Some(below) => (vec![Some(below.intervals)], Some(below.extremes), Some(below.centres)),
        None => (vec![None], None, None),
    };
    let (mut nodes, mut mip) = (vec![base.nodes], base.mip);
    let mut out = Vec::with_capacity(levels as usize);
    for index in 0..levels as usize {
        let k = first + index as u32;
        let cells = shift(core, index);
        let coarse = shift(core, index + 1);
        // Each level's codes are the children of the next one's on a border of one cell more.
        let border = (1 << (levels as usize - 1 - index)) - 1;
        let sample = (sample_level(k, first) - first) as usize;
        let sources = Sources {
            nodes: &nodes[sample],
            intervals: intervals[sample].as_ref(),
            children: codes.as_ref(),
            span: (index - sample) as u32,
        };
        let plane = deviations(&sources, coarse.expand(border));
        let mut ext = Field::new(coarse);
        match &extremes {
            Some(finer) => extremes_next(finer, coarse, ext.data_mut()),
            None => extremes_from_nodes(&nodes[index], coarse, ext.data_mut()),
        }
        out.push(LevelPlanes {
            level: k,
            nodes: nodes[index].crop(cells.nodes()),
            mip: mip.crop(cells.nodes()),
            extremes: ext.clone(),
            deviations: plane.crop(cells.nodes()),
        });
        let mut interval = Field::new(coarse.expand(padding(levels) >> (index + 1)));
        interval_next(&nodes[index], intervals[index].as_ref(), interval.window(), interval.data_mut());
        // The filter eats one node a level: 2^l - 1 wide at first, half of it rounded down later.
        let mut filtered = Field::new(coarse.nodes().expand(border as i32));
        mip_into(&mip, filtered.window(), filtered.data_mut());
        if let Some(absent) = absent {
            unfilter(&mut filtered, &nodes[index], |x, y| absent(k, 2 * x, 2 * y));
        }
        codes = Some(centres(&plane));
        nodes.push(nodes[index].decimate());
        intervals.push(Some(interval));
        (mip, extremes) = (filtered, Some(ext));
        if sample > 0 {
            // Nothing coarser looks at these again.
            nodes[sample - 1] = Field::new(Window::new(0, 0, 0, 0));
            intervals[sample - 1] = None;
        }
    }
    let top = shift(core, levels as usize);
    let crop = |f: Option<Option<Field<Interval>>>| f.flatten().map(|f| f.crop(top));
    let below = match (crop(intervals.pop()), extremes, codes) {
        (Some(intervals), Some(extremes), Some(codes)) => Some(Below { intervals, extremes, centres: codes.crop(top) }),
        _ => None,
    };
    let nodes = nodes.pop().map_or_else(|| Field::new(top.nodes()), |n| n.crop(top.nodes()));
    Block { levels: out, next: Base { level: first + levels, nodes, mip: mip.crop(top.nodes()), below } }
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
