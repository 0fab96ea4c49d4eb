//! Zstandard frames of a tile's small planes.

use std::cell::RefCell;

use zstd::bulk::Compressor;
use zstd::zstd_safe::{CParameter, Strategy};

const LEVEL: i32 = 3;

thread_local! {
    /// A context is as large as what it compresses is small: one a thread, not one a frame.
    static RUNS: RefCell<Option<Compressor<'static>>> = RefCell::new(Compressor::new(LEVEL).ok());
    static SYMBOLS: RefCell<Option<Compressor<'static>>> = RefCell::new(symbols());
}

/// Bytes that come in runs or repeat; the same frame whatever was compressed before.
pub fn compress_runs(bytes: &[u8]) -> Vec<u8> {
    RUNS.with_borrow_mut(|kept| compress(kept, bytes))
}

/// Bytes that are as good as random but for how often each one comes: their short chance repeats,
/// told as such, would cost 7 to 15 % more than all of them as symbols.
pub fn compress_symbols(bytes: &[u8]) -> Vec<u8> {
    SYMBOLS.with_borrow_mut(|kept| compress(kept, bytes))
}

/// Only repeats of seven bytes and more that lie next to one another are looked for.
fn symbols() -> Option<Compressor<'static>> {
    let mut made = Compressor::new(LEVEL).ok()?;
    let settings = [
        CParameter::Strategy(Strategy::ZSTD_fast),
        CParameter::MinMatch(7),
        CParameter::HashLog(6),
        CParameter::ChainLog(6),
        CParameter::SearchLog(1),
        CParameter::WindowLog(15),
    ];
    settings.into_iter().try_for_each(|setting| made.set_parameter(setting)).ok()?;
    Some(made)
}

// Compressing into memory fails only where there is no memory.
fn compress(kept: &mut Option<Compressor<'static>>, bytes: &[u8]) -> Vec<u8> {
    kept.as_mut().and_then(|kept| kept.compress(bytes).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(seed: u32) -> Vec<u8> {
        let length = (seed * 7919) % 40_000;
        let byte =
            |k: u32| (k.wrapping_mul(2_654_435_761).wrapping_add(seed) >> (16 + seed % 16)) as u8 & (seed as u8 | 3);
        (0..length).map(byte).collect()
    }

    #[test]
    fn a_used_context_gives_what_a_fresh_one_gives() {
        for seed in 0..200 {
            let bytes = sample(seed);
            assert_eq!(compress_runs(&bytes), zstd::bulk::compress(&bytes, LEVEL).unwrap(), "{seed}");
            assert_eq!(compress_symbols(&bytes), compress(&mut symbols(), &bytes), "{seed}");
        }
    }

    #[test]
    fn symbols_cost_little_more_than_their_entropy() {
        let bytes: Vec<u8> = (0..16_384u64)
            .map(|k| (k.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ k << 17).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 61)
            .map(|octant| [0, 0, 0, 1, 1, 2, 3, 4][octant as usize])
            .collect();
        let count = |value: u8| bytes.iter().filter(|&&b| b == value).count() as f64 / bytes.len() as f64;
        let bits: f64 = (0..5).map(count).map(|p| -p * p.log2()).sum();
        let least = bits * bytes.len() as f64 / 8.0;
        let frame = compress_symbols(&bytes).len() as f64;
        assert!((least..1.1 * least).contains(&frame), "{frame} of {least}");
        assert!(frame < compress_runs(&bytes).len() as f64);
    }
}
