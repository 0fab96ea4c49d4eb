//! The GPU backend: a planet's resident set, and frames of it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_shaders::frame::{Places, Shaded, Style};
use relief_shaders::leb::tessellate::PASSES;
use relief_shaders::planet as shared;

use super::atlas::Atlas;
use super::device::{Device, DeviceError};
use super::kernel;
use super::picture::{Groups, Picture};
use super::readback::{Mapping, Readback};
use super::targets::Targets;
use super::tessellate::{Control, Lists, Tessellation};
use super::timestamps::Timestamps;
use crate::frame::{Frame, RenderError, Renderer, Scheme, Settings, Stats, style_of};
use crate::planet::Planet;
use crate::residency::{Progress, Resident};
use crate::view::View;

/// Triangles that a pass may yield and relief triangles, to begin with; both grow when needed.
const CAPACITY: [u32; 2] = [1 << 17, 1 << 18];
/// The passes that are timed.
const TIMED: &[&str] = &["tessellate", "draw", "shade"];

/// A planet on a GPU; draws any number of views, one after the other.
pub struct Gpu {
    device: Device,
    resident: Resident<Atlas>,
    tessellation: Tessellation,
    picture: Picture,
    timestamps: Timestamps,
    view: wgpu::Buffer,
    style_buffer: wgpu::Buffer,
    style: Style,
    lists: Lists,
    targets: Option<(Targets, Groups)>,
}

/// A frame that was drawn and is still on the GPU.
struct Drawn {
    control: Control,
    missing: usize,
    pass_ms: Vec<(&'static str, f64)>,
}

impl Gpu {
    /// A resident set of up to `atlas_bytes`, within the device's limits.
    ///
    /// # Errors
    /// What the device says, limits too small, or a damaged tile of the coarsest level.
    pub fn new(device: &Device, planet: Arc<Planet>, atlas_bytes: u64) -> Result<Self, RenderError> {
        let capacity = Atlas::capacity(device, atlas_bytes)?;
        let style = style_of(&planet)?;
        let atlas = Atlas::new(device, &planet, capacity)?;
        let resident = Resident::new(planet, capacity, atlas)?;
        let gpu = device.guard(|| {
            let tessellation = Tessellation::new(device);
            let view = kernel::uniform(device, "view", &shared::View::default());
            Self {
                picture: Picture::new(device),
                timestamps: Timestamps::new(device, TIMED),
                style_buffer: kernel::uniform(device, "style", &style),
                lists: tessellation.lists(device, &view, CAPACITY),
                targets: None,
                device: device.clone(),
                resident,
                tessellation,
                view,
                style,
            }
        })?;
        Ok(gpu)
    }

    /// The device.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The resident set.
    #[must_use]
    pub fn resident(&self) -> &Resident<Atlas> {
        &self.resident
    }

    /// The resident set, for kernels that are run on it.
    pub fn resident_mut(&mut self) -> &mut Resident<Atlas> {
        &mut self.resident
    }

    /// Draws a view with what is resident, with lists as large as it needs.
    fn draw(&mut self, view: &View, settings: &Settings) -> Result<Drawn, RenderError> {
        loop {
            let drawn = self.draw_once(view, settings)?;
            if drawn.control.overflow == 0 || !self.grow()? {
                return Ok(drawn);
            }
        }
    }

    fn draw_once(&mut self, view: &View, settings: &Settings) -> Result<Drawn, RenderError> {
        let size = [view.width, view.height];
        let uniform = view.uniform(self.resident.planet())?;
        Targets::check(&self.device, size)?;
        let style = Style { overlay: settings.overlay as u32, ..self.style };
        let device = self.device.clone();
        let (control, seen, times) = device.guard(|| {
            if self.targets.as_ref().is_none_or(|(targets, _)| targets.size != size) {
                self.targets = None;
                let targets = Targets::new(&self.device, size);
                let groups = self.groups(&targets);
                self.targets = Some((targets, groups));
            }
            self.device.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
            self.device.queue().write_buffer(&self.style_buffer, 0, bytemuck::bytes_of(&style));
            let mut encoder = self.device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.encode(&mut encoder, &uniform, settings.scheme);
            let control = Readback::of(&self.device, &mut encoder, &self.lists.control);
            let seen = self.resident.store().take_seen(&mut encoder);
            let times = self.timestamps.read(&self.device, &mut encoder);
            self.device.queue().submit([encoder.finish()]);
            (control.map(), seen.map(), times.map(Readback::map))
        })?;
        let missing = self.resident.ask_record(&seen.wait::<u32>(&self.device)?);
        let control = control.wait::<Control>(&self.device)?.first().copied().unwrap_or_default();
        let pass_ms = match times {
            Some(times) => self.timestamps.pass_ms(&self.device, &times)?,
            None => Vec::new(),
        };
        Ok(Drawn { control, missing, pass_ms })
    }

