//! Pictures and meshes from a canvas to RAM.

use relief_shaders::frame::{Places, Shaded};

use super::canvas::Canvas;
use super::device::{Device, DeviceError};
use super::readback::{Mapping, Readback};
use crate::frame::{Frame, ReliefTriangle, Settings, Stats};

impl Canvas {
    /// The last picture in RAM.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn read(&self, device: &Device, settings: &Settings, stats: Stats) -> Result<Frame, DeviceError> {
        let Some((targets, _)) = &self.sized else { return Ok(Frame::default()) };
        let (words, places) = device.guard(|| {
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let words = [&targets.colours, &targets.distances, &targets.normals]
                .map(|buffer| Readback::of(device, &mut encoder, buffer));
            let places = settings.places.then(|| targets.read_places(device, &mut encoder));
            device.queue().submit([encoder.finish()]);
            (words.map(Readback::map), places.map(|rows| rows.map(|rows| rows.map())))
        })?;
        let [colours, distances, normals] = words;
        let shaded = Shaded {
            colours: colours.wait(device)?,
            distances_m: distances.wait(device)?,
            normals: normals.wait(device)?,
        };
        let frame = Frame::new(targets.size, shaded, stats);
        let Some([(places, compact_places), (depths, compact_depths)]) = places else { return Ok(frame) };
        let words = |mapping: &Mapping| mapping.wait::<u32>(device);
        let drawn = Places {
            width: targets.size[0],
            places: compact_places(&words(&places)?).chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(),
            depths: compact_depths(&words(&depths)?).into_iter().map(f32::from_bits).collect(),
        };
        Ok(frame.with_places(&drawn))
    }

    /// The first relief triangles of the last mesh.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn read_mesh(&self, device: &Device, count: u64) -> Result<Vec<ReliefTriangle>, DeviceError> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = count * size_of::<ReliefTriangle>() as u64;
        let mapping = device.guard(|| {
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let readback = Readback::first(device, &mut encoder, &self.lists.relief, bytes);
            device.queue().submit([encoder.finish()]);
            readback.map()
        })?;
        mapping.wait(device)
    }
}
