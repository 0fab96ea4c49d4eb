//! Lists, counts and arguments of one view's tessellation.

use relief_shaders::leb::control::Args;
use relief_shaders::leb::{Params, ReliefTriangle, Triangle};
use relief_shaders::paper::{Control, Patch};
use relief_shaders::planet as shared;
use wgpu::BufferUsages as Use;

use super::device::{Device, DeviceError};
use super::kernel;
use super::tessellate::Tessellation;

/// Triangles that a pass may yield and relief triangles, to begin with; both grow when needed.
pub(super) const CAPACITY: [u32; 2] = [1 << 17, 1 << 18];
/// Triangles of one workgroup.
pub(super) const GROUP: u32 = 64;
/// Bytes of an entry of a pass's list, whichever the scheme.
const ENTRY_BYTES: u64 =
    if size_of::<Patch>() > size_of::<Triangle>() { size_of::<Patch>() } else { size_of::<Triangle>() } as u64;

/// Buffers shared by all schemes.
pub(super) struct Lists {
    /// Triangles that a pass may yield, and relief triangles.
    pub capacity: [u32; 2],
    params: wgpu::Buffer,
    /// Three corners a triangle.
    pub relief: wgpu::Buffer,
    /// A [`Control`]; scheme `leb` uses its first part.
    pub control: wgpu::Buffer,
    /// An [`Args`].
    pub args: wgpu::Buffer,
    /// Reading one list and writing the other, and the other way round.
    pub passes: [wgpu::BindGroup; 2],
    pub steer: wgpu::BindGroup,
}

impl Lists {
    /// For a view whose uniform lies in `view`.
    pub fn new(device: &Device, tessellation: &Tessellation, view: &wgpu::Buffer, capacity: [u32; 2]) -> Self {
        let [list, relief] = capacity.map(u64::from);
        let lists = [(); 2].map(|()| kernel::empty(device, "triangles", list * ENTRY_BYTES, Use::STORAGE));
        let relief_bytes = relief * size_of::<ReliefTriangle>() as u64;
        let relief = kernel::empty(device, "relief triangles", relief_bytes, Use::STORAGE | Use::COPY_SRC);
        let params = kernel::uniform(device, "parameters", &Params::default());
        let counts = Use::STORAGE | Use::COPY_SRC | Use::COPY_DST;
        let control = kernel::empty(device, "control", size_of::<Control>() as u64, counts);
        let arguments = Use::STORAGE | Use::INDIRECT | Use::COPY_DST;
        let args = kernel::empty(device, "arguments", size_of::<Args>() as u64, arguments);
        let whole = wgpu::Buffer::as_entire_binding;
        let passes = [[0, 1], [1, 0]].map(|[from, to]| {
            let buffers = [view, &params, &lists[from], &lists[to], &relief, &control];
            kernel::group(device, &tessellation.lists, &buffers.map(whole))
        });
        let steer = kernel::group(device, &tessellation.steer, &[&params, &control, &args].map(whole));
        Self { capacity, params, relief, control, args, passes, steer }
    }

    /// What the kernels are told of the view and of these lists.
    pub fn set(&self, device: &Device, planet: &shared::Planet, view: &shared::View) {
        let params = Params::new(planet, view, self.capacity[0], self.capacity[1]);
        device.queue().write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
    }

    /// Counts and arguments of a mesh that needs no passes.
    pub fn set_ready(&self, device: &Device, control: &Control) {
        let args = Args { vertices: 3 * control.relief, instances: 1, ..Args::default() };
        device.queue().write_buffer(&self.control, 0, bytemuck::bytes_of(control));
        device.queue().write_buffer(&self.args, 0, bytemuck::bytes_of(&args));
    }

    /// Lists twice as long; none when the device holds no larger ones.
    ///
    /// # Errors
    /// [`DeviceError::OutOfMemory`].
    pub fn doubled(
        &self,
        device: &Device,
        tessellation: &Tessellation,
        view: &wgpu::Buffer,
    ) -> Result<Option<Self>, DeviceError> {
        let limits = device.wgpu().limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let [list, relief] = self.capacity.map(|count| u64::from(count) * 2);
        let bytes = (list * ENTRY_BYTES).max(relief * size_of::<ReliefTriangle>() as u64);
        let groups = u64::from(limits.max_compute_workgroups_per_dimension);
        if bytes > most || list > groups * u64::from(GROUP) {
            return Ok(None);
        }
        device.guard(|| Some(Self::new(device, tessellation, view, [list as u32, relief as u32])))
    }
}
