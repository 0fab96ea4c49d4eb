//! One question, one answer: parsing, placing, asking the kernels, printing.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use relief_formats::geodesy::{s_from_lon_deg, t_from_lat_deg};
use relief_formats::surface::{Place, Surface};
use relief_front::error::ToolError;
use relief_runtime::planet::Planet;
use relief_runtime::shadow::{PointSun, sun_of};
use relief_runtime::view::{Camera, SUN_RADIUS_DEG};

use super::Args;
use super::kernels::Kernels;
use crate::backend::Backend;
use crate::errors::open;

/// Decoded samples that are kept between points.
const CACHE_BYTES: u64 = 256 << 20;

/// A point of the map.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// Fixed point, for the kernels.
    fixed: [u32; 2],
    /// Its cell, for bounds and fill marks.
    place: Place,
}

/// What is known of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Metres.
    pub height_m: f32,
    /// Level of the nodes around it.
    pub level: u32,
    /// True where one of them holds no measurement.
    pub filled: bool,
    /// Least and greatest height around it, metres.
    pub bounds_m: [f64; 2],
    /// Visible part of the sun, where there is one.
    pub lit: Option<f32>,
}

/// Answers questions about one level of a file.
pub struct Prober {
    path: PathBuf,
    planet: Arc<Planet>,
    level: u32,
    sun: Option<PointSun>,
    kernels: Kernels,
}

impl Prober {
    /// Opens the file and the backend.
    pub fn new(args: &Args) -> Result<Self, ToolError> {
        let planet = open(&args.file)?;
        let coarsest = planet.grid().root_level();
        if args.level > coarsest {
            return Err(ToolError::usage(
                format!("--level {}", args.level),
                format!("the file has the levels 0 (finest) to {coarsest}"),
                "ask for one of these levels; `relief-bake inspect` lists them",
            ));
        }
        let light = args.sun.light(&planet)?;
        let backend = Backend::find(args.backend)?;
        Ok(Self {
            kernels: Kernels::new(&backend, Arc::clone(&planet), &args.file)?,
            path: args.file.clone(),
            level: args.level,
            sun: light.map(|light| PointSun {
                sun: sun_of(&light.sun, if args.soft { SUN_RADIUS_DEG } else { 0.0 }),
                level: args.level,
                ..PointSun::default()
            }),
            planet,
        })
    }

    /// What a point of this file must be.
    pub fn rule(&self) -> &'static str {
        match self.planet.grid().plane {
            false => "a point is a longitude (any turn) and a latitude (-90 to 90) in degrees",
            true => "a point is X and Y of the file's CRS, within its square",
        }
    }

    /// Where a point given as (lon, lat) or (X, Y) lies.
    pub fn place(&self, [x, y]: [f64; 2]) -> Result<At, String> {
        let relief = self.planet.relief();
        let words = |error: &dyn std::fmt::Display| error.to_string();
        if relief.grid().plane {
            let place = Place::from_xy(relief.body(), relief.grid(), self.level, x, y).map_err(|e| words(&e))?;
            let camera = Camera::over_plane(&self.planet, x, y, 0.0).map_err(|e| words(&e))?;
            return Ok(At { fixed: [camera.s, camera.t], place });
        }
        let place = Place::from_deg(relief.grid(), self.level, x, y).map_err(|e| words(&e))?;
        let fixed = [s_from_lon_deg(x).map_err(|e| words(&e))?, t_from_lat_deg(y).map_err(|e| words(&e))?];
        Ok(At { fixed, place })
    }

    /// Answers in the order of the questions.
    pub fn answers(&mut self, points: &[At]) -> Result<Vec<Answer>, ToolError> {
        let in_file = ToolError::of_file(&self.path);
        // Tile by tile: neighbours share what is decoded for them.
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_unstable_by_key(|&k| points[k].place.tile);
        let places: Vec<[u32; 2]> = order.iter().map(|&k| points[k].fixed).collect();
        let known = self.kernels.at(self.level, self.sun.as_ref(), &places)?;
        let mut known = known.into_iter();
        let mut answers: Vec<Option<Answer>> = vec![None; points.len()];
        let surface = Surface::new(self.planet.relief(), CACHE_BYTES);
        for run in order.chunk_by(|&a, &b| points[a].place.tile == points[b].place.tile) {
            let tile = surface.tile(points[run[0]].place.tile).map_err(in_file)?;
            for (&k, (height_m, lit)) in run.iter().zip(&mut known) {
                let sample = tile.sample(&points[k].place);
                let (filled, bounds_m) = (sample.filled, sample.bounds_m);
                answers[k] = Some(Answer { height_m, level: self.level, filled, bounds_m, lit });
            }
        }
        Ok(answers.into_iter().flatten().collect())
    }
}

impl Answer {
    /// The JSON object, without a line end.
    pub fn json(&self) -> String {
        let Self { height_m, level, filled, bounds_m: [low, high], lit } = self;
        // Debug prints the shortest digits that read back, valid JSON for finite numbers.
        let mut out =
            format!(r#"{{"height_m":{height_m:?},"level":{level},"filled":{filled},"bounds_m":[{low:?},{high:?}]"#);
        if let Some(lit) = lit {
            // Writing to a String cannot fail.
            let _ = write!(out, r#","lit":{lit:?}"#);
        }
        out.push('}');
        out
    }

    /// The answer for a human reader.
    pub fn text(&self) -> String {
        let [low, high] = self.bounds_m;
        let mut out = String::new();
        let mut row = |name: &str, value: String| {
            let _ = writeln!(out, "{name:<10}{value}");
        };
        row("height", format!("{} m", self.height_m));
        row("bounds", format!("{low} to {high} m"));
        row("level", self.level.to_string());
        row("filled", if self.filled { "yes" } else { "no" }.into());
        if let Some(lit) = self.lit {
            row("lit", format!("{:.1} %", lit * 100.0));
        }
        out
    }
}

/// Two numbers with spaces or a comma between them.
pub fn parse_point(line: &str) -> Result<[f64; 2], String> {
    let words: Vec<&str> = line.split([' ', '\t', ',', '\r', '\n']).filter(|word| !word.is_empty()).collect();
    let number =
        |word: &str| word.parse::<f64>().map_err(|_| format!("{word:?} is no number: must be two numbers, `lon lat`"));
    match words.as_slice() {
        &[x, y] => Ok([number(x)?, number(y)?]),
        words => Err(format!("{} words: must be two numbers, `lon lat`", words.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_two_numbers() {
        assert_eq!(parse_point(" -1.5\t2e1\r"), Ok([-1.5, 20.0]));
        assert_eq!(parse_point("3,4\n"), Ok([3.0, 4.0]));
        for bad in ["", "1", "1 x", "1 2 3", "1;2"] {
            assert!(parse_point(bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn answers_are_json() {
        let answer = Answer { height_m: 0.1, level: 2, filled: true, bounds_m: [-1e-9, 3.0], lit: None };
        assert_eq!(answer.json(), r#"{"height_m":0.1,"level":2,"filled":true,"bounds_m":[-1e-9,3.0]}"#);
        let lit = Answer { lit: Some(0.25), ..answer };
        assert!(lit.json().ends_with(r#","lit":0.25}"#) && lit.text().contains("25.0 %"));
    }
}
