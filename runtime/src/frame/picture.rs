//! A frame in RAM.

use relief_shaders::frame::{Places, Shaded};

use super::Stats;

/// What was drawn; rows from the top, one value a pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Pixels from left to right.
    pub width: u32,
    /// Pixels from top to bottom.
    pub height: u32,
    /// sRGB and an alpha of 255.
    pub colour: Vec<[u8; 4]>,
    /// Metres from the camera; 0 in the sky.
    pub distance_m: Vec<f32>,
    /// East and north of the ground's unit normal times 32767; 0 in the sky.
    pub normal: Vec<[i16; 2]>,
    /// Visible part of the sun's disk: 0 in full shadow (and in the sky) to 255.
    pub lit: Vec<u8>,
    /// S, T and level of each pixel, where they were asked for.
    pub places: Option<Vec<Place>>,
    /// What it cost.
    pub stats: Stats,
}

/// Where a pixel looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Fixed point.
    pub s: u32,
    /// Fixed point.
    pub t: u32,
    /// Level of detail of the triangle that is drawn there; none in the sky.
    pub level: Option<i8>,
}

impl Frame {
    pub(crate) fn new([width, height]: [u32; 2], shaded: Shaded, stats: Stats) -> Self {
        let bytes = |colour: &u32| colour.to_le_bytes();
        Self {
            width,
            height,
            colour: shaded.colours.iter().map(bytes).map(|[r, g, b, _]| [r, g, b, 255]).collect(),
            lit: shaded.colours.iter().map(|colour| (colour >> 24) as u8).collect(),
            distance_m: shaded.distances_m,
            normal: shaded.normals.iter().map(|&n| [n as i16, (n >> 16) as i16]).collect(),
            places: None,
            stats,
        }
    }

    pub(crate) fn with_places(self, drawn: &Places) -> Self {
        let place = |(&[s, t, marks], &depth): (&[u32; 3], &f32)| match depth > 0.0 {
            true => Place { s, t, level: Some(((marks & 255) as i32 - 128) as i8) },
            false => Place::default(),
        };
        let places = drawn.places.iter().zip(&drawn.depths).map(place).collect();
        Self { places: Some(places), ..self }
    }
}
