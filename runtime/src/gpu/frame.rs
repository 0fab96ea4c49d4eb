//! The GPU backend: a planet's resident set, and frames of it.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use relief_formats::tile::TileKey;
use relief_shaders::frame::Style;
use relief_shaders::planet as shared;

use super::atlas::Atlas;
use super::canvas::Canvas;
use super::device::{Device, DeviceError};
use super::paper;
use super::pending::{Finished, Pending};
use super::picture::Picture;
use super::present::{HostTargets, Present};
use super::readback::Readback;
use super::targets::Targets;
use super::tessellate::Tessellation;
use super::timestamps::Timestamps;
use crate::frame::{Frame, ReliefTriangle, RenderError, Renderer, Scheme, Settings, Shadow, Stats, sea_of, style_of};
use crate::planet::Planet;
use crate::residency::{Progress, Resident};
use crate::view::View;

/// The passes that are timed.
const TIMED: &[&str] = &["tessellate", "draw", "shade"];
/// Frames that a host may be ahead of the GPU.
const IN_FLIGHT: usize = 3;

/// A planet on a GPU; draws any number of views, one after the other.
pub struct Gpu {
    device: Device,
    resident: Resident<Atlas>,
    tessellation: Tessellation,
    picture: Picture,
    present: Present,
    timestamps: Timestamps,
    style: Style,
    canvas: Canvas,
    /// What the paper's shadows read; made when a frame first asks for it.
    paper: Option<wgpu::BindGroup>,
    in_flight: VecDeque<Pending>,
    /// Of the last frame that was finished.
    stats: Stats,
    /// Passes of the tessellation that are tried first: an empty one costs time too.
    passes: u32,
}

