//! A viewer's half of the protocol.
