//! Masks as GeoTIFF, where `relief-bake export` puts the same nodes.

use std::io::{Seek, Write};

use relief_front::window::{Rectangle, Samples};
use relief_runtime::geotiff::{Georeference, write_mask};
use relief_runtime::planet::Planet;

use crate::light::Light;
use crate::typed::plain;

/// Writes a mask of a rectangle of a level's nodes, rows from the north.
///
/// # Errors
/// What the writer answered.
pub fn write_tif(
    out: impl Write + Seek,
    planet: &Planet,
    level: u32,
    light: &Light,
    (samples, rectangle): (&Samples, Rectangle),
    lit: &[u8],
) -> std::io::Result<()> {
    let mut metadata = vec![
        ("RELIEF_PLANE", "shadow".to_owned()),
        ("RELIEF_LEVEL", level.to_string()),
        (if samples.wraps { "SUB_SOLAR_DEG" } else { "SUN_AZIMUTH_ELEVATION_DEG" }, light.angles()),
    ];
    metadata.extend(light.time.map(|time| ("TIME", plain(time))));
    let georeference = Georeference {
        body: planet.relief().body(),
        geo_transform: samples.geo_transform(rectangle),
        metadata: &metadata,
    };
    write_mask(out, [rectangle.columns, rectangle.rows], lit, &georeference).map_err(std::io::Error::other)
}
