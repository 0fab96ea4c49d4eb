//! How a lost device is made anew.

use std::time::Duration;

use relief_protocol::error::{Code, Fault};

use crate::backend::{Backend, BackendChoice};
use crate::serve::ask::of_tool;

/// Finds backends of a kind.
pub type Find = Box<dyn Fn(BackendChoice) -> Result<Backend, Fault> + Send>;

/// Where another device comes from, and when it is asked for.
pub struct Recovery {
    /// Another backend.
    pub find: Find,
    /// Waits before each attempt.
    pub waits: &'static [Duration],
    /// Views are refused for so long after all attempts failed: each round of them holds others up.
    pub given_up: Duration,
}

impl Default for Recovery {
    fn default() -> Self {
        const WAITS: &[Duration] =
            &[Duration::ZERO, Duration::from_millis(200), Duration::from_secs(1), Duration::from_secs(5)];
        let find = |choice| Backend::find(choice).map_err(|error| of_tool(Code::Device, &error));
        Self { find: Box::new(find), waits: WAITS, given_up: Duration::from_secs(30) }
    }
}
