//! The decoder with AVX-512: sixteen samples fill a register, a block is two of them.
//!
//! The lookups stay scalar: a hardware gather was 5 % faster, but takes a raw pointer. All else,
//! raw bits included, is a dozen vector instructions for sixteen samples.

use std::arch::x86_64::*;
use std::array::from_fn;

use bytemuck::cast;

use super::super::bits::{BitReader, window};
use super::super::rans::{DECODE, Decoder, LANES, SCALE_BITS, SLOTS};
use super::super::residual::BUCKETS;
use super::super::token::{ESCAPE, ESCAPE_BITS};

/// Samples of a register.
const GROUP: usize = 16;
/// Registers of a block: one sample from each state.
const GROUPS: usize = LANES / GROUP;

type Lanes = [__m512i; GROUPS];

/// See [`super::read`].
#[target_feature(enable = "avx512f,avx512bw,avx512vbmi2,bmi2,popcnt")]
pub(super) fn read(rans: &mut Decoder<'_>, raw: &mut BitReader<'_>, coding: &[u32; BUCKETS], values: &mut [i32]) {
    let table: &[u32; 1 << 16] = &DECODE;
    let coding: [__m512i; BUCKETS / GROUP] = cast(*coding);
    let mut states: Lanes = cast(rans.states);
    let mut next = rans.next;
    let mut position = raw.position;
    for values in values.chunks_mut(LANES) {
        let (a, live): (Lanes, u32) = match values.first_chunk::<LANES>() {
            Some(a) => (cast(*a), !0),
            None => {
                let mut a = [0; LANES];
                a[..values.len()].copy_from_slice(values);
                (cast(a), (1 << values.len()) - 1)
            }
        };
        let codes = [code(&coding, a[0]), code(&coding, a[1])];
        let words = window::<{ 2 * LANES }>(rans.words, next);
        let (tokens, used);
        (states, tokens, used) = step(table, states, codes, cast(words), live);
        next += 2 * used as usize;

        // Most blocks are of tokens below 16 that stand for themselves.
        let low = codes.map(|code| _mm512_srli_epi32::<16>(code));
        let lows = _mm512_or_si512(low[0], low[1]);
        let most = _mm512_or_si512(_mm512_slli_epi32::<4>(lows), _mm512_max_epu32(tokens[0], tokens[1]));
        let z = if _mm512_cmpgt_epu32_mask(most, _mm512_set1_epi32(15)) == 0 {
            tokens
        } else {
            let a = range(tokens[0], low[0], live as __mmask16);
            let b = range(tokens[1], low[1], (live >> GROUP) as __mmask16);
            let (a, more) = raw_bits(a, window(raw.bytes, position >> 3), position & 7);
            position += more;
            let (b, more) = raw_bits(b, window(raw.bytes, position >> 3), position & 7);
            position += more;
            [a, b]
        };
        let out: [i32; LANES] = cast(z.map(|z| {
            let sign = _mm512_sub_epi32(_mm512_setzero_si512(), _mm512_and_si512(z, _mm512_set1_epi32(1)));
            _mm512_xor_si512(_mm512_srli_epi32::<1>(z), sign)
        }));
        match values.first_chunk_mut::<LANES>() {
            Some(r) => *r = out,
            None => values.copy_from_slice(&out[..values.len()]),
        }
    }
    rans.states = cast(states);
    rans.next = next;
    raw.position = position;
}

/// Half-octave buckets of activities, then their table and low bits.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vbmi2,bmi2,popcnt")]
fn code(coding: &[__m512i; BUCKETS / GROUP], activity: __m512i) -> __m512i {
    let set = |n: i32| _mm512_set1_epi32(n);
    let y = _mm512_add_epi32(_mm512_min_epi32(activity, set(i32::MAX - 1)), set(1));
    let bits = _mm512_srli_epi32::<22>(_mm512_castps_si512(_mm512_cvtepi32_ps(y)));
    let bucket = _mm512_min_epu32(_mm512_sub_epi32(bits, set(254)), set(BUCKETS as i32 - 1));
    let low = _mm512_permutex2var_epi32(coding[0], bucket, coding[1]);
    let high = _mm512_cmpgt_epu32_mask(bucket, set(31));
    _mm512_mask_permutexvar_epi32(low, high, bucket, coding[2])
}

