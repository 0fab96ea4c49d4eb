//! The relief of the pages, as rays fetch it.

use super::exact::Relief;
use crate::pages::{BLOCKS, CELLS, NONE, Pages, SLOT_MASK};

/// Pages with the last one at hand: a ray stays in a tile for many steps. A page is asked for when
/// a ray turns to it.
#[derive(Clone, Copy)]
pub struct PagedRelief<'a> {
    pages: Pages<'a>,
    level: u32,
    x: u32,
    y: u32,
    page: u32,
}

impl<'a> PagedRelief<'a> {
    /// The relief of some pages, no page at hand.
    #[must_use]
    pub fn new(pages: Pages<'a>) -> Self {
        Self { pages, level: NONE, x: 0, y: 0, page: NONE }
    }

    /// The page of a tile, or [`NONE`]; levels beyond the coarsest have none.
    fn shadow_page(&mut self, level: u32, x: u32, y: u32) -> u32 {
        if level > self.pages.planet.root_level {
            return NONE;
        }
        if level != self.level || x != self.x || y != self.y {
            self.pages.ask(level, x, y);
            (self.level, self.x, self.y) = (level, x, y);
            self.page = self.pages.find(level, x, y);
        }
        self.page
    }
}

impl Relief for PagedRelief<'_> {
    fn extremes_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 2]> {
        let page = self.shadow_page(level, x / BLOCKS, y / BLOCKS);
        (page != NONE).then(|| self.pages.extremes_m(page & SLOT_MASK, x % BLOCKS, y % BLOCKS))
    }

    fn corners_m(&mut self, level: u32, x: u32, y: u32) -> Option<[f32; 4]> {
        let page = self.shadow_page(level, x / CELLS, y / CELLS);
        if page == NONE {
            return None;
        }
        let (slot, column, row) = (page & SLOT_MASK, x % CELLS, y % CELLS);
        let node = |dx, dy| self.pages.node_m(slot, column + dx, row + dy);
        Some([node(0, 0), node(1, 0), node(0, 1), node(1, 1)])
    }
}
