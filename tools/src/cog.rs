//! Cloud-optimised GeoTIFFs of a plane, through GDAL.
//!
//! The raster's pixel centres are the samples: on a globe the outer rows' centres lie on the
//! poles, half a pixel beyond which the raster ends. Memory is bounded whatever the size: the
//! plane is written block by block into a temporary GeoTIFF, which GDAL then copies.

use std::path::Path;

use gdal::raster::{Buffer, GdalType, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, DriverManager, Metadata as _};
use relief_formats::body::Body;
use relief_formats::file::{Plane, Relief};

use crate::lattice::{Lattice, PlaneChoice, Rectangle};
use crate::source::{crs::traditional, quiet};
use relief_front::error::ToolError;
use relief_front::staging::Staging;

/// Rows and columns that are written together: whole blocks of the temporary file.
const ROWS: u32 = 256;
const COLUMNS: u32 = 1 << 16;

/// Samples as the GeoTIFF holds them. All types hold the file's heights exactly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleType {
    /// Flags.
    Byte,
    /// Whole metres.
    Int16,
    /// Whole metres.
    Int32,
    /// Metres.
    Float32,
}

impl SampleType {
    /// The smallest type that holds a plane's values, and the one that means void.
    #[must_use]
    pub fn of(relief: &Relief, plane: PlaneChoice) -> Self {
        let (header, step_m) = (relief.header(), relief.step_m());
        let limit = |q: i32| f64::from(q) * step_m;
        let (low, high) = (limit(header.min_q), limit(header.max_q));
        let fits = |least: f64, most: f64| low > least && high <= most;
        match plane {
            PlaneChoice::Filled => Self::Byte,
            PlaneChoice::Deviation => Self::Float32,
            _ if step_m < 1.0 => Self::Float32,
            PlaneChoice::Nodes | PlaneChoice::Mip if fits(f64::from(i16::MIN), f64::from(i16::MAX)) => Self::Int16,
            // Extremes are rounded outwards, by less than the range of all heights.
            _ if fits(f64::from(i32::MIN) / 4.0, f64::from(i32::MAX) / 4.0) => Self::Int32,
            _ => Self::Float32,
        }
    }

    /// GDAL's name for it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Byte => "Byte",
            Self::Int16 => "Int16",
            Self::Int32 => "Int32",
            Self::Float32 => "Float32",
        }
    }
}

/// Writes a rectangle of a plane as a COG at `path`; returns its size in bytes and sample type.
///
/// # Errors
/// An output that exists without `replace`; a damaged tile of the file at `input`; whatever GDAL
/// or the disk answers. Then nothing is left behind.
pub fn write_cog(
    (input, relief): (&Path, &Relief),
    lattice: &Lattice<'_>,
    rectangle: Rectangle,
    path: &Path,
    replace: bool,
) -> Result<(u64, SampleType), ToolError> {
    let staging = Staging::beside(path, replace)?;
    quiet::set_up();
    let kind = SampleType::of(relief, lattice.plane());
    let writer = Writer { input, relief, lattice, rectangle, path };
    let raster = staging.path("raster.tif");
    match kind {
        SampleType::Byte => writer.raster(&raster, 0u8, |v| v as u8)?,
        SampleType::Int16 => writer.raster(&raster, i16::MIN, |v| v as i16)?,
        SampleType::Int32 => writer.raster(&raster, i32::MIN, |v| v as i32)?,
        SampleType::Float32 => writer.raster(&raster, f32::NAN, |v| v)?,
    }
    writer.copy(&raster, &staging.path("cog.tif"))?;
    Ok((staging.publish("cog.tif")?, kind))
}

struct Writer<'a> {
    input: &'a Path,
    relief: &'a Relief,
    lattice: &'a Lattice<'a>,
    rectangle: Rectangle,
    path: &'a Path,
}

