//! From names and options to sources that agree with each other.

use std::sync::{Arc, OnceLock};

use relief_formats::body::Body;

use super::exr_reader::{ExrReader, is_exr, open_exr};
use super::gdal_reader::{GdalReader, open_band};
use super::geoid::{Geoid, plane_reference, reference};
use super::georef::Georef;
use super::heights::{BandTags, HeightRule};
use super::options::{BodyChoice, Fill, SourceOptions};
use super::place::on_globe;
use super::plane::{self, PlanePlace};
use super::raster::{Raster, Reader};
use super::record::{SourceRecord, file_name, hash_file};
use super::{Mapping, Source, SourceSet, quiet};
use relief_front::error::ToolError;

/// `a` is not a larger spacing than `b`, but for the rounding of tags to a part in a thousand.
pub(super) fn no_coarser(a: f64, b: f64) -> bool {
    a <= b * 1.001
}

/// An input before it is placed on a body.
struct Opened {
    path: String,
    size: (usize, usize),
    tags: BandTags,
    type_name: String,
    driver: String,
    georef: Georef,
    format: Format,
}

enum Format {
    Gdal(Box<super::gdal_reader::OpenBand>),
    Exr(super::exr_reader::OpenExr),
}

pub(super) fn open_all(inputs: &[String], options: &SourceOptions) -> Result<SourceSet, ToolError> {
    quiet::set_up();
    if inputs.is_empty() {
        return Err(ToolError::usage("no input", "a bake needs at least one raster", "name one or more files"));
    }
    let opened = inputs.iter().map(|path| open_one(path, options)).collect::<Result<Vec<_>, _>>()?;
    if options.bounds.is_some() && !opened.iter().any(|input| input.georef.from_bounds) {
        return Err(ToolError::usage(
            "--bounds with inputs that all have a georeference of their own",
            "--bounds is for files without one",
            "leave --bounds out",
        ));
    }
    let (body, mut places) = if options.body == Some(BodyChoice::Plane) {
        let rasters: Vec<_> = opened.iter().map(|input| (input.path.as_str(), input.size, &input.georef)).collect();
        let (body, places) = plane::fit(&rasters)?;
        (body, places.into_iter().map(Some).collect())
    } else {
        (common_body(&opened, options)?, vec![None; opened.len()])
    };
    let shares = shares(&opened, options)?;
    let mut geoids = Vec::new();
    let mut sources = Vec::new();
    for ((input, share), place) in opened.into_iter().zip(shares).zip(places.drain(..)) {
        sources.push(finish(input, share, place, &body, options, &mut geoids)?);
    }
    Ok(SourceSet { body, sources, options: options.clone() })
}

fn open_one(path: &str, options: &SourceOptions) -> Result<Opened, ToolError> {
    if is_exr(path) {
        let exr = open_exr(path, options.channel.as_deref())?;
        let georef = Georef::of_bounds(path, exr.size, options)?;
        return Ok(Opened {
            path: path.into(),
            size: exr.size,
            tags: exr.tags.clone(),
            type_name: exr.type_name.clone(),
            driver: "EXR".into(),
            georef,
            format: Format::Exr(exr),
        });
    }
    let band = open_band(path, options.channel.as_deref())?;
    let georef = Georef::of_dataset(path, &band.dataset, options)?;
    let mut tags = band.tags.clone();
    // The vertical axis's unit counts where the band does not say its own.
    if tags.unit.is_empty()
        && let Some(unit_m) = georef.crs.as_ref().and_then(|crs| crs.vertical_unit_m)
    {
        tags.unit_m = Some(unit_m);
    }
    Ok(Opened {
        path: path.into(),
        size: (band.width, band.height),
        tags,
        type_name: band.type_name.clone(),
        driver: band.driver.clone(),
        georef,
        format: Format::Gdal(Box::new(band)),
    })
}

fn common_body(opened: &[Opened], options: &SourceOptions) -> Result<Body, ToolError> {
    let first = opened[0].georef.body(options);
    for input in &opened[1..] {
        let other = input.georef.body(options);
        if other != first {
            return Err(ToolError::usage(
                format!("{} lies on {}, {} on {}", opened[0].path, name(&first), input.path, name(&other)),
                "all inputs of one bake lie on one body",
                "bake them apart, or say which body with --body",
            ));
        }
    }
    Ok(first)
}

