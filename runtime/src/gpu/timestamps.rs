//! Time of passes by the GPU's own clock.

use super::device::{Device, DeviceError};
use super::kernel;
use super::readback::{Mapping, Readback};

/// Two queries a pass.
pub(super) struct Timestamps {
    queries: Option<wgpu::QuerySet>,
    resolved: wgpu::Buffer,
    names: &'static [&'static str],
    period_ns: f64,
}

impl Timestamps {
    /// Queries for some passes; without a clock nothing is measured.
    pub fn new(device: &Device, names: &'static [&'static str]) -> Self {
        use wgpu::BufferUsages as Use;
        let count = 2 * names.len() as u32;
        let queries = device.has_timestamps().then(|| {
            device.wgpu().create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("passes"),
                ty: wgpu::QueryType::Timestamp,
                count,
            })
        });
        let resolved = kernel::empty(device, "timestamps", 8 * u64::from(count), Use::QUERY_RESOLVE | Use::COPY_SRC);
        Self { queries, resolved, names, period_ns: f64::from(device.queue().get_timestamp_period()) }
    }

    /// Where the n-th pass, a compute pass, writes its times.
    pub fn compute(&self, n: u32) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.queries.as_ref().map(|query_set| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * n),
            end_of_pass_write_index: Some(2 * n + 1),
        })
    }

    /// Where the n-th pass, a render pass, writes its times.
    pub fn render(&self, n: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.queries.as_ref().map(|query_set| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * n),
            end_of_pass_write_index: Some(2 * n + 1),
        })
    }

    /// Adds to an encoder the copy of the times.
    pub fn read(&self, device: &Device, encoder: &mut wgpu::CommandEncoder) -> Option<Readback> {
        self.queries.as_ref().map(|queries| {
            encoder.resolve_query_set(queries, 0..2 * self.names.len() as u32, &self.resolved, 0);
            Readback::of(device, encoder, &self.resolved)
        })
    }

    /// Milliseconds of each pass.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn pass_ms(&self, device: &Device, mapping: &Mapping) -> Result<Vec<(&'static str, f64)>, DeviceError> {
        let ticks: Vec<u64> = mapping.wait(device)?;
        let ms = |pair: &[u64]| pair[1].saturating_sub(pair[0]) as f64 * self.period_ns / 1e6;
        Ok(self.names.iter().copied().zip(ticks.chunks_exact(2).map(ms)).collect())
    }
}
