//! The bake: stages of blocks from the finest level up, a journal of finished blocks, one file.

mod compose;
mod crown;
mod handoff;
mod journal;
mod output;
mod plan;
mod provenance;
mod record;
mod run;
mod stage;

pub use compose::{Composed, Composer};
pub use handoff::{Handoff, Handoffs};
pub use plan::{BLOCK_CELLS, BLOCK_LEVELS, Plan};
pub use run::{BakeOptions, BakeReport, bake};
pub use stage::{BlockKey, blocks};
