//! Output files by their names.

use std::io::Write;
use std::path::Path;

use relief_front::error::ToolError;

/// Refuses a name that does not end in one of `extensions`.
pub fn check_name(flag: &str, path: &Path, extensions: &[&str]) -> Result<(), ToolError> {
    let given = extension(path);
    if extensions.contains(&given.as_str()) {
        return Ok(());
    }
    let endings: Vec<String> = extensions.iter().map(|e| format!(".{e}")).collect();
    Err(ToolError::usage(
        format!("{flag} {}", path.display()),
        format!("the name ends in {} and so says what to write", endings.join(" or ")),
        format!("name {}", path.with_extension(extensions[0]).display()),
    ))
}

/// The ending of a name in lower case, without its dot.
pub fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Writes an 8-bit grey PNG, rows from the top.
///
/// # Errors
/// What the writer answered.
pub fn write_grey_png(out: impl Write, [width, height]: [u32; 2], values: &[u8]) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(values)?;
    Ok(writer.finish()?)
}
