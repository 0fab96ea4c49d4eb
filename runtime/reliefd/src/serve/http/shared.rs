//! What all handlers share.

use std::sync::Arc;

use axum::extract::FromRef;
use tokio::sync::Semaphore;

use crate::serve::hub::Hub;
use crate::serve::stop::Stop;

/// What all handlers share.
#[derive(Clone)]
pub struct Shared {
    /// The planets and their viewers.
    pub hub: Arc<Hub>,
    /// The daemon's end.
    pub stop: Stop,
    /// Room for requests in work.
    pub room: Arc<Semaphore>,
}

impl FromRef<Shared> for Arc<Hub> {
    fn from_ref(shared: &Shared) -> Self {
        Self::clone(&shared.hub)
    }
}
