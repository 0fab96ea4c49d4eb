//! Source heights onto nodes.
