//! Residuals as tokens and raw bits.
//!
//! A residual r becomes z = 2r (r >= 0) or -2r - 1 (r < 0). Under scale t (half octaves) its low
//! k(t) bits are raw; the rest, u = z >> k, is a token: u itself below 16, then four tokens an
//! octave with raw bits, and [`ESCAPE`] from 512 on, followed by all 27 bits of z. The last scale
//! is for residuals spread evenly over eight values.

/// Number of scales a bucket may be mapped to.
pub const SCALES: usize = 64;
/// Scales below this one have a table each and no raw low bits.
pub const SMALL_SCALES: usize = 16;
/// Number of tables: the small scales, and one for each half octave above.
pub const TABLES: usize = SMALL_SCALES + 2;
/// The scale of residuals that are spread evenly over eight values: table 0 and three raw bits.
pub const EVEN_SCALE: u8 = SCALES as u8 - 1;
/// Tokens of a table.
pub const TOKENS: usize = 37;
/// The token for quotients of 512 and more.
pub const ESCAPE: u8 = 36;
/// Bits of z after an escape. Samples stay within +-2^23, so residuals stay within +-2^25.
pub const ESCAPE_BITS: u32 = 27;

/// The table of a scale.
#[inline]
#[must_use]
pub const fn table_of(t: u8) -> usize {
    if t == EVEN_SCALE {
        return 0;
    }
    let t = t as usize;
    if t < SMALL_SCALES { t } else { SMALL_SCALES + ((t - SMALL_SCALES) & 1) }
}

/// Raw low bits of a scale.
#[inline]
#[must_use]
pub const fn low_bits(t: u8) -> u32 {
    if t == EVEN_SCALE {
        return 3;
    }
    let t = t as u32;
    if t < SMALL_SCALES as u32 { 0 } else { (t - SMALL_SCALES as u32) >> 1 }
}

/// Zigzag: small magnitudes become small numbers.
#[inline]
#[must_use]
pub const fn zigzag(r: i32) -> u32 {
    ((r << 1) ^ (r >> 31)) as u32
}

/// Inverse of [`zigzag`].
#[inline]
#[must_use]
pub const fn unzigzag(z: u32) -> i32 {
    (z >> 1) as i32 ^ -((z & 1) as i32)
}

/// Smallest quotient of a token, and its raw bits.
#[must_use]
pub const fn token_range(token: u8) -> (u32, u32) {
    if token < 16 {
        (token as u32, 0)
    } else {
        let octave = (token as u32 - 16) / 4;
        ((4 + (token as u32 & 3)) << (octave + 2), octave + 2)
    }
}

/// Token of every quotient below 512, and its raw bits.
static QUOTIENTS: [(u8, u8); 512] = {
    let mut quotients = [(0, 0); 512];
    let mut token = 0;
    while token < ESCAPE {
        let (base, bits) = token_range(token);
        let mut u = base;
        while u < base + (1 << bits) {
            quotients[u as usize] = (token, bits as u8);
            u += 1;
        }
        token += 1;
    }
    quotients
};

/// Token of a zigzagged residual with `low` raw low bits, all its raw bits and their number.
#[inline]
#[must_use]
pub fn tokenize(z: u32, low: u32) -> (u8, u32, u32) {
    let u = z >> low;
    if u < 512 {
        let (token, bits) = QUOTIENTS[u as usize];
        let n = u32::from(bits) + low;
        (token, z & ((1 << n) - 1), n)
    } else {
        (ESCAPE, z, ESCAPE_BITS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_dense_and_invertible() {
        for u in 0..512u32 {
            let (token, raw, n) = tokenize(u, 0);
            let (base, bits) = token_range(token);
            assert_eq!((base + raw, bits), (u, n), "quotient {u}");
        }
        assert_eq!(tokenize(511, 0).0, ESCAPE - 1);
        assert_eq!(tokenize(512, 0), (ESCAPE, 512, ESCAPE_BITS));
        assert_eq!(tokenize((511 << 5) + 31, low_bits(26)).0, ESCAPE - 1);
    }

    #[test]
    fn zigzag_is_invertible_to_its_ends() {
        for r in [0, 1, -1, 7, -8, (1 << 25) - 1, -(1 << 25)] {
            assert_eq!(unzigzag(zigzag(r)), r);
            assert!(zigzag(r) < 1 << ESCAPE_BITS);
        }
    }
}
