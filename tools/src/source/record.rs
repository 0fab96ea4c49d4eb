//! What a bake records about each input, so that it can be repeated and doubted.

use std::io::Read;
use std::path::Path;

use serde::{Deserialize, Serialize};

use relief_front::error::ToolError;

/// One input as it was used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceRecord {
    /// File name without its folder.
    pub file: String,
    /// BLAKE3 of the file's bytes, hexadecimal; absent for what is not a file on disk.
    pub blake3: Option<String>,
    /// GDAL's short driver name, or `EXR`.
    pub driver: String,
    /// Columns of pixels.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// Sample type as GDAL names it.
    pub sample_type: String,
    /// Authority and code, or the name of the CRS, or where else the georeference came from.
    pub crs: String,
    /// `cell` or `node`.
    pub registration: String,
    /// Metres in the unit of the heights.
    pub unit_m: f64,
    /// Height units per stored unit.
    pub scale: f64,
    /// Height of the stored zero, in height units.
    pub offset: f64,
    /// Semi-axis that was taken off because the stored values are radii, metres; else 0.
    pub radius_removed_m: f64,
    /// Stored value that means void.
    pub nodata: Option<f64>,
    /// Distance between samples as an angle at the equator, degrees (plane: CRS units).
    pub spacing: f64,
    /// `ellipsoid`, `as-given`, or the file name of the geoid whose undulation was added.
    pub vertical: String,
    /// BLAKE3 of the geoid file.
    pub geoid_blake3: Option<String>,
}

/// BLAKE3 of a file; none where `path` is not a plain file (GDAL's `/vsi` and subdataset names).
///
/// # Errors
/// [`ToolError::Io`] when the file cannot be read.
pub(crate) fn hash_file(path: &str) -> Result<Option<String>, ToolError> {
    if !Path::new(path).is_file() {
        return Ok(None);
    }
    let fail = |error| ToolError::Io {
        action: "read",
        path: path.into(),
        error,
        remedy: "check that the file may be read and its disk is healthy".into(),
    };
    let mut file = std::fs::File::open(path).map_err(fail)?;
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer).map_err(fail)? {
            0 => return Ok(Some(hasher.finalize().to_hex().to_string())),
            read => hasher.update(&buffer[..read]),
        };
    }
}

/// The last part of a path, or all of it.
pub(crate) fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or_else(|| path.to_owned(), |name| name.to_string_lossy().into_owned())
}
