//! Pixels of one named channel of an EXR file.

use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::*;

use super::heights::{BandTags, HeightRule};
use relief_front::error::ToolError;

/// One channel of one part of an EXR file. Its data window is the raster, row 0 north.
pub(crate) struct ExrReader {
    path: String,
    channel: String,
    size: (usize, usize),
    rule: HeightRule,
}

/// What the header tells about the chosen channel.
pub(crate) struct OpenExr {
    pub channel: String,
    pub size: (usize, usize),
    pub type_name: String,
    pub tags: BandTags,
}

/// True when the file starts as EXR files do, or is named like one.
pub(crate) fn is_exr(path: &str) -> bool {
    const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    let mut start = [0; 4];
    let by_name = Path::new(path).extension().is_some_and(|end| end.eq_ignore_ascii_case("exr"));
    let read = std::fs::File::open(path).and_then(|mut file| std::io::Read::read_exact(&mut file, &mut start));
    (by_name && Path::new(path).is_file()) || (read.is_ok() && start == MAGIC)
}

/// Reads the header and picks the channel: the one named, else `height`, `Y`, `Z`, else the only one.
///
/// # Errors
/// [`ToolError::Source`] with the decoder's message, or with the list of channels.
pub(crate) fn open_exr(path: &str, wanted: Option<&str>) -> std::result::Result<OpenExr, ToolError> {
    let meta = guarded(path, || MetaData::read_from_file(path, false))?;
    let flat: Vec<_> = meta.headers.iter().filter(|header| !header.deep).collect();
    let mut names: Vec<String> = Vec::new();
    for channel in flat.iter().flat_map(|header| &header.channels.list) {
        let name = channel.name.to_string();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let picked = match wanted {
        Some(name) => names.iter().find(|known| *known == name),
        None => ["height", "Y", "Z"]
            .iter()
            .find_map(|usual| names.iter().find(|name| name == usual))
            .or_else(|| names.first().filter(|_| names.len() == 1)),
    };
    let Some(channel) = picked.cloned() else {
        let what = match wanted {
            Some(name) => format!("it has no channel {name:?}"),
            None => "none of its channels is known to be the height".to_owned(),
        };
        return Err(ToolError::source(
            path,
            what,
            format!("channels: {}", if names.is_empty() { "none that is not deep".into() } else { names.join(", ") }),
            "name one with --channel",
        ));
    };
    let found = flat
        .iter()
        .find_map(|header| Some((header, header.channels.list.iter().find(|entry| entry.name.eq(channel.as_str()))?)));
    let Some((header, entry)) = found else {
        return Err(damaged(path, "the channel list contradicts itself"));
    };
    if entry.sampling != Vec2(1, 1) {
        return Err(ToolError::source(
            path,
            format!("channel {channel} has one sample every {} x {} pixels", entry.sampling.0, entry.sampling.1),
            "the height channel has a sample in every pixel",
            "name another channel with --channel",
        ));
    }
    let size = (header.layer_size.0, header.layer_size.1);
    if size.0 == 0 || size.1 == 0 {
        return Err(damaged(path, "the data window is empty"));
    }
    let (type_name, integer) = match entry.sample_type {
        SampleType::F16 => ("Float16", false),
        SampleType::F32 => ("Float32", false),
        SampleType::U32 => ("UInt32", true),
    };
    let tags = BandTags { float32: !integer, integer, ..BandTags::default() };
    Ok(OpenExr { channel, size, type_name: type_name.into(), tags })
}

impl ExrReader {
    /// A reader of the channel that was opened.
    pub fn new(path: &str, open: &OpenExr, rule: HeightRule) -> Self {
        Self { path: path.into(), channel: open.channel.clone(), size: open.size, rule }
    }

    /// Decodes the whole channel, metres, NaN where void.
    ///
    /// # Errors
    /// [`ToolError::Source`] with the decoder's message when the file is damaged.
    pub fn load(&self) -> std::result::Result<Vec<f32>, ToolError> {
        struct Pixels {
            width: usize,
            values: Vec<f32>,
        }
        let rule = self.rule.clone();
        let image = guarded(&self.path, move || {
            read()
                .no_deep_data()
                .largest_resolution_level()
                .specific_channels()
                .required(self.channel.as_str())
                .collect_pixels(
                    |size, _| Pixels { width: size.width(), values: vec![f32::NAN; size.area()] },
                    move |pixels: &mut Pixels, at, (value,): (Sample,)| {
                        let raw = match value {
                            Sample::F16(value) => f64::from(value.to_f32()),
                            Sample::F32(value) => f64::from(value),
                            Sample::U32(value) => f64::from(value),
                        };
                        pixels.values[at.y() * pixels.width + at.x()] = rule.height_m(raw);
                    },
                )
                .first_valid_layer()
                .all_attributes()
                .from_file(&self.path)
        })?;
        let pixels = image.layer_data.channel_data.pixels;
        if pixels.values.len() != self.size.0 * self.size.1 || pixels.width != self.size.0 {
            return Err(damaged(&self.path, "the data window changed between two readings"));
        }
        Ok(pixels.values)
    }
}

/// Runs the decoder; what it says, and should it panic that too, becomes an error about the file.
fn guarded<T>(path: &str, decode: impl FnOnce() -> Result<T>) -> std::result::Result<T, ToolError> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode)) {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(damaged(path, &error.to_string())),
        Err(_) => Err(damaged(path, "the decoder gave up on its contents")),
    }
}

fn damaged(path: &str, message: &str) -> ToolError {
    ToolError::source(
        path,
        format!("EXR: {message}"),
        "an EXR file is whole and of a kind the exr crate reads (flat, scan lines or tiles)",
        "write it again from its source, for example with exrmaketiled or oiiotool",
    )
}
