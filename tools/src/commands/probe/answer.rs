//! One question, one answer: parsing, placing and printing.

use std::fmt::Write as _;

use relief_formats::file::Relief;
use relief_formats::geodesy::Ellipsoid;
use relief_formats::surface::{Place, PlaceError, PointSample, Surface};

use relief_front::error::ToolError;

/// Decoded samples that are kept between points.
const CACHE_BYTES: u64 = 256 << 20;

/// What answers questions about one level of a file.
pub struct Prober<'a> {
    pub surface: Surface<'a>,
    level: u32,
    /// None on a plane.
    ellipsoid: Option<Ellipsoid>,
}

impl<'a> Prober<'a> {
    pub fn new(relief: &'a Relief, level: u32) -> Result<Self, ToolError> {
        let coarsest = relief.grid().root_level();
        if level > coarsest {
            return Err(ToolError::usage(
                format!("--level {level}"),
                format!("the file has the levels 0 (finest) to {coarsest}"),
                "ask for one of these levels; `relief-bake inspect` lists them",
            ));
        }
        let ellipsoid = Ellipsoid::of(relief.body());
        Ok(Self { surface: Surface::new(relief, CACHE_BYTES), level, ellipsoid })
    }

    /// What a point of this file must be.
    pub fn rule(&self) -> &'static str {
        match self.ellipsoid {
            Some(_) => "a point is a longitude (any turn) and a latitude (-90 to 90) in degrees",
            None => "a point is X and Y of the file's CRS, within its square",
        }
    }

    /// Where a point given as (lon, lat) or (X, Y) lies.
    pub fn place(&self, [x, y]: [f64; 2]) -> Result<Place, PlaceError> {
        let relief = self.surface.relief();
        match self.ellipsoid {
            Some(_) => Place::from_deg(relief.grid(), self.level, x, y),
            None => Place::from_xy(relief.body(), relief.grid(), self.level, x, y),
        }
    }

    /// Appends the JSON object, without a line end.
    pub fn write_json(&self, out: &mut String, [x, y]: [f64; 2], sample: &PointSample) {
        let PointSample { height_m, filled, bounds_m: [low, high] } = *sample;
        // Debug prints the shortest digits that read back as the same f64, valid JSON for finite
        // numbers; writing to a String cannot fail.
        let _ = write!(
            out,
            r#"{{"height_m":{height_m:?},"level":{},"filled":{filled},"bounds_m":[{low:?},{high:?}]"#,
            self.level
        );
        if let Some(ellipsoid) = &self.ellipsoid {
            let [x, y, z] = ellipsoid.ecef_from_deg_m(x, y, height_m);
            let _ = write!(out, r#","ecef_m":[{x:?},{y:?},{z:?}]"#);
        }
        out.push('}');
    }

    /// Appends the answer for a human reader.
    pub fn write_text(&self, out: &mut String, [x, y]: [f64; 2], sample: &PointSample) {
        let PointSample { height_m, filled, bounds_m: [low, high] } = *sample;
        let mut row = |name: &str, value: String| {
            let _ = writeln!(out, "{name:<10}{value}");
        };
        row("height", format!("{height_m} m"));
        row("bounds", format!("{low} to {high} m"));
        row("level", self.level.to_string());
        row("filled", if filled { "yes" } else { "no" }.into());
        if let Some(ellipsoid) = &self.ellipsoid {
            let [x, y, z] = ellipsoid.ecef_from_deg_m(x, y, height_m);
            row("ecef", format!("{x:.4} {y:.4} {z:.4} m"));
        }
    }
}

/// Two numbers with spaces or a comma between them.
pub fn parse_point(line: &str) -> Result<[f64; 2], String> {
    let mut words = line.split([' ', '\t', ',', '\r']).filter(|word| !word.is_empty());
    let mut number = |what: &str| {
        let word = words.next().ok_or_else(|| format!("{what} is missing: must be two numbers, `lon lat`"))?;
        word.parse::<f64>().map_err(|_| format!("{word:?} is no number: must be two numbers, `lon lat`"))
    };
    let point = [number("the first number")?, number("the second number")?];
    match words.next() {
        None => Ok(point),
        Some(word) => Err(format!("{word:?} is one word too many: must be two numbers, `lon lat`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_two_numbers() {
        assert_eq!(parse_point(" -1.5\t2e1\r"), Ok([-1.5, 20.0]));
        assert_eq!(parse_point("3,4"), Ok([3.0, 4.0]));
        for bad in ["", "1", "1 x", "1 2 3", "1;2"] {
            assert!(parse_point(bad).is_err(), "{bad:?}");
        }
    }
}
