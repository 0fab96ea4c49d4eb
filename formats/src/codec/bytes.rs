//! Little-endian numbers from the front of a slice.

/// Takes an i32.
pub fn take_i32(bytes: &mut &[u8]) -> Option<i32> {
    let (head, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(i32::from_le_bytes(*head))
}
