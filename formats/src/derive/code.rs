//! Deviations as bytes: four codes to an octave, rounded up.
//!
//! A deviation is worked out in sixteenths of a height unit (the file's step), where it is an
//! integer. Code 0 is exactly 0; code c >= 1 stands for "at most
//! (4 + (c - 1) mod 4) 2^floor((c - 1) / 4) / 32 units": 1/8, 5/32, 3/16, 7/32, 1/4, ... , 2^25
//! units at code 113. These are exact in f32. The largest deviation there can be, with heights
//! |q| <= 2^24, is 2^25 units.

/// The largest deviation, 2^25 units, in sixteenths of a unit.
pub(crate) const MAX_SIXTEENTHS: i32 = 1 << 29;

/// The smallest code whose value is not below `q_units`, a deviation in height units. Zero and
/// less give 0, NaN and all beyond the last code give 255.
#[must_use]
pub fn encode_deviation(q_units: f32) -> u8 {
    if q_units <= 0.0 {
        return 0;
    }
    if q_units.is_nan() {
        return u8::MAX;
    }
    // 1/8 has the exponent bits 124; below it a subnormal is as good as any small number.
    let quarters = (q_units.to_bits() + (1 << 21) - 1) >> 21;
    quarters.saturating_sub(124 * 4 - 1).clamp(1, 255) as u8
}

/// The deviation in height units that a code stands for: an upper bound of what was encoded.
#[must_use]
pub fn decode_deviation(code: u8) -> f32 {
    if code == 0 { 0.0 } else { f32::from_bits((u32::from(code) + 124 * 4 - 1) << 21) }
}

/// The smallest code whose value is not below `sixteenths` (0 to 2^30 - 1) sixteenths of a unit.
///
/// In integers: 0 for 0; else with z = 2 `sixteenths` - 1, 1 if z < 4, else 4 e + f + 2 where
/// e = floor(log2 z) - 2 and f = floor(z / 2^e) - 4. Written with the bits of an f32 because that
/// runs in vector registers; the low bits that an f32 cannot hold do not reach f.
#[inline(always)]
pub(crate) fn encode_sixteenths(sixteenths: i32) -> u8 {
    let z = 2 * sixteenths - 1;
    let z = if z >= 1 << 24 { z & !127 } else { z };
    let quarters = ((z as f32).to_bits() >> 21) as i32 - (129 * 4 - 2);
    // z = -1 for a deviation of 0: its sign bit must not be taken for a size.
    if sixteenths == 0 { 0 } else { quarters.max(1) as u8 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_integers(sixteenths: i32) -> u8 {
        let z = i64::from(sixteenths) * 2 - 1;
        if z < 0 {
            return 0;
        }
        if z < 4 {
            return 1;
        }
        let e = i64::from(z.ilog2()) - 2;
        (4 * e + (z >> e) - 4 + 2) as u8
    }

    #[test]
    fn codes_rise_by_quarters_of_an_octave() {
        assert_eq!(decode_deviation(0), 0.0);
        assert_eq!([1, 2, 3, 4, 5].map(decode_deviation), [0.125, 0.15625, 0.1875, 0.21875, 0.25]);
        assert_eq!(decode_deviation(113), (1 << 25) as f32);
        for code in 1..=255u8 {
            let value = decode_deviation(code);
            assert!(value > decode_deviation(code - 1) && value.is_finite());
            assert_eq!(encode_deviation(value), code);
            assert_eq!(encode_deviation(value.next_up()), code.saturating_add(1));
        }
        assert_eq!(encode_deviation(f32::from_bits(1)), 1);
        assert_eq!(encode_deviation(-1.0), 0);
        assert_eq!(encode_deviation(f32::INFINITY), 255);
        assert_eq!(encode_deviation(f32::NAN), 255);
    }

    #[test]
    fn the_integer_rule_and_the_vector_form_agree() {
        let near_powers = (2..29).flat_map(|e| (4..8).flat_map(move |f| (-3..4).map(move |d| ((f << e) >> 2) + d)));
        for x in (0..1 << 16).chain(near_powers).filter(|x| (0..1 << 30).contains(x)) {
            assert_eq!(encode_sixteenths(x), by_integers(x), "{x}");
        }
    }

    proptest! {
        #[test]
        fn a_code_bounds_what_it_encodes(x in 0i32..1 << 30) {
            let code = encode_sixteenths(x);
            prop_assert_eq!(code, by_integers(x));
            prop_assert!(f64::from(decode_deviation(code)) * 16.0 >= f64::from(x));
            prop_assert!(code < 2 || f64::from(decode_deviation(code - 1)) * 16.0 < f64::from(x));
        }
    }
}
