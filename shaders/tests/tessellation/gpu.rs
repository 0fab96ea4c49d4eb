//! The kernels on an adapter, against the twin: the same triangles.

use std::collections::HashSet;
use std::sync::atomic::Ordering;

use bytemuck::Pod;
use relief_shaders::kernels;
use relief_shaders::leb::{Args, Control, PASSES, Params, ReliefTriangle, START_MOST, Stats, tessellate};
use wgpu::util::DeviceExt;
use wgpu::{BufferUsages, ShaderStages};

use super::camera::Camera;
use super::page_set::{Fault, PageSet};
use super::planet::{Ground, TestPlanet, hash};
use super::views::{hard, random};

/// An adapter's device, and the kernels on it.
struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
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

impl Gpu {
    /// None where `RELIEF_NO_GPU=1` says that there is no adapter.
    fn new() -> Option<Self> {
        if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
            eprintln!("RELIEF_NO_GPU=1: the kernels are not run");
            return None;
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect("an adapter; RELIEF_NO_GPU=1 leaves out what needs one");
        let descriptor = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
        let layout = |bindings: &[(u32, wgpu::BufferBindingType)]| {
            let entries: Vec<_> = bindings
                .iter()
                .map(|&(binding, ty)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: ShaderStages::COMPUTE,
                    ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
                    count: None,
                })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let [read, write] = [true, false].map(|read_only| wgpu::BufferBindingType::Storage { read_only });
        let groups = [
            layout(&[(0, uniform), (1, read), (2, read), (3, read), (4, write)]),
            layout(&[(0, uniform), (1, uniform), (2, read), (3, write), (4, write), (5, write)]),
            layout(&[(0, uniform), (1, write), (2, write)]),
        ];
        let pipeline = |source: &'static str, entry: &str, groups: &[&wgpu::BindGroupLayout]| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(entry),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &groups.iter().map(|&group| Some(group)).collect::<Vec<_>>(),
                immediate_size: 0,
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let start = pipeline(kernels::LEB_START, "leb_start", &[&groups[0], &groups[1]]);
        let pass = pipeline(kernels::LEB_PASS, "leb_pass", &[&groups[0], &groups[1]]);
        let args = pipeline(kernels::LEB_ARGS, "leb_args", &[&groups[2]]);
        Some(Self { groups, start, pass, args, device, queue })
    }

