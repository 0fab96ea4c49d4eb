//! The loop of a viewer: a view goes out, pictures come back.

use std::error::Error;
use std::time::Instant;

use relief_client::{Attached, Event, Payload};
use relief_protocol::to_viewer::ToViewer;
use relief_protocol::view::View;

/// A camera under way, and what it measured.
pub struct Flight<'a> {
    daemon: &'a mut Attached,
    begin: Instant,
    pictures: u32,
    complete: u32,
    triangles: u64,
    bytes: u64,
    /// From a view to its first picture.
    latencies_ms: Vec<f64>,
}

impl<'a> Flight<'a> {
    /// With the camera `fly` of a daemon.
    pub fn new(daemon: &'a mut Attached) -> Self {
        let begin = Instant::now();
        Self { daemon, begin, pictures: 0, complete: 0, triangles: 0, bytes: 0, latencies_ms: Vec::new() }
    }

    /// The daemon.
    pub fn daemon(&mut self) -> &mut Attached {
        self.daemon
    }

    /// Sends a view and takes its pictures: the first, or with `patient` all until the complete one.
    pub fn go(
        &mut self,
        view: View,
        patient: bool,
        mut show: impl FnMut(&Payload) -> Result<(), Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let sent = Instant::now();
        let number = self.daemon.view("fly", view)?;
        let mut is_first = true;
        loop {
            let payload = match self.daemon.next_event()? {
                Event::Payload(payload) => payload,
                // About what was asked; others, such as a damaged tile, do not stop a flight.
                Event::Message(ToViewer::Error(fault)) if fault.camera.is_some() => return Err(fault.into()),
                Event::Message(message) => {
                    eprintln!("fly: the daemon says {}", message.text());
                    continue;
                }
            };
            self.bytes += payload.with(<[u8]>::len)? as u64;
            let header = payload.header();
            // Pictures of the view before may still be under way.
            if header.view == number {
                show(&payload)?;
            }
            if header.part + 1 < header.parts {
                continue;
            }
            self.pictures += 1;
            self.complete += u32::from(header.complete);
            self.triangles = header.stats.triangles;
            if header.view != number {
                continue;
            }
            if std::mem::take(&mut is_first) {
                self.latencies_ms.push(sent.elapsed().as_secs_f64() * 1e3);
            }
            if header.complete || !patient {
                return Ok(());
            }
        }
    }

    /// What was measured, in words.
    pub fn figures(&self) -> String {
        let elapsed_s = self.begin.elapsed().as_secs_f64();
        let mut sorted = self.latencies_ms.clone();
        sorted.sort_by(f64::total_cmp);
        let quantile =
            |q: f64| sorted.get((q * (sorted.len().max(1) - 1) as f64).round() as usize).unwrap_or(&f64::NAN);
        format!(
            "{} pictures ({} complete) of {} views in {elapsed_s:.2} s: {:.1} frames/s, {:.1} MB/s\n\
             latency {:.1} ms (p50), {:.1} ms (p95)\n\
             {} triangles in the last",
            self.pictures,
            self.complete,
            self.latencies_ms.len(),
            f64::from(self.pictures) / elapsed_s,
            self.bytes as f64 / elapsed_s / 1e6,
            quantile(0.5),
            quantile(0.95),
            self.triangles,
        )
    }
}
