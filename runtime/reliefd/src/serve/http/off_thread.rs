//! Work that would keep a thread of the async runtime from everybody else.

use std::sync::{Arc, Weak};

use relief_protocol::error::{Code, Fault};

/// Tells work whether anybody still waits for it.
pub struct Asker(Weak<()>);

impl Asker {
    /// Refuses to go on for nobody.
    ///
    /// # Errors
    /// [`Code::Timeout`], which nobody reads.
    pub fn waits(&self) -> Result<(), Fault> {
        match self.0.strong_count() {
            0 => Err(Fault::new(Code::Timeout, "nobody waits", "an answer has a reader", "ask again")),
            _ => Ok(()),
        }
    }
}

/// Does work on a thread of its own. Where the asker goes away the work may see it and end.
///
/// # Errors
/// Those of the work.
pub async fn off_thread<T: Send + 'static>(
    work: impl FnOnce(&Asker) -> Result<T, Fault> + Send + 'static,
) -> Result<T, Fault> {
    // Dropped with this future.
    let here = Arc::new(());
    let asker = Asker(Arc::downgrade(&here));
    let done = tokio::task::spawn_blocking(move || work(&asker)).await;
    done.unwrap_or_else(|error| {
        let what = format!("the work ended: {error}");
        Err(Fault::new(
            Code::Internal,
            what,
            "a question that is understood is answered",
            "tell whoever runs the daemon",
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[tokio::test]
    async fn work_sees_that_its_asker_is_gone() {
        let (started, starts) = mpsc::channel();
        let (go, goes) = mpsc::channel::<()>();
        let (ended, ends) = mpsc::channel();
        let asked = tokio::spawn(off_thread(move |asker| {
            let _ = started.send(asker.waits().is_ok());
            let _ = goes.recv();
            let _ = ended.send(asker.waits().is_err());
            Ok(())
        }));
        assert_eq!(tokio::task::spawn_blocking(move || starts.recv()).await.ok(), Some(Ok(true)));
        asked.abort();
        assert!(asked.await.is_err());
        let _ = go.send(());
        assert_eq!(tokio::task::spawn_blocking(move || ends.recv()).await.ok(), Some(Ok(true)));
    }
}
