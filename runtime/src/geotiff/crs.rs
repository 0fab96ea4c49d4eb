//! GeoKeys of a body's CRS.
//!
//! A globe on WGS-84 is EPSG:4326, another one a geographic CRS by its semi-axes. A plane's WKT is
//! named by its EPSG code where it has one. Otherwise the keys hold its name alone, and its WKT
//! goes into a file beside the raster, NAME.tif.aux.xml, which GDAL reads first.

use relief_formats::body::Body;

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const GEODETIC_CRS: u16 = 2048;
const GEODETIC_CITATION: u16 = 2049;
const GEODETIC_DATUM: u16 = 2050;
const ANGULAR_UNITS: u16 = 2054;
const ELLIPSOID: u16 = 2056;
const SEMI_MAJOR: u16 = 2057;
const SEMI_MINOR: u16 = 2058;
const PROJECTED_CRS: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;

const PROJECTED: u16 = 1;
const GEOGRAPHIC: u16 = 2;
const PIXEL_IS_AREA: u16 = 1;
const USER_DEFINED: u16 = 32767;
const DEGREE: u16 = 9102;
const WGS84: u16 = 4326;

const DOUBLES_TAG: u16 = 34736;
const ASCII_TAG: u16 = 34737;

/// Keys in ascending order, with the parameters that do not fit them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GeoKeys {
    keys: Vec<[u16; 4]>,
    doubles: Vec<f64>,
    ascii: String,
}

impl GeoKeys {
    /// The keys of a body; for a plane without CRS only that pixels are areas.
    #[must_use]
    pub fn of(body: &Body) -> Self {
        let mut keys = Self::default();
        match body {
            Body::Ellipsoid { name, a_m, b_m } => keys.globe(name, [*a_m, *b_m]),
            Body::Plane { crs_wkt, .. } => keys.plane(crs_wkt.trim()),
        }
        keys
    }

    fn globe(&mut self, name: &str, axes_m: [f64; 2]) {
        self.code(MODEL_TYPE, GEOGRAPHIC);
        self.code(RASTER_TYPE, PIXEL_IS_AREA);
        let earth = Body::earth();
        if matches!(earth, Body::Ellipsoid { a_m, b_m, .. } if (a_m - axes_m[0]).abs() < 1e-3 && (b_m - axes_m[1]).abs() < 1e-3)
        {
            self.code(GEODETIC_CRS, WGS84);
            return;
        }
        self.code(GEODETIC_CRS, USER_DEFINED);
        let name = ascii(name);
        // GDAL's words for the parts of a user-defined CRS.
        self.text(
            GEODETIC_CITATION,
            &format!("GCS Name = {name}|Datum = {name}|Ellipsoid = {name}|Primem = Reference meridian|"),
        );
        self.code(GEODETIC_DATUM, USER_DEFINED);
        self.code(ANGULAR_UNITS, DEGREE);
        self.code(ELLIPSOID, USER_DEFINED);
        self.double(SEMI_MAJOR, axes_m[0]);
        self.double(SEMI_MINOR, axes_m[1]);
    }

    fn plane(&mut self, wkt: &str) {
        let projected = ["PROJCS", "PROJCRS", "BOUNDCRS"].iter().any(|kind| wkt.starts_with(kind));
        let geographic = ["GEOGCS", "GEOGCRS", "GEODCRS"].iter().any(|kind| wkt.starts_with(kind));
        match epsg_code(wkt) {
            Some(code) if projected || geographic => {
                self.code(MODEL_TYPE, if projected { PROJECTED } else { GEOGRAPHIC });
                self.code(RASTER_TYPE, PIXEL_IS_AREA);
                self.code(if projected { PROJECTED_CRS } else { GEODETIC_CRS }, code);
            }
            _ if projected => {
                self.code(MODEL_TYPE, PROJECTED);
                self.code(RASTER_TYPE, PIXEL_IS_AREA);
                self.code(PROJECTED_CRS, USER_DEFINED);
                self.text(PROJECTED_CITATION, &format!("{}|", ascii(name_of(wkt))));
            }
            _ if geographic => {
                self.code(MODEL_TYPE, GEOGRAPHIC);
                self.code(RASTER_TYPE, PIXEL_IS_AREA);
                self.code(GEODETIC_CRS, USER_DEFINED);
                self.text(GEODETIC_CITATION, &format!("{}|", ascii(name_of(wkt))));
            }
            _ => self.code(RASTER_TYPE, PIXEL_IS_AREA),
        }
    }

    fn code(&mut self, key: u16, value: u16) {
        self.keys.push([key, 0, 1, value]);
    }

    fn double(&mut self, key: u16, value: f64) {
        self.keys.push([key, DOUBLES_TAG, 1, self.doubles.len() as u16]);
        self.doubles.push(value);
    }

    fn text(&mut self, key: u16, text: &str) {
        self.keys.push([key, ASCII_TAG, text.len() as u16, self.ascii.len() as u16]);
        self.ascii.push_str(text);
    }

    /// The directory: version 1, revision 1.1, number of keys, then four numbers a key.
    #[must_use]
    pub fn directory(&self) -> Vec<u16> {
        let head = [1, 1, 1, self.keys.len() as u16];
        [head].iter().chain(&self.keys).flatten().copied().collect()
    }

    /// Parameters in f64.
    #[must_use]
    pub fn doubles(&self) -> &[f64] {
        &self.doubles
    }

    /// Parameters in ASCII.
    #[must_use]
    pub fn ascii(&self) -> &str {
        &self.ascii
    }
}

/// GDAL's file beside a raster, NAME.tif.aux.xml, for a CRS that GeoKeys do not name in full.
#[must_use]
pub fn sidecar(body: &Body) -> Option<String> {
    let Body::Plane { crs_wkt, .. } = body else { return None };
    let wkt = crs_wkt.trim();
    if !wkt.contains('[') || epsg_code(wkt).is_some() {
        return None;
    }
    let srs = super::escaped(wkt);
    Some(format!("<PAMDataset>\n  <SRS dataAxisToSRSAxisMapping=\"1,2\">{srs}</SRS>\n</PAMDataset>\n"))
}

/// The first quoted text of a WKT: the CRS's name.
fn name_of(wkt: &str) -> &str {
    wkt.split('"').nth(1).unwrap_or("unnamed")
}

/// The EPSG code of the outermost object: what stands directly within it as AUTHORITY (WKT 1) or
/// ID (WKT 2), or the whole text of the form EPSG:n.
fn epsg_code(wkt: &str) -> Option<u16> {
    let (mut depth, mut quoted) = (0, false);
    for (at, c) in wkt.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '[' if !quoted => {
                let word = wkt[..at].rsplit(|c: char| !c.is_ascii_alphabetic()).next()?;
                if depth == 1 && matches!(word, "AUTHORITY" | "ID") {
                    let mut parts =
                        wkt[at + 1..].split(']').next()?.split(',').map(|part| part.trim().trim_matches('"'));
                    let (name, code) = (parts.next()?, parts.next()?);
                    return if name == "EPSG" { code.parse().ok() } else { None };
                }
                depth += 1;
            }
            ']' if !quoted => depth -= 1,
            _ => {}
        }
    }
    None
}

/// TIFF's texts are ASCII, and `|` ends one.
fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii() && !c.is_ascii_control() && c != '|' { c } else { '?' }).collect()
}
