//! What the tests of the GPU backend share.

use std::sync::Arc;

use relief_runtime::gpu::{AdapterChoice, Device};
use relief_runtime::planet::Planet;

use relief_tests::sample_file::Sample;

/// The device of these tests; none where `RELIEF_NO_GPU=1` says that there is no adapter.
///
/// # Panics
/// Where there is no adapter and nobody said so.
pub fn device() -> Option<Device> {
    if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
        eprintln!("RELIEF_NO_GPU=1: nothing is tested on a GPU");
        return None;
    }
    match Device::headless(AdapterChoice::Fastest) {
        Ok(device) => Some(device),
        Err(error) => panic!("{error} (RELIEF_NO_GPU=1 leaves the tests that need one out)"),
    }
}

/// A planet of a sample.
pub fn planet(sample: &Sample) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sample.relief");
    sample.write(&path);
    Planet::open(&path).unwrap()
}

/// The 32-bit texels of a texture whose rows are a multiple of 256 bytes.
pub fn read_words(device: &Device, texture: &wgpu::Texture, [width, height]: [u32; 2]) -> Vec<u32> {
    let buffer = device.wgpu().create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * width * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    device.queue().submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
    device.wait().unwrap();
    let view = buffer.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&view)
}
