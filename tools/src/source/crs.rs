//! What a coordinate reference system says: body, horizontal part, vertical reference.

use gdal::spatial_ref::{AxisMappingStrategy, SpatialRef};
use relief_formats::body::Body;

use super::quiet;
use relief_front::error::ToolError;

/// What the CRS says that heights are measured from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum VerticalCrs {
    /// Nothing: a horizontal CRS.
    Unsaid,
    Ellipsoidal,
    Egm96,
    /// A reference this tool has no grid for, by name.
    Other(String),
}

/// A usable CRS: geographic or projected.
#[derive(Clone, Debug)]
pub(crate) struct Crs {
    /// The horizontal part.
    pub wkt: String,
    /// `EPSG:4326`, or the name where there is no authority.
    pub short: String,
    pub geographic: bool,
    pub a_m: f64,
    pub b_m: f64,
    pub vertical: VerticalCrs,
    /// Metres per unit of the vertical axis, where the CRS says one.
    pub vertical_unit_m: Option<f64>,
}

impl Crs {
    /// Reads the CRS of the input `path`; `None` where it has none.
    ///
    /// # Errors
    /// [`ToolError::Source`] when there is one that cannot place pixels on a body.
    pub fn read(path: &str, dataset: &gdal::Dataset) -> Result<Option<Self>, ToolError> {
        let Ok(full) = dataset.spatial_ref() else {
            quiet::drain();
            return Ok(None);
        };
        let wkt = full.to_wkt().map_err(|error| unusable(path, &quiet::explain(&error)))?;
        if wkt.is_empty() {
            return Ok(None);
        }
        Self::from_wkt(path, &wkt).map(Some)
    }

    /// Reads a CRS from its text (WKT 1 or 2).
    pub fn from_wkt(path: &str, wkt: &str) -> Result<Self, ToolError> {
        let parts = compound_parts(wkt);
        let horizontal = parts.as_ref().map_or(wkt, |(horizontal, _)| *horizontal);
        let srs = traditional(horizontal).map_err(|error| unusable(path, &quiet::explain(&error)))?;
        if !(srs.is_geographic() || srs.is_projected() || srs.is_derived_geographic()) {
            let name = srs.name().unwrap_or_default();
            return Err(unusable(path, &format!("the CRS {name:?} is neither geographic nor projected")));
        }
        let axes = srs.semi_major().and_then(|a| Ok((a, srs.semi_minor()?)));
        let (a_m, b_m) = axes.map_err(|error| unusable(path, &quiet::explain(&error)))?;
        let vertical = match &parts {
            Some((_, vertical)) => named_vertical(vertical),
            None if srs.axes_count() == 3 => VerticalCrs::Ellipsoidal,
            None => VerticalCrs::Unsaid,
        };
        let vertical_unit_m = parts.is_some().then(|| {
            let whole = SpatialRef::from_wkt(wkt).ok()?;
            whole.get_attr_value("VERT_CS|UNIT", 1).ok()??.parse().ok()
        });
        quiet::drain();
        Ok(Self {
            wkt: horizontal.to_owned(),
            short: srs.authority().ok().or_else(|| srs.name()).unwrap_or_else(|| "unnamed".into()),
            geographic: srs.is_geographic() && !srs.is_derived_geographic(),
            a_m,
            // GDAL computes it from the flattening; micrometres are beyond any datum.
            b_m: (b_m * 1e6).round() / 1e6,
            vertical,
            vertical_unit_m: vertical_unit_m.flatten(),
        })
    }

    /// The body this CRS's ellipsoid belongs to.
    pub fn body(&self) -> Body {
        let near = |value: f64, of: f64, within: f64| (value - of).abs() <= within * of;
        // Datums of one body differ by parts in 1e4; the bodies themselves by much more.
        if near(self.a_m, 6_378_137.0, 0.003) {
            Body::earth()
        } else if near(self.a_m, 1_737_400.0, 0.002) {
            Body::moon()
        } else if near(self.a_m, 3_396_190.0, 0.002) {
            Body::mars()
        } else {
            Body::Ellipsoid { name: format!("{},{}", self.a_m, self.b_m), a_m: self.a_m, b_m: self.b_m }
        }
    }
}

