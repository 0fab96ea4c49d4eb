//! Where the relief over a patch lies, and whether it may be seen.

use super::patch::{Patch, level};
use crate::leb::Params;
use crate::leb::cull::hidden;
use crate::leb::params::SLACK;
use crate::leb::region::Region;
use crate::pages::{NONE, Pages, SLOT_MASK};
use crate::planet::View;
use crate::position::camera_relative_m;

/// The extremes of S_0 over the square a patch is half of, metres: that is one block of H_ext, or
/// the finest around it that there is.
#[must_use]
pub fn square_interval_m(pages: &Pages<'_>, patch: &Patch) -> [f32; 2] {
    let first = level(pages.planet, patch).max(0) as u32;
    let [_, [s, t], _] = patch.midpoints();
    for level in first..=pages.planet.root_level {
        let at = pages.place(level, s, t);
        let page = pages.find(level, at.x, at.y);
        if page != NONE {
            return pages.extremes_m(page & SLOT_MASK, at.column / 2, at.row / 2);
        }
    }
    [pages.planet.min_m, pages.planet.max_m]
}

/// True when nothing over the patch can be seen: Algorithm 2 of paper 000 and the frustum, for the
/// ball around the relief over it. `horizon` tells that the camera is outside the ground.
#[must_use]
pub fn invisible(pages: &Pages<'_>, view: &View, params: &Params, horizon: bool, patch: &Patch) -> bool {
    let node = patch.node();
    let [low, high] = square_interval_m(pages, patch);
    let centre_m = camera_relative_m(pages.planet, view, node.s, node.t, 0.5 * (low + high));
    let [x, y, z] = centre_m;
    let distance_m = (x * x + y * y + z * z).sqrt();
    let slack_m = SLACK * distance_m + params.slack_m;
    let region = Region { centre_m, distance_m, half_range_m: 0.5 * (high - low), slack_m };
    hidden(view, params, &node, &region, horizon)
}