    fn groups(&self, targets: &Targets) -> Groups {
        let buffers = [&self.view, &self.style_buffer];
        self.picture.groups(&self.device, self.resident.store(), buffers, &self.lists, targets)
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, view: &shared::View, scheme: Scheme) {
        let (atlas, planet) = (self.resident.store(), self.resident.uniform());
        let Some((targets, groups)) = &self.targets else { return };
        let timed = |n| wgpu::ComputePassDescriptor {
            label: Some(TIMED[n as usize]),
            timestamp_writes: self.timestamps.compute(n),
        };
        {
            let mut pass = encoder.begin_compute_pass(&timed(0));
            match scheme {
                Scheme::Leb => {
                    self.tessellation.leb(&self.device, &mut pass, atlas, &self.lists, (planet, view), PASSES);
                }
                Scheme::Uniform { level } => {
                    self.tessellation.uniform(&self.device, &mut pass, atlas, &self.lists, planet, level);
                }
            }
        }
        self.picture.draw(encoder, groups, &self.lists, targets, self.timestamps.render(1));
        let mut pass = encoder.begin_compute_pass(&timed(2));
        self.picture.shade(&mut pass, atlas, groups, targets.size);
    }

    /// Doubles the lists; false when the device holds no larger ones.
    fn grow(&mut self) -> Result<bool, DeviceError> {
        let limits = self.device.wgpu().limits();
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let capacity = self.lists.capacity.map(|count| count.saturating_mul(2));
        // 48 bytes a relief triangle; 65535 groups of 64 in a dispatch.
        if u64::from(capacity[1]) * 48 > most || capacity[0] > 65_535 * 64 {
            return Ok(false);
        }
        let lists = self.device.guard(|| self.tessellation.lists(&self.device, &self.view, capacity))?;
        self.lists = lists;
        if let Some((targets, _)) = self.targets.take() {
            let groups = self.device.guard(|| self.groups(&targets))?;
            self.targets = Some((targets, groups));
        }
        Ok(true)
    }

    fn stats(&self, drawn: Drawn) -> Stats {
        let control = drawn.control;
        Stats {
            triangles: u64::from(control.relief.min(self.lists.capacity[1])),
            passes: control.passes,
            tested: u64::from(control.tested),
            culled: u64::from(control.culled),
            overflow: control.overflow != 0,
            tiles_resident: self.resident.count(),
            tiles_missing: drawn.missing,
            pass_ms: drawn.pass_ms,
        }
    }

    /// The last frame in RAM.
    fn read(&self, drawn: Drawn, settings: &Settings) -> Result<Frame, RenderError> {
        let Some((targets, _)) = &self.targets else { return Ok(Frame::default()) };
        let device = &self.device;
        let (words, places) = device.guard(|| {
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let words = [&targets.colours, &targets.distances, &targets.normals]
                .map(|buffer| Readback::of(device, &mut encoder, buffer));
            let places = settings.places.then(|| targets.read_places(device, &mut encoder));
            device.queue().submit([encoder.finish()]);
            (words.map(Readback::map), places.map(|rows| rows.map(|rows| rows.map())))
        })?;
        let [colours, distances, normals] = words;
        let shaded = Shaded {
            colours: colours.wait(device)?,
            distances_m: distances.wait(device)?,
            normals: normals.wait(device)?,
        };
        let frame = Frame::new(targets.size, shaded, self.stats(drawn));
        let Some([(places, compact_places), (depths, compact_depths)]) = places else { return Ok(frame) };
        let words = |mapping: &Mapping| mapping.wait::<u32>(device);
        let drawn = Places {
            width: targets.size[0],
            places: compact_places(&words(&places)?).chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(),
            depths: compact_depths(&words(&depths)?).into_iter().map(f32::from_bits).collect(),
        };
        Ok(frame.with_places(&drawn))
    }
}

impl Renderer for Gpu {
    fn render(&mut self, view: &View, settings: &Settings) -> Result<Frame, RenderError> {
        let drawn = self.draw(view, settings)?;
        self.read(drawn, settings)
    }

    fn update(&mut self, budget: Duration) -> Progress {
        self.resident.update(budget)
    }

    fn render_until_complete(
        &mut self,
        view: &View,
        settings: &Settings,
        time: Duration,
    ) -> Result<Frame, RenderError> {
        let deadline = Instant::now() + time;
        loop {
            let drawn = self.draw(view, settings)?;
            let left = deadline.saturating_duration_since(Instant::now());
            let done = drawn.missing == 0 || left.is_zero() || {
                let progress = self.resident.update(left);
                progress.full && progress.loaded == 0
            };
            if done {
                return self.read(drawn, settings);
            }
        }
    }
}
