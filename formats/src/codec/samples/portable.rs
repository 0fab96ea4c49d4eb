//! The decoder in plain Rust.

use super::super::bits::{BitReader, window};
use super::super::rans::{DECODE, Decoder, LANES, LOW, SCALE_BITS, SLOTS};
use super::super::residual::BUCKETS;
use super::super::token::{ESCAPE, ESCAPE_BITS, token_range, unzigzag};

/// Samples whose words are looked up together.
const GROUP: usize = 16;

/// See [`super::read`].
#[inline(always)]
pub(super) fn read(rans: &mut Decoder<'_>, raw: &mut BitReader<'_>, coding: &[u32; BUCKETS], values: &mut [i32]) {
    let table: &[u32; 1 << 16] = &DECODE;
    let mut states = rans.states;
    let mut next = rans.next;
    for values in values.chunks_mut(LANES) {
        for (v, x) in values.chunks_mut(GROUP).zip(states.as_chunks_mut::<GROUP>().0) {
            let mut code = [0u32; GROUP];
            for (c, a) in code.iter_mut().zip(&*v) {
                let bits = ((a.saturating_add(1)) as f32).to_bits();
                *c = coding[((bits >> 22).saturating_sub(254)).min(BUCKETS as u32 - 1) as usize];
            }
            let words: [u8; 2 * GROUP] = window(rans.words, next);
            let mut used = 0;
            let mut token = [0u32; GROUP];
            for i in 0..v.len() {
                let entry = table[usize::from((code[i] | x[i] & (SLOTS as u32 - 1)) as u16)];
                token[i] = entry >> 24;
                let y = (x[i] >> SCALE_BITS) * (entry >> 12 & 0xfff) + (entry & 0xfff);
                let at = used % GROUP * 2;
                let word = u32::from(u16::from_le_bytes([words[at], words[at + 1]]));
                let refill = y < LOW;
                x[i] = if refill { y << 16 | word } else { y };
                used += usize::from(refill);
            }
            next += 2 * used;
            for i in 0..v.len() {
                let (t, k) = (token[i] as u8, code[i] >> 16);
                let (base, bits) = if t == ESCAPE {
                    (0, ESCAPE_BITS)
                } else {
                    let (b, n) = token_range(t);
                    (b << k, n + k)
                };
                v[i] = unzigzag(base + raw.get(bits));
            }
        }
    }
    rans.states = states;
    rans.next = next;
}
