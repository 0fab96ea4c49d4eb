//! The decoder in plain Rust: a chunk's contexts, then its tokens, then its raw bits, so that the
//! compiler can use vectors for what does not come one by one.

use super::super::bits::{BitReader, last_window};
use super::super::rans::{DECODE, Decoder, LANES, LOW, SCALE_BITS, SLOTS};
use super::super::residual::BUCKETS;
use super::super::token::{ESCAPE, ESCAPE_BITS, unzigzag};

/// Samples of a chunk: what is known of them stays in the first-level cache.
const CHUNK: usize = 8 * LANES;

/// See [`super::read`].
#[inline(always)]
pub(super) fn read(rans: &mut Decoder<'_>, raw: &mut BitReader<'_>, coding: &[u32; BUCKETS], values: &mut [i32]) {
    let (mut codes, mut tokens) = ([0; CHUNK], [0; CHUNK]);
    for values in values.chunks_mut(CHUNK) {
        let (codes, tokens) = (&mut codes[..values.len()], &mut tokens[..values.len()]);
        contexts(coding, values, codes);
        for (codes, tokens) in codes.chunks(LANES).zip(tokens.chunks_mut(LANES)) {
            block(rans, codes, tokens);
        }
        residuals(raw, codes, tokens, values);
    }
}

/// Half-octave buckets of activities, then their table and low bits.
#[inline(always)]
fn contexts(coding: &[u32; BUCKETS], activity: &[i32], codes: &mut [u32]) {
    let mut all = [0; 64];
    all[..BUCKETS].copy_from_slice(coding);
    for (code, a) in codes.iter_mut().zip(activity) {
        let bits = (a.saturating_add(1) as f32).to_bits();
        *code = (bits >> 22).saturating_sub(254).min(BUCKETS as u32 - 1);
    }
    for code in codes {
        *code = all[*code as usize % 64];
    }
}

/// The tokens of a block, one from each state.
#[inline(always)]
fn block(rans: &mut Decoder<'_>, codes: &[u32], tokens: &mut [u32]) {
    let table: &[u32; 1 << 16] = &DECODE;
    let padded;
    let words: &[u8; 2 * LANES] = match rans.words.get(rans.next..).and_then(|words| words.first_chunk()) {
        Some(words) => words,
        None => {
            padded = last_window(rans.words, rans.next);
            &padded
        }
    };
    let mut used = 0;
    for ((code, token), x) in codes.iter().zip(tokens).zip(&mut rans.states) {
        let entry = table[usize::from((code | *x & (SLOTS as u32 - 1)) as u16)];
        *token = entry >> 24;
        let next = (*x >> SCALE_BITS) * (entry >> 12 & 0xfff) + (entry & 0xfff);
        let at = used % LANES * 2;
        let word = u32::from(u16::from_le_bytes([words[at], words[at + 1]]));
        // No branch: a refill comes as good as at random.
        let refill = u32::from(next < LOW);
        *x = next << (16 * refill) | (word & refill.wrapping_neg());
        used += refill as usize;
    }
    rans.next += 2 * used;
}

/// Residuals from tokens under their low bits, and the raw bits that follow.
#[inline(always)]
fn residuals(raw: &mut BitReader<'_>, codes: &mut [u32], tokens: &mut [u32], values: &mut [i32]) {
    // Codes become numbers of raw bits, tokens what these are added to.
    let mut any = 0;
    for (code, token) in codes.iter_mut().zip(&mut *tokens) {
        let (low, octaves) = (*code >> 16, (*token >> 2).saturating_sub(2));
        let small = *token < 16;
        let bits = if small { low } else { low + octaves };
        let base = if small { *token } else { 4 + (*token & 3) } << bits;
        let escape = *token == u32::from(ESCAPE);
        *token = if escape { 0 } else { base };
        *code = if escape { ESCAPE_BITS } else { bits };
        any |= *code;
    }
    if any != 0 {
        for (bits, z) in codes.iter().zip(&mut *tokens) {
            *z += raw.get(*bits);
        }
    }
    for (value, z) in values.iter_mut().zip(tokens) {
        *value = unzigzag(*z);
    }
}
