//! The passes of `leb` on the GPU (protocol: `relief_shaders::leb`), and the uniform mesh.

use bytemuck::{Pod, Zeroable};
use relief_shaders::kernels;
use relief_shaders::leb::{Params, ReliefTriangle, Triangle};
use relief_shaders::planet as shared;
use wgpu::BufferUsages as Use;

use super::atlas::Atlas;
use super::device::Device;
use super::kernel::{self, Binding};

/// Pipelines of the tessellation.
pub(super) struct Tessellation {
    lists: wgpu::BindGroupLayout,
    steer: wgpu::BindGroupLayout,
    cells: wgpu::BindGroupLayout,
    start: wgpu::ComputePipeline,
    pass: wgpu::ComputePipeline,
    args: wgpu::ComputePipeline,
    uniform: wgpu::ComputePipeline,
}

/// `struct LebControl` of `wgsl/lib/leb_lists.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(super) struct Control {
    pub count_in: u32,
    pub count_out: u32,
    pub relief: u32,
    pub overflow: u32,
    pub tested: u32,
    pub culled: u32,
    pub passes: u32,
    pub horizon: u32,
}

/// `struct UniformMesh` of `wgsl/frame_uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct UniformMesh {
    level: u32,
    columns: u32,
    rows: u32,
    padding: u32,
}

/// Lists and results of one view.
pub(super) struct Lists {
    /// Triangles that a pass may yield, and relief triangles.
    pub capacity: [u32; 2],
    params: wgpu::Buffer,
    /// Three corners a triangle.
    pub relief: wgpu::Buffer,
    /// A [`Control`].
    pub control: wgpu::Buffer,
    /// Arguments: of an indirect dispatch, and of an indirect draw from byte 16 on.
    pub args: wgpu::Buffer,
    /// Reading one list and writing the other, and the other way round.
    passes: [wgpu::BindGroup; 2],
    steer: wgpu::BindGroup,
}

impl Tessellation {
    pub fn new(device: &Device) -> Self {
        use Binding::{Read, ReadWrite, Uniform};
        let pages = Atlas::layout(device);
        let lists = kernel::layout(device, "leb", &[Uniform, Uniform, Read, ReadWrite, ReadWrite, ReadWrite]);
        let steer = kernel::layout_for(
            device,
            "leb_args",
            wgpu::ShaderStages::COMPUTE,
            [(1, Uniform), (5, ReadWrite), (6, ReadWrite)],
        );
        let cells = kernel::layout(device, "frame_uniform", &[Uniform, ReadWrite]);
        let of = |name, source, groups: &[Option<&wgpu::BindGroupLayout>]| {
            let layout = kernel::pipeline_layout(device, groups);
            kernel::pipeline(device, &layout, &kernel::module(device, name, source), name)
        };
        Self {
            start: of("leb_start", kernels::LEB_START, &[Some(&pages), Some(&lists)]),
            pass: of("leb_pass", kernels::LEB_PASS, &[Some(&pages), Some(&lists)]),
            args: of("leb_args", kernels::LEB_ARGS, &[None, Some(&steer)]),
            uniform: {
                let layout = kernel::pipeline_layout(device, &[Some(&pages), Some(&cells)]);
                let module = kernel::module(device, "frame_uniform", kernels::FRAME_UNIFORM);
                kernel::pipeline(device, &layout, &module, "uniform_mesh")
            },
            lists,
            steer,
            cells,
        }
    }

