//! Numbers as a reader wants them.

/// With so many significant digits and no exponent; `0` for zero.
#[must_use]
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { "-".into() };
    }
    let magnitude = value.abs().log10().floor() as i32;
    let decimals = (digits - 1 - magnitude).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if decimals == 0 { thousands(&text) } else { text }
}

/// A whole number with thin spaces between groups of three digits, from five digits on.
#[must_use]
pub fn whole(value: u64) -> String {
    thousands(&value.to_string())
}

fn thousands(text: &str) -> String {
    let digits = text.trim_start_matches('-').len();
    if digits < 5 {
        return text.to_owned();
    }
    let mut grouped = String::new();
    for (at, digit) in text.chars().enumerate() {
        let left = text.chars().count() - at;
        if at > 0 && left.is_multiple_of(3) && !grouped.ends_with('-') {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped
}

/// Megabytes (10^6).
#[must_use]
pub fn megabytes(bytes: u64) -> String {
    significant(bytes as f64 / 1e6, 4)
}

/// Millions.
#[must_use]
pub fn millions(value: f64) -> String {
    significant(value / 1e6, 3)
}

/// A power of two as people write it: `1/16`, `4`.
#[must_use]
pub fn power_of_two(exponent: i8) -> String {
    let power = f64::from(exponent.unsigned_abs()).exp2();
    if exponent < 0 { format!("1/{power}") } else { power.to_string() }
}

/// Text that may stand in HTML, attributes too.
#[must_use]
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits() {
        assert_eq!(significant(0.0078125, 3), "0.00781");
        assert_eq!(significant(12.345, 3), "12.3");
        assert_eq!(significant(1234.5, 3), "1234");
        assert_eq!(significant(-12345.6, 3), "-12\u{202f}346");
        assert_eq!((significant(0.0, 3), significant(f64::NAN, 3)), ("0".into(), "-".into()));
        assert_eq!(whole(8_388_608), "8\u{202f}388\u{202f}608");
        assert_eq!((power_of_two(-6), power_of_two(0), power_of_two(3)), ("1/64".into(), "1".into(), "8".into()));
        assert_eq!(escaped("a<\"b\"&c>"), "a&lt;&quot;b&quot;&amp;c&gt;");
    }
}
