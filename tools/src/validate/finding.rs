//! Broken rules as they are collected: every one counted, the first hundred of each kept.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use relief_formats::body::Body;
use relief_formats::grid::Grid;
use relief_formats::tile::TileKey;
use serde::Serialize;

use super::check::{Check, Level, Severity};

/// Where a rule is broken; what does not apply is absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Place {
    /// First byte concerned, from the start of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub byte: Option<u64>,
    /// Level, 0 the finest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// Column and row of the tile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tile: Option<[u32; 2]>,
    /// Longitude of the node (or the tile's middle), degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Geodetic latitude, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    /// A plane's easting in units of its CRS, in place of the longitude.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<f64>,
    /// A plane's northing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<f64>,
}

impl Place {
    /// A byte of the file.
    #[must_use]
    pub fn byte(at: u64) -> Self {
        Self { byte: Some(at), ..Self::default() }
    }

    /// Node (i, j) of a tile, counted from its south-west corner.
    #[must_use]
    pub fn node(body: &Body, grid: &Grid, key: TileKey, (i, j): (usize, usize)) -> Self {
        let at = |tile: u32, node: usize| i64::from(tile) * 256 + node as i64;
        let (column, row) = (at(key.x, i), at(key.y, j));
        let place = Self { level: Some(key.level), tile: Some([key.x, key.y]), ..Self::default() };
        match *body {
            Body::Ellipsoid { .. } => {
                let column = column.rem_euclid(i64::from(grid.width(key.level)));
                place.with([grid.lon_deg(key.level, column), grid.lat_deg(key.level, row)], false)
            }
            Body::Plane { x0, y0, dx, dy, .. } => {
                let scale = f64::from(1u32 << key.level);
                place.with([x0 + column as f64 * scale * dx, y0 + row as f64 * scale * dy], true)
            }
        }
    }

    /// The middle of a tile.
    #[must_use]
    pub fn tile(body: &Body, grid: &Grid, key: TileKey) -> Self {
        Self::node(body, grid, key, (128, 128))
    }

    /// A place on the map: longitude and latitude in degrees, or a plane's x and y.
    #[must_use]
    pub fn with(self, at: [f64; 2], plane: bool) -> Self {
        if plane {
            Self { x: Some(at[0]), y: Some(at[1]), ..self }
        } else {
            Self { lon_deg: Some(at[0]), lat_deg: Some(at[1]), ..self }
        }
    }

    /// Coarsest level first, as tiles lie in a file.
    fn order(&self) -> (u64, std::cmp::Reverse<u32>, u64, [u64; 2]) {
        let morton = self.tile.map_or(0, |[x, y]| TileKey::new(0, x, y).morton());
        let bits = |v: Option<f64>| v.map_or(0, |v| (v.to_bits() ^ (1 << 63)).wrapping_add(0));
        let map = [bits(self.lat_deg.or(self.y)), bits(self.lon_deg.or(self.x))];
        (self.byte.unwrap_or(0), std::cmp::Reverse(self.level.unwrap_or(u32::MAX)), morton, map)
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut parts = Vec::new();
        if let Some(byte) = self.byte {
            parts.push(format!("byte {byte}"));
        }
        if let Some(level) = self.level {
            parts.push(format!("level {level}"));
        }
        if let Some([x, y]) = self.tile {
            parts.push(format!("tile ({x}, {y})"));
        }
        if let (Some(lon), Some(lat)) = (self.lon_deg, self.lat_deg) {
            parts.push(format!("lon {lon:.6} lat {lat:.6}"));
        }
        if let (Some(x), Some(y)) = (self.x, self.y) {
            parts.push(format!("x {x} y {y}"));
        }
        f.write_str(&parts.join(" "))
    }
}

/// One broken rule.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The rule's stable code.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What was found, with its values.
    pub what: String,
    /// Where.
    #[serde(rename = "where")]
    pub place: Place,
    #[serde(skip)]
    pub(super) check: Check,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let place = self.place.to_string();
        let gap = if place.is_empty() { "" } else { ": " };
        write!(f, "{} {severity}: {}{gap}{place}", self.code, self.what)
    }
}

/// A collection that any thread adds to. What is kept does not depend on the order of adding.
#[derive(Debug)]
pub struct Findings {
    kept: usize,
    by_check: Mutex<BTreeMap<Check, (u64, Vec<Finding>)>>,
}

impl Findings {
    /// A collection that keeps the first `kept` findings of each rule and counts all.
    #[must_use]
    pub fn new(kept: usize) -> Self {
        Self { kept, by_check: Mutex::default() }
    }

    /// Adds one.
    pub fn add(&self, check: Check, place: Place, what: impl Into<String>) {
        let finding = Finding { code: check.code(), severity: check.severity(), what: what.into(), place, check };
        let mut by_check = self.by_check.lock().unwrap_or_else(PoisonError::into_inner);
        let (count, list) = by_check.entry(check).or_default();
        *count += 1;
        list.push(finding);
        if list.len() > 2 * self.kept {
            sort(list);
            list.truncate(self.kept);
        }
    }

    /// True when a rule of this level is broken and that is an error.
    #[must_use]
    pub fn any_error(&self, level: Level) -> bool {
        let by_check = self.by_check.lock().unwrap_or_else(PoisonError::into_inner);
        by_check.keys().any(|check| check.level() == level && check.severity() == Severity::Error)
    }

    /// True without findings.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.by_check.lock().unwrap_or_else(PoisonError::into_inner).is_empty()
    }

    /// The findings in the order of codes and places, and the number of each code.
    #[must_use]
    pub fn finish(self) -> (Vec<Finding>, BTreeMap<&'static str, u64>) {
        let mut counts = BTreeMap::new();
        let mut all = Vec::new();
        for (check, (count, mut list)) in self.by_check.into_inner().unwrap_or_else(PoisonError::into_inner) {
            counts.insert(check.code(), count);
            sort(&mut list);
            list.truncate(self.kept);
            all.append(&mut list);
        }
        (all, counts)
    }
}

fn sort(list: &mut [Finding]) {
    list.sort_by(|a, b| a.place.order().cmp(&b.place.order()).then_with(|| a.what.cmp(&b.what)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_counted_and_the_first_kept() {
        let findings = Findings::new(3);
        for k in (0..20).rev() {
            findings.add(Check::Padding, Place::byte(k), format!("byte {k}"));
        }
        assert!(findings.any_error(Level::Structure) && !findings.any_error(Level::Checksum));
        let (list, counts) = findings.finish();
        assert_eq!(counts[Check::Padding.code()], 20);
        assert_eq!(list.iter().map(|f| f.place.byte.unwrap()).collect::<Vec<_>>(), [0, 1, 2]);
    }

    #[test]
    fn places_are_on_the_map() {
        let grid = Grid::new(9, false);
        let place = Place::node(&Body::earth(), &grid, TileKey::new(0, 3, 1), (256, 256));
        assert_eq!((place.lon_deg, place.lat_deg), (Some(-180.0), Some(90.0)));
        assert_eq!(place.to_string(), "level 0 tile (3, 1) lon -180.000000 lat 90.000000");
        let body = Body::Plane { crs_wkt: String::new(), x0: 10.0, y0: 20.0, dx: 2.0, dy: 3.0 };
        let place = Place::node(&body, &Grid::new(9, true), TileKey::new(1, 0, 0), (1, 2));
        assert_eq!((place.x, place.y, place.lon_deg), (Some(14.0), Some(32.0), None));
    }
}
