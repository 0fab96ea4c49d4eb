//! What a picture is drawn into.

use wgpu::{BufferUsages, TextureUsages};

use super::device::Device;
use super::kernel;
use super::readback::{Mapping, Readback};
use crate::view::ViewError;

/// Format of the places: S, T, marks.
pub(super) const PLACES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Format of the depths.
pub(super) const DEPTHS: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Textures and buffers of one size.
pub(super) struct Targets {
    pub size: [u32; 2],
    places: wgpu::Texture,
    pub places_view: wgpu::TextureView,
    depths: wgpu::Texture,
    pub depths_view: wgpu::TextureView,
    /// One word a pixel each.
    pub colours: wgpu::Buffer,
    pub distances: wgpu::Buffer,
    pub normals: wgpu::Buffer,
}

impl Targets {
    /// True where a picture of this size fits the device.
    pub fn check(device: &Device, [width, height]: [u32; 2]) -> Result<(), ViewError> {
        let limits = device.wgpu().limits();
        let bytes = 4 * u64::from(width) * u64::from(height);
        let side = limits.max_texture_dimension_2d;
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if width.max(height) > side {
            return Err(ViewError::Size { width, height, limit: Some(side) });
        }
        if bytes > most {
            return Err(ViewError::Size { width, height, limit: Some(side.min((most / 4).isqrt() as u32)) });
        }
        Ok(())
    }

    pub fn new(device: &Device, size: [u32; 2]) -> Self {
        let texture = |label, format, usage| {
            let texture = device.wgpu().create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(size),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | usage,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            (texture, view)
        };
        let words = |label| {
            let bytes = 4 * u64::from(size[0]) * u64::from(size[1]);
            kernel::empty(device, label, bytes, BufferUsages::STORAGE | BufferUsages::COPY_SRC)
        };
        let (places, places_view) = texture("places", PLACES, TextureUsages::COPY_SRC);
        let (depths, depths_view) = texture("depths", DEPTHS, TextureUsages::COPY_SRC);
        Self {
            size,
            places,
            places_view,
            depths,
            depths_view,
            colours: words("colours"),
            distances: words("distances"),
            normals: words("normals"),
        }
    }

    /// Adds to an encoder the copy of the places and of their depths.
    pub fn read_places(&self, device: &Device, encoder: &mut wgpu::CommandEncoder) -> [Rows; 2] {
        [(&self.places, 16), (&self.depths, 4)].map(|(texture, bytes)| {
            let row_bytes = (self.size[0] * bytes).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
            let readback = Readback::empty(device, u64::from(row_bytes) * u64::from(self.size[1]));
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: readback.buffer(),
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row_bytes),
                        rows_per_image: None,
                    },
                },
                extent(self.size),
            );
            Rows { readback, row_words: row_bytes as usize / 4, words: (self.size[0] * bytes) as usize / 4 }
        })
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

/// A copy of a texture, its rows padded.
pub(super) struct Rows {
    readback: Readback,
    row_words: usize,
    words: usize,
}

impl Rows {
    /// Asks for the words, after the commands were submitted: the mapping, and what takes the
    /// padding away.
    pub fn map(self) -> (Mapping, impl Fn(&[u32]) -> Vec<u32>) {
        let (row_words, words) = (self.row_words, self.words);
        let compact = move |all: &[u32]| all.chunks(row_words).flat_map(|row| &row[..words]).copied().collect();
        (self.readback.map(), compact)
    }
}
