//! How long a unit of a plane's CRS is.

use relief_formats::body::Body;
use relief_formats::grid::Grid;

/// Metres of a degree of a great circle of the mean Earth (IUGG mean radius 6 371 008.8 m).
const DEGREE_M: f64 = 111_195.08;

/// Metres of one CRS unit eastwards and northwards at the middle of a plane: what its WKT says of
/// a projected CRS, degrees of a sphere for a geographic one, metres where it says nothing.
pub(super) fn metres_per_unit(body: &Body, grid: Grid) -> [f64; 2] {
    let Body::Plane { crs_wkt, y0, dy, .. } = body else { return [1.0; 2] };
    let head = crs_wkt.trim_start();
    if ["GEOGCS", "GEOGCRS", "GEODCRS"].iter().any(|kind| head.starts_with(kind)) {
        let middle_deg = y0 + dy * f64::from(grid.height(0)) / 2.0;
        let cos = middle_deg.clamp(-89.0, 89.0).to_radians().cos();
        return [DEGREE_M * cos, DEGREE_M];
    }
    [projected_unit_m(head).unwrap_or(1.0); 2]
}

/// The factor of the outermost linear unit: in WKT 1 and 2 alike the last `UNIT` that stands
/// directly within the projected CRS.
fn projected_unit_m(wkt: &str) -> Option<f64> {
    let mut depth = 0;
    let mut quoted = false;
    let mut unit = None;
    for (at, c) in wkt.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '[' if !quoted => {
                let keyword = wkt[..at].rsplit(|c: char| !c.is_ascii_alphabetic()).next()?;
                if depth == 1 && matches!(keyword, "UNIT" | "LENGTHUNIT") {
                    unit = wkt[at + 1..].split(']').next()?.split(',').nth(1)?.trim().parse().ok();
                }
                depth += 1;
            }
            ']' if !quoted => depth -= 1,
            _ => {}
        }
    }
    unit.filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(crs_wkt: &str) -> [f64; 2] {
        let body = Body::Plane { crs_wkt: crs_wkt.into(), x0: 0.0, y0: 59.0, dx: 1.0, dy: 2.0 / 256.0 };
        metres_per_unit(&body, Grid::new(8, true))
    }

    #[test]
    fn feet_degrees_and_nothing() {
        let feet = r#"PROJCS["x [ UNIT",GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]],UNIT["US survey foot",0.3048006096012192]]"#;
        assert_eq!(plane(feet), [0.304_800_609_601_219_2; 2]);
        let wkt2 = r#"PROJCRS["u",CS[Cartesian,2],AXIS["e",east,LENGTHUNIT["foot",0.3048]],LENGTHUNIT["metre",1]]"#;
        assert_eq!(plane(wkt2), [1.0; 2]);
        assert_eq!(plane(""), [1.0; 2]);
        let [east, north] = plane(r#"GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]]"#);
        assert!((east / north - 0.5).abs() < 1e-12 && (north - 111_195.08).abs() < 1e-6);
    }
}
