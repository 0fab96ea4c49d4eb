//! What is typed: numbers with commas, sizes, steps of time.

use std::str::FromStr;

use chrono::{DateTime, SecondsFormat, TimeDelta, Utc};

/// Finite numbers with commas between them, `least` to `most` of them.
fn numbers(text: &str, least: usize, most: usize, names: &str) -> Result<Vec<f64>, String> {
    let words: Vec<&str> = text.split(',').map(str::trim).collect();
    let numbers: Option<Vec<f64>> =
        words.iter().map(|word| word.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    match numbers {
        Some(numbers) if (least..=most).contains(&numbers.len()) => Ok(numbers),
        _ => Err(format!("must be {names}: finite numbers with commas between them, no spaces")),
    }
}

/// `LON,LAT,HEIGHT[,HEADING,PITCH,ROLL]` (a plane: X,Y,HEIGHT and the same).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraArg {
    /// Longitude, degrees, or X.
    pub x: f64,
    /// Latitude, degrees, or Y.
    pub y: f64,
    /// Metres above the ellipsoid or the plane.
    pub height_m: f64,
    /// Heading, pitch and roll, degrees: straight down with north up unless given.
    pub turned_deg: [f64; 3],
}

impl FromStr for CameraArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = numbers(text, 3, 6, "LON,LAT,HEIGHT[,HEADING,PITCH,ROLL]")?;
        let [x, y, height_m] = [numbers[0], numbers[1], numbers[2]];
        let given = |at: usize, default| numbers.get(at).copied().unwrap_or(default);
        Ok(Self { x, y, height_m, turned_deg: [given(3, 0.0), given(4, -90.0), given(5, 0.0)] })
    }
}

/// Two angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnglesArg(pub [f64; 2]);

impl FromStr for AnglesArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = numbers(text, 2, 2, "LON,LAT (a plane: AZIMUTH,ELEVATION) in degrees")?;
        Ok(Self([numbers[0], numbers[1]]))
    }
}

/// A point of the map: longitude and latitude in degrees, or X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointArg(pub [f64; 2]);

impl FromStr for PointArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = numbers(text, 2, 2, "LON,LAT in degrees (a plane: X,Y)")?;
        Ok(Self([numbers[0], numbers[1]]))
    }
}

/// WxH in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeArg(pub [u32; 2]);

impl FromStr for SizeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
        match sides {
            Some([width, height]) if width > 0 && height > 0 => Ok(Self([width, height])),
            _ => Err("must be WIDTHxHEIGHT, both whole and at least 1, such as 1920x1080".into()),
        }
    }
}

/// Times may be as many as this.
const MOST_TIMES: i64 = 100_000;

/// FROM,TO,STEP: times from FROM to TO, both included where the step meets TO.
#[derive(Clone, Debug, PartialEq)]
pub struct TimesArg(pub Vec<DateTime<Utc>>);

impl FromStr for TimesArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split(',').map(str::trim).collect();
        let &[from, to, step] = words.as_slice() else {
            return Err("must be FROM,TO,STEP: two RFC 3339 times and a step such as 30s, 15min, 1h or 1d".into());
        };
        let (from, to, step) = (time(from)?, time(to)?, step_of(step)?);
        if to < from {
            return Err(format!("TO, {}, must not lie before FROM, {}", plain(to), plain(from)));
        }
        let count = (to - from).num_milliseconds() / step.num_milliseconds() + 1;
        if count > MOST_TIMES {
            return Err(format!("{count} times: must be at most {MOST_TIMES}; choose a longer step"));
        }
        let times = (0..count).map(|k| from + TimeDelta::milliseconds(k * step.num_milliseconds()));
        Ok(Self(times.collect()))
    }
}

/// An RFC 3339 time.
pub fn time(text: &str) -> Result<DateTime<Utc>, String> {
    DateTime::parse_from_rfc3339(text)
        .map(|time| time.to_utc())
        .map_err(|error| format!("{text:?} is no RFC 3339 time, such as 2026-06-21T12:00:00Z: {error}"))
}

/// A time as RFC 3339 in UTC, without fractions of a second that are zero.
pub fn plain(time: DateTime<Utc>) -> String {
    time.to_rfc3339_opts(SecondsFormat::AutoSi, true)
}

fn step_of(text: &str) -> Result<TimeDelta, String> {
    let at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(at);
    let unit_ms = match unit {
        "s" => Some(1e3),
        "min" => Some(6e4),
        "h" => Some(3.6e6),
        "d" => Some(8.64e7),
        _ => None,
    };
    let milliseconds =
        unit_ms.and_then(|ms| Some(number.parse::<f64>().ok()? * ms)).filter(|ms| (1.0..1e14).contains(ms));
    match milliseconds {
        Some(ms) => Ok(TimeDelta::milliseconds(ms.round() as i64)),
        None => {
            Err(format!("a step of {text:?}: must be a number above 0 and its unit, s, min, h or d, such as 15min"))
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    #[test]
    fn cameras_look_down_unless_told() {
        let camera: CameraArg = "86.9, 27.5,9e3".parse().unwrap();
        assert_eq!(camera, CameraArg { x: 86.9, y: 27.5, height_m: 9000.0, turned_deg: [0.0, -90.0, 0.0] });
        assert_eq!("1,2,3,45,-10".parse::<CameraArg>().unwrap().turned_deg, [45.0, -10.0, 0.0]);
        assert_eq!("-1,-2,-3,45,-10,2".parse::<CameraArg>().unwrap().turned_deg, [45.0, -10.0, 2.0]);
        for bad in ["", "1,2", "1,2,3,4,5,6,7", "1,2,x", "1,2,nan", "1,inf,2", "1;2;3"] {
            assert!(bad.parse::<CameraArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_have_two_sides() {
        assert_eq!("1920x1080".parse(), Ok(SizeArg([1920, 1080])));
        for bad in ["", "1920", "0x5", "5x0", "-1x5", "5x5x5", "1.5x2", "99999999999x2"] {
            assert!(bad.parse::<SizeArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn times_step_from_first_to_last() {
        let TimesArg(times) = "2026-06-21T04:00:00+02:00,2026-06-21T03:00:00Z,15min".parse().unwrap();
        let shown: Vec<String> = times.into_iter().map(plain).collect();
        let expected = ["02:00:00", "02:15:00", "02:30:00", "02:45:00", "03:00:00"];
        assert_eq!(shown, expected.map(|time| format!("2026-06-21T{time}Z")));
        let count = |text: &str| text.parse::<TimesArg>().map(|times| times.0.len());
        assert_eq!(count("2026-01-01T00:00:00Z,2026-01-01T00:00:00Z,1d"), Ok(1));
        assert_eq!(count("2026-01-01T00:00:00Z,2026-01-02T00:00:01Z,0.5d"), Ok(3));
        for bad in [
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z",
            "2026-01-02T00:00:00Z,2026-01-01T00:00:00Z,1h",
            "2026-01-01,2026-01-02T00:00:00Z,1h",
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z,1",
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z,0h",
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z,-1h",
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z,0.5s",
            "2026-01-01T00:00:00Z,2026-01-02T00:00:00Z,1fortnight",
        ] {
            // Half a second is a step, but too many of them.
            assert!(count(bad).is_err(), "{bad}");
        }
    }
}
