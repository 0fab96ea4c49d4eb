//! Pixels through GDAL: one band, metres out, and never zeros in place of a damaged block.

use std::sync::{Mutex, PoisonError};

use gdal::raster::GdalDataType;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags, Metadata};

use super::heights::{BandTags, HeightRule};
use super::quiet;
use relief_front::error::ToolError;

/// A band of a GDAL dataset, readable from any thread.
pub(crate) struct GdalReader {
    path: String,
    band: usize,
    rule: HeightRule,
    masked: bool,
    pub block: (usize, usize),
    /// Open handles that no thread uses at present: a handle serves one thread at a time.
    idle: Mutex<Vec<Dataset>>,
}

/// What opening a file tells about its band.
pub(crate) struct OpenBand {
    pub dataset: Dataset,
    pub band: usize,
    pub width: usize,
    pub height: usize,
    pub block: (usize, usize),
    pub tags: BandTags,
    pub type_name: String,
    pub driver: String,
    masked: bool,
}

/// Opens `path` and finds the band that `channel` names (number or description; else the first).
///
/// # Errors
/// [`ToolError::Source`]: missing, empty, not a raster, no such band, a type without order.
pub(crate) fn open_band(path: &str, channel: Option<&str>) -> Result<OpenBand, ToolError> {
    let dataset = open(path)?;
    let count = dataset.raster_count();
    if count == 0 {
        return Err(no_band(path, &dataset));
    }
    let band = find_band(path, &dataset, channel)?;
    let fail = |error: gdal::errors::GdalError| unreadable(path, "its band", &quiet::explain(&error));
    let raster = dataset.rasterband(band).map_err(fail)?;
    let (width, height) = raster.size();
    if width == 0 || height == 0 {
        return Err(ToolError::source(
            path,
            format!("the raster is {width} x {height}"),
            "a raster has at least one pixel",
            "write the file again",
        ));
    }
    let kind = raster.band_type();
    let type_name = kind.name();
    if type_name.starts_with('C') || type_name == "Unknown" {
        return Err(ToolError::source(
            path,
            format!("band {band} holds {type_name} values"),
            "heights are real numbers",
            "name another band with --channel",
        ));
    }
    let flags = raster.mask_flags().map_err(fail)?;
    let integer = kind.is_integer();
    let tags = BandTags {
        nodata: raster.no_data_value(),
        scale: raster.scale(),
        offset: raster.offset(),
        unit: raster.unit(),
        unit_m: None,
        float32: kind == GdalDataType::Float32,
        integer,
    };
    let block = raster.block_size();
    let masked = !flags.is_all_valid() && (flags.is_per_dataset() || flags.is_alpha());
    let driver = dataset.driver().short_name();
    quiet::drain();
    Ok(OpenBand { dataset, band, width, height, block, tags, type_name, driver, masked })
}

impl GdalReader {
    /// A reader of the band that was opened.
    pub fn new(path: &str, open: OpenBand, rule: HeightRule) -> Self {
        Self {
            path: path.to_owned(),
            band: open.band,
            rule,
            masked: open.masked,
            block: open.block,
            idle: Mutex::new(vec![open.dataset]),
        }
    }