impl Gpu {
    /// A resident set of up to `atlas_bytes`, within the device's limits.
    ///
    /// # Errors
    /// What the device says, limits too small, or a damaged tile of the coarsest level.
    pub fn new(device: &Device, planet: Arc<Planet>, atlas_bytes: u64) -> Result<Self, RenderError> {
        let capacity = Atlas::capacity(device, atlas_bytes)?;
        let style = style_of(&planet)?;
        let sea_m = sea_of(&planet);
        let atlas = Atlas::new(device, &planet, capacity)?;
        // Drivers take their time over pipelines.
        let (resident, (tessellation, picture)) = rayon::join(
            || Resident::new(planet, capacity, atlas),
            || {
                rayon::join(
                    || device.guard(|| Tessellation::new(device)),
                    || device.guard(|| Picture::new(device, &sea_m)),
                )
            },
        );
        let (resident, tessellation, picture) = (resident?, tessellation?, picture?);
        let gpu = device.guard(|| Self {
            picture,
            present: Present::new(device),
            timestamps: Timestamps::new(device, TIMED),
            canvas: Canvas::new(device, &tessellation, &style),
            device: device.clone(),
            resident,
            tessellation,
            style,
            paper: None,
            in_flight: VecDeque::new(),
            stats: Stats::default(),
            passes: u32::MAX,
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

    /// Draws a view with what is resident into the host's targets, without waiting for the GPU.
    /// The counts are those of the latest frame that the GPU has finished, a few frames ago.
    ///
    /// # Errors
    /// A view that shows nothing, or what the device says.
    pub fn present(&mut self, view: &View, settings: &Settings, host: &HostTargets<'_>) -> Result<Stats, RenderError> {
        let pending = self.submit(view, settings, Some(host))?;
        self.in_flight.push_back(pending);
        // Only what has ended already: the host waits for nobody.
        let _ = self.device.wgpu().poll(wgpu::PollType::Poll);
        while let Some(pending) = self.in_flight.pop_front() {
            let finished = if self.in_flight.len() < IN_FLIGHT {
                match pending.poll(&self.device, &self.timestamps)? {
                    Ok(finished) => finished,
                    Err(pending) => {
                        self.in_flight.push_front(pending);
                        break;
                    }
                }
            } else {
                pending.wait(&self.device, &self.timestamps)?
            };
            self.note(finished);
            self.make_room()?;
        }
        Ok(self.stats.clone())
    }

    /// Draws a view with what is resident, with lists as large as it needs, and waits.
    fn draw(&mut self, view: &View, settings: &Settings) -> Result<(), RenderError> {
        loop {
            let finished = self.submit(view, settings, None)?.wait(&self.device, &self.timestamps)?;
            self.note(finished);
            if !self.make_room()? {
                return Ok(());
            }
        }
    }

    /// More passes or longer lists, if the last frame had too few; true when it is to be drawn again.
    fn make_room(&mut self) -> Result<bool, DeviceError> {
        if !self.stats.overflow {
            return Ok(false);
        }
        if self.passes != u32::MAX {
            self.passes = u32::MAX;
            return Ok(true);
        }
        self.canvas.grow(&self.device, &self.tessellation)
    }

    fn submit(
        &mut self,
        view: &View,
        settings: &Settings,
        host: Option<&HostTargets<'_>>,
    ) -> Result<Pending, RenderError> {
        let uniform = view.uniform(self.resident.planet())?;
        Targets::check(&self.device, [view.width, view.height])?;
        settings.check()?;
        settings.check_kernel(self.resident.planet().grid())?;
        if settings.shadow == Shadow::Paper && self.paper.is_none() {
            self.paper = Some(paper::group(&self.device, self.resident.planet())?);
        }
        let style = settings.style(&self.style);
        let device = self.device.clone();
        let pending = device.guard(|| {
            self.canvas.set(&device, &self.picture, self.resident.store(), &uniform, &style);
            let mut encoder = device.wgpu().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            self.encode(&mut encoder, &uniform, settings);
            if let (Some(host), Some((targets, _))) = (host, &self.canvas.sized) {
                self.present.encode(&device, &mut encoder, &self.canvas.view, targets, host);
            }
            let control = Readback::of(&device, &mut encoder, &self.canvas.lists.control);
            let fetched = Readback::of(&device, &mut encoder, &self.canvas.fetched);
            let seen = self.resident.store().take_seen(&mut encoder);
            let times = self.timestamps.read(&device, &mut encoder);
            device.queue().submit([encoder.finish()]);
            Pending {
                control: control.map(),
                fetched: fetched.map(),
                seen: seen.map(),
                times: times.map(Readback::map),
            }
        })?;
        Ok(pending)
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, view: &shared::View, settings: &Settings) {
        let (atlas, planet, lists) = (self.resident.store(), self.resident.uniform(), &self.canvas.lists);
        let Some((targets, groups)) = &self.canvas.sized else { return };
        let timed = |n: u32| wgpu::ComputePassDescriptor {
            label: Some(TIMED[n as usize]),
            timestamp_writes: self.timestamps.compute(n),
        };
        {
            let mut pass = encoder.begin_compute_pass(&timed(0));
            let passes = self.passes.min(Tessellation::most_passes(planet, settings.scheme));
            let buffers = (atlas, lists);
            self.tessellation.encode(&self.device, &mut pass, buffers, (planet, view), (settings.scheme, passes));
        }
        encoder.clear_buffer(&self.canvas.fetched, 0, None);
        self.picture.draw(encoder, groups, lists, targets, self.timestamps.render(1));
        let mut pass = encoder.begin_compute_pass(&timed(2));
        let paper = self.paper.as_ref().filter(|_| settings.shadow == Shadow::Paper);
        self.picture.shade(&self.device, &mut pass, (atlas, paper), (groups, targets.size), settings.overlay);
    }

    fn note(&mut self, finished: Finished) {
        let control = finished.control;
        // A few more than the last frame took, falling slowly, so that views may alternate.
        self.passes = (control.passes + 2).max(self.passes.saturating_sub(1).min(64));
        self.stats = Stats {
            triangles: u64::from(control.relief.min(self.canvas.lists.capacity[1])),
            fillers: u64::from(control.fillers),
            passes: control.passes,
            tested: u64::from(control.tested),
            culled: u64::from(control.culled),
            overflow: control.overflow != 0 || control.count_in != 0,
            tiles_missing: self.resident.ask_record(&finished.seen),
            tiles_resident: self.resident.count(),
            fetches: finished.fetches,
            pass_ms: finished.pass_ms,
        };
    }
}

impl Renderer for Gpu {
    fn mesh(&mut self, view: &View, scheme: Scheme) -> Result<Vec<ReliefTriangle>, RenderError> {
        self.draw(view, &Settings { scheme, ..Settings::default() })?;
        Ok(self.canvas.read_mesh(&self.device, self.stats.triangles)?)
    }

    fn render(&mut self, view: &View, settings: &Settings) -> Result<Frame, RenderError> {
        self.draw(view, settings)?;
        Ok(self.canvas.read(&self.device, settings, self.stats.clone())?)
    }

    fn update(&mut self, budget: Duration) -> Progress {
        self.resident.update(budget)
    }

    fn damaged(&self) -> Vec<(TileKey, String)> {
        self.resident.damaged().map(|(key, error)| (key, error.to_string())).collect()
    }

    fn render_until_complete(
        &mut self,
        view: &View,
        settings: &Settings,
        time: Duration,
    ) -> Result<Frame, RenderError> {
        let deadline = Instant::now() + time;
        loop {
            self.draw(view, settings)?;
            let left = deadline.saturating_duration_since(Instant::now());
            let done = self.stats.tiles_missing == 0 || left.is_zero() || {
                let progress = self.resident.update(left);
                progress.full && progress.loaded == 0
            };
            if done {
                return Ok(self.canvas.read(&self.device, settings, self.stats.clone())?);
            }
        }
    }
}
