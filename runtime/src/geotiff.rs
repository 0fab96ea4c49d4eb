//! Masks as GeoTIFF 1.1 (OGC 19-008), without GDAL: 8-bit, north up, one strip after another.

mod crs;

use std::io::{Seek, Write};

use relief_formats::body::Body;
use tiff::encoder::compression::DeflateLevel;
use tiff::encoder::{Compression, DirectoryEncoder, Predictor, TiffEncoder, TiffKind, colortype::Gray8};
use tiff::tags::Tag;
use tiff::{TiffError, TiffResult};

pub use crs::{GeoKeys, sidecar};

/// Rows of a strip.
const STRIP: u32 = 64;
/// Above this a classic TIFF's 32-bit offsets may not do, deflated badly or not.
const CLASSIC_BYTES: u64 = 0xf000_0000;
/// GDAL's tag for metadata.
const GDAL_METADATA: u16 = 42112;

/// Where a raster lies and what it is.
pub struct Georeference<'a> {
    /// The body, with its CRS.
    pub body: &'a Body,
    /// GDAL's geotransform, without rotation: west edge, width of a pixel, 0, north edge, 0, minus
    /// the height of a pixel; degrees on a globe, CRS units on a plane.
    pub geo_transform: [f64; 6],
    /// Names and values for GDAL's metadata.
    pub metadata: &'a [(&'a str, String)],
}

/// Writes a mask: `values` row by row from the north, `columns` x `rows` of them.
///
/// # Errors
/// What the writer answered, or a raster that has no pixels or not as many as it says.
pub fn write_mask<W: Write + Seek>(
    out: W,
    [columns, rows]: [u32; 2],
    values: &[u8],
    georeference: &Georeference<'_>,
) -> TiffResult<()> {
    if values.len() as u64 > CLASSIC_BYTES {
        write(TiffEncoder::new_big(out)?, [columns, rows], values, georeference)
    } else {
        write(TiffEncoder::new(out)?, [columns, rows], values, georeference)
    }
}

fn write<W: Write + Seek, K: TiffKind>(
    encoder: TiffEncoder<W, K>,
    [columns, rows]: [u32; 2],
    values: &[u8],
    georeference: &Georeference<'_>,
) -> TiffResult<()> {
    if columns == 0 || rows == 0 || values.len() as u64 != u64::from(columns) * u64::from(rows) {
        return Err(TiffError::IoError(std::io::Error::other(format!(
            "{columns} x {rows} pixels need as many values, above none; there are {}",
            values.len()
        ))));
    }
    let mut encoder =
        encoder.with_compression(Compression::Deflate(DeflateLevel::Balanced)).with_predictor(Predictor::None);
    let mut image = encoder.new_image::<Gray8>(columns, rows)?;
    image.rows_per_strip(STRIP)?;
    describe(image.encoder(), georeference)?;
    // The encoder compresses only what it is given whole.
    image.write_data(values)
}

fn describe<W: Write + Seek, K: TiffKind>(
    directory: &mut DirectoryEncoder<'_, W, K>,
    georeference: &Georeference<'_>,
) -> TiffResult<()> {
    let [west, dx, _, north, _, minus_dy] = georeference.geo_transform;
    directory.write_tag(Tag::ModelPixelScaleTag, &[dx, -minus_dy, 0.0][..])?;
    directory.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, west, north, 0.0][..])?;
    let keys = GeoKeys::of(georeference.body);
    directory.write_tag(Tag::GeoKeyDirectoryTag, &keys.directory()[..])?;
    if !keys.doubles().is_empty() {
        directory.write_tag(Tag::GeoDoubleParamsTag, keys.doubles())?;
    }
    if !keys.ascii().is_empty() {
        directory.write_tag(Tag::GeoAsciiParamsTag, keys.ascii())?;
    }
    if !georeference.metadata.is_empty() {
        let item = |(name, value): &(&str, String)| format!("<Item name=\"{name}\">{}</Item>", escaped(value));
        let items: String = georeference.metadata.iter().map(item).collect();
        directory.write_tag(Tag::Unknown(GDAL_METADATA), &*format!("<GDALMetadata>{items}</GDALMetadata>"))?;
    }
    Ok(())
}

/// Text for XML; what TIFF's ASCII cannot hold becomes a question mark.
fn escaped(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii() && !c.is_ascii_control() { c } else { '?' }).fold(
        String::new(),
        |mut out, c| {
            match c {
                '&' => out.push_str("&amp;"),
                '<' => out.push_str("&lt;"),
                '>' => out.push_str("&gt;"),
                c => out.push(c),
            }
            out
        },
    )
}

#[cfg(test)]
mod tests;
