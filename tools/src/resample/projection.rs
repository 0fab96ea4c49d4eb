//! From longitude and latitude to the pixels of a projected, rotated or otherwise bent raster.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::atomic::{AtomicU64, Ordering};

use gdal::spatial_ref::{CoordTransform, SpatialRef};

use super::bounds::{Bounds, bounds};
use crate::source::crs::traditional;
use crate::source::quiet;
use relief_front::error::ToolError;

/// A raster's place, by its affine and, unless that gives longitude and latitude, its CRS.
#[derive(Debug)]
pub(crate) struct Projection {
    id: u64,
    path: String,
    /// WKT of the nodes' longitude and latitude, and of the raster's coordinates.
    systems: Option<(String, String)>,
    /// Map coordinates to pixel corners, as GDAL's affine.
    inverse: [f64; 6],
    /// Longitudes are brought to within half a turn of this one, where x is a longitude.
    middle_deg: Option<f64>,
    pub bounds: Bounds,
    /// Distance between samples in the middle of the raster, degrees of a great circle.
    pub spacing_deg: f64,
}

/// A projection ready for use on this thread.
pub(crate) struct Transformer<'a> {
    projection: &'a Projection,
    transform: Option<Rc<CoordTransform>>,
}

static NEXT_ID: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static TRANSFORMS: RefCell<HashMap<u64, Rc<CoordTransform>>> = RefCell::new(HashMap::new());
}

impl Projection {
    /// Places a raster of `size` pixels. `systems` as in the type; `geographic` where x and y are
    /// degrees of longitude and latitude.
    ///
    /// # Errors
    /// [`ToolError::Source`] when PROJ knows no way between the systems, or no pixel lies on the body.
    pub fn new(
        path: &str,
        size: (usize, usize),
        transform: &[f64; 6],
        systems: Option<(String, String)>,
        geographic: bool,
    ) -> Result<Self, ToolError> {
        let corner = |c: f64, r: f64| forward(transform, c, r);
        let (w, h) = (size.0 as f64, size.1 as f64);
        let mut projection = Self {
            id: NEXT_ID.fetch_add(1, Ordering::Relaxed),
            path: path.to_owned(),
            systems,
            inverse: invert(transform),
            middle_deg: geographic.then(|| corner(0.5 * w, 0.5 * h)[0]),
            bounds: Bounds { west_deg: -180.0, span_deg: 360.0, south_deg: -90.0, north_deg: 90.0 },
            spacing_deg: 0.0,
        };
        let back = match &projection.systems {
            Some((nodes, own)) => Some(projection.connect(own, nodes)?),
            None => None,
        };
        let lon_lat = |c: f64, r: f64| -> Option<[f64; 2]> {
            let [x, y] = corner(c, r);
            match &back {
                Some(back) => one(back, x, y),
                None => Some([x, y]),
            }
        };
        let spacing = [(0.5, 0.5), (0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)]
            .into_iter()
            .find_map(|(fx, fy)| spacing_deg(&lon_lat, fx * w, fy * h));
        projection.spacing_deg = spacing.ok_or_else(|| {
            ToolError::source(
                path,
                "none of the pixels tried lies on the body",
                "the CRS turns pixels into longitudes and latitudes",
                "check the CRS and the geotransform with gdalinfo",
            )
        })?;
        let transformer = projection.transformer()?;
        let bounds = bounds(&lon_lat, &transformer, size);
        drop(transformer);
        projection.bounds = bounds;
        quiet::drain();
        Ok(projection)
    }

    fn connect(&self, from: &str, to: &str) -> Result<CoordTransform, ToolError> {
        let made = traditional(from).and_then(|from| CoordTransform::new(&from, &traditional(to)?));
        made.map_err(|error| {
            ToolError::source(
                &self.path,
                format!("PROJ finds no way to its CRS: {}", quiet::explain(&error)),
                "there is a transformation between the body's longitude and latitude and the CRS",
                "say the body with --body, or reproject the file with gdalwarp",
            )
        })
    }

    /// Longitude and latitude, degrees, of pixel coordinates (corner of the first pixel at 0, 0);
    /// none where the CRS does not reach.
    ///
    /// # Errors
    /// As [`Projection::new`].
    pub fn lon_lats(&self, pixels: &[[f64; 2]]) -> Result<Vec<Option<[f64; 2]>>, ToolError> {
        let back = match &self.systems {
            Some((nodes, own)) => Some(self.connect(own, nodes)?),
            None => None,
        };
        let transform = invert(&self.inverse);
        let found = pixels.iter().map(|&[c, r]| {
            let [x, y] = forward(&transform, c, r);
            match &back {
                Some(back) => one(back, x, y),
                None => Some([x, y]),
            }
        });
        let found = found.collect();
        quiet::drain();
        Ok(found)
    }

