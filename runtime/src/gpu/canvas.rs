//! The buffers a view is drawn with: its uniforms, lists and targets.

use relief_shaders::frame::Style;
use relief_shaders::leb::{ReliefTriangle, Triangle};
use relief_shaders::planet as shared;

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel;
use super::picture::{Groups, Picture};
use super::targets::Targets;
use super::tessellate::{Lists, Tessellation};

/// Triangles that a pass may yield and relief triangles, to begin with; both grow when needed.
const CAPACITY: [u32; 2] = [1 << 17, 1 << 18];
/// Groups of 64 triangles in one dispatch.
const MOST_GROUPS: u32 = 65_535;

pub(super) struct Canvas {
    pub view: wgpu::Buffer,
    pub style: wgpu::Buffer,
    pub lists: Lists,
    /// Of the last picture's size.
    pub sized: Option<(Targets, Groups)>,
}

impl Canvas {
    pub fn new(device: &Device, tessellation: &Tessellation, style: &Style) -> Self {
        let view = kernel::uniform(device, "view", &shared::View::default());
        let lists = tessellation.lists(device, &view, CAPACITY);
        Self { style: kernel::uniform(device, "style", style), view, lists, sized: None }
    }

    /// Targets of a size, and what view and style are.
    pub fn set(&mut self, device: &Device, picture: &Picture, atlas: &Atlas, view: &shared::View, style: &Style) {
        let size = [view.width, view.height];
        if self.sized.as_ref().is_none_or(|(targets, _)| targets.size != size) {
            self.sized = None;
            let targets = Targets::new(device, size);
            let groups = picture.groups(device, atlas, [&self.view, &self.style], &self.lists, &targets);
            self.sized = Some((targets, groups));
        }
        device.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        device.queue().write_buffer(&self.style, 0, bytemuck::bytes_of(style));
    }

    /// Doubles the lists; false when the device holds no larger ones.
    ///
    /// # Errors
    /// [`DeviceError::OutOfMemory`].
    pub fn grow(&mut self, device: &Device, tessellation: &Tessellation) -> Result<bool, DeviceError> {
        let limits = device.wgpu().limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let [list, relief] = self.lists.capacity.map(|count| u64::from(count) * 2);
        let bytes = [list * size_of::<Triangle>() as u64, relief * size_of::<ReliefTriangle>() as u64];
        if bytes.into_iter().any(|bytes| bytes > most) || list > u64::from(MOST_GROUPS) * 64 {
            return Ok(false);
        }
        self.lists = device.guard(|| tessellation.lists(device, &self.view, [list as u32, relief as u32]))?;
        self.sized = None;
        Ok(true)
    }
}
