//! The daemon's end, and what leads to it.

use std::future::Future;
use std::sync::Arc;

use relief_front::error::ToolError;
use tokio::sync::watch;

use super::cannot;

/// Tells all parts of the daemon that it ends.
#[derive(Clone)]
pub struct Stop(Arc<watch::Sender<bool>>);

impl Stop {
    /// Nobody wants it to end yet.
    pub fn new() -> Self {
        Self(Arc::new(watch::Sender::new(false)))
    }

    /// It ends from now on.
    pub fn begin(&self) {
        self.0.send_replace(true);
    }

    /// Whether it ends.
    pub fn begun(&self) -> bool {
        *self.0.borrow()
    }

    /// Waits for its end.
    pub async fn wait(&self) {
        // Whoever waits holds a sender, so it cannot be closed.
        let _ = self.0.subscribe().wait_for(|&begun| begun).await;
    }
}

/// Waits for SIGTERM or Ctrl-C; they are caught from the call on. Needs a runtime of tokio.
///
/// # Errors
/// A system that does not let them be caught.
pub fn signals() -> Result<impl Future<Output = &'static str>, ToolError> {
    use tokio::signal::unix::{SignalKind, signal};
    let caught = |kind| signal(kind).map_err(|error| cannot("catch signals", &error));
    let (mut term, mut interrupt) = (caught(SignalKind::terminate())?, caught(SignalKind::interrupt())?);
    Ok(async move {
        tokio::select! {
            _ = term.recv() => "SIGTERM",
            _ = interrupt.recv() => "Ctrl-C",
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn who_waits_and_who_comes_late_hears_of_it() {
        let stop = Stop::new();
        assert!(!stop.begun());
        let waits = tokio::spawn({
            let stop = stop.clone();
            async move { stop.wait().await }
        });
        stop.begin();
        assert!(waits.await.is_ok() && stop.begun());
        stop.wait().await;
    }
}
