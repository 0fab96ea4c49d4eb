//! The kernels on an adapter, against the twin: the same triangles.

use std::collections::HashSet;
use std::sync::atomic::Ordering;

use relief_shaders::kernels;
use relief_shaders::leb::{
    Args, Control, Corner, PASSES, Params, ReliefTriangle, START_MOST, Stats, Triangle, tessellate,
};
use relief_shaders::planet::View;
use wgpu::BufferUsages;

use super::camera::Camera;
use super::page_set::Fault;
use super::planet::{Ground, TestPlanet, hash};
use super::views::{hard, random};
use crate::gpu::{Gpu, PAGES, READ, UNIFORM, WRITE};
use crate::page_set::PageSet;

/// The kernels of the scheme on an adapter.
struct Kernels {
    gpu: Gpu,
    /// Pages, lists, and what steers.
    groups: [wgpu::BindGroupLayout; 3],
    start: wgpu::ComputePipeline,
    pass: wgpu::ComputePipeline,
    args: wgpu::ComputePipeline,
}

/// What a tessellation on the GPU yields.
struct Drawn {
    triangles: Vec<ReliefTriangle>,
    stats: Stats,
    asked: HashSet<u32>,
}

impl Kernels {
    fn new() -> Option<Self> {
        let gpu = Gpu::new()?;
        let groups = [
            gpu.layout(&PAGES),
            gpu.layout(&[UNIFORM, UNIFORM, READ, WRITE, WRITE, WRITE]),
            gpu.layout(&[UNIFORM, WRITE, WRITE]),
        ];
        let [pages, lists, steer] = groups.each_ref();
        let start = gpu.pipeline(kernels::LEB_START, "leb_start", &[pages, lists]);
        let pass = gpu.pipeline(kernels::LEB_PASS, "leb_pass", &[pages, lists]);
        let args = gpu.pipeline(kernels::LEB_ARGS, "leb_args", &[steer]);
        Some(Self { groups, start, pass, args, gpu })
    }

    fn tessellate(&self, set: &PageSet, view: &View, params: &Params) -> Drawn {
        let (gpu, storage) = (&self.gpu, BufferUsages::STORAGE);
        let pages = gpu.pages(set);
        let pages_group = gpu.group(&self.groups[0], &pages.each_ref());
        let eye = gpu.buffer(&[*view], BufferUsages::UNIFORM);
        let limits = gpu.buffer(&[*params], BufferUsages::UNIFORM);
        let list = || gpu.buffer(&vec![Triangle::default(); params.list_capacity as usize], storage);
        let lists = [list(), list()];
        let relief = gpu.buffer(&vec![ReliefTriangle::default(); params.relief_capacity as usize], storage);
        let control = gpu.buffer(&[Control::default()], storage);
        let args = gpu.buffer(&[Args::default()], storage | BufferUsages::INDIRECT);
        let group = |read: usize| {
            gpu.group(&self.groups[1], &[&eye, &limits, &lists[read], &lists[1 - read], &relief, &control])
        };
        let groups = [group(0), group(1)];
        let steer = gpu.group(&self.groups[2], &[&limits, &control, &args]);
        gpu.compute(|compute| {
            compute.set_pipeline(&self.start);
            compute.set_bind_group(0, &pages_group, &[]);
            compute.set_bind_group(1, &groups[1], &[]);
            compute.dispatch_workgroups(1, 1, 1);
            for pass in 0..=PASSES {
                compute.set_pipeline(&self.args);
                compute.set_bind_group(0, &steer, &[]);
                compute.dispatch_workgroups(1, 1, 1);
                if pass < PASSES {
                    compute.set_pipeline(&self.pass);
                    compute.set_bind_group(0, &pages_group, &[]);
                    compute.set_bind_group(1, &groups[pass as usize % 2], &[]);
                    compute.dispatch_workgroups_indirect(&args, 0);
                }
            }
        });
        let control = gpu.read::<Control>(&control)[0];
        let args = gpu.read::<Args>(&args)[0];
        assert_eq!(args.vertices, 3 * control.relief.min(params.relief_capacity));
        assert_eq!([args.groups[0], args.instances, args.first_vertex, args.first_instance], [0, 1, 0, 0]);
        let corners: Vec<Corner> = gpu.read(&relief);
        Drawn {
            triangles: corners.chunks(3).take(args.vertices as usize / 3).map(|c| [c[0], c[1], c[2]]).collect(),
            stats: control.stats(),
            asked: gpu.read::<u32>(&pages[4]).into_iter().filter(|&k| k != 0).collect(),
        }
    }
}

/// A triangle as numbers; a height's last bits may differ below level 0.
fn names(triangles: &[ReliefTriangle]) -> HashSet<[u32; 6]> {
    triangles.iter().map(|[a, b, c]| [a.s, a.t, b.s, b.t, c.s, c.t]).collect()
}

