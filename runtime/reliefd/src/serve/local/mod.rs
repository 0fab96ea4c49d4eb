//! The Unix socket that viewers beside the daemon attach by: messages are lines, payloads lie in
//! rings of shared memory.

mod lines;
mod listener;
mod ring;
mod rings;
mod viewer;

#[cfg(test)]
mod tests;

pub use listener::Listener;
