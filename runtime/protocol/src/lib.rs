//! What `reliefd` and its viewers say to each other: PROTOCOL.md as types.
