//! PNG output.

use std::io::{self, Write};
use std::path::Path;

use super::RgbImage;
use crate::error::ToolError;
use crate::publish::publish;

/// Writes an 8-bit RGB PNG, whole or not at all; an existing file is replaced.
///
/// # Errors
/// What the disk answered.
pub fn write_png(path: &Path, image: &RgbImage) -> Result<(), ToolError> {
    publish(path, |out| encode(image, out))
}

/// The bytes of an 8-bit RGB PNG, for embedding.
///
/// # Errors
/// A picture without pixels, or one whose sides PNG cannot count.
pub fn png_bytes(image: &RgbImage) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode(image, &mut bytes)?;
    Ok(bytes)
}

fn encode(image: &RgbImage, out: impl Write) -> io::Result<()> {
    let side = |n: usize| u32::try_from(n).map_err(io::Error::other);
    let mut encoder = png::Encoder::new(out, side(image.width)?, side(image.height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(image.pixels.as_flattened()).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_back() {
        let pixels: Vec<[u8; 3]> = (0..35u8).map(|k| [k, 255 - k, k * 7]).collect();
        let image = RgbImage { width: 7, height: 5, pixels };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &image).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes, png_bytes(&image).unwrap());
        let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().unwrap();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut buffer).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (7, 5, png::ColorType::Rgb));
        assert_eq!(buffer, image.pixels.as_flattened());
    }

    #[test]
    fn a_picture_without_pixels_is_refused() {
        assert!(png_bytes(&RgbImage { width: 0, height: 0, pixels: vec![] }).is_err());
        assert!(png_bytes(&RgbImage { width: 2, height: 2, pixels: vec![] }).is_err());
    }
}
