//! The buffers a view is drawn with: its uniforms, lists and targets.

use relief_shaders::frame::Style;
use relief_shaders::planet as shared;

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel;
use super::lists::{CAPACITY, Lists};
use super::picture::{Groups, Picture};
use super::targets::Targets;
use super::tessellate::Tessellation;

/// Pixels of other sizes that are kept, 32 bytes each: cameras of several sizes take turns, and making
/// targets anew costs as much as a small picture.
const KEPT_PIXELS: u64 = 1 << 22;
/// Other sizes that are kept.
const KEPT: usize = 8;

pub(super) struct Canvas {
    pub view: wgpu::Buffer,
    pub style: wgpu::Buffer,
    pub lists: Lists,
    /// What the shadows' rays fetched: rays, heights, extremes, steps.
    pub fetched: wgpu::Buffer,
    /// Of the last picture's size.
    pub sized: Option<(Targets, Groups)>,
    /// Of sizes before, the latest last.
    kept: Vec<(Targets, Groups)>,
}

impl Canvas {
    pub fn new(device: &Device, tessellation: &Tessellation, style: &Style) -> Self {
        let view = kernel::uniform(device, "view", &shared::View::default());
        let lists = Lists::new(device, tessellation, &view, CAPACITY);
        let counts = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let fetched = kernel::empty(device, "fetched", 16, counts);
        Self { fetched, style: kernel::uniform(device, "style", style), view, lists, sized: None, kept: Vec::new() }
    }

    /// Targets of a size, and what view and style are.
    pub fn set(&mut self, device: &Device, picture: &Picture, atlas: &Atlas, view: &shared::View, style: &Style) {
        let size = [view.width, view.height];
        if self.sized.as_ref().is_none_or(|(targets, _)| targets.size != size) {
            self.kept.extend(self.sized.take());
            let at = self.kept.iter().position(|(targets, _)| targets.size == size);
            let known = at.map(|at| self.kept.remove(at));
            self.forget_some();
            self.sized = Some(known.unwrap_or_else(|| {
                let targets = Targets::new(device, size);
                let buffers = [&self.view, &self.style, &self.fetched];
                let groups = picture.groups(device, atlas, buffers, &self.lists, &targets);
                (targets, groups)
            }));
        }
        device.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(view));
        device.queue().write_buffer(&self.style, 0, bytemuck::bytes_of(style));
    }

    /// Keeps few targets, and few pixels.
    fn forget_some(&mut self) {
        let pixels = |(targets, _): &(Targets, Groups)| targets.size.map(u64::from).iter().product::<u64>();
        while self.kept.len() > KEPT || self.kept.iter().map(pixels).sum::<u64>() > KEPT_PIXELS {
            self.kept.remove(0);
        }
    }

    /// Doubles the lists; false when the device holds no larger ones.
    ///
    /// # Errors
    /// [`DeviceError::OutOfMemory`].
    pub fn grow(&mut self, device: &Device, tessellation: &Tessellation) -> Result<bool, DeviceError> {
        let Some(lists) = self.lists.doubled(device, tessellation, &self.view)? else { return Ok(false) };
        self.lists = lists;
        self.sized = None;
        self.kept.clear();
        Ok(true)
    }
}
