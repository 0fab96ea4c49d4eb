//! The promises of scheme `leb`, checked in f64 over random and hard views of small planets:
//! watertight, bounded, positions exact, nothing visible culled, activity nested. Each check has
//! a test in which it fails.

mod breaches;
mod camera;
mod checks;
mod deviation;
mod file_pages;
mod nested;
mod on_gpu;
mod page_set;
mod paper;
mod planet;
mod promises;
mod scene;
mod views;
mod virtual_cells;
