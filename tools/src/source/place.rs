//! How a raster on a globe is sampled: along its axes, or through its projection.

use relief_formats::body::Body;

use super::Mapping;
use super::georef::Georef;
use super::options::SourceOptions;
use super::quiet;
use crate::resample::axis::Axis;
use crate::resample::cylindrical::{Rows, straighten};
use crate::resample::projection::{Projection, coincide, geographic_part};
use relief_front::error::ToolError;

/// The longitude and latitude that nodes on Earth have.
const WGS84: &str = "EPSG:4326";

/// A raster's mapping, and the spacing of its samples in degrees at the equator.
///
/// # Errors
/// [`ToolError::Source`] when its coordinates cannot be degrees, or PROJ cannot use its CRS.
pub(super) fn on_globe(
    path: &str,
    size: (usize, usize),
    georef: &Georef,
    body: &Body,
    options: &SourceOptions,
) -> Result<(Mapping, f64), ToolError> {
    // A body the user names takes longitude and latitude as they are.
    let datum_matters = *body == Body::earth() && options.body.is_none();
    let transform = &georef.transform;
    let systems = match &georef.crs {
        None => None,
        Some(crs) if crs.geographic && !datum_matters => None,
        Some(crs) if crs.geographic => {
            let same = crs.short == WGS84 || coincide(WGS84, &crs.wkt, transform, size);
            (!same).then(|| (WGS84.to_owned(), crs.wkt.clone()))
        }
        Some(crs) if datum_matters => Some((WGS84.to_owned(), crs.wkt.clone())),
        Some(crs) => {
            let nodes = geographic_part(&crs.wkt).map_err(|error| {
                ToolError::source(
                    path,
                    quiet::explain(&error),
                    "a projected CRS stands on a geographic one",
                    "check the CRS with gdalinfo",
                )
            })?;
            Some((nodes, crs.wkt.clone()))
        }
    };
    let geographic = georef.crs.as_ref().is_none_or(|crs| crs.geographic);
    if geographic {
        check_degrees(path, size, transform)?;
    }
    if geographic && systems.is_none() && georef.axis_aligned() {
        let (columns, rows) = lon_lat_axes(size, georef);
        let spacing_deg = columns.step_deg.abs().min(rows.step_deg.abs());
        return Ok((Mapping::LonLat { columns, rows: Rows::Even(rows) }, spacing_deg));
    }
    let projection = Projection::new(path, size, transform, systems, geographic)?;
    let spacing_deg = projection.spacing_deg;
    let straight = if georef.axis_aligned() { straighten(projection, size)? } else { Err(projection) };
    let mapping = match straight {
        Ok((columns, rows)) => Mapping::LonLat { columns, rows },
        Err(projection) => Mapping::Projected(Box::new(projection)),
    };
    Ok((mapping, spacing_deg))
}

/// The axes of a raster whose columns are meridians and whose rows are parallels.
pub(super) fn lon_lat_axes((nx, ny): (usize, usize), georef: &Georef) -> (Axis, Axis) {
    let [x0, dx, _, y0, _, dy] = georef.transform;
    let extent = |n: usize| {
        let last = n as f64 - 1.0;
        if georef.node_bounds { [0.0, last] } else { [-0.5, last + 0.5] }
    };
    let columns = Axis::longitude(nx, x0 + 0.5 * dx, dx, extent(nx));
    let rows = Axis::latitude(ny, y0 + 0.5 * dy, dy, extent(ny), columns.period.is_some());
    (columns, rows)
}

fn check_degrees(path: &str, (nx, ny): (usize, usize), t: &[f64; 6]) -> Result<(), ToolError> {
    let (x, y) = (t[0] + 0.5 * nx as f64 * t[1], t[3] + 0.5 * ny as f64 * t[5]);
    let half_px = 0.51 * (t[5].abs() + t[4].abs());
    let lats = [t[3], t[3] + nx as f64 * t[4], t[3] + ny as f64 * t[5]];
    if x.abs() <= 720.0 && y.abs() <= 90.0 && lats.iter().all(|lat| lat.abs() <= 90.0 + half_px) {
        return Ok(());
    }
    Err(ToolError::source(
        path,
        format!("its rows reach latitude {} and {}, its middle longitude {x}", lats[0], lats[2]),
        "latitudes lie within 90 degrees of the equator",
        "the coordinates are not degrees: assign the right CRS (gdal_edit.py -a_srs ...)",
    ))
}