/// The states after a block, its tokens, and the words it used.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vbmi2,bmi2,popcnt")]
fn step(table: &[u32; 1 << 16], states: Lanes, codes: Lanes, words: __m512i, live: u32) -> (Lanes, Lanes, u32) {
    let set = |n: i32| _mm512_set1_epi32(n);
    let slots = _mm512_set1_epi32(SLOTS as i32 - 1);
    let slot = |g: usize| _mm512_or_si512(_mm512_and_si512(states[g], slots), codes[g]);
    let (a, b) = (_mm512_cvtepi32_epi16(slot(0)), _mm512_cvtepi32_epi16(slot(1)));
    let entries: Lanes = [cast(lookup(table, cast(a))), cast(lookup(table, cast(b)))];
    let next = [0, 1].map(|g| {
        let frequency = _mm512_and_si512(_mm512_srli_epi32::<12>(entries[g]), set(0xfff));
        let offset = _mm512_and_si512(entries[g], set(0xfff));
        let whole = _mm512_srli_epi32::<SCALE_BITS>(states[g]);
        _mm512_add_epi32(_mm512_mullo_epi32(whole, frequency), offset)
    });
    let alive = [live as __mmask16, (live >> GROUP) as __mmask16];
    let refill = [0, 1].map(|g| _mm512_mask_cmplt_epu32_mask(alive[g], next[g], set(1 << 16)));
    let all = u32::from(refill[1]) << GROUP | u32::from(refill[0]);
    let words: [__m256i; GROUPS] = cast(_mm512_maskz_expand_epi16(all, words));
    let states = [0, 1].map(|g| {
        let (high, low) = (_mm512_slli_epi32::<16>(next[g]), _mm512_cvtepu16_epi32(words[g]));
        let full = _mm512_mask_or_epi32(next[g], refill[g], high, low);
        _mm512_mask_mov_epi32(states[g], alive[g], full)
    });
    (states, entries.map(|entry| _mm512_srli_epi32::<24>(entry)), all.count_ones())
}

/// Entries of sixteen slots of 16 bits each.
#[inline(always)]
fn lookup(table: &[u32; 1 << 16], slots: [u64; GROUP / 4]) -> [u32; GROUP] {
    from_fn(|n| table[usize::from((slots[n / 4] >> (16 * (n % 4))) as u16)])
}

/// What tokens stand for under their low bits: the smallest z and the raw bits to add.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vbmi2,bmi2,popcnt")]
fn range(token: __m512i, low: __m512i, live: __mmask16) -> (__m512i, __m512i) {
    let set = |n: i32| _mm512_set1_epi32(n);
    let octaves = _mm512_cmpgt_epu32_mask(token, set(15));
    let own = _mm512_maskz_sub_epi32(octaves, _mm512_srli_epi32::<2>(token), set(2));
    let mantissa = _mm512_or_si512(_mm512_and_si512(token, set(3)), set(4));
    let escape = _mm512_cmpeq_epi32_mask(token, set(i32::from(ESCAPE)));
    let bits = _mm512_add_epi32(own, low);
    let base = _mm512_sllv_epi32(_mm512_mask_mov_epi32(token, octaves, mantissa), bits);
    let base = _mm512_maskz_mov_epi32(!escape, base);
    let bits = _mm512_mask_mov_epi32(bits, escape, set(ESCAPE_BITS as i32));
    (base, _mm512_maskz_mov_epi32(live, bits))
}

/// Zigzagged residuals from their ranges and raw bits, and the number of these. A group has at
/// most 16 x 27 of them: they lie within 64 bytes from the first one's.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vbmi2,bmi2,popcnt")]
fn raw_bits((base, bits): (__m512i, __m512i), bytes: [u8; 64], skip: usize) -> (__m512i, usize) {
    let set = |n: i32| _mm512_set1_epi32(n);
    let zero = set(0);
    let sum = _mm512_add_epi32(bits, _mm512_alignr_epi32::<15>(bits, zero));
    let sum = _mm512_add_epi32(sum, _mm512_alignr_epi32::<14>(sum, zero));
    let sum = _mm512_add_epi32(sum, _mm512_alignr_epi32::<12>(sum, zero));
    let sum = _mm512_add_epi32(sum, _mm512_alignr_epi32::<8>(sum, zero));
    let start = _mm512_add_epi32(_mm512_sub_epi32(sum, bits), set(skip as i32));
    let sums: [u32; GROUP] = cast(sum);
    let bytes: __m512i = cast(bytes);
    let word = _mm512_srli_epi32::<5>(start);
    let here = _mm512_permutexvar_epi32(word, bytes);
    let after = _mm512_permutexvar_epi32(_mm512_add_epi32(word, set(1)), bytes);
    let value = _mm512_shrdv_epi32(here, after, start);
    let mask = _mm512_sllv_epi32(set(-1), bits);
    (_mm512_add_epi32(base, _mm512_andnot_si512(mask, value)), sums[GROUP - 1] as usize)
}
