//! The stored samples of a class, a block of one from each rANS state at a time: context, token,
//! raw bits. Bytes past the end of words or raw bits read as zeros; the readers' own `finish`
//! reports it, so the loops carry no errors.

mod portable;
#[cfg(target_arch = "x86_64")]
mod wide;

use multiversion::{multiversion, target::match_target};

use super::bits::BitReader;
use super::rans::Decoder;
use super::residual::BUCKETS;

/// Reads residuals in place of their activities. `coding[b]` says of activity bucket b the first
/// slot of its table, and in the high half its raw low bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vbmi2+bmi2+popcnt", "x86_64+avx2+bmi1+bmi2+fma+lzcnt+popcnt",))]
pub fn read(rans: &mut Decoder<'_>, raw: &mut BitReader<'_>, coding: &[u32; BUCKETS], values: &mut [i32]) {
    match_target! {
        "x86_64+avx512f+avx512bw+avx512vbmi2+bmi2+popcnt" => wide::read(rans, raw, coding, values),
        _ => portable::read(rans, raw, coding, values),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::rans::slot_base;
    use crate::codec::token::{SCALES, low_bits, table_of};
    use proptest::prelude::*;

    proptest! {
        /// Whatever this machine runs reads like the portable decoder, from junk as well: the same
        /// residuals, the same states, and the same ends.
        #[test]
        fn all_decoders_are_one(
            words in prop::collection::vec(any::<u8>(), 0..400),
            bits in prop::collection::vec(any::<u8>(), 0..600),
            scales in prop::array::uniform32(0..SCALES as u8),
            activity in prop::collection::vec((0i32..1 << 30, 0u32..30), 0..700),
        ) {
            let head: Vec<u8> = (0..super::super::rans::LANES).flat_map(|lane| (0x1_0000 + 77 * lane as u32).to_le_bytes()).collect();
            let stream: Vec<u8> = head.into_iter().chain(words[..words.len() & !1].iter().copied()).collect();
            let coding: [u32; BUCKETS] = std::array::from_fn(|b| {
                let t = scales[b % 32];
                slot_base(table_of(t)) | low_bits(t) << 16
            });
            let values: Vec<i32> = activity.iter().map(|&(a, shift)| a >> shift).collect();
            let run = |read: fn(&mut Decoder<'_>, &mut BitReader<'_>, &[u32; BUCKETS], &mut [i32])| {
                let mut rans = Decoder::new(&stream).unwrap();
                let mut raw = BitReader::new(&bits);
                let mut values = values.clone();
                for class in values.chunks_mut(300) {
                    read(&mut rans, &mut raw, &coding, class);
                }
                (values, rans.states, rans.next, raw.position)
            };
            prop_assert_eq!(run(read), run(portable::read));
        }
    }
}
