//! As many open files as the system lets us have: each viewer is one, and the usual limit of 1024 is
//! there for programs that cannot count further.

/// Raises the limit; where that is not allowed, it stays as it is.
#[cfg(target_os = "linux")]
pub fn raise() {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

    let limit = getrlimit(Resource::Nofile);
    if let Err(error) = setrlimit(Resource::Nofile, Rlimit { current: limit.maximum, ..limit }) {
        tracing::warn!(%error, limit = ?limit.current, "few viewers can attach: the limit of open files stays");
    }
}

/// Elsewhere there is no such limit.
#[cfg(not(target_os = "linux"))]
pub fn raise() {}
