//! The inputs of a bake opened once more, with the options that its metadata records.

use std::path::PathBuf;

use relief_formats::body::Body;
use relief_formats::file::{Metadata, Relief};

use super::check::Check;
use super::finding::{Findings, Place};
use crate::source::{
    BodyChoice, Fill, Registration, Resample, SourceOptions, SourceRecord, SourceSet, Unit, Vertical, open_sources,
};
use relief_front::error::ToolError;

/// What a bake was told about its inputs and its metadata does not hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Against {
    /// The inputs, in the order of the bake.
    pub inputs: Vec<String>,
    /// West, south, east, north of inputs without georeference.
    pub bounds: Option<[f64; 4]>,
    /// How their samples lie in the bounds.
    pub registration: Option<Registration>,
    /// EXR channel.
    pub channel: Option<String>,
    /// The geoid grid that was added, where it is not EGM96.
    pub geoid: Option<PathBuf>,
}

/// The records of all inputs.
pub(super) fn records(metadata: &Metadata) -> Vec<SourceRecord> {
    metadata.sources.iter().filter_map(|value| serde_json::from_value(value.clone()).ok()).collect()
}

/// The record of the n-th input: that at its place, unless another has its name.
pub(super) fn record_of<'a>(records: &'a [SourceRecord], n: usize, path: &str) -> Option<&'a SourceRecord> {
    let named =
        |record: &&SourceRecord| std::path::Path::new(path).file_name().is_some_and(|name| *name == *record.file);
    records.get(n).filter(named).or_else(|| records.iter().find(named)).or_else(|| records.get(n))
}

/// One input, opened as the bake did.
pub(super) struct Input {
    pub set: SourceSet,
    /// The finest level that it was sampled at.
    pub finest: u32,
}

impl Input {
    /// # Errors
    /// An input that cannot be opened, or lies on another body.
    pub fn open(
        relief: &Relief,
        against: &Against,
        path: &str,
        record: Option<&SourceRecord>,
        memory_bytes: u64,
        findings: &Findings,
    ) -> Result<Self, ToolError> {
        let body = relief.body();
        let mut options = options(relief.metadata(), against, record, memory_bytes)?;
        options.body = body.is_plane().then_some(BodyChoice::Plane);
        let inputs = [path.to_owned()];
        let mut set = open_sources(&inputs, &options)?;
        if set.body != *body {
            options.body = Some(choice(body));
            set = open_sources(&inputs, &options)?;
        }
        if set.body != *body {
            return Err(ToolError::source(
                path,
                "it lies on another body or in another map than the file",
                "a file is compared with what it was baked from",
                "name the inputs of the bake in their order",
            ));
        }
        if let (Some(record), Some(found)) = (record, set.describe().first())
            && record.blake3 != found.blake3
        {
            let what = format!("{path} is not the {} that was baked: its bytes have another hash", record.file);
            findings.add(Check::SourceRecord, Place::default(), what);
        }
        let grid = relief.grid();
        let finest = set.finest_level(0, &grid).min(grid.root_level());
        Ok(Self { set, finest })
    }
}

fn choice(body: &Body) -> BodyChoice {
    match body {
        Body::Plane { .. } => BodyChoice::Plane,
        Body::Ellipsoid { name, a_m, b_m } => match name.as_str() {
            "earth" => BodyChoice::Earth,
            "moon" => BodyChoice::Moon,
            "mars" => BodyChoice::Mars,
            _ => BodyChoice::Axes(*a_m, *b_m),
        },
    }
}

/// The options of the bake, from the metadata and an input's record.
fn options(
    metadata: &Metadata,
    against: &Against,
    record: Option<&SourceRecord>,
    memory_bytes: u64,
) -> Result<SourceOptions, ToolError> {
    let unit = |unit_m: f64| [Unit::M, Unit::Ft, Unit::UsFt].into_iter().find(|unit| unit.metres() == unit_m);
    Ok(SourceOptions {
        nodata: record.and_then(|record| record.nodata),
        scale: record.map(|record| record.scale),
        offset: record.map(|record| record.offset),
        unit: record.and_then(|record| unit(record.unit_m)),
        // Only an input without georeference of its own may be given one.
        bounds: against.bounds.filter(|_| record.is_none_or(|record| record.crs.starts_with("given"))),
        registration: against.registration,
        channel: against.channel.clone(),
        vertical: vertical(metadata, against)?,
        body: None,
        resample: resample(&metadata.resampling)?,
        fill: if metadata.fill == "interpolate" { Fill::Interpolate } else { Fill::None },
        // A set takes a third of what it is told for pixels.
        memory_bytes: memory_bytes.saturating_mul(3),
        threads: rayon::current_num_threads(),
    })
}

fn vertical(metadata: &Metadata, against: &Against) -> Result<Option<Vertical>, ToolError> {
    let text = metadata.vertical.as_str();
    if let Some(path) = &against.geoid {
        return Ok(Some(Vertical::Gtx(path.clone())));
    }
    match text {
        "ellipsoid" => Ok(Some(Vertical::Ellipsoid)),
        "as given" => Ok(Some(Vertical::AsGiven)),
        "ellipsoid (EGM96 added)" => Ok(Some(Vertical::Egm96)),
        _ if text.ends_with("added)") => Err(ToolError::usage(
            format!("the file's vertical reference is {text:?}"),
            "a comparison adds the geoid that the bake added",
            "name that grid with --geoid PATH.gtx",
        )),
        _ => Ok(None),
    }
}

fn resample(name: &str) -> Result<Resample, ToolError> {
    let kernels =
        [Resample::Auto, Resample::Nearest, Resample::Bilinear, Resample::Cubic, Resample::Lanczos, Resample::Average];
    kernels.into_iter().find(|kernel| format!("{kernel:?}").eq_ignore_ascii_case(name)).ok_or_else(|| {
        ToolError::usage(
            format!("the file was resampled by {name:?}"),
            "a comparison uses the kernel of the bake",
            "use the version of relief-bake that the file's metadata names",
        )
    })
}