    /// Lists of a capacity, for a view whose uniform lies in `view`.
    pub fn lists(&self, device: &Device, view: &wgpu::Buffer, capacity: [u32; 2]) -> Lists {
        let [list, relief] = capacity.map(u64::from);
        let bytes = list * size_of::<Triangle>() as u64;
        let lists = [(); 2].map(|()| kernel::empty(device, "triangles", bytes, Use::STORAGE));
        let relief =
            kernel::empty(device, "relief triangles", relief * size_of::<ReliefTriangle>() as u64, Use::STORAGE);
        let params = kernel::uniform(device, "leb parameters", &Params::default());
        let control = kernel::empty(
            device,
            "leb control",
            size_of::<Control>() as u64,
            Use::STORAGE | Use::COPY_SRC | Use::COPY_DST,
        );
        let args = kernel::empty(device, "leb arguments", 32, Use::STORAGE | Use::INDIRECT | Use::COPY_DST);
        let whole = wgpu::Buffer::as_entire_binding;
        let passes = [[0, 1], [1, 0]].map(|[from, to]| {
            let buffers = [view, &params, &lists[from], &lists[to], &relief, &control];
            kernel::group(device, &self.lists, &buffers.map(whole))
        });
        let steer =
            kernel::group_at(device, &self.steer, [(1, whole(&params)), (5, whole(&control)), (6, whole(&args))]);
        Lists { capacity, params, relief, control, args, passes, steer }
    }

    /// Adds to a pass the bisection of a view. At most `passes` passes are run; whether that was
    /// enough, [`Control::count_in`] says.
    pub fn leb(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        atlas: &Atlas,
        lists: &Lists,
        (planet, view): (&shared::Planet, &shared::View),
        passes: u32,
    ) {
        let params = Params::new(planet, view, lists.capacity[0], lists.capacity[1]);
        device.queue().write_buffer(&lists.params, 0, bytemuck::bytes_of(&params));
        let steer = |pass: &mut wgpu::ComputePass<'_>| {
            pass.set_pipeline(&self.args);
            pass.set_bind_group(1, &lists.steer, &[]);
            pass.dispatch_workgroups(1, 1, 1);
        };
        pass.set_bind_group(0, atlas.group(), &[]);
        pass.set_pipeline(&self.start);
        pass.set_bind_group(1, &lists.passes[1], &[]);
        pass.dispatch_workgroups(1, 1, 1);
        steer(pass);
        for n in 0..passes as usize {
            pass.set_pipeline(&self.pass);
            pass.set_bind_group(1, &lists.passes[n % 2], &[]);
            pass.dispatch_workgroups_indirect(&lists.args, 0);
            steer(pass);
        }
    }

    /// Adds to a pass the uniform mesh of a level. Where the capacity is too small it is that of a
    /// coarser one, and [`Control::overflow`] is set; the coarsest level's always fits.
    pub fn uniform(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        atlas: &Atlas,
        lists: &Lists,
        planet: &shared::Planet,
        level: u32,
    ) {
        let cells = |level: u32| {
            let rows = 1u32 << (planet.m - level);
            [rows << (1 - planet.plane), rows]
        };
        let fits = |level: u32| {
            let [columns, rows] = cells(level).map(u64::from);
            2 * columns * rows <= u64::from(lists.capacity[1])
        };
        let wanted = level.min(planet.root_level);
        let level = (wanted..planet.root_level).find(|&level| fits(level)).unwrap_or(planet.root_level);
        let [columns, rows] = cells(level);
        let triangles = 2 * columns * rows;
        let mesh = kernel::uniform(device, "uniform mesh", &UniformMesh { level, columns, rows, padding: 0 });
        let overflow = u32::from(level > wanted);
        let control = Control { relief: triangles, tested: triangles, overflow, passes: 1, ..Control::default() };
        device.queue().write_buffer(&lists.control, 0, bytemuck::bytes_of(&control));
        let args = [0u32, 0, 0, 0, 3 * triangles, 1, 0, 0];
        device.queue().write_buffer(&lists.args, 0, bytemuck::cast_slice(&args));
        let group = kernel::group(device, &self.cells, &[mesh.as_entire_binding(), lists.relief.as_entire_binding()]);
        pass.set_pipeline(&self.uniform);
        pass.set_bind_group(0, atlas.group(), &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(columns.div_ceil(8), rows.div_ceil(8), 1);
    }
}
