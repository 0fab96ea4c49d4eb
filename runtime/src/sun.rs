//! Where the sun stands over the Earth at a time.

use chrono::{DateTime, Utc};
use relief_formats::geodesy::Ellipsoid;
use solar_positioning::{Location, SolarPositions, delta_t};

/// A time at which the sun's place is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{time}: {reason}")]
pub struct SunError {
    /// The time asked for.
    pub time: DateTime<Utc>,
    /// Why.
    pub reason: &'static str,
}

/// The point of the Earth that has the sun in its zenith: geodetic longitude (-180 to 180) and
/// latitude, degrees, as for an infinitely far sun.
///
/// NREL's solar position algorithm (Reda and Andreas 2004, 0.0003 degrees) with its estimate of
/// TT - UT1; UTC stands for UT1, which is at most 0.9 s or 0.004 degrees of longitude off.
///
/// # Errors
/// [`SunError`] for a leap second, or a year outside -500 to 3000.
pub fn sub_solar_deg(time: DateTime<Utc>) -> Result<[f64; 2], SunError> {
    let refused = |reason| SunError { time, reason };
    let unknown = refused("the sun's place is known for the years -500 to 3000, leap seconds excepted");
    let delta_t_s = delta_t::estimate_from_date_like(&time).map_err(|_| unknown)?;
    let sun = SolarPositions::new().for_time(&time, delta_t_s).map_err(|_| unknown)?;
    // The directions from two ends of a diameter: the parallax of 8.8 seconds of arc cancels.
    let mut towards = [0.0; 3];
    for longitude in [0.0, 180.0] {
        let seen = sun.at(Location { latitude: 0.0, longitude }, 0.0, None).map_err(|_| unknown)?;
        let (sin_a, cos_a) = seen.azimuth().to_radians().sin_cos();
        let (sin_e, cos_e) = seen.elevation_angle().to_radians().sin_cos();
        // At the equator: up is the normal there, north the axis.
        let [up_x, up_y, _] = Ellipsoid::normal_from_deg(longitude, 0.0);
        let (east, north) = (sin_a * cos_e, cos_a * cos_e);
        towards[0] += sin_e * up_x - east * up_y;
        towards[1] += sin_e * up_y + east * up_x;
        towards[2] += north;
    }
    let [x, y, z] = towards;
    Ok([y.atan2(x).to_degrees(), z.atan2(x.hypot(y)).to_degrees()])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

    use super::*;

    fn at(time: &str) -> [f64; 2] {
        sub_solar_deg(time.parse().unwrap()).unwrap()
    }

    fn turn(deg: f64) -> f64 {
        (deg + 180.0).rem_euclid(360.0) - 180.0
    }

    /// Reda and Andreas, table A5.1: 2003-10-17 12:30:30 at UTC-7, declination -9.31434, local hour
    /// angle 11.105902 at longitude -105.1786; they take TT - UT1 = 67 s.
    #[test]
    fn the_papers_example() {
        let [lon, lat] = at("2003-10-17T12:30:30-07:00");
        assert!((lat + 9.31434).abs() < 5e-4, "{lat}");
        assert!((lon - (-105.1786 - 11.105902)).abs() < 5e-4, "{lon}");
    }

    /// Meeus, Astronomical Algorithms, example 25.b: 1992-10-13 0h TD (59 s later than UT), apparent
    /// declination -7 47 01.74, right ascension 13h 13m 30.749s.
    #[test]
    fn the_textbooks_example() {
        let [lon, lat] = at("1992-10-12T23:59:01Z");
        assert!((lat + (7.0 + 47.0 / 60.0 + 1.74 / 3600.0)).abs() < 1e-3, "{lat}");
        // Greenwich sidereal time: Meeus eq. 12.4, without nutation (below 0.005 degrees).
        let days = 2_448_908.5 - 59.0 / 86_400.0 - 2_451_545.0;
        let sidereal_deg = 280.460_618_37 + 360.985_647_366_29 * days;
        let right_ascension_deg = 15.0 * (13.0 + 13.0 / 60.0 + 30.749 / 3600.0);
        assert!(turn(lon - (right_ascension_deg - sidereal_deg)).abs() < 6e-3, "{lon}");
    }

    /// Times of the seasons as almanacs print them, to the minute.
    #[test]
    fn equinoxes_and_solstices() {
        for equinox in ["2024-03-20T03:06:00Z", "2024-09-22T12:44:00Z", "2000-03-20T07:35:00Z"] {
            assert!(at(equinox)[1].abs() < 5e-4, "{equinox} {:?}", at(equinox));
        }
        for (solstice, sign) in [("2024-06-20T20:51:00Z", 1.0), ("2024-12-21T09:20:00Z", -1.0)] {
            // The obliquity of 2024, 23 26 10, and its nutation of 9 seconds of arc at most.
            assert!((at(solstice)[1] * sign - 23.4361).abs() < 3e-3, "{solstice} {:?}", at(solstice));
        }
    }

    /// The Astronomical Almanac's formulas of low precision (section C), good to 0.01 degrees in
    /// longitude along the ecliptic from 1950 to 2050.
    #[test]
    fn the_almanacs_short_formulas_agree() {
        let start: DateTime<Utc> = "1950-01-01T00:00:00Z".parse().unwrap();
        for k in 0..2000i64 {
            let time = start + chrono::TimeDelta::seconds(k * 1_577_000);
            let days = time.timestamp() as f64 / 86_400.0 + 2_440_587.5 - 2_451_545.0;
            let anomaly = (357.528 + 0.985_600_3 * days).to_radians();
            let ecliptic =
                (280.460 + 0.985_647_4 * days + 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
            let obliquity = (23.439 - 4e-7 * days).to_radians();
            let lat = (obliquity.sin() * ecliptic.sin()).asin().to_degrees();
            let right_ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos()).to_degrees();
            let lon = right_ascension - (280.460_618_37 + 360.985_647_366_29 * days);
            let found = sub_solar_deg(time).unwrap();
            assert!((found[1] - lat).abs() < 0.012, "{time} {found:?} {lat}");
            assert!(turn(found[0] - lon).abs() < 0.02, "{time} {found:?} {lon}");
        }
    }

    #[test]
    fn times_without_a_sun_are_refused() {
        for time in ["2016-12-31T23:59:60Z", "+9999-01-01T00:00:00Z"] {
            let error = sub_solar_deg(time.parse().unwrap()).unwrap_err();
            assert!(error.to_string().contains("known for"), "{error}");
        }
    }
}