    /// This thread's transformer.
    ///
    /// # Errors
    /// As [`Projection::new`].
    pub fn transformer(&self) -> Result<Transformer<'_>, ToolError> {
        let Some((nodes, own)) = &self.systems else {
            return Ok(Transformer { projection: self, transform: None });
        };
        let kept = TRANSFORMS.with_borrow(|kept| kept.get(&self.id).cloned());
        let transform = match kept {
            Some(transform) => transform,
            None => {
                let transform = Rc::new(self.connect(nodes, own)?);
                TRANSFORMS.with_borrow_mut(|kept| kept.insert(self.id, transform.clone()));
                transform
            }
        };
        Ok(Transformer { projection: self, transform: Some(transform) })
    }
}

impl Transformer<'_> {
    /// Pixel coordinates (corner of the first pixel at 0, 0); none where the CRS does not reach.
    pub fn pixel(&self, lon_deg: f64, lat_deg: f64) -> Option<[f64; 2]> {
        let [mut x, y] = match &self.transform {
            Some(transform) => one(transform, lon_deg, lat_deg)?,
            None => [lon_deg, lat_deg],
        };
        if let Some(middle_deg) = self.projection.middle_deg {
            x -= 360.0 * ((x - middle_deg) / 360.0).round();
        }
        let pixel = forward(&self.projection.inverse, x, y);
        (pixel[0].is_finite() && pixel[1].is_finite()).then_some(pixel)
    }
}

/// True when the two systems give the same longitude and latitude all over a raster.
pub(crate) fn coincide(nodes: &str, own: &str, transform: &[f64; 6], size: (usize, usize)) -> bool {
    let Ok(change) = traditional(nodes).and_then(|nodes| CoordTransform::new(&nodes, &traditional(own)?)) else {
        return false;
    };
    let same = (0..25).all(|at| {
        let (c, r) = (size.0 as f64 * f64::from(at % 5) / 4.0, size.1 as f64 * f64::from(at / 5) / 4.0);
        let [x, y] = forward(transform, c, r);
        let (x, y) = (x - 360.0 * (x / 360.0).round(), y.clamp(-90.0, 90.0));
        one(&change, x, y).is_some_and(|[lon, lat]| {
            let turn = (lon - x).abs();
            (turn < 1e-9 || (turn - 360.0).abs() < 1e-9) && (lat - y).abs() < 1e-9
        })
    });
    quiet::drain();
    same
}

/// WKT of the longitude and latitude that a CRS is built on.
pub(crate) fn geographic_part(wkt: &str) -> gdal::errors::Result<String> {
    let srs: SpatialRef = traditional(wkt)?;
    srs.geog_cs()?.to_wkt()
}

/// Transforms a single point. PROJ may choose among operations by the mean of the points given
/// at once: point by point the choice depends on the position alone.
fn one(transform: &CoordTransform, x: f64, y: f64) -> Option<[f64; 2]> {
    let (mut xs, mut ys) = ([x], [y]);
    let done = transform.transform_coords(&mut xs, &mut ys, &mut []);
    (done.is_ok() && xs[0].is_finite() && ys[0].is_finite()).then_some([xs[0], ys[0]])
}

fn forward(t: &[f64; 6], c: f64, r: f64) -> [f64; 2] {
    [t[0] + c * t[1] + r * t[2], t[3] + c * t[4] + r * t[5]]
}

fn invert(t: &[f64; 6]) -> [f64; 6] {
    let determinant = t[1] * t[5] - t[2] * t[4];
    let [a, b, c, d] = [t[5] / determinant, -t[2] / determinant, -t[4] / determinant, t[1] / determinant];
    [-a * t[0] - b * t[3], a, b, -c * t[0] - d * t[3], c, d]
}

/// The smaller of the distances to the next column and to the next row at a pixel.
fn spacing_deg(lon_lat: &dyn Fn(f64, f64) -> Option<[f64; 2]>, c: f64, r: f64) -> Option<f64> {
    let here = lon_lat(c, r)?;
    let distance = |to: [f64; 2]| {
        // On the unit sphere, by the chord: near a pole longitudes tell nothing.
        let point = |[lon, lat]: [f64; 2]| {
            let (lon, lat) = (lon.to_radians(), lat.to_radians());
            [lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin()]
        };
        let squares = point(here).into_iter().zip(point(to)).map(|(a, b)| (a - b) * (a - b));
        (0.5 * squares.sum::<f64>().sqrt()).asin().to_degrees() * 2.0
    };
    let spacing = distance(lon_lat(c + 1.0, r)?).min(distance(lon_lat(c, r + 1.0)?));
    (spacing > 0.0 && spacing.is_finite()).then_some(spacing)
}
