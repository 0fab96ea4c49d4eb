//! What a thread keeps between the planes it decodes, so that none of it is allocated, or filled
//! with zeros, for every tile.

use std::cell::RefCell;

use super::lifting::Classes;

/// The classes of a plane while it is decoded.
#[derive(Default)]
pub(super) struct Scratch {
    /// Predictions, and once a class was read, its samples.
    pub samples: Classes,
    /// Activities, and once a class was read, its residuals.
    pub residuals: Classes,
    /// The two for a plane's even samples.
    pub even: [Vec<i32>; 2],
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Runs `decode` with this thread's buffers: 0.5 MiB once tiles were decoded.
pub(super) fn with<T>(decode: impl FnOnce(&mut Scratch) -> T) -> T {
    SCRATCH.with(|scratch| match scratch.try_borrow_mut() {
        Ok(mut scratch) => decode(&mut scratch),
        Err(_) => decode(&mut Scratch::default()),
    })
}
