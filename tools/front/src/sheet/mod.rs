//! Reports: a folder with a page, tables and plots.

pub mod folder;
pub mod machine;
pub mod number;
pub mod page;
pub mod plot;
pub mod table;
