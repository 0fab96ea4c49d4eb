//! Little-endian bit streams: the first bit written is the lowest bit of the first byte.

use super::CodecError;

/// Appends up to 32 bits at a time.
#[derive(Default)]
pub struct BitWriter {
    bytes: Vec<u8>,
    pending: u64,
    count: u32,
}

impl BitWriter {
    /// Appends the low `n` bits of `value` (n <= 32, the other bits zero).
    #[inline]
    pub fn put(&mut self, value: u32, n: u32) {
        self.pending |= u64::from(value) << self.count;
        self.count += n;
        if self.count >= 32 {
            self.bytes.extend_from_slice(&(self.pending as u32).to_le_bytes());
            self.pending >>= 32;
            self.count -= 32;
        }
    }

    /// Pads the last byte with zeros and returns the stream.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        let tail = self.count.div_ceil(8) as usize;
        self.bytes.extend_from_slice(&self.pending.to_le_bytes()[..tail]);
        self.bytes
    }
}

/// N bytes from `at` on; zeros where `bytes` ends.
#[inline(always)]
pub(super) fn window<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    match bytes.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(window) => *window,
        None => last_window(bytes, at),
    }
}

#[cold]
pub(super) fn last_window<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut window = [0; N];
    for (to, from) in window.iter_mut().zip(bytes.get(at..).unwrap_or_default()) {
        *to = *from;
    }
    window
}

/// Reads what [`BitWriter`] wrote. Reading past the end gives zeros and is reported by
/// [`BitReader::finish`], so the hot loop carries no branch for it.
pub struct BitReader<'a> {
    pub(super) bytes: &'a [u8],
    /// Bits that were read; beyond the end once `bytes` proved too short.
    pub(super) position: usize,
}

impl<'a> BitReader<'a> {
    /// A reader over `bytes`.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }

    /// The next `n` <= 32 bits.
    #[inline(always)]
    pub fn get(&mut self, n: u32) -> u32 {
        let value = u64::from_le_bytes(window(self.bytes, self.position >> 3)) >> (self.position & 7);
        self.position += n as usize;
        (value & ((1 << n) - 1)) as u32
    }

    /// Checks that exactly the whole stream was read and that its padding is zero.
    pub fn finish(mut self) -> Result<(), CodecError> {
        let Some(left) = (self.bytes.len() * 8).checked_sub(self.position) else {
            return Err(CodecError::Truncated);
        };
        if left >= 8 || self.get(left as u32) != 0 {
            return Err(CodecError::Trailing);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn round_trip(values in prop::collection::vec((any::<u32>(), 0u32..=32), 0..200)) {
            let mut writer = BitWriter::default();
            let masked: Vec<_> = values.iter().map(|&(v, n)| ((u64::from(v) & ((1u64 << n) - 1)) as u32, n)).collect();
            for &(v, n) in &masked { writer.put(v, n); }
            let bytes = writer.finish();
            let mut reader = BitReader::new(&bytes);
            for &(v, n) in &masked { prop_assert_eq!(reader.get(n), v); }
            prop_assert_eq!(reader.finish(), Ok(()));
        }
    }

    #[test]
    fn ends_are_checked() {
        let mut early = BitReader::new(&[1]);
        early.get(9);
        assert_eq!(early.finish(), Err(CodecError::Truncated));
        assert_eq!(BitReader::new(&[0]).finish(), Err(CodecError::Trailing));
        let mut dirty = BitReader::new(&[0x80]);
        dirty.get(7);
        assert_eq!(dirty.finish(), Err(CodecError::Trailing));
    }
}
