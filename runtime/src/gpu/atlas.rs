//! The atlas in the GPU's memory: group 0 of every kernel (`wgsl/lib/pages.wgsl`).

use relief_shaders::pages::{BOUND_WORDS, HEIGHT_WORDS};

use super::device::{Device, DeviceError};
use super::kernel::{self, Binding};
use super::readback::Readback;
use crate::planet::Planet;
use crate::residency::{Capacity, Page, Resident, Store};

/// Slots, tables and the record of pages asked for.
pub struct Atlas {
    device: Device,
    planet: wgpu::Buffer,
    heights: wgpu::Buffer,
    bounds: wgpu::Buffer,
    table: wgpu::Buffer,
    seen: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Bindings of group 0: planet, page table, heights, bounds, seen.
const GROUP: [Binding; 5] = [Binding::Uniform, Binding::Read, Binding::Read, Binding::Read, Binding::ReadWrite];

impl Atlas {
    /// The slots that fit `atlas_bytes` and the device's limits.
    ///
    /// # Errors
    /// Limits too small for any view.
    pub fn capacity(device: &Device, atlas_bytes: u64) -> Result<Capacity, crate::residency::CapacityError> {
        let limits = device.wgpu().limits();
        Capacity::within(atlas_bytes, limits.max_storage_buffer_binding_size.min(limits.max_buffer_size))
    }

    /// An empty atlas for a planet.
    ///
    /// # Errors
    /// What the device says, [`DeviceError::OutOfMemory`] above all.
    pub fn new(device: &Device, planet: &Planet, capacity: Capacity) -> Result<Self, DeviceError> {
        use wgpu::BufferUsages as Use;
        device.guard(|| {
            let words = |label, words: u64, usage| kernel::empty(device, label, 4 * words, usage);
            let slots = u64::from(capacity.slots());
            let planet_uniform = kernel::uniform(device, "planet", &capacity.uniform(planet));
            let heights = words("heights", slots * u64::from(HEIGHT_WORDS), Use::STORAGE | Use::COPY_DST);
            let bounds = words("bounds", slots * u64::from(BOUND_WORDS), Use::STORAGE | Use::COPY_DST);
            let table = words("page table", 2 << capacity.table_bits(), Use::STORAGE | Use::COPY_DST);
            let seen =
                words("pages asked for", 1 << capacity.seen_bits(), Use::STORAGE | Use::COPY_DST | Use::COPY_SRC);
            let group = kernel::group(
                device,
                &Self::layout(device),
                &[&planet_uniform, &table, &heights, &bounds, &seen].map(wgpu::Buffer::as_entire_binding),
            );
            Self { device: device.clone(), planet: planet_uniform, heights, bounds, table, seen, group }
        })
    }

    /// The layout of group 0.
    #[must_use]
    pub fn layout(device: &Device) -> wgpu::BindGroupLayout {
        kernel::layout(device, "pages", &GROUP)
    }

    /// Group 0.
    #[must_use]
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// The planet's uniform, for pipelines that read no page.
    pub(super) fn planet(&self) -> &wgpu::Buffer {
        &self.planet
    }

    /// The device it lies on.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Adds to an encoder: the record of pages asked for is copied for reading and cleared.
    pub(super) fn take_seen(&self, encoder: &mut wgpu::CommandEncoder) -> Readback {
        let readback = Readback::of(&self.device, encoder, &self.seen);
        encoder.clear_buffer(&self.seen, 0, None);
        readback
    }
}

impl Store for Atlas {
    fn write_page(&mut self, slot: u32, page: &Page) {
        let slot = u64::from(slot);
        let queue = self.device.queue();
        queue.write_buffer(&self.heights, 4 * slot * u64::from(HEIGHT_WORDS), bytemuck::cast_slice(&page.heights));
        queue.write_buffer(&self.bounds, 4 * slot * u64::from(BOUND_WORDS), bytemuck::cast_slice(&page.bounds));
    }

    fn write_table(&mut self, table: &[[u32; 2]]) {
        self.device.queue().write_buffer(&self.table, 0, bytemuck::cast_slice(table));
    }
}

impl Resident<Atlas> {
    /// Hands a record that a frame left to [`Resident::ask`].
    pub(super) fn ask_record(&mut self, record: &[u32]) -> usize {
        self.ask(record.iter().filter_map(|entry| entry.checked_sub(1)))
    }
}
