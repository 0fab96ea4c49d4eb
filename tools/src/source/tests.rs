//! Sources made here, sampled, and compared with values worked out independently.

use std::path::Path;

use gdal::DriverManager;
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use relief_formats::grid::Grid;

use super::*;

/// A small GeoTIFF in the making.
struct Tif {
    size: (usize, usize),
    transform: Option<[f64; 6]>,
    crs: Option<&'static str>,
    nodata: Option<f64>,
    scale: Option<f64>,
    offset: Option<f64>,
    creation: &'static [&'static str],
}

impl Default for Tif {
    fn default() -> Self {
        Self {
            size: (36, 18),
            transform: Some([-180.0, 10.0, 0.0, 90.0, 0.0, -10.0]),
            crs: Some("EPSG:4326"),
            nodata: None,
            scale: None,
            offset: None,
            creation: &[],
        }
    }
}

impl Tif {
    /// Writes pixels `value(column, row)` and returns the path.
    fn write<T: gdal::raster::GdalType + Copy>(
        &self,
        folder: &Path,
        name: &str,
        value: impl Fn(usize, usize) -> T,
    ) -> String {
        quiet::set_up();
        let path = folder.join(name);
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let options = RasterCreationOptions::from_iter(self.creation.iter().copied());
        let (nx, ny) = self.size;
        let mut dataset = driver.create_with_band_type_with_options::<T, _>(&path, nx, ny, 1, &options).unwrap();
        if let Some(transform) = &self.transform {
            dataset.set_geo_transform(transform).unwrap();
        }
        if let Some(crs) = self.crs {
            dataset.set_spatial_ref(&SpatialRef::from_definition(crs).unwrap()).unwrap();
        }
        let mut band = dataset.rasterband(1).unwrap();
        band.set_no_data_value(self.nodata).unwrap();
        if let Some(scale) = self.scale {
            band.set_scale(scale).unwrap();
        }
        if let Some(offset) = self.offset {
            band.set_offset(offset).unwrap();
        }
        let pixels = (0..nx * ny).map(|at| value(at % nx, at / nx)).collect();
        band.write((0, 0), (nx, ny), &mut Buffer::new((nx, ny), pixels)).unwrap();
        dataset.close().unwrap();
        path.to_str().unwrap().to_owned()
    }
}

fn given() -> SourceOptions {
    SourceOptions { vertical: Some(Vertical::AsGiven), ..SourceOptions::default() }
}

fn open(path: &str, options: &SourceOptions) -> SourceSet {
    open_sources(&[path.to_owned()], options).unwrap()
}

/// The whole level as one block of (W, H + 1) nodes.
fn level(set: &SourceSet, grid: &Grid, level: u32) -> HeightBlock {
    let window = NodeWindow {
        level,
        x0: 0,
        y0: 0,
        nx: grid.width(level) as usize,
        ny: grid.height(level) as usize + 1,
    };
    set.sample(0, grid, &window).unwrap()
}

/// Every bit of a block, voids told apart.
fn bits(block: &HeightBlock) -> Vec<(u32, u8)> {
    block.height_m.iter().zip(&block.state).map(|(height, state)| (height.to_bits(), *state)).collect()
}

/// Smooth on the whole sphere, poles included.
fn sine(lon_deg: f64, lat_deg: f64) -> f64 {
    1000.0 * lat_deg.to_radians().cos().powi(2) * (2.0 * lon_deg).to_radians().cos() + 300.0 * lat_deg.to_radians().sin()
}

/// Cell-registered and gridline, north-up and south-up, -180..180 and 0..360 all hold the same
/// field; the nodes must not see the difference beyond interpolation error.
#[test]
fn registrations_and_directions_agree_with_the_field() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::new(8, false);
    let layouts: [(&str, (usize, usize), [f64; 6]); 5] = [
        ("cell", (720, 360), [-180.0, 0.5, 0.0, 90.0, 0.0, -0.5]),
        ("south_up", (720, 360), [-180.0, 0.5, 0.0, -90.0, 0.0, 0.5]),
        ("from_zero", (720, 360), [0.0, 0.5, 0.0, 90.0, 0.0, -0.5]),
        ("gridline", (721, 361), [-0.25, 0.5, 0.0, 90.25, 0.0, -0.5]),
        ("westwards", (720, 360), [180.0, -0.5, 0.0, 90.0, 0.0, -0.5]),
    ];
    for (name, size, transform) in layouts {
        let tif = Tif { size, transform: Some(transform), ..Tif::default() };
        let path = tif.write(folder.path(), &format!("{name}.tif"), |c, r| {
            let lon = transform[0] + (c as f64 + 0.5) * transform[1];
            let lat = transform[3] + (r as f64 + 0.5) * transform[5];
            sine(lon, lat) as f32
        });
        for (resample, bound) in [(Resample::Bilinear, 0.06), (Resample::Cubic, 0.002), (Resample::Lanczos, 0.6)] {
            let set = open(&path, &SourceOptions { resample, ..given() });
            let block = level(&set, &grid, 0);
            let mut worst: f64 = 0.0;
            for (at, height) in block.height_m.iter().enumerate() {
                let (i, j) = ((at % 512) as i64, (at / 512) as i64);
                let lat = grid.lat_deg(0, j);
                let error = f64::from(*height) - sine(grid.lon_deg(0, i), lat);
                // A pole is the mean of its row; cells have theirs a quarter degree off it.
                if lat.abs() < 90.0 {
                    worst = worst.max(error.abs());
                }
            }
            assert!(block.state.iter().all(|state| *state == DATA));
            assert!(worst < bound, "{name} {resample:?}: {worst}");
            let pole = &block.height_m[256 * 512..];
            assert!(pole.iter().all(|height| height.to_bits() == pole[0].to_bits()));
            assert!((pole[0] - 300.0).abs() < 0.01, "{name}: {}", pole[0]);
        }
    }
}
