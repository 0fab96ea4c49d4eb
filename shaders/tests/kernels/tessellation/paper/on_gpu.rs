//! The kernels on an adapter: passes as the module's page says.

use relief_shaders::kernels::{LEB_ARGS, PAPER_PASS, PAPER_START};
use relief_shaders::leb::{Args, Params, ReliefTriangle};
use relief_shaders::paper::patch::start_count;
use relief_shaders::paper::{Control, Patch, passes};
use relief_shaders::planet::View;
use wgpu::BufferUsages as Use;

use crate::gpu::{Gpu, PAGES, READ, UNIFORM, WRITE};
use crate::page_set::PageSet;

pub struct Kernels {
    gpu: Gpu,
    /// Pages, lists, and what steers.
    groups: [wgpu::BindGroupLayout; 3],
    start: wgpu::ComputePipeline,
    pass: wgpu::ComputePipeline,
    args: wgpu::ComputePipeline,
}

impl Kernels {
    /// None where there is no adapter.
    pub fn new() -> Option<Self> {
        let gpu = Gpu::new()?;
        let groups = [
            gpu.layout(&PAGES),
            gpu.layout(&[UNIFORM, UNIFORM, READ, WRITE, WRITE, WRITE]),
            gpu.layout(&[UNIFORM, WRITE, WRITE]),
        ];
        let [pages, lists, steer] = groups.each_ref();
        let start = gpu.pipeline(PAPER_START, "paper_start", &[pages, lists]);
        let pass = gpu.pipeline(PAPER_PASS, "paper_pass", &[pages, lists]);
        let args = gpu.pipeline(LEB_ARGS, "leb_args", &[steer]);
        Some(Self { groups, start, pass, args, gpu })
    }

    /// The triangles in the order of their places, and the counts.
    pub fn tessellate(&self, set: &PageSet, view: &View, params: &Params) -> (Vec<ReliefTriangle>, Control) {
        let gpu = &self.gpu;
        let pages = gpu.group(&self.groups[0], &gpu.pages(set).each_ref());
        let eye = gpu.buffer(&[*view], Use::UNIFORM);
        let limits = gpu.buffer(&[*params], Use::UNIFORM);
        // One more than the capacity, to see that nothing is written there.
        let list = || gpu.buffer(&vec![Patch::default(); params.list_capacity as usize + 1], Use::STORAGE);
        let lists = [list(), list()];
        let relief = gpu.buffer(&vec![ReliefTriangle::default(); params.relief_capacity as usize + 1], Use::STORAGE);
        let control = gpu.buffer(&[Control::default()], Use::STORAGE);
        let args = gpu.buffer(&[Args::default()], Use::STORAGE | Use::INDIRECT);
        let group = |read: usize| {
            gpu.group(&self.groups[1], &[&eye, &limits, &lists[read], &lists[1 - read], &relief, &control])
        };
        let groups = [group(0), group(1)];
        let steer = gpu.group(&self.groups[2], &[&limits, &control, &args]);
        gpu.compute(|pass| {
            pass.set_bind_group(0, &pages, &[]);
            pass.set_bind_group(1, &groups[1], &[]);
            pass.set_pipeline(&self.start);
            pass.dispatch_workgroups(start_count(&set.planet).div_ceil(64), 1, 1);
            for n in 0..=passes(&set.planet) {
                pass.set_bind_group(0, &steer, &[]);
                pass.set_pipeline(&self.args);
                pass.dispatch_workgroups(1, 1, 1);
                if n < passes(&set.planet) {
                    pass.set_bind_group(0, &pages, &[]);
                    pass.set_bind_group(1, &groups[n as usize % 2], &[]);
                    pass.set_pipeline(&self.pass);
                    pass.dispatch_workgroups_indirect(&args, 0);
                }
            }
        });
        let control = gpu.read::<Control>(&control)[0];
        let mut triangles = gpu.read::<ReliefTriangle>(&relief);
        assert_eq!(triangles.pop(), Some(ReliefTriangle::default()), "written beyond the relief's end");
        for list in &lists {
            assert_eq!(gpu.read::<Patch>(list).pop(), Some(Patch::default()), "written beyond a list's end");
        }
        triangles.truncate(control.relief as usize);
        triangles.sort_unstable_by_key(|t| t.map(|c| (c.t, c.s)));
        (triangles, control)
    }
}
