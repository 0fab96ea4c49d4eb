//! What becomes of the files while they are served: replaced, deleted, cut. On SIGHUP, or once a
//! changed file has stayed the same for two looks, its new bake is opened and handed to the engine;
//! viewers stay.

use std::fs::Metadata;
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::sync::Arc;

use relief_front::error::ToolError;
use relief_protocol::error::{Code, Fault};
use relief_protocol::to_viewer::ToViewer;
use relief_runtime::planet::Planet;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::time::MissedTickBehavior;

use super::hub::{Hub, Served};
use super::patience::patience;

use crate::truncated;

/// Watches all files, for as long as the daemon runs.
pub async fn watch(hub: Arc<Hub>) {
    let mut hangups = signal(SignalKind::hangup())
        .inspect_err(|error| tracing::warn!(%error, "SIGHUP is not heard: files are watched all the same"))
        .ok();
    let mut files: Vec<Watched> = hub.all().map(|served| Watched::new(Arc::clone(served))).collect();
    let mut looks = tokio::time::interval(patience().look);
    looks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        let told = tokio::select! {
            () = hangup(&mut hangups) => true,
            _ = looks.tick() => false,
        };
        for file in &mut files {
            file.look(&hub, told).await;
        }
    }
}

async fn hangup(signals: &mut Option<Signal>) {
    let heard = match signals {
        Some(signals) => signals.recv().await,
        None => None,
    };
    if heard.is_none() {
        std::future::pending::<()>().await;
    }
}

/// What tells one file from another, or from itself after a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Identity {
    device: u64,
    inode: u64,
    bytes: u64,
    modified: (i64, i64),
}

impl Identity {
    fn of(file: &Metadata) -> Self {
        Self { device: file.dev(), inode: file.ino(), bytes: file.len(), modified: (file.mtime(), file.mtime_nsec()) }
    }

    fn of_open(planet: &Planet) -> Option<Self> {
        planet.relief().file()?.metadata().ok().as_ref().map(Self::of)
    }
}

/// What a look at a path says is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Nothing,
    /// The path has no file any more.
    Missing,
    /// There is a file that was not opened yet.
    Open(Identity),
}

/// Looks at one path, one after the other.
#[derive(Debug, Default)]
struct Looks {
    /// The file that is served.
    shown: Option<Identity>,
    /// What the last look saw.
    seen: Option<Identity>,
    /// A file that was tried and is bad.
    tried: Option<Identity>,
    missing: bool,
}

impl Looks {
    /// `told`: who runs the daemon says that the file is whole now.
    fn at(&mut self, now: Option<Identity>, told: bool) -> Step {
        let steady = now == std::mem::replace(&mut self.seen, now);
        let Some(now) = now else {
            return if std::mem::replace(&mut self.missing, true) { Step::Nothing } else { Step::Missing };
        };
        self.missing = false;
        let known = self.shown == Some(now) || (self.tried == Some(now) && !told);
        if known || !(steady || told) {
            return Step::Nothing;
        }
        self.tried = Some(now);
        Step::Open(now)
    }
}

struct Watched {
    served: Arc<Served>,
    looks: Looks,
    /// That the map met what was cut off was told.
    cut: bool,
}

impl Watched {
    fn new(served: Arc<Served>) -> Self {
        let shown = Identity::of_open(&served.planet());
        Self { served, looks: Looks { shown, ..Looks::default() }, cut: false }
    }

    async fn look(&mut self, hub: &Hub, told: bool) {
        let Served { name, path, .. } = &*self.served;
        if !self.cut && truncated::faults(self.served.planet().relief().bytes()) > 0 {
            self.cut = true;
            hub.fault(
                name,
                Fault::new(
                    Code::Damaged,
                    "the file was cut while it is served, or its disk fails",
                    "a file is replaced by renaming a new one, never edited in place",
                    "coarser tiles stand in; whoever runs the daemon bakes or copies the file again",
                ),
            );
        }
        let at = path.clone();
        // The disk may take its time.
        let now =
            tokio::task::spawn_blocking(move || std::fs::metadata(at)).await.unwrap_or_else(|error| Err(error.into()));
        match self.looks.at(now.as_ref().ok().map(Identity::of), told) {
            Step::Nothing => {}
            Step::Missing => {
                let error = now.err().map_or_else(String::new, |error| error.to_string());
                tracing::warn!(planet = name, error, path = %path.display(), "the file is gone; its map is served on");
            }
            Step::Open(_) => self.open(hub).await,
        }
    }

    async fn open(&mut self, hub: &Hub) {
        let (path, cache_bytes) = (self.served.path.clone(), self.served.planet().tiles().cache_bytes());
        let opened = tokio::task::spawn_blocking(move || super::planets::open(&path, cache_bytes)).await;
        let planet = match opened {
            Ok(Ok(planet)) => planet,
            Ok(Err(error)) => return hub.fault(&self.served.name, refused(&self.served.path, &error)),
            Err(error) => return tracing::error!(%error, "opening a new file fell over"),
        };
        self.looks.shown = Identity::of_open(&planet);
        self.cut = false;
        self.served.engine.replace(planet);
    }
}

fn refused(path: &Path, error: &ToolError) -> Fault {
    tracing::error!(path = %path.display(), "the new file cannot be served: {error}");
    Fault::new(
        Code::Damaged,
        "the new file cannot be opened",
        "a file is replaced by a whole one",
        "the file before it is served on; whoever runs the daemon finds the reason in its log",
    )
}

impl Hub {
    /// Tells all viewers, and the log, what is wrong with a planet.
    fn fault(&self, planet: &str, fault: Fault) {
        tracing::warn!(planet, code = ?fault.code, "{}", fault.what);
        self.meters.fault(fault.code);
        self.tell(ToViewer::Error(Fault { what: format!("{planet}: {}", fault.what), ..fault }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(inode: u64, bytes: u64) -> Identity {
        Identity { device: 1, inode, bytes, modified: (5, 5) }
    }

    #[test]
    fn a_new_file_is_opened_once_it_stays_the_same() {
        let mut looks = Looks { shown: Some(file(1, 10)), ..Looks::default() };
        assert_eq!(looks.at(Some(file(1, 10)), false), Step::Nothing);
        assert_eq!(looks.at(Some(file(2, 3)), false), Step::Nothing, "it may still grow");
        assert_eq!(looks.at(Some(file(2, 7)), false), Step::Nothing);
        assert_eq!(looks.at(Some(file(2, 7)), false), Step::Open(file(2, 7)));
        // It was bad: not again before it changes, unless somebody says so.
        assert_eq!(looks.at(Some(file(2, 7)), false), Step::Nothing);
        assert_eq!(looks.at(Some(file(2, 7)), true), Step::Open(file(2, 7)));
        assert_eq!(looks.at(Some(file(3, 7)), true), Step::Open(file(3, 7)), "no need to wait");
        looks.shown = Some(file(3, 7));
        assert_eq!(looks.at(Some(file(3, 7)), true), Step::Nothing, "it is served already");
    }

    #[test]
    fn a_missing_file_is_told_of_once() {
        let mut looks = Looks { shown: Some(file(1, 10)), ..Looks::default() };
        assert_eq!([(); 3].map(|()| looks.at(None, false)), [Step::Missing, Step::Nothing, Step::Nothing]);
        assert_eq!(looks.at(Some(file(1, 10)), false), Step::Nothing);
        assert_eq!(looks.at(None, true), Step::Missing);
        assert_eq!(looks.at(Some(file(2, 10)), false), Step::Nothing);
        assert_eq!(looks.at(Some(file(2, 10)), false), Step::Open(file(2, 10)));
    }
}