fn name(body: &Body) -> String {
    match body {
        Body::Ellipsoid { name, .. } => name.clone(),
        Body::Plane { .. } => "a plane".into(),
    }
}

/// Bytes of pixels each input may hold: all of them, smallest first, while they fit into a third
/// of the memory; the rest share what is left.
///
/// # Errors
/// [`ToolError::Usage`] when inputs have to be held whole and do not fit.
fn shares(opened: &[Opened], options: &SourceOptions) -> Result<Vec<u64>, ToolError> {
    let budget = options.memory_bytes / 3;
    let bytes = |input: &Opened| input.size.0 as u64 * input.size.1 as u64 * 4;
    let total: u64 = opened.iter().map(bytes).sum();
    if options.fill == Fill::Interpolate {
        // The raster, its filled copy and the pyramid between them: at most half the memory.
        let needed = 2 * (total * 8).div_ceil(3);
        if needed > options.memory_bytes {
            return Err(ToolError::usage(
                format!("--fill interpolate with {total} bytes of pixels and --memory {}", options.memory_bytes),
                format!("filling holds the inputs whole, which takes {needed} bytes"),
                format!("give --memory {needed}, or --fill none or a height"),
            ));
        }
        return Ok(opened.iter().map(bytes).collect());
    }
    let mut order: Vec<_> = (0..opened.len()).collect();
    order.sort_by_key(|at| bytes(&opened[*at]));
    let (mut left, mut shares) = (budget, vec![0; opened.len()]);
    for (done, at) in order.iter().enumerate() {
        let input = &opened[*at];
        let fair = left / (opened.len() - done) as u64;
        shares[*at] = bytes(input).min(fair);
        left -= shares[*at];
        if matches!(input.format, Format::Exr(_)) && bytes(input) > fair {
            let needed = 3 * opened.len() as u64 * bytes(input);
            return Err(ToolError::usage(
                format!("{}: {} bytes of pixels and --memory {}", input.path, bytes(input), options.memory_bytes),
                format!("an EXR file is decoded whole, which takes {needed} bytes here"),
                format!("give --memory {needed}, or convert it to a tiled GeoTIFF"),
            ));
        }
    }
    Ok(shares)
}

/// Places an input and settles what its values mean.
fn finish(
    input: Opened,
    budget: u64,
    place: Option<PlanePlace>,
    body: &Body,
    options: &SourceOptions,
    geoids: &mut Vec<Arc<Geoid>>,
) -> Result<Source, ToolError> {
    let Opened { path, size, tags, type_name, driver, georef, format } = input;
    let rule = HeightRule::new(&path, &tags, options, body)?;
    let (mapping, spacing, reference) = match place {
        Some(place) => (Mapping::Plane(place), georef.transform[1].abs(), plane_reference(options)?),
        None => {
            let (mapping, spacing_deg) = on_globe(&path, size, &georef, body, options)?;
            let said = georef.crs.as_ref().map(|crs| &crs.vertical);
            (mapping, spacing_deg, reference(&path, said, body, options, geoids)?)
        }
    };
    let reader = match format {
        Format::Gdal(band) => Reader::Gdal(GdalReader::new(&path, *band, rule.clone())),
        Format::Exr(exr) => Reader::Exr(ExrReader::new(&path, &exr, rule.clone())),
    };
    let raster = Raster::new(&path, size, reader, budget, options.threads);
    let (vertical, geoid_blake3) = reference.describe();
    let record = SourceRecord {
        file: file_name(&path),
        blake3: hash_file(&path)?,
        driver,
        width: size.0,
        height: size.1,
        sample_type: type_name,
        crs: georef.describe(),
        registration: if georef.node_bounds { "node".into() } else { "cell".into() },
        unit_m: rule.unit_m,
        scale: rule.scale,
        offset: rule.offset,
        radius_removed_m: rule.radius_m,
        nodata: rule.nodata,
        spacing,
        vertical,
        geoid_blake3,
    };
    let poles = [const { OnceLock::new() }; 2];
    Ok(Source { raster, mapping, spacing, rule, reference, record, poles, filled: OnceLock::new() })
}