/// Share of triangles that only one of the two has.
fn difference(a: &[ReliefTriangle], b: &[ReliefTriangle]) -> f64 {
    let (a, b) = (names(a), names(b));
    a.symmetric_difference(&b).count() as f64 / a.len().max(b.len()).max(1) as f64
}

fn compare(kernels: &Kernels, planet: &TestPlanet, set: &PageSet, what: &str, camera: Camera) -> [usize; 2] {
    let view = camera.view(planet);
    let params = Params::new(&set.planet, &view, 400_000, 400_000);
    set.seen.iter().for_each(|cell| cell.store(0, Ordering::Relaxed));
    let twin = tessellate(&set.pages(), &view, &params);
    let drawn = kernels.tessellate(set, &view, &params);
    assert!(!drawn.stats.overflow && !twin.stats.overflow, "{what}: {:?} {:?}", drawn.stats, twin.stats);
    let share = difference(&twin.triangles, &drawn.triangles);
    assert!(
        share <= 1e-3 || twin.triangles.len() < 2000 && share * (twin.triangles.len() as f64) < 4.5,
        "{what}: {share}"
    );
    assert_eq!(names(&drawn.triangles).len(), drawn.triangles.len(), "{what}: a triangle twice");
    let asked: HashSet<u32> = set.seen.iter().map(|c| c.load(Ordering::Relaxed)).filter(|&k| k != 0).collect();
    if share == 0.0 {
        assert_eq!(asked, drawn.asked, "{what}: other pages asked for");
        assert_eq!(twin.stats, drawn.stats, "{what}");
    }
    [twin.triangles.len(), (share * twin.triangles.len() as f64) as usize]
}

#[test]
fn kernels_draw_what_the_twin_draws() {
    let Some(kernels) = Kernels::new() else { return };
    let planets = [
        TestPlanet::globe(9, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 }),
        TestPlanet::globe(8, 1000.0, 800.0, 0.125, Ground::Hills { most: 800, seed: 3 }),
        TestPlanet::plane(9, 30_000.0, 0.125, Ground::Wild { most: 8000, seed: 5 }),
    ];
    let mut total = [0; 2];
    for planet in &planets {
        let mut run = |set: &PageSet, what: &str, camera| {
            let [all, other] = compare(&kernels, planet, set, what, camera);
            total = [total[0] + all, total[1] + other];
        };
        let whole = PageSet::whole(planet);
        if !planet.plane {
            hard(planet).into_iter().for_each(|(what, camera)| run(&whole, what, camera));
        }
        let missing = PageSet::of(planet, Fault::None, |k, x, y| {
            !hash(u64::from(x), u64::from(y), u64::from(k)).is_multiple_of(3)
        });
        for n in 0..6 {
            run(&whole, &format!("random {n}"), random(planet, n, 31));
            run(&missing, &format!("missing {n}"), random(planet, n, 31));
        }
    }
    eprintln!("{} of {} triangles differ", total[1], total[0]);
    assert!(total[0] > 50_000 && total[1] * 1000 < total[0], "{total:?}");
}

#[test]
fn a_list_that_is_full_is_told_and_nothing_is_written_beyond() {
    let Some(kernels) = Kernels::new() else { return };
    let planet = TestPlanet::globe(8, 6_378_137.0, 6_356_752.3, 0.5, Ground::Hills { most: 12_000, seed: 1 });
    let set = PageSet::whole(&planet);
    let camera = hard(&planet)[0].1;
    let view = camera.view(&planet);
    for (list, relief) in [(100, 100_000), (100_000, 100)] {
        let params = Params::new(&set.planet, &view, list, relief);
        assert!(tessellate(&set.pages(), &view, &params).stats.overflow);
        let drawn = kernels.tessellate(&set, &view, &params);
        assert!(drawn.stats.overflow && drawn.triangles.len() <= relief as usize);
    }
    const { assert!(START_MOST < 100) };
}

#[test]
fn other_triangles_are_noticed() {
    let planet = TestPlanet::globe(8, 1000.0, 800.0, 0.125, Ground::Hills { most: 800, seed: 3 });
    let set = PageSet::whole(&planet);
    let triangles = |camera: Camera| {
        let view = camera.view(&planet);
        tessellate(&set.pages(), &view, &Params::new(&set.planet, &view, 400_000, 400_000)).triangles
    };
    let camera = random(&planet, 0, 31);
    let (a, b) = (triangles(camera), triangles(Camera { pixel_error: 2.1, ..camera }));
    assert_eq!(difference(&a, &a), 0.0);
    assert!(difference(&a, &b) > 1e-3);
}