    /// Reads `nx` x `ny` pixels from (`x`, `y`) into `out`, metres, NaN where void.
    ///
    /// # Errors
    /// [`ToolError::Source`] when GDAL reports anything but success.
    pub fn read(&self, (x, y): (usize, usize), (nx, ny): (usize, usize), out: &mut [f32]) -> Result<(), ToolError> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let dataset = match idle {
            Some(dataset) => dataset,
            None => open(&self.path)?,
        };
        let outcome = self.read_with(&dataset, (x, y), (nx, ny), out);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(dataset);
        outcome
    }

    fn read_with(
        &self,
        dataset: &Dataset,
        (x, y): (usize, usize),
        (nx, ny): (usize, usize),
        out: &mut [f32],
    ) -> Result<(), ToolError> {
        quiet::drain();
        let what = || format!("pixels {x}..{} of rows {y}..{}", x + nx, y + ny);
        let fail = |error: gdal::errors::GdalError| unreadable(&self.path, &what(), &quiet::explain(&error));
        let band = dataset.rasterband(self.band).map_err(fail)?;
        // A block row at a time keeps the f64 copy small.
        let rows_at_once = self.block.1.max(1).max((1 << 18) / nx.max(1)).min(ny);
        let mut raw = vec![0.0_f64; nx * rows_at_once];
        let mut mask = vec![0_u8; if self.masked { raw.len() } else { 0 }];
        for (chunk, rows) in out.chunks_mut(nx * rows_at_once).enumerate() {
            let at = (x as isize, (y + chunk * rows_at_once) as isize);
            let size = (nx, rows.len() / nx);
            let raw = &mut raw[..rows.len()];
            band.read_into_slice(at, size, size, raw, None).map_err(fail)?;
            for (height, value) in rows.iter_mut().zip(raw.iter()) {
                *height = self.rule.height_m(*value);
            }
            if self.masked {
                let mask = &mut mask[..rows.len()];
                let mask_band = band.open_mask_band().map_err(fail)?;
                mask_band.read_into_slice(at, size, size, mask, None).map_err(fail)?;
                for (height, valid) in rows.iter_mut().zip(mask.iter()) {
                    if *valid == 0 {
                        *height = f32::NAN;
                    }
                }
            }
        }
        // Some drivers report a failure and go on with what they have.
        match quiet::drain() {
            messages if messages.is_empty() => Ok(()),
            messages => Err(unreadable(&self.path, &what(), &messages.join("; "))),
        }
    }
}

/// Opens a raster read-only.
fn open(path: &str) -> Result<Dataset, ToolError> {
    quiet::drain();
    let flags = GdalOpenFlags::GDAL_OF_RASTER | GdalOpenFlags::GDAL_OF_READONLY | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR;
    let options = DatasetOptions { open_flags: flags, ..DatasetOptions::default() };
    Dataset::open_ex(path, options).map_err(|error| {
        let message = quiet::explain(&error);
        let on_disk = std::fs::metadata(path);
        let gdal_name = path.starts_with("/vsi") || path.contains(':');
        let (what, rule, remedy) = match on_disk {
            Err(error) if !gdal_name => {
                (format!("{error}"), "the input exists and may be read", "check the name and the folder")
            }
            Ok(meta) if meta.is_file() && meta.len() == 0 => {
                ("the file is empty (0 bytes)".into(), "a raster has at least one pixel", "copy or download it again")
            }
            Ok(meta) if meta.is_dir() => {
                ("it is a folder".into(), "an input is a raster file", "name the files in it, or build a VRT of them")
            }
            _ => (
                format!("not a raster that GDAL can open: {message}"),
                "inputs are rasters in a format GDAL reads, or EXR",
                "check it with gdalinfo",
            ),
        };
        ToolError::source(path, what, rule, remedy)
    })
}

fn no_band(path: &str, dataset: &Dataset) -> ToolError {
    let parts = dataset.metadata_domain("SUBDATASETS").unwrap_or_default();
    let names: Vec<_> =
        parts.iter().filter_map(|entry| entry.split_once("_NAME=").map(|(_, name)| name.to_owned())).take(8).collect();
    let remedy = match names.is_empty() {
        true => "name a file with a raster band".to_owned(),
        false => format!("name one of its parts: {}", names.join(", ")),
    };
    ToolError::source(path, "it has no raster band", "an input has one band of heights", remedy)
}

fn find_band(path: &str, dataset: &Dataset, channel: Option<&str>) -> Result<usize, ToolError> {
    let Some(wanted) = channel else { return Ok(1) };
    let count = dataset.raster_count();
    let names: Vec<_> = (1..=count)
        .map(|at| dataset.rasterband(at).ok().and_then(|band| band.description().ok()).unwrap_or_default())
        .collect();
    let by_number = wanted.parse().ok().filter(|number| (1..=count).contains(number));
    by_number.or_else(|| names.iter().position(|name| name == wanted).map(|at| at + 1)).ok_or_else(|| {
        let named: Vec<_> = names.iter().filter(|name| !name.is_empty()).cloned().collect();
        ToolError::source(
            path,
            format!("it has no band {wanted:?}"),
            format!(
                "bands are 1 to {count}{}",
                if named.is_empty() { String::new() } else { format!(": {}", named.join(", ")) }
            ),
            "name one of them with --channel",
        )
    })
}

fn unreadable(path: &str, what: &str, message: &str) -> ToolError {
    ToolError::source(
        path,
        format!("GDAL could not read {what}: {message}"),
        "every block of the raster can be decoded",
        "the file is damaged or cut short: copy or download it again",
    )
}
