//! Scheme `leb`: adaptive tessellation by longest-edge bisection.
//!
//! A pass takes a list of triangles; each is culled, drawn as a relief triangle, or halved, and
//! its halves likewise. Passes go on until the list is empty. Nothing is kept from frame to frame.
//!
//! The mesh is watertight: whether a hypotenuse is halved depends on its midpoint alone
//! ([`active`]). It is bounded: no point of S_0 in view is further than `pixel_error` pixels from the
//! drawn surface, where the pages it needs are usable, and but for the rounding of positions
//! (5e-7 of the distance) and of heights below level 0 (two units in the last place). Nothing
//! visible is culled ([`cull`]).
//!
//! What it takes from the pages: deviations saturated down to what lies below level 0; H_ext intervals
//! within those of the coarser block around them; a page usable only if all pages of the next
//! coarser level that touch it are; all pages of the coarsest level.
//!
//! # On the GPU
//!
//! Three kernels, compiled from [`kernels::LEB_START`](crate::kernels::LEB_START), `LEB_PASS` and
//! `LEB_ARGS`; 8 storage buffers at most.
//!
//! `leb_start` and `leb_pass`: group 0 is that of the pages (planet, table, heights, bounds, seen);
//! group 1:
//!
//! | binding | | bytes |
//! |---|---|---|
//! | 0 | uniform [`View`](crate::planet::View) | |
//! | 1 | uniform [`Params`] | |
//! | 2 | storage, read: list of [`Triangle`] | 12 `list_capacity` |
//! | 3 | storage: the other list | 12 `list_capacity` |
//! | 4 | storage: [`ReliefTriangle`] | 48 `relief_capacity` |
//! | 5 | storage: [`Control`] | |
//!
//! `leb_args`: group 0: 0 uniform [`Params`], 1 storage [`Control`], 2 storage [`Args`] (also with
//! usage INDIRECT).
//!
//! With lists A and B: `leb_start` (1 group) writes A; `leb_args` (1 group); then [`PASSES`] times
//! `leb_pass` (indirect, `Args` at 0), reading A and writing B, then B and A by turns, each
//! followed by `leb_args`. A pass that finds its list empty has no groups. Draw indirectly from
//! [`Args::DRAW_OFFSET`]: vertex n is corner n % 3 of relief triangle n / 3; its position is
//! `camera_relative_m` of its place and height, the same in every triangle it belongs to.
//! Where [`Control::overflow`] is set a list was full and the mesh has holes: draw with a
//! larger `pixel_error`, or larger lists. `list_capacity` is at most 64 times the adapter's
//! largest dispatch and at least [`START_MOST`].

pub mod active;
pub mod control;
pub mod cull;
pub mod params;
pub mod region;
pub mod tessellate;
pub mod triangle;
pub mod virtual_cells;

pub use control::{Args, Control};
pub use params::Params;
pub use tessellate::{Corner, Mesh, PASSES, ReliefTriangle, Stats, tessellate};
pub use triangle::{Node, START_MOST, Triangle};
