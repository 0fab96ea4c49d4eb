//! A picture as payloads.

use jpeg_encoder::{ColorType, Encoder};
use relief_protocol::payload::{Format, Header, Stream};
use relief_protocol::to_server::{Frame, FrameFormat, Mask, MaskFormat, Streams};
use relief_runtime::frame;

use super::outbox::Payload;
use crate::mesh::packed::packed;
use crate::serve::engine::Picture;

/// All payloads of a picture, smallest part first.
pub fn payloads<'a>(picture: &'a Picture, camera: &'a str, streams: Streams) -> impl Iterator<Item = Payload> + 'a {
    let wanted = [
        (Stream::Frame, streams.frame.is_some()),
        (Stream::Mask, streams.mask.is_some()),
        (Stream::Depth, streams.depth.is_some()),
        (Stream::Mesh, streams.mesh.is_some() && picture.mesh.is_some()),
    ];
    let parts: Vec<Stream> = wanted.into_iter().filter(|&(_, wanted)| wanted).map(|(stream, _)| stream).collect();
    let count = parts.len() as u32;
    (0..).zip(parts).map(move |(part, stream)| {
        let mut mesh = None;
        let (format, bytes) = match stream {
            Stream::Frame => frame_bytes(&picture.frame, streams.frame.unwrap_or_default()),
            Stream::Mask => mask_bytes(&picture.frame, streams.mask.unwrap_or_default()),
            Stream::Depth => (Format::F32, picture.frame.distance_m.iter().flat_map(|m| m.to_le_bytes()).collect()),
            Stream::Mesh => {
                let triangles = picture.mesh.as_deref().unwrap_or_default();
                let (counts, bytes) = packed(&picture.planet, &picture.view.camera, triangles);
                mesh = Some(counts);
                (Format::Mesh, bytes)
            }
        };
        let header = Header {
            stream,
            format,
            camera: camera.to_owned(),
            view: picture.number,
            seq: picture.seq,
            part,
            parts: count,
            size: [picture.frame.width, picture.frame.height],
            complete: picture.complete,
            sun: picture.sun_deg,
            stats: picture.stats.clone(),
            mesh,
        };
        Payload { header, bytes, hold: picture.hold() }
    })
}

/// A frame, packed.
pub fn frame_bytes(frame: &frame::Frame, Frame { format, quality }: Frame) -> (Format, Vec<u8>) {
    let pixels: &[u8] = frame.colour.as_flattened();
    match (format, u16::try_from(frame.width), u16::try_from(frame.height)) {
        (FrameFormat::Jpeg, Ok(width), Ok(height)) => {
            let mut bytes = Vec::new();
            // Writing to memory fails for no picture of this size.
            match Encoder::new(&mut bytes, quality).encode(pixels, width, height, ColorType::Rgba) {
                Ok(()) => (Format::Jpeg, bytes),
                Err(_) => png(frame, png::ColorType::Rgba, pixels),
            }
        }
        (FrameFormat::Rgba, ..) => (Format::Rgba, pixels.to_vec()),
        _ => png(frame, png::ColorType::Rgba, pixels),
    }
}

fn mask_bytes(frame: &frame::Frame, Mask { format }: Mask) -> (Format, Vec<u8>) {
    match format {
        MaskFormat::Png => png(frame, png::ColorType::Grayscale, &frame.lit),
        MaskFormat::Raw => (Format::U8, frame.lit.clone()),
    }
}

fn png(frame: &frame::Frame, colour: png::ColorType, samples: &[u8]) -> (Format, Vec<u8>) {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, frame.width, frame.height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    // Writing to memory fails for no picture that has pixels.
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(samples)?;
        writer.finish()
    });
    if written.is_err() {
        bytes.clear();
    }
    (Format::Png, bytes)
}
