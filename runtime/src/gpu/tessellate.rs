//! The passes of the schemes on the GPU; their protocols are those of `relief_shaders::leb` and
//! `relief_shaders::paper`.

use std::sync::OnceLock;

use relief_shaders::frame::uniform::UniformMesh;
use relief_shaders::paper::{Control, patch};
use relief_shaders::{kernels, leb, paper, planet as shared};

use super::atlas::Atlas;
use super::device::Device;
use super::kernel::{self, Binding};
use super::lists::{GROUP, Lists};
use crate::frame::Scheme;

/// Pipelines of the tessellation.
pub(super) struct Tessellation {
    /// Group 1 of the passes.
    pub lists: wgpu::BindGroupLayout,
    /// Group 0 of what runs between passes.
    pub steer: wgpu::BindGroupLayout,
    cells: wgpu::BindGroupLayout,
    args: wgpu::ComputePipeline,
    /// Start and pass of `leb`.
    leb: [wgpu::ComputePipeline; 2],
    /// Start and pass of `paper`, compiled when they are first needed.
    paper: OnceLock<[wgpu::ComputePipeline; 2]>,
    /// Compiled when it is first needed.
    uniform: OnceLock<wgpu::ComputePipeline>,
}

impl Tessellation {
    pub fn new(device: &Device) -> Self {
        use Binding::{Read, ReadWrite, Uniform};
        let lists = kernel::layout(device, "lists", &[Uniform, Uniform, Read, ReadWrite, ReadWrite, ReadWrite]);
        let steer = kernel::layout(device, "steer", &[Uniform, ReadWrite, ReadWrite]);
        let cells = kernel::layout(device, "cells", &[Uniform, ReadWrite]);
        let steering = kernel::pipeline_layout(device, &[Some(&steer)]);
        let args =
            kernel::pipeline(device, &steering, &kernel::module(device, "leb_args", kernels::LEB_ARGS), "leb_args");
        let passes = [("leb_start", kernels::LEB_START), ("leb_pass", kernels::LEB_PASS)];
        let leb = passes.map(|pass| over_pages(device, &lists, pass));
        Self { leb, paper: OnceLock::new(), uniform: OnceLock::new(), args, lists, steer, cells }
    }

    /// The passes that surely suffice.
    pub fn most_passes(planet: &shared::Planet, scheme: Scheme) -> u32 {
        match scheme {
            Scheme::Leb => leb::tessellate::PASSES,
            Scheme::Paper => paper::tessellate::passes(planet),
            Scheme::Uniform { .. } => 1,
        }
    }

    /// Adds to a pass the mesh of a view. At most `passes` passes are run; where that was too few,
    /// `count_in` of the control is not 0.
    pub fn encode(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        (atlas, lists): (&Atlas, &Lists),
        (planet, view): (&shared::Planet, &shared::View),
        (scheme, passes): (Scheme, u32),
    ) {
        lists.set(device, planet, view);
        lists.set_ready(device, &Control::default());
        match scheme {
            Scheme::Leb => self.bisect(pass, &self.leb, (atlas, lists), 1, passes),
            Scheme::Paper => {
                let groups = patch::start_count(planet).div_ceil(GROUP);
                let pipelines = self.paper.get_or_init(|| {
                    let passes = [("paper_start", kernels::PAPER_START), ("paper_pass", kernels::PAPER_PASS)];
                    passes.map(|pass| over_pages(device, &self.lists, pass))
                });
                self.bisect(pass, pipelines, (atlas, lists), groups, passes);
            }
            Scheme::Uniform { level } => self.uniform(device, pass, (atlas, lists), planet, level),
        }
    }

    /// A start and then passes, each of which reads what the one before wrote.
    fn bisect(
        &self,
        pass: &mut wgpu::ComputePass<'_>,
        [start, step]: &[wgpu::ComputePipeline; 2],
        (atlas, lists): (&Atlas, &Lists),
        start_groups: u32,
        passes: u32,
    ) {
        pass.set_pipeline(start);
        pass.set_bind_group(0, atlas.group(), &[]);
        pass.set_bind_group(1, &lists.passes[1], &[]);
        pass.dispatch_workgroups(start_groups, 1, 1);
        self.steer(pass, lists);
        for n in 0..passes as usize {
            pass.set_pipeline(step);
            pass.set_bind_group(0, atlas.group(), &[]);
            pass.set_bind_group(1, &lists.passes[n % 2], &[]);
            pass.dispatch_workgroups_indirect(&lists.args, 0);
            self.steer(pass, lists);
        }
    }

    fn steer(&self, pass: &mut wgpu::ComputePass<'_>, lists: &Lists) {
        pass.set_pipeline(&self.args);
        pass.set_bind_group(0, &lists.steer, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// The uniform mesh of a level. Where the capacity is too small it is that of a coarser one, and
    /// `overflow` is set; the coarsest level's always fits.
    fn uniform(
        &self,
        device: &Device,
        pass: &mut wgpu::ComputePass<'_>,
        (atlas, lists): (&Atlas, &Lists),
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
        let overflow = u32::from(level > wanted);
        let control = Control { relief: triangles, tested: triangles, overflow, passes: 1, ..Control::default() };
        lists.set_ready(device, &control);
        let mesh = kernel::uniform(device, "uniform mesh", &UniformMesh { level, columns, rows, padding: 0 });
        let group = kernel::group(device, &self.cells, &[&mesh, &lists.relief].map(wgpu::Buffer::as_entire_binding));
        let kernel = ("frame_uniform", kernels::FRAME_UNIFORM);
        pass.set_pipeline(self.uniform.get_or_init(|| over_pages(device, &self.cells, kernel)));
        pass.set_bind_group(0, atlas.group(), &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(columns.div_ceil(8), rows.div_ceil(8), 1);
    }
}

/// The pipeline of a kernel whose group 0 is the pages'; the entry point has the kernel's name.
fn over_pages(
    device: &Device,
    group: &wgpu::BindGroupLayout,
    (name, source): (&str, &'static str),
) -> wgpu::ComputePipeline {
    let layout = kernel::pipeline_layout(device, &[Some(&Atlas::layout(device)), Some(group)]);
    kernel::pipeline(device, &layout, &kernel::module(device, name, source), name)
}
