//! What a submitted frame leaves to be read: the pages it asked for, counts, times.

use relief_shaders::frame::Fetches;
use relief_shaders::paper::Control;

use super::device::{Device, DeviceError};
use super::readback::Mapping;
use super::timestamps::Timestamps;

/// Of a frame that may not be finished yet.
pub(super) struct Pending {
    pub control: Mapping,
    pub fetched: Mapping,
    pub seen: Mapping,
    pub times: Option<Mapping>,
}

/// Of a frame that is.
pub(super) struct Finished {
    pub control: Control,
    pub seen: Vec<u32>,
    pub fetches: Fetches,
    pub pass_ms: Vec<(&'static str, f64)>,
}

impl Pending {
    /// Waits for the frame.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn wait(self, device: &Device, timestamps: &Timestamps) -> Result<Finished, DeviceError> {
        let control = self.control.wait::<Control>(device)?;
        self.rest(device, timestamps, &control)
    }

    /// What the frame left, if the device has finished it.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn poll(self, device: &Device, timestamps: &Timestamps) -> Result<Result<Finished, Self>, DeviceError> {
        match self.control.take::<Control>()? {
            Some(control) => self.rest(device, timestamps, &control).map(Ok),
            None => Ok(Err(self)),
        }
    }

    fn rest(self, device: &Device, timestamps: &Timestamps, control: &[Control]) -> Result<Finished, DeviceError> {
        let fetched = self.fetched.wait::<u32>(device)?;
        let count = |k: usize| fetched.get(k).copied().map_or(0, u64::from);
        Ok(Finished {
            fetches: Fetches { rays: count(0), heights: count(1), extremes: count(2), steps: count(3) },
            control: control.first().copied().unwrap_or_default(),
            seen: self.seen.wait(device)?,
            pass_ms: match self.times {
                Some(times) => timestamps.pass_ms(device, &times)?,
                None => Vec::new(),
            },
        })
    }
}
