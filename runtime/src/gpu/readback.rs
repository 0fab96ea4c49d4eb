//! Bytes back from the GPU.

use std::sync::mpsc::{Receiver, channel};

use bytemuck::Pod;

use super::device::{Device, DeviceError};
use super::kernel;

/// A copy of a buffer, to be read once its commands are done.
pub(super) struct Readback {
    buffer: wgpu::Buffer,
}

/// A copy that is being mapped.
pub(super) struct Mapping {
    buffer: wgpu::Buffer,
    done: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Readback {
    /// Adds to an encoder the copy of a whole buffer.
    pub fn of(device: &Device, encoder: &mut wgpu::CommandEncoder, source: &wgpu::Buffer) -> Self {
        Self::first(device, encoder, source, source.size())
    }

    /// Adds to an encoder the copy of a buffer's first bytes.
    pub fn first(device: &Device, encoder: &mut wgpu::CommandEncoder, source: &wgpu::Buffer, bytes: u64) -> Self {
        let readback = Self::empty(device, bytes);
        encoder.copy_buffer_to_buffer(source, 0, &readback.buffer, 0, bytes);
        readback
    }

    /// Room for bytes.
    pub fn empty(device: &Device, bytes: u64) -> Self {
        use wgpu::BufferUsages as Use;
        let buffer = kernel::empty(device, "readback", bytes, Use::MAP_READ | Use::COPY_DST);
        Self { buffer }
    }

    /// Where the bytes are copied to.
    pub fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Asks for the bytes, after the commands were submitted.
    pub fn map(self) -> Mapping {
        let (sender, done) = channel();
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody receives when the mapping was given up.
            let _ = sender.send(result);
        });
        Mapping { buffer: self.buffer, done }
    }
}

impl Mapping {
    /// The bytes, as soon as they are there; the device must have been polled.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn take<T: Pod>(&self) -> Result<Option<Vec<T>>, DeviceError> {
        match self.done.try_recv() {
            Ok(result) => {
                result.map_err(|error| DeviceError::Lost(error.to_string()))?;
                let view = self.buffer.get_mapped_range(..).map_err(|error| DeviceError::Lost(error.to_string()))?;
                let values = bytemuck::pod_collect_to_vec(&view);
                drop(view);
                self.buffer.unmap();
                Ok(Some(values))
            }
            Err(std::sync::mpsc::TryRecvError::Empty) => Ok(None),
            Err(error) => Err(DeviceError::Lost(error.to_string())),
        }
    }

    /// Waits for the bytes.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn wait<T: Pod>(&self, device: &Device) -> Result<Vec<T>, DeviceError> {
        device.wait()?;
        self.take()?.ok_or_else(|| DeviceError::Lost("a mapping did not end with its work".into()))
    }
}
