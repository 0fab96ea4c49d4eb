//! Small rasters for tests.

use std::path::Path;

use gdal::DriverManager;
use gdal::raster::{Buffer, GdalType, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;

/// A GeoTIFF to be written.
pub struct Raster<'a> {
    pub size: (usize, usize),
    /// GDAL's geotransform; none: no georeference.
    pub transform: Option<[f64; 6]>,
    /// EPSG code; 0: none.
    pub epsg: u32,
    pub nodata: Option<f64>,
    /// Height units per stored unit, and the height of the stored zero.
    pub scale_offset: Option<(f64, f64)>,
    pub options: &'a [&'a str],
}

impl Raster<'_> {
    /// The whole globe from 180 W, cell-registered, north up.
    pub fn world(width: usize) -> Self {
        let step_deg = 360.0 / width as f64;
        Self {
            size: (width, width / 2),
            transform: Some([-180.0, step_deg, 0.0, 90.0, 0.0, -step_deg]),
            epsg: 4326,
            nodata: None,
            scale_offset: None,
            options: &[],
        }
    }

    /// A region in UTM zone 31 N with pixels of 30 m.
    pub fn utm(size: (usize, usize)) -> Self {
        let transform = Some([500_000.0, 30.0, 0.0, 5_000_000.0, 0.0, -30.0]);
        Self { size, transform, epsg: 32631, nodata: None, scale_offset: None, options: &[] }
    }

    /// Writes the file with values from (column, row).
    pub fn write<T: GdalType + Copy>(&self, path: &Path, value: impl Fn(usize, usize) -> T) {
        let (nx, ny) = self.size;
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let options: RasterCreationOptions = self.options.iter().copied().collect();
        let mut file = driver.create_with_band_type_with_options::<T, _>(path, nx, ny, 1, &options).unwrap();
        if let Some(transform) = &self.transform {
            file.set_geo_transform(transform).unwrap();
        }
        if self.epsg > 0 {
            file.set_spatial_ref(&SpatialRef::from_epsg(self.epsg).unwrap()).unwrap();
        }
        let mut band = file.rasterband(1).unwrap();
        if self.nodata.is_some() {
            band.set_no_data_value(self.nodata).unwrap();
        }
        if let Some((scale, offset)) = self.scale_offset {
            band.set_scale(scale).unwrap();
            band.set_offset(offset).unwrap();
        }
        let values = (0..nx * ny).map(|k| value(k % nx, k / nx)).collect();
        band.write((0, 0), self.size, &mut Buffer::new(self.size, values)).unwrap();
        file.close().unwrap();
    }
}
