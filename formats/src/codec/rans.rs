//! rANS with four interleaved states and 16-bit renormalisation (Duda 2013, Giesen 2014).
//!
//! A state x stays in [2^16, 2^32). Symbol number i of a class belongs to state i mod 4. The
//! encoder walks backwards, so the decoder reads forwards: the four start states, then words.

use std::sync::LazyLock;

use super::CodecError;
use super::tables::FREQUENCIES;
use super::token::{TABLES, TOKENS};

/// Bits of a frequency: the frequencies of a table sum to 2^11.
pub const SCALE_BITS: u32 = 11;
/// Slots of a table.
pub const SLOTS: usize = 1 << SCALE_BITS;
/// Interleaved states.
pub const LANES: usize = 4;
/// Lowest value of a state, and every state's value before the first symbol is encoded.
pub const LOW: u32 = 1 << 16;

/// Per slot: token in bits 24.., frequency in 12..24, offset in the symbol's range in 0..12.
static DECODE: LazyLock<Vec<u32>> = LazyLock::new(|| {
    let mut slots = Vec::with_capacity(TABLES * SLOTS);
    for table in &FREQUENCIES {
        for (token, &frequency) in table.iter().enumerate() {
            let frequency = u32::from(frequency);
            slots.extend((0..frequency).map(|offset| (token as u32) << 24 | frequency << 12 | offset));
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

    /// Encodes everything: four start states, then words, little-endian.
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

/// Decodes what [`Encoder`] wrote.
pub struct Decoder<'a> {
    states: [u32; LANES],
    words: &'a [u8],
    next: usize,
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

    /// Decodes one class: `bases[i]` is the first slot of sample i's table.
    pub fn class(&mut self, bases: &[u32], tokens: &mut [u8]) {
        let table = DECODE.as_slice();
        let mut states = self.states;
        let mut next = self.next;
        let words = self.words;
        let mut step = |state: &mut u32, base: u32, token: &mut u8| {
            let x = *state;
            let entry = table[base as usize + (x as usize & (SLOTS - 1))];
            *token = (entry >> 24) as u8;
            let y = (x >> SCALE_BITS) * (entry >> 12 & 0xfff) + (entry & 0xfff);
            // Past the end zeros are read; `finish` reports it.
            let word = words.get(next..next + 2).map_or(0, |w| u32::from(u16::from_le_bytes([w[0], w[1]])));
            let refill = y < LOW;
            *state = if refill { y << 16 | word } else { y };
            next += if refill { 2 } else { 0 };
        };
        let mut bases4 = bases.chunks_exact(LANES);
        let mut tokens4 = tokens.chunks_exact_mut(LANES);
        for (b, t) in (&mut bases4).zip(&mut tokens4) {
            step(&mut states[0], b[0], &mut t[0]);
            step(&mut states[1], b[1], &mut t[1]);
            step(&mut states[2], b[2], &mut t[2]);
            step(&mut states[3], b[3], &mut t[3]);
        }
        for ((state, &b), t) in states.iter_mut().zip(bases4.remainder()).zip(tokens4.into_remainder()) {
            step(state, b, t);
        }
        self.states = states;
        self.next = next;
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
    use proptest::prelude::*;

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
                let bases: Vec<u32> = class.iter().map(|&(table, _)| slot_base(table)).collect();
                let mut tokens = vec![0; class.len()];
                decoder.class(&bases, &mut tokens);
                prop_assert!(tokens.iter().zip(class).all(|(a, (_, b))| a == b));
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
        decoder.class(&[0; 100], &mut [0; 100]);
        assert_eq!(decoder.finish(), Err(CodecError::Truncated));
    }
}
