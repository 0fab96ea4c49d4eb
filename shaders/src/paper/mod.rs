//! Scheme `paper`: adaptive triangle patches (paper 000, Algorithms 2 to 5, and paper 004).
//!
//! The start is the patch mesh. A pass takes a list of patches; each becomes a relief triangle or
//! is split into the four parts of a fan, and the parts that may be seen make the next list. A patch
//! is split by Algorithm 3: unless at each of its three corners the edge of the prism that bounds
//! the relief over it, from d- below to d+ above, projects to at most n_px pixels.
//!
//! Where it differs from the paper:
//! - **One side, one decision.** A side is divided if both its patches are split. Each can work out
//!   the other, because whether a patch is split depends on nothing but its corners. Where a split
//!   patch has a neighbour that is not, a vertical filler (end, end, midpoint) closes the gap, and
//!   so on for the halves of that side. The paper lets each patch decide by itself, so that two
//!   may disagree about their side and leave a crack.
//! - **d+ and d-** are the stored deviation of the longest side's midpoint, a bound for both
//!   triangles on that side; d+ has the body's bulge over a flat triangle besides. The paper does
//!   not say where they come from.
//! - **Near patches.** When the camera is nearer to a patch than the patch is wide, the longest
//!   projection need not be at a corner: there the prism is also measured at the nearest point it
//!   may have, whatever its direction.
//! - **Diagonals** alternate as the file's deviations have it, where Algorithm 1 has them all run one
//!   way; after the first split both are the same.
//! - **Poles.** Algorithm 1 has one triangle in each polar cell; split, it would leave half of the
//!   cell uncovered. Here the cell has two, and those with no area are left out when drawn.
//! - **Horizon.** Algorithm 2 with the ball around a patch for its corners and an ellipsoid below
//!   all relief for the polar sphere: see [`crate::leb::cull`].
//!
//! n_px is no bound of the error (the prism is measured at few places); scheme `leb` has that.
//!
//! # On the GPU
//! `paper_start` and `paper_pass` do the same, and `leb_args` steers both schemes. The groups are those
//! of [`crate::leb`], with lists of [`Patch`]es and this scheme's [`Control`], whose first words
//! are those of the other's. The host
//! 1. fills the control with zeros and dispatches `paper_start`, which writes list A, with
//!    [`start_count`](patch::start_count) / 64 groups, rounded up;
//! 2. dispatches `leb_args`, one group;
//! 3. [`passes`] times: `paper_pass` (indirect), reading A and writing B, then B and A by turns, each
//!    followed by `leb_args`;
//! 4. draws indirectly as there.
//!
//! The order of triangles differs from run to run, their set does not. A list that is full sets
//! `overflow`; nothing is written beyond it.

pub mod control;
pub mod decide;
pub mod extent;
pub mod patch;
pub mod tessellate;

pub use control::Control;
pub use patch::Patch;
pub use tessellate::{Drawn, Stats, passes, tessellate};