    fn buffer(&self, bytes: &[u8], usage: BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents: bytes, usage })
    }

    fn group(&self, layout: usize, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.groups[layout],
            entries: &entries,
        })
    }

    fn read<T: Pod>(&self, buffer: &wgpu::Buffer, bytes: u64) -> Vec<T> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, bytes);
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        bytemuck::pod_collect_to_vec(&copy.get_mapped_range(..).unwrap())
    }

    fn tessellate(&self, set: &PageSet, view: &relief_shaders::planet::View, params: &Params) -> Drawn {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let seen = self.buffer(&vec![0; 4 * set.seen.len()], storage);
        let pages = self.group(
            0,
            &[
                (0, &self.buffer(bytemuck::bytes_of(&set.planet), BufferUsages::UNIFORM)),
                (1, &self.buffer(bytemuck::cast_slice(&set.table), storage)),
                (2, &self.buffer(bytemuck::cast_slice(&set.heights), storage)),
                (3, &self.buffer(bytemuck::cast_slice(&set.bounds), storage)),
                (4, &seen),
            ],
        );
        let [view, params_buffer] =
            [bytemuck::bytes_of(view), bytemuck::bytes_of(params)].map(|b| self.buffer(b, BufferUsages::UNIFORM));
        let empty = |bytes: u64, more: BufferUsages| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: storage | more,
                mapped_at_creation: false,
            })
        };
        let none = BufferUsages::empty();
        let lists =
            [empty(12 * u64::from(params.list_capacity), none), empty(12 * u64::from(params.list_capacity), none)];
        let relief = empty(48 * u64::from(params.relief_capacity), none);
        let control = empty(size_of::<Control>() as u64, none);
        let args = empty(size_of::<Args>() as u64, BufferUsages::INDIRECT);
        let group = |from: &wgpu::Buffer, to: &wgpu::Buffer| {
            self.group(1, &[(0, &view), (1, &params_buffer), (2, from), (3, to), (4, &relief), (5, &control)])
        };
        let forth = group(&lists[0], &lists[1]);
        let back = group(&lists[1], &lists[0]);
        let steer = self.group(2, &[(0, &params_buffer), (1, &control), (2, &args)]);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut compute = encoder.begin_compute_pass(&Default::default());
            compute.set_pipeline(&self.start);
            compute.set_bind_group(0, &pages, &[]);
            compute.set_bind_group(1, &back, &[]);
            compute.dispatch_workgroups(1, 1, 1);
            for pass in 0..=PASSES {
                compute.set_pipeline(&self.args);
                compute.set_bind_group(0, &steer, &[]);
                compute.dispatch_workgroups(1, 1, 1);
                if pass < PASSES {
                    compute.set_pipeline(&self.pass);
                    compute.set_bind_group(0, &pages, &[]);
                    compute.set_bind_group(1, if pass % 2 == 0 { &forth } else { &back }, &[]);
                    compute.dispatch_workgroups_indirect(&args, 0);
                }
            }
        }
        self.queue.submit([encoder.finish()]);
        let control = self.read::<Control>(&control, size_of::<Control>() as u64)[0];
        let args = self.read::<Args>(&args, size_of::<Args>() as u64)[0];
        assert_eq!(args.vertices, 3 * control.relief.min(params.relief_capacity));
        assert_eq!([args.groups[0], args.instances, args.first_vertex, args.first_instance], [0, 1, 0, 0]);
        let corners: Vec<relief_shaders::leb::Corner> = self.read(&relief, 48 * u64::from(params.relief_capacity));
        Drawn {
            triangles: corners.chunks(3).take(args.vertices as usize / 3).map(|c| [c[0], c[1], c[2]]).collect(),
            stats: control.stats(),
            asked: self.read::<u32>(&seen, 4 * set.seen.len() as u64).into_iter().filter(|&k| k != 0).collect(),
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

fn compare(gpu: &Gpu, planet: &TestPlanet, set: &PageSet, what: &str, camera: Camera) -> [usize; 2] {
    let view = camera.view(planet);
    let params = Params::new(&set.planet, &view, 400_000, 400_000);
    set.seen.iter().for_each(|cell| cell.store(0, Ordering::Relaxed));
    let twin = tessellate(&set.pages(), &view, &params);
    let drawn = gpu.tessellate(set, &view, &params);
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
    let Some(gpu) = Gpu::new() else { return };
    let planets = [
        TestPlanet::globe(9, 6_378_137.0, 6_356_752.3, 0.5, Ground::Wild { most: 12_000, seed: 1 }),
        TestPlanet::globe(8, 1000.0, 800.0, 0.125, Ground::Hills { most: 800, seed: 3 }),
        TestPlanet::plane(9, 30_000.0, 0.125, Ground::Wild { most: 8000, seed: 5 }),
    ];
    let mut total = [0; 2];
    for planet in &planets {
        let mut run = |set: &PageSet, what: &str, camera| {
            let [all, other] = compare(&gpu, planet, set, what, camera);
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
    let Some(gpu) = Gpu::new() else { return };
    let planet = TestPlanet::globe(8, 6_378_137.0, 6_356_752.3, 0.5, Ground::Hills { most: 12_000, seed: 1 });
    let set = PageSet::whole(&planet);
    let camera = hard(&planet)[0].1;
    let view = camera.view(&planet);
    for (list, relief) in [(100, 100_000), (100_000, 100)] {
        let params = Params::new(&set.planet, &view, list, relief);
        assert!(tessellate(&set.pages(), &view, &params).stats.overflow);
        let drawn = gpu.tessellate(&set, &view, &params);
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