impl Writer<'_> {
    /// The temporary GeoTIFF, block by block.
    fn raster<T: GdalType + Copy + Into<f64>>(
        &self,
        at: &Path,
        void: T,
        sample: impl Fn(f32) -> T,
    ) -> Result<(), ToolError> {
        let Rectangle { column, row, columns, rows } = self.rectangle;
        let options = options(&[
            "TILED=YES",
            "BLOCKXSIZE=256",
            "BLOCKYSIZE=256",
            "COMPRESS=ZSTD",
            "ZSTD_LEVEL=1",
            "PREDICTOR=2",
            "BIGTIFF=IF_SAFER",
        ]);
        let driver = self.gdal(DriverManager::get_driver_by_name("GTiff"))?;
        let created =
            driver.create_with_band_type_with_options::<T, _>(at, columns as usize, rows as usize, 1, &options);
        let mut dataset = self.gdal(created)?;
        self.describe(&mut dataset)?;
        let mut band = self.gdal(dataset.rasterband(1))?;
        if self.has_voids()? {
            self.gdal(band.set_no_data_value(Some(void.into())))?;
        }
        self.gdal(band.set_description(self.lattice.plane().name()))?;
        for x in (0..columns).step_by(COLUMNS as usize) {
            let nx = COLUMNS.min(columns - x);
            for y in (0..rows).step_by(ROWS as usize) {
                let ny = ROWS.min(rows - y);
                // GDAL's rows start in the north.
                let part = Rectangle { column: column + i64::from(x), row: row + rows - y - ny, columns: nx, rows: ny };
                let samples = self.lattice.read(part).map_err(ToolError::of_file(self.input))?;
                let rows = samples.chunks_exact(nx as usize).rev().flatten();
                let values = rows.map(|&v| if v.is_nan() { void } else { sample(v) }).collect();
                let size = (nx as usize, ny as usize);
                self.gdal(band.write((x as isize, y as isize), size, &mut Buffer::new(size, values)))?;
            }
        }
        self.gdal(dataset.flush_cache())?;
        self.gdal(dataset.close())?;
        self.nothing_failed()
    }

    /// Where the pixels lie, and what they are.
    fn describe(&self, dataset: &mut Dataset) -> Result<(), ToolError> {
        self.gdal(dataset.set_geo_transform(&self.lattice.samples().geo_transform(self.rectangle)))?;
        if let Some(crs) = self.gdal(crs_of(self.relief.body()))? {
            self.gdal(dataset.set_spatial_ref(&crs))?;
        }
        let level = self.lattice.level().to_string();
        for (key, value) in [
            ("RELIEF_PLANE", self.lattice.plane().name()),
            ("RELIEF_LEVEL", level.as_str()),
            ("VERTICAL_REFERENCE", self.relief.metadata().vertical.as_str()),
            ("UNIT", if self.lattice.plane() == PlaneChoice::Filled { "1" } else { "metre" }),
        ] {
            self.gdal(dataset.set_metadata_item(key, value, ""))?;
        }
        Ok(())
    }

    /// True when a void may be among the samples.
    fn has_voids(&self) -> Result<bool, ToolError> {
        if !self.lattice.shows_voids() {
            return Ok(false);
        }
        for entry in self.relief.entries() {
            let entry = entry.map_err(ToolError::of_file(self.input))?;
            if !entry.range(Plane::Filled).is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn copy(&self, raster: &Path, cog: &Path) -> Result<(), ToolError> {
        let source = self.gdal(Dataset::open(raster))?;
        let driver = self.gdal(DriverManager::get_driver_by_name("COG"))?;
        let resampling = match self.lattice.plane() {
            PlaneChoice::Nodes | PlaneChoice::Mip => "OVERVIEW_RESAMPLING=AVERAGE",
            _ => "OVERVIEW_RESAMPLING=NEAREST",
        };
        let options = options(&[
            "COMPRESS=DEFLATE",
            "PREDICTOR=YES",
            "OVERVIEW_PREDICTOR=YES",
            "BLOCKSIZE=512",
            "BIGTIFF=IF_SAFER",
            "NUM_THREADS=ALL_CPUS",
            resampling,
        ]);
        let copy = self.gdal(source.create_copy(&driver, cog, &options))?;
        self.gdal(copy.close())?;
        self.nothing_failed()
    }

    /// GDAL reports a failure of a last write (a full disk) in words alone.
    fn nothing_failed(&self) -> Result<(), ToolError> {
        match quiet::drain() {
            words if words.is_empty() => Ok(()),
            words => Err(self.refused(&words.join("; "))),
        }
    }

    fn gdal<T>(&self, result: gdal::errors::Result<T>) -> Result<T, ToolError> {
        result.map_err(|error| self.refused(&quiet::explain(&error)))
    }

    /// The first failures tell the cause; what follows are its echoes.
    fn refused(&self, words: &str) -> ToolError {
        let words: Vec<&str> = words.split("; ").take(2).collect();
        ToolError::Io {
            action: "cannot write",
            path: self.path.to_path_buf(),
            error: std::io::Error::other(words.join("; ")),
            remedy: "check that the disk has room (twice the raster), or export a --window or a coarser --level".into(),
        }
    }
}

fn options(pairs: &[&str]) -> RasterCreationOptions {
    let mut options = RasterCreationOptions::new();
    for pair in pairs {
        // Fails only for text with a NUL byte.
        let _ = options.add_string(pair);
    }
    options
}

/// The CRS of a body: EPSG:4326 on WGS-84, longitude and latitude on another ellipsoid, the
/// source's own on a plane (none where it had none).
fn crs_of(body: &Body) -> gdal::errors::Result<Option<SpatialRef>> {
    let wgs84 = Body::earth();
    match (body, &wgs84) {
        (Body::Plane { crs_wkt, .. }, _) if crs_wkt.is_empty() => Ok(None),
        (Body::Plane { crs_wkt, .. }, _) => traditional(crs_wkt).map(Some),
        (Body::Ellipsoid { a_m, b_m, .. }, Body::Ellipsoid { a_m: a, b_m: b, .. })
            if (a_m - a).abs() < 1e-3 && (b_m - b).abs() < 1e-3 =>
        {
            traditional("EPSG:4326").map(Some)
        }
        (Body::Ellipsoid { name, a_m, b_m }, _) => {
            let inverse_flattening = if a_m == b_m { 0.0 } else { a_m / (a_m - b_m) };
            let name: String = name.chars().filter(|c| *c != '"').collect();
            traditional(&format!(
                r#"GEOGCS["{name}",DATUM["{name}",SPHEROID["{name}",{a_m},{inverse_flattening}]],PRIMEM["Reference meridian",0],UNIT["degree",0.0174532925199433]]"#
            ))
            .map(Some)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_body_has_its_crs() {
        quiet::set_up();
        assert_eq!(crs_of(&Body::earth()).unwrap().unwrap().auth_code().unwrap(), 4326);
        for body in [Body::moon(), Body::mars(), Body::Ellipsoid { name: "9,7".into(), a_m: 9e5, b_m: 7e5 }] {
            let crs = crs_of(&body).unwrap().unwrap();
            let Body::Ellipsoid { a_m, b_m, .. } = body else { unreachable!() };
            assert!(crs.is_geographic());
            assert!((crs.semi_major().unwrap() - a_m).abs() < 1e-6 && (crs.semi_minor().unwrap() - b_m).abs() < 1e-6);
        }
        let plane = |wkt: &str| Body::Plane { crs_wkt: wkt.into(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 };
        assert!(crs_of(&plane("")).unwrap().is_none());
        assert!(crs_of(&plane("EPSG:32611")).unwrap().unwrap().is_projected());
        assert!(crs_of(&plane("nonsense")).is_err());
        quiet::drain();
    }
}
