//! Where a raster's pixels lie: from the file, or from the user's bounds.

use relief_formats::body::Body;

use super::crs::Crs;
use super::options::{BodyChoice, Registration, SourceOptions};
use super::quiet;
use relief_front::error::ToolError;

/// Pixel corners to map coordinates, and what those coordinates are.
#[derive(Clone, Debug)]
pub(crate) struct Georef {
    /// GDAL's affine: x = t0 + c t1 + r t2, y = t3 + c t4 + r t5 for pixel corner (c, r).
    pub transform: [f64; 6],
    /// The CRS; none where coordinates are the body's own longitude and latitude in degrees.
    pub crs: Option<Crs>,
    /// Samples lie on the outer bounds: the outermost half pixels say nothing.
    pub node_bounds: bool,
    /// From the user's bounds, not from the file.
    pub from_bounds: bool,
}

impl Georef {
    /// Reads a GDAL dataset's georeference, or makes one from the options.
    ///
    /// # Errors
    /// [`ToolError::Source`] for a CRS that is missing or unusable, and for a transform without area.
    pub fn of_dataset(path: &str, dataset: &gdal::Dataset, options: &SourceOptions) -> Result<Self, ToolError> {
        let size = dataset.raster_size();
        let transform = dataset.geo_transform();
        let crs = Crs::read(path, dataset)?;
        quiet::drain();
        let Ok(transform) = transform else {
            return Self::of_bounds(path, size, options);
        };
        let [_, a, b, _, c, d] = transform;
        let determinant = a * d - b * c;
        if !transform.iter().all(|value| value.is_finite()) || determinant == 0.0 {
            return Err(ToolError::source(
                path,
                format!("its geotransform is {transform:?}"),
                "pixels have an area",
                "repair it with gdal_edit.py -a_ullr, or give --bounds W,S,E,N on a copy without it",
            ));
        }
        if crs.is_none() && !matches!(options.body, Some(body) if body != BodyChoice::Plane) {
            if options.bounds.is_some() {
                return Self::of_bounds(path, size, options);
            }
            if options.body != Some(BodyChoice::Plane) {
                return Err(ToolError::source(
                    path,
                    "it has coordinates but no coordinate reference system",
                    "pixels lie at known longitudes and latitudes",
                    "assign one (gdal_edit.py -a_srs EPSG:...), or say --body earth if they are degrees",
                ));
            }
        }
        Ok(Self { transform, crs, node_bounds: false, from_bounds: false })
    }

    /// The georeference that `--bounds` and `--registration` describe; row 0 is north.
    ///
    /// # Errors
    /// [`ToolError::Source`] without bounds, [`ToolError::Usage`] for bounds without area.
    pub fn of_bounds(path: &str, (nx, ny): (usize, usize), options: &SourceOptions) -> Result<Self, ToolError> {
        let Some(bounds) = options.bounds else {
            return Err(ToolError::source(
                path,
                "it has no georeference",
                "pixels lie at known longitudes and latitudes",
                "give --bounds W,S,E,N (whole globe: --bounds=-180,-90,180,90) and --registration",
            ));
        };
        let [west, south, east, north] = bounds;
        let plane = options.body == Some(BodyChoice::Plane);
        let in_range = plane || (south >= -90.0 && north <= 90.0 && east - west <= 360.0);
        if !bounds.iter().all(|b| b.is_finite()) || west >= east || south >= north || !in_range {
            return Err(ToolError::usage(
                format!("--bounds {west},{south},{east},{north}"),
                "west < east <= west + 360 and -90 <= south < north <= 90",
                "across the antimeridian let east exceed 180, as in --bounds 172,-24,190,-10",
            ));
        }
        let node = options.registration == Some(Registration::Node);
        let (intervals_x, intervals_y) = if node { (nx.max(2) - 1, ny.max(2) - 1) } else { (nx, ny) };
        let (dx, dy) = ((east - west) / intervals_x as f64, (north - south) / intervals_y as f64);
        let half = if node { 0.5 } else { 0.0 };
        let transform = [west - half * dx, dx, 0.0, north + half * dy, 0.0, -dy];
        Ok(Self { transform, crs: None, node_bounds: node, from_bounds: true })
    }

    /// True when rows run along parallels of x and columns along y.
    pub fn axis_aligned(&self) -> bool {
        self.transform[2] == 0.0 && self.transform[4] == 0.0
    }

    /// The body: the user's, else the CRS's, else Earth. The plane is not one of them.
    pub fn body(&self, options: &SourceOptions) -> Body {
        match options.body {
            Some(BodyChoice::Earth) => Body::earth(),
            Some(BodyChoice::Moon) => Body::moon(),
            Some(BodyChoice::Mars) => Body::mars(),
            Some(BodyChoice::Axes(a_m, b_m)) => Body::Ellipsoid { name: format!("{a_m},{b_m}"), a_m, b_m },
            Some(BodyChoice::Plane) | None => self.crs.as_ref().map_or_else(Body::earth, Crs::body),
        }
    }

    /// What a record says about it.
    pub fn describe(&self) -> String {
        match &self.crs {
            Some(crs) => crs.short.clone(),
            None if self.from_bounds => "given bounds".into(),
            None => "given body".into(),
        }
    }
}
