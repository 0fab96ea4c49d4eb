//! rANS with 32 interleaved states and 16-bit renormalisation (Duda 2013, Giesen 2014).
//!
//! A state x stays in [2^16, 2^32). Symbol number i of a class belongs to state i mod 32. The
//! encoder walks backwards, so the decoder reads forwards: the start states, then words.

use std::sync::LazyLock;

use super::CodecError;
use super::tables::FREQUENCIES;
use super::token::TOKENS;

/// Bits of a frequency: the frequencies of a table sum to 2^11.
pub const SCALE_BITS: u32 = 11;
/// Slots of a table.
pub const SLOTS: usize = 1 << SCALE_BITS;
/// Interleaved states.
pub const LANES: usize = 32;
/// Lowest value of a state, and every state's value before the first symbol is encoded.
pub const LOW: u32 = 1 << 16;

/// Per slot: token in bits 24.., frequency in 12..24, offset in the symbol's range in 0..12. Filled
/// up to 2^16 slots, so that an index of 16 bits needs no check.
pub(super) static DECODE: LazyLock<Box<[u32; 1 << 16]>> = LazyLock::new(|| {
    let mut slots = Box::new([0; 1 << 16]);
    let mut next = slots.iter_mut();
    for table in &FREQUENCIES {
        for (token, &frequency) in table.iter().enumerate() {
            let frequency = u32::from(frequency);
            for (offset, slot) in (0..frequency).zip(&mut next) {
                *slot = (token as u32) << 24 | frequency << 12 | offset;
            }
        }
    }
    slots
});

/// Per table and token: start of the range in the high half, frequency in the low half.
static ENCODE: LazyLock<Vec<[u32; TOKENS]>> = LazyLock::new(|| {
    FREQUENCIES
        .iter()
        .map(|table| {
            let mut start = 0;
            std::array::from_fn(|token| {
                let entry = start << 16 | u32::from(table[token]);
                start += u32::from(table[token]);
                entry
            })
        })
        .collect()
});

/// Collects the symbols of a plane, class by class.
#[derive(Default)]
pub struct Encoder {
    symbols: Vec<u32>,
    classes: Vec<usize>,
}

impl Encoder {
    /// Starts a class: its first symbol belongs to state 0.
    pub fn start_class(&mut self, symbols: usize) {
        self.classes.push(self.symbols.len());
        self.symbols.reserve(symbols);
    }

    /// Adds a token under a table.
    #[inline]
    pub fn push(&mut self, table: usize, token: u8) {
        self.symbols.push(ENCODE[table][token as usize]);
    }

    /// Encodes everything: the start states, then words, little-endian.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        let mut states = [LOW; LANES];
        let mut words = Vec::<u16>::with_capacity(self.symbols.len());
        let mut end = self.symbols.len();
        for &begin in self.classes.iter().rev() {
            for (i, &symbol) in self.symbols[begin..end].iter().enumerate().rev() {
                let (start, frequency) = (symbol >> 16, symbol & 0xffff);
                let state = &mut states[i % LANES];
                let mut x = *state;
                // Emit a word when the state would leave its interval; never true at full scale.
                if u64::from(x) >= u64::from(frequency) << (32 - SCALE_BITS) {
                    words.push(x as u16);
                    x >>= 16;
                }
                let quotient = x / frequency;
                *state = (quotient << SCALE_BITS) + (x - quotient * frequency) + start;
            }
            end = begin;
        }
        let mut bytes = Vec::with_capacity(4 * LANES + 2 * words.len());
        for state in states {
            bytes.extend_from_slice(&state.to_le_bytes());
        }
        bytes.extend(words.iter().rev().flat_map(|word| word.to_le_bytes()));
        bytes
    }
}

/// The states and words of a plane that is being decoded; [`super::samples`] steps them.
pub struct Decoder<'a> {
    pub(super) states: [u32; LANES],
    pub(super) words: &'a [u8],
    /// Bytes of `words` that were used; beyond its end once it proved too short.
    pub(super) next: usize,
}

impl<'a> Decoder<'a> {
    /// A decoder over the bytes of one plane.
    pub fn new(bytes: &'a [u8]) -> Result<Self, CodecError> {
        let (head, words) = bytes.split_at_checked(4 * LANES).ok_or(CodecError::Truncated)?;
        let mut states = [0; LANES];
        for (state, raw) in states.iter_mut().zip(head.chunks_exact(4)) {
            *state = u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]);
            if *state < LOW {
                return Err(CodecError::Range);
            }
        }
        if words.len() % 2 != 0 {
            return Err(CodecError::Trailing);
        }
        Ok(Self { states, words, next: 0 })
    }

    /// Checks that every word was used and every state is back at its start.
    pub fn finish(self) -> Result<(), CodecError> {
        if self.next > self.words.len() {
            Err(CodecError::Truncated)
        } else if self.next < self.words.len() || self.states != [LOW; LANES] {
            Err(CodecError::Trailing)
        } else {
            Ok(())
        }
    }
}

/// First slot of a table, as [`Decoder::class`] wants it.
#[must_use]
pub const fn slot_base(table: usize) -> u32 {
    (table * SLOTS) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::token::TABLES;
    use proptest::prelude::*;

    /// One class as SPEC section 6 says it, symbol by symbol.
    fn decode(decoder: &mut Decoder<'_>, tables: &[usize]) -> Vec<u8> {
        let step = |(i, table): (usize, &usize)| {
            let state = &mut decoder.states[i % LANES];
            let slot = *state % SLOTS as u32;
            let entry = DECODE[slot_base(*table) as usize + slot as usize];
            *state = (*state >> SCALE_BITS) * (entry >> 12 & 0xfff) + (entry & 0xfff);
            if *state < LOW {
                let word =
                    decoder.words.get(decoder.next..decoder.next + 2).map_or(0, |w| u16::from_le_bytes([w[0], w[1]]));
                *state = *state << 16 | u32::from(word);
                decoder.next += 2;
            }
            (entry >> 24) as u8
        };
        tables.iter().enumerate().map(step).collect()
    }

    #[test]
    fn tables_fill_their_slots_and_know_every_token() {
        for (index, table) in FREQUENCIES.iter().enumerate() {
            assert_eq!(table.iter().map(|&f| usize::from(f)).sum::<usize>(), SLOTS, "table {index}");
            assert!(table.iter().all(|&f| f > 0), "table {index} cannot code every token");
        }
    }

    proptest! {
        #[test]
        fn round_trip(classes in prop::collection::vec(
            prop::collection::vec((0..TABLES, 0..TOKENS as u8), 0..300), 1..4)) {
            let mut encoder = Encoder::default();
            for class in &classes {
                encoder.start_class(class.len());
                for &(table, token) in class { encoder.push(table, token); }
            }
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes).unwrap();
            for class in &classes {
                let (tables, tokens): (Vec<usize>, Vec<u8>) = class.iter().copied().unzip();
                prop_assert_eq!(decode(&mut decoder, &tables), tokens);
            }
            prop_assert_eq!(decoder.finish(), Ok(()));
        }
    }

    #[test]
    fn a_missing_word_is_noticed() {
        let mut encoder = Encoder::default();
        encoder.start_class(100);
        (0..100).for_each(|_| encoder.push(0, 30));
        let bytes = encoder.finish();
        let mut decoder = Decoder::new(&bytes[..bytes.len() - 2]).unwrap();
        decode(&mut decoder, &[0; 100]);
        assert_eq!(decoder.finish(), Err(CodecError::Truncated));
    }
}
