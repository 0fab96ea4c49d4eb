//! Tiles decoded by worker threads, a bounded number at a time.

use std::collections::HashSet;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use relief_formats::file::FormatError;
use relief_formats::tile::TileKey;

use super::page::{Decoder, Page};
use crate::planet::Planet;

/// Tiles in work for each worker thread: enough to hide the time between two updates.
const FOR_EACH_WORKER: usize = 4;

type Decoded = (TileKey, Result<Page, FormatError>);

pub(super) struct Loader {
    decoder: Arc<Decoder>,
    loading: HashSet<TileKey>,
    sender: Sender<Decoded>,
    receiver: Receiver<Decoded>,
    limit: usize,
}

impl Loader {
    pub fn new(planet: Arc<Planet>) -> Self {
        let (sender, receiver) = channel();
        let limit = FOR_EACH_WORKER * rayon::current_num_threads();
        Self { decoder: Arc::new(Decoder::new(planet)), loading: HashSet::new(), sender, receiver, limit }
    }

    /// Decodes a tile on this thread.
    pub fn decode(&self, key: TileKey) -> Result<Page, FormatError> {
        self.decoder.page(key)
    }

    /// Tiles that may be in work together.
    pub fn limit(&self) -> usize {
        self.limit
    }

    pub fn in_flight(&self) -> usize {
        self.loading.len()
    }

    pub fn idle(&self) -> bool {
        self.loading.is_empty()
    }

    pub fn is_loading(&self, key: TileKey) -> bool {
        self.loading.contains(&key)
    }

    /// Decodes a tile on a worker.
    pub fn start(&mut self, key: TileKey) {
        self.loading.insert(key);
        let (decoder, sender) = (Arc::clone(&self.decoder), self.sender.clone());
        rayon::spawn(move || {
            // Nobody receives when the resident set is gone.
            let _ = sender.send((key, decoder.page(key)));
        });
    }

    /// The next decoded tile; none when nothing is in work or the time is over.
    pub fn receive(&mut self, wait: Duration) -> Option<Decoded> {
        if self.loading.is_empty() {
            return None;
        }
        let decoded = self.receiver.recv_timeout(wait).ok()?;
        self.loading.remove(&decoded.0);
        Some(decoded)
    }
}
