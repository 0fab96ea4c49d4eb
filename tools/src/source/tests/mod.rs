//! Sources made here, sampled, and compared with values worked out independently.

use std::path::Path;

use gdal::DriverManager;
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use relief_formats::grid::Grid;

use super::*;

mod consistency;
mod cylindrical;
mod files;
mod meaning;
mod planes;
mod positions;

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

/// A folder and a file in it, which go with the folder.
struct Made {
    path: String,
    _folder: tempfile::TempDir,
}

fn made<T: gdal::raster::GdalType + Copy>(tif: &Tif, value: impl Fn(usize, usize) -> T) -> Made {
    let folder = tempfile::tempdir().unwrap();
    Made { path: tif.write(folder.path(), "made.tif", value), _folder: folder }
}

fn window(level: u32, x0: i64, y0: i64, nx: usize, ny: usize) -> NodeWindow {
    NodeWindow { level, x0, y0, nx, ny }
}

/// Why an input is refused.
fn refusal(path: &str, options: &SourceOptions) -> String {
    match open_sources(&[path.to_owned()], options) {
        Ok(_) => panic!("{path} was accepted"),
        Err(error) => error.to_string(),
    }
}

fn open(path: &str, options: &SourceOptions) -> SourceSet {
    open_sources(&[path.to_owned()], options).unwrap()
}

/// The whole level as one block of (W, H + 1) nodes.
fn level(set: &SourceSet, grid: &Grid, level: u32) -> HeightBlock {
    let window =
        NodeWindow { level, x0: 0, y0: 0, nx: grid.width(level) as usize, ny: grid.height(level) as usize + 1 };
    set.sample(0, grid, &window).unwrap()
}

/// Every bit of a block, voids told apart.
fn bits(block: &HeightBlock) -> Vec<(u32, u8)> {
    block.height_m.iter().zip(&block.state).map(|(height, state)| (height.to_bits(), *state)).collect()
}
