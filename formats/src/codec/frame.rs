//! Zstandard frames of a tile's small planes.

use std::cell::RefCell;

use zstd::bulk::Compressor;

const LEVEL: i32 = 3;

thread_local! {
    /// A context is as large as what it compresses is small: one a thread, not one a frame.
    static COMPRESSOR: RefCell<Option<Compressor<'static>>> = RefCell::new(Compressor::new(LEVEL).ok());
}

/// Bytes as one frame; the same whatever was compressed before.
pub fn compress(bytes: &[u8]) -> Vec<u8> {
    // Compressing into memory fails only where there is no memory.
    COMPRESSOR.with_borrow_mut(|kept| kept.as_mut().and_then(|kept| kept.compress(bytes).ok())).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_used_context_gives_what_a_fresh_one_gives() {
        for seed in 0..200_u32 {
            let length = (seed * 7919) % 40_000;
            let bytes: Vec<u8> = (0..length)
                .map(|k| {
                    (k.wrapping_mul(2_654_435_761).wrapping_add(seed) >> (16 + seed % 16)) as u8 & (seed as u8 | 3)
                })
                .collect();
            assert_eq!(compress(&bytes), zstd::bulk::compress(&bytes, LEVEL).unwrap(), "{seed}");
        }
    }
}
