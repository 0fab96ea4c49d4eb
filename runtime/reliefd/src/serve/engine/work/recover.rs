//! How the engine goes on after a lost device, and after a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};

use relief_protocol::error::{Code, Fault};
use relief_runtime::gpu::DeviceError;

use super::Worker;
use crate::backend::{Backend, BackendChoice};
use crate::serve::ask::of_draw;
use crate::serve::engine::drawer::Drawer;
use crate::serve::engine::slot::{Ask, Sink};

impl Worker {
    /// After a panic, which is a defect of ours: who asked is told, and all others go on with tiles
    /// made anew.
    pub(super) fn fell(&mut self, drawn: Option<(u64, Ask, Sink)>) {
        let fault = Fault::new(
            Code::Internal,
            "a view that the daemon fell over",
            "every view is drawn or refused",
            "tell whoever runs the daemon; its log says more. Other views are drawn on",
        );
        if let Some((slot, ask, sink)) = drawn {
            self.board.forget(slot);
            self.lacked.remove(&slot);
            sink(Err(fault.at(ask.view)));
        } else {
            self.listener.fault(fault);
        }
        // Where that fails the old ones may still do.
        let _ = guarded(|| self.renew(self.limits.backend));
    }

    /// Makes device and tiles anew; without a GPU that works, all cores draw if they may. True when
    /// all views are about to be drawn again.
    pub(super) fn recover(&mut self, error: &DeviceError) -> bool {
        self.listener.fault(Fault::new(
            Code::Device,
            error.to_string(),
            "drawing needs a GPU that works",
            "wait: the daemon makes the device anew, and pictures follow",
        ));
        for wait in self.recovery.waits {
            std::thread::sleep(*wait);
            if self.renew(self.limits.backend).is_ok() {
                return true;
            }
        }
        // The twins have no device to lose.
        self.limits.backend == BackendChoice::Auto && self.renew(BackendChoice::Cpu).is_ok()
    }

    fn renew(&mut self, choice: BackendChoice) -> Result<(), Fault> {
        let backend = match (choice, &self.backend) {
            (BackendChoice::Cpu, _) => Backend::Cpu,
            // A software adapter that was asked for is one again.
            (BackendChoice::Auto, Backend::Gpu(_)) => (self.recovery.find)(BackendChoice::Gpu)?,
            (choice, _) => (self.recovery.find)(choice)?,
        };
        self.drawer = Drawer::new(&backend, &self.planet, self.limits.atlas_bytes).map_err(of_draw)?;
        self.backend = backend;
        self.lacked.clear();
        self.board.again();
        Ok(())
    }
}

pub(super) fn guarded<T>(work: impl FnOnce() -> T) -> std::thread::Result<T> {
    // What a panic leaves behind is made anew before it is used again.
    catch_unwind(AssertUnwindSafe(work))
}
