//! A source's own samples where they lie: what a resampled surface is judged by.

use relief_formats::body::Body;

use super::geoid::Reference;
use super::{Mapping, SourceSet};
use crate::resample::cylindrical::Rows;
use relief_front::error::ToolError;

/// One measured sample of a source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centre {
    /// Longitude in degrees; on a plane X of its CRS.
    pub x: f64,
    /// Latitude in degrees; on a plane Y of its CRS.
    pub y: f64,
    /// Height in metres, the geoid added where there is one.
    pub height_m: f64,
}

impl SourceSet {
    /// Columns and rows of a source.
    #[must_use]
    pub fn size(&self, source: usize) -> (usize, usize) {
        let raster = &self.sources[source].raster;
        (raster.width, raster.height)
    }

    /// The samples of every `every`-th row within `rows` and of every `every`-th column, those
    /// with data.
    ///
    /// # Errors
    /// [`ToolError::Source`] when the file turns out to be damaged.
    pub fn centres(&self, source: usize, rows: std::ops::Range<usize>, every: usize) -> Result<Vec<Centre>, ToolError> {
        let source = &self.sources[source];
        let columns: Vec<usize> = (0..source.raster.width).step_by(every.max(1)).collect();
        let rows: Vec<(usize, bool)> = rows.step_by(every.max(1)).map(|row| (row, false)).collect();
        let patch = source.raster.gather(&rows, &columns, None)?;
        let pixels = rows.iter().flat_map(|&(row, _)| columns.iter().map(move |&column| (column, row)));
        let places: Vec<Option<[f64; 2]>> = match &source.mapping {
            Mapping::LonLat { columns, rows: Rows::Even(rows) } => pixels
                .map(|(c, r)| {
                    Some([columns.first_deg + c as f64 * columns.step_deg, rows.first_deg + r as f64 * rows.step_deg])
                })
                .collect(),
            Mapping::Projected(projection) | Mapping::LonLat { rows: Rows::Uneven { along: projection, .. }, .. } => {
                projection.lon_lats(&pixels.map(|(c, r)| [c as f64 + 0.5, r as f64 + 0.5]).collect::<Vec<_>>())?
            }
            Mapping::Plane(place) => {
                let Body::Plane { x0, y0, dx, dy, .. } = &self.body else { return Ok(Vec::new()) };
                let (nx, ny) = (source.raster.width, source.raster.height);
                let along = |at: usize, n: usize, flip: bool| (if flip { n - 1 - at } else { at }) as f64;
                pixels
                    .map(|(c, r)| {
                        let i = place.first.0 as f64 + along(c, nx, place.flip_x);
                        let j = place.first.1 as f64 + along(r, ny, place.flip_y);
                        Some([x0 + i * dx, y0 + j * dy])
                    })
                    .collect()
            }
        };
        let centres = places.into_iter().zip(&patch.pixels).filter_map(|(place, &height)| {
            let [x, y] = place.filter(|_| !height.is_nan())?;
            let undulation_m = match &source.reference {
                Reference::Geoid(geoid) => geoid.undulation_m(x, y.clamp(-90.0, 90.0))?,
                _ => 0.0,
            };
            Some(Centre { x, y, height_m: f64::from(height) + undulation_m })
        });
        Ok(centres.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BodyChoice, SourceOptions, Vertical, open_sources};
    use relief_formats::grid::Grid;

    use super::super::NodeWindow;

    fn data(name: &str) -> String {
        format!("{}/../tests/data/{name}", env!("CARGO_MANIFEST_DIR"))
    }

    #[test]
    fn samples_lie_where_the_rasters_have_them() {
        let options = SourceOptions { vertical: Some(Vertical::AsGiven), ..SourceOptions::default() };
        let earth = open_sources(&[data("earth_etopo1_6min.tif")], &options).unwrap();
        let row = (900 - 279)..(900 - 279 + 1);
        let centres = earth.centres(0, row, 1).unwrap();
        let everest = centres.iter().max_by(|a, b| a.height_m.total_cmp(&b.height_m)).unwrap();
        assert_eq!(everest.height_m, 8266.0);
        assert!((everest.x - 87.1).abs() < 1e-6 && (everest.y - 27.9).abs() < 1e-6, "{everest:?}");
    }

    #[test]
    fn the_geoid_is_the_one_that_nodes_get() {
        let options = SourceOptions { vertical: Some(Vertical::Egm96), ..SourceOptions::default() };
        let plain = SourceOptions { vertical: Some(Vertical::AsGiven), ..SourceOptions::default() };
        let name = [data("earth_etopo1_6min.tif")];
        let (added, given) = (open_sources(&name, &options).unwrap(), open_sources(&name, &plain).unwrap());
        let grid = Grid::new(8, false);
        let window = NodeWindow { level: 0, x0: 0, y0: 128, nx: 1, ny: 1 };
        let node = |set: &super::SourceSet| set.sample(0, &grid, &window).unwrap().height_m[0];
        // Node (0, 128) lies at 180 W on the equator, which is a sample.
        let centre = |set: &super::SourceSet| set.centres(0, 900..901, 1).unwrap()[1800];
        assert!((centre(&added).x.abs() - 180.0).abs() < 1e-9 && centre(&added).y.abs() < 1e-9);
        let undulation_m = centre(&added).height_m - centre(&given).height_m;
        assert!((undulation_m - f64::from(node(&added) - node(&given))).abs() < 1e-3 && undulation_m.abs() > 1.0);
    }

    #[test]
    fn projected_and_plane_samples() {
        let options = SourceOptions { vertical: Some(Vertical::AsGiven), ..SourceOptions::default() };
        let name = [data("sierra_albers_30m.tif")];
        let globe = open_sources(&name, &options).unwrap();
        let centres = globe.centres(0, 0..1, 500).unwrap();
        assert_eq!(centres.len(), 3);
        assert!(centres.iter().all(|c| (-120.0..-115.0).contains(&c.x) && (35.0..40.0).contains(&c.y)), "{centres:?}");
        let flat = SourceOptions { body: Some(BodyChoice::Plane), ..options };
        let plane = open_sources(&name, &flat).unwrap();
        // The last stored row is the southernmost, where node (0, 0) is.
        let south = plane.centres(0, 1099..1100, 1).unwrap();
        let relief_formats::body::Body::Plane { x0, y0, .. } = plane.body else { panic!("not a plane") };
        assert_eq!((south[0].x, south[0].y), (x0, y0));
        assert_eq!(plane.size(0), (1100, 1100));
    }
}
