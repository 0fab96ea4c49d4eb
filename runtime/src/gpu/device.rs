//! The host's device, or one of our own.

use std::sync::{Arc, Mutex, PoisonError};

/// A GPU that is not there or gave up: the caller chooses another backend, or makes the device
/// anew.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// No adapter of the kind that was asked for.
    #[error("no GPU adapter: {0}; --backend cpu needs none")]
    NoAdapter(String),
    /// The adapter gives no device.
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// Why.
        reason: String,
    },
    /// The device was lost: driver reset, unplugged, destroyed.
    #[error("the GPU device was lost: {0}")]
    Lost(String),
    /// Its memory is used up.
    #[error("the GPU is out of memory: {0}")]
    OutOfMemory(String),
    /// The driver or the validation refused what we asked for.
    #[error("the GPU refused: {0}")]
    Refused(String),
}

/// Which adapter a device of our own comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest; a software adapter where there is no other.
    #[default]
    Fastest,
    /// A software adapter.
    Software,
}

/// A device with its queue. Clones are the same device.
#[derive(Clone, Debug)]
pub struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
    fault: Arc<Mutex<Option<DeviceError>>>,
}

impl Device {
    /// A device of our own, without a window, with all the adapter's limits.
    ///
    /// # Errors
    /// [`DeviceError::NoAdapter`], [`DeviceError::NoDevice`].
    pub fn headless(choice: AdapterChoice) -> Result<Self, DeviceError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter: choice == AdapterChoice::Software,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| DeviceError::NoAdapter(error.to_string()))?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("relief"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| DeviceError::NoDevice { adapter: adapter.get_info().name, reason: error.to_string() })?;
        let ours = Self::of_host(device, queue);
        let fault = Arc::clone(&ours.fault);
        ours.device.set_device_lost_callback(move |reason, message| {
            remember(&fault, DeviceError::Lost(format!("{reason:?} {message}")));
        });
        let fault = Arc::clone(&ours.fault);
        ours.device.on_uncaptured_error(Arc::new(move |error| remember(&fault, sort(error))));
        Ok(ours)
    }

    /// The host's device. Its callbacks stay the host's.
    #[must_use]
    pub fn of_host(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        Self { device, queue, fault: Arc::default() }
    }

    /// The device.
    #[must_use]
    pub fn wgpu(&self) -> &wgpu::Device {
        &self.device
    }

    /// Its queue.
    #[must_use]
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Name, backend and driver of the adapter.
    #[must_use]
    pub fn info(&self) -> wgpu::AdapterInfo {
        self.device.adapter_info()
    }

    /// True when passes can be timed.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.device.features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// What went wrong outside our own calls, if anything did.
    ///
    /// # Errors
    /// The first fault of a device of our own; the host's are reported to the host.
    pub fn check(&self) -> Result<(), DeviceError> {
        match &*self.fault.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(fault) => Err(fault.clone()),
            None => Ok(()),
        }
    }

    /// Runs calls on the device and catches what it says of them.
    ///
    /// # Errors
    /// [`DeviceError::OutOfMemory`], [`DeviceError::Refused`], or an earlier fault.
    pub fn guard<T>(&self, calls: impl FnOnce() -> T) -> Result<T, DeviceError> {
        self.check()?;
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = calls();
        let errors = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
        let error = errors.into_iter().flatten().next();
        if error.is_some() {
            // That the device is lost is only said to those who poll; it explains the rest.
            let _ = self.device.poll(wgpu::PollType::Poll);
        }
        self.check()?;
        match error {
            Some(error) => Err(sort(error)),
            None => Ok(result),
        }
    }

    /// Waits for all submitted work.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn wait(&self) -> Result<(), DeviceError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| DeviceError::Lost(error.to_string()))?;
        self.check()
    }
}

fn remember(fault: &Mutex<Option<DeviceError>>, error: DeviceError) {
    let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
    // A lost device is the reason of all that follows.
    if fault.is_none() || matches!(error, DeviceError::Lost(_)) {
        *fault = Some(error);
    }
}

fn sort(error: wgpu::Error) -> DeviceError {
    match error {
        wgpu::Error::OutOfMemory { source } => DeviceError::OutOfMemory(source.to_string()),
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            DeviceError::Refused(description)
        }
    }
}