/// A CRS whose coordinates come as x or longitude first, whatever its authority says.
pub(crate) fn traditional(wkt: &str) -> gdal::errors::Result<SpatialRef> {
    let mut srs = SpatialRef::from_definition(wkt)?;
    srs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    Ok(srs)
}

fn unusable(path: &str, what: &str) -> ToolError {
    ToolError::source(
        path,
        what,
        "the CRS is geographic or projected, on a body with known axes",
        "assign the right CRS (gdal_edit.py -a_srs ...), or give --body and --bounds",
    )
}

/// The horizontal and the vertical part of a compound CRS.
fn compound_parts(wkt: &str) -> Option<(&str, &str)> {
    let open = wkt.find('[')?;
    let keyword = wkt[..open].trim();
    if !matches!(keyword, "COMPD_CS" | "COMPOUNDCRS") {
        return None;
    }
    let parts = children(&wkt[open + 1..]);
    Some((parts.get(1)?, parts.get(2)?))
}

/// The comma-separated members of a WKT node whose `[` has just been passed.
fn children(text: &str) -> Vec<&str> {
    let (mut depth, mut quoted, mut start, mut members) = (0, false, 0, Vec::new());
    for (at, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '[' => depth += 1,
            ']' if depth == 0 => {
                members.push(text[start..at].trim());
                break;
            }
            ']' => depth -= 1,
            ',' if depth == 0 => {
                members.push(text[start..at].trim());
                start = at + 1;
            }
            _ => {}
        }
    }
    members
}

fn named_vertical(wkt: &str) -> VerticalCrs {
    let name = wkt.split('"').nth(1).unwrap_or("unnamed").to_owned();
    let lower = name.to_ascii_lowercase();
    if lower.contains("egm96") {
        VerticalCrs::Egm96
    } else if lower.contains("ellipsoid") || wkt.contains(",2002") {
        VerticalCrs::Ellipsoidal
    } else {
        VerticalCrs::Other(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crs(definition: &str) -> Crs {
        quiet::set_up();
        let wkt = SpatialRef::from_definition(definition).unwrap().to_wkt().unwrap();
        Crs::from_wkt("t", &wkt).unwrap()
    }

    #[test]
    fn vertical_references() {
        assert_eq!(crs("EPSG:4326").vertical, VerticalCrs::Unsaid);
        assert_eq!(crs("EPSG:4979").vertical, VerticalCrs::Ellipsoidal);
        assert_eq!(crs("EPSG:4326+5773").vertical, VerticalCrs::Egm96);
        let feet = crs("EPSG:26915+6360");
        assert_eq!(feet.vertical, VerticalCrs::Other("NAVD88 height (ftUS)".into()));
        assert!((feet.vertical_unit_m.unwrap() - 0.304_800_6).abs() < 1e-6);
        assert!(!feet.geographic && feet.wkt.starts_with("PROJCS"));
    }

    #[test]
    fn bodies() {
        assert_eq!(crs("EPSG:26915").body(), Body::earth());
        assert_eq!(crs("+proj=longlat +R=1737400 +no_defs").body(), Body::moon());
        assert_eq!(crs("+proj=longlat +R=3396190 +no_defs").body(), Body::mars());
        let vesta = crs("+proj=longlat +a=289000 +b=229000 +no_defs").body();
        assert_eq!(vesta, Body::Ellipsoid { name: "289000,229000".into(), a_m: 289_000.0, b_m: 229_000.0 });
    }

    #[test]
    fn local_systems_are_refused() {
        quiet::set_up();
        let wkt = r#"LOCAL_CS["site",UNIT["metre",1]]"#;
        assert!(Crs::from_wkt("t", wkt).unwrap_err().to_string().contains("neither geographic nor projected"));
    }
}
