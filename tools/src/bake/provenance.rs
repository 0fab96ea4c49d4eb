//! Where a file's heights come from, for its metadata and for the work file's identity.

use relief_formats::file::Metadata;

use super::plan::Plan;
use super::run::BakeOptions;
use crate::source::{SourceOptions, SourceSet, Vertical};
use relief_front::error::ToolError;

/// The metadata of a bake: its sources as they were understood, and what made heights of them.
///
/// # Errors
/// A record that is no JSON.
pub(super) fn metadata(sources: &SourceSet, plan: &Plan, options: &BakeOptions) -> Result<Metadata, ToolError> {
    let records = sources.describe().iter().map(serde_json::to_value).collect::<Result<Vec<_>, _>>();
    let vertical = match &options.source.vertical {
        Some(Vertical::Ellipsoid) => "ellipsoid".to_string(),
        Some(Vertical::Egm96) => "ellipsoid (EGM96 added)".to_string(),
        Some(Vertical::Gtx(path)) => {
            format!("ellipsoid ({} added)", path.file_name().unwrap_or_default().to_string_lossy())
        }
        Some(Vertical::AsGiven) => "as given".to_string(),
        None => "as the source's CRS says".to_string(),
    };
    let versions = [
        ("format", "1.0".to_string()),
        ("gdal", gdal::version::VersionInfo::release_name()),
        ("relief-bake", env!("CARGO_PKG_VERSION").to_string()),
        ("zstd", zstd_version()),
    ];
    Ok(Metadata {
        body: sources.body.clone(),
        vertical,
        sources: records.map_err(|e| ToolError::usage(format!("metadata: {e}"), "it is JSON", "report this"))?,
        resampling: format!("{:?}", options.source.resample).to_lowercase(),
        fill: format!("{:?}", options.source.fill).to_lowercase(),
        bound_m: plan.step_m() / 2.0,
        versions: versions.map(|(name, version)| (name.to_string(), version)).into(),
    })
}

fn zstd_version() -> String {
    let n = relief_formats::codec::zstd_version_number();
    format!("{}.{}.{}", n / 10_000, n / 100 % 100, n % 100)
}

/// Hashes everything that decides the file's bytes; threads and memory do not.
///
/// # Errors
/// Metadata that cannot be written.
pub(super) fn identity(metadata: &Metadata, plan: &Plan, options: &BakeOptions) -> Result<[u8; 32], ToolError> {
    let source = SourceOptions { threads: 0, memory_bytes: 0, ..options.source.clone() };
    let mut hasher = blake3::Hasher::new();
    hasher.update(&metadata.encode().map_err(ToolError::of_file(&options.output))?);
    hasher.update(format!("{:?} {} {:?} {:?}", plan.grid, plan.step_exponent, options.layout, source).as_bytes());
    Ok(*hasher.finalize().as_bytes())
}
