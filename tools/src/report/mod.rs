//! Speed against error: the same inputs baked with many steps and kernels, each file measured.
//!
//! Two differences are told apart. At the nodes a file differs from what it was rounded from by
//! at most half a step: that is what a step costs. At the sources' own samples it differs by
//! rounding and resampling together: that is what a user of the file sees.

mod at_nodes;
mod at_samples;
mod choice;
mod codecs;
mod csv;
mod error;
mod figures;
mod measure;
mod page;
mod run;

pub use codecs::Codec;
pub use error::Errors;
pub use measure::{Case, Measured};
pub use relief_front::sheet::machine::Machine;
pub use run::{Report, ReportOptions, run};
