//! Sizes of memory on the command line.

/// Bytes with an optional binary or decimal suffix: 4096, 512MiB, 1.5GB.
///
/// # Errors
/// Rule and remedy, for clap to put after the value.
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let refusal = |rule: &str| Err(format!("\n  rule: {rule}\n  remedy: write it as 512MiB"));
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor: f64 = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kib" => 1024.0,
        "m" | "mib" => 1024.0 * 1024.0,
        "g" | "gib" => 1024.0 * 1024.0 * 1024.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        _ => return refusal("bytes, or a number with KiB, MiB, GiB, kB, MB or GB"),
    };
    match digits.trim().parse::<f64>() {
        Ok(v) if v >= 1.0 && v * factor < 1e18 => Ok((v * factor) as u64),
        _ => refusal("it is a positive number of bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_with_suffixes() {
        assert_eq!(parse_bytes("1GiB"), Ok(1 << 30));
        assert_eq!(parse_bytes("1.5MB"), Ok(1_500_000));
        assert_eq!(parse_bytes("4096"), Ok(4096));
        for bad in ["", "-1", "0", "12XB", "GiB", "nan"] {
            assert!(parse_bytes(bad).is_err(), "{bad}");
        }
    }
}
