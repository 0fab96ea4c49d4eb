//! Rows of residuals that need no samples of their own: a row that repeats the row before, or has
//! one residual throughout, is only marked.

use super::CodecError;

/// How a row of residuals is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// Every sample.
    Whole = 0,
    /// Nothing: it equals the row before.
    Repeat = 1,
    /// Its first sample, which stands for all.
    Constant = 2,
}

impl Row {
    /// The cheapest way to store a row, given the one before it.
    pub(super) fn of(row: &[i32], before: Option<&[i32]>) -> Self {
        if before == Some(row) {
            Self::Repeat
        } else if row.len() > 1 && row.iter().all(|&r| r == row[0]) {
            Self::Constant
        } else {
            Self::Whole
        }
    }

    /// Samples stored of a row of `width`.
    pub(super) fn stored(self, width: usize) -> usize {
        match self {
            Self::Whole => width,
            Self::Repeat => 0,
            Self::Constant => 1,
        }
    }
}

/// The stored samples of all rows, one after another.
pub(super) fn gather<'a>(rows: &'a [Row], samples: &'a [i32], width: usize) -> impl Iterator<Item = i32> + 'a {
    rows.iter().zip(samples.chunks_exact(width)).flat_map(move |(row, s)| s[..row.stored(width)].iter().copied())
}

/// Appends the marks, two bits a row, the first row lowest.
pub(super) fn put_rows(header: &mut Vec<u8>, rows: &[Row]) {
    header.extend(rows.chunks(4).map(|four| four.iter().rev().fold(0, |byte, &row| byte << 2 | row as u8)));
}

/// Takes the marks of `count` rows; the first row has none before it to repeat.
pub(super) fn take_rows(header: &mut &[u8], count: usize) -> Result<Vec<Row>, CodecError> {
    let (bytes, rest) = header.split_at_checked(count.div_ceil(4)).ok_or(CodecError::Truncated)?;
    *header = rest;
    (0..bytes.len() * 4)
        .filter_map(|y| match (bytes[y / 4] >> (2 * (y % 4)) & 3, y) {
            (0, y) if y >= count => None,
            (_, y) if y >= count => Some(Err(CodecError::Trailing)),
            (0, _) => Some(Ok(Row::Whole)),
            (1, 1..) => Some(Ok(Row::Repeat)),
            (2, _) => Some(Ok(Row::Constant)),
            _ => Some(Err(CodecError::Range)),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_row_marks_are_refused() {
        assert_eq!(take_rows(&mut &[1][..], 2), Err(CodecError::Range));
        assert_eq!(take_rows(&mut &[3][..], 1), Err(CodecError::Range));
        assert_eq!(take_rows(&mut &[0x10][..], 2), Err(CodecError::Trailing));
        assert_eq!(take_rows(&mut &[][..], 1), Err(CodecError::Truncated));
    }

    #[test]
    fn marks_round_trip() {
        let rows = [Row::Whole, Row::Repeat, Row::Constant, Row::Repeat, Row::Whole];
        let mut header = Vec::new();
        put_rows(&mut header, &rows);
        let mut rest = header.as_slice();
        assert_eq!(take_rows(&mut rest, rows.len()).unwrap(), rows);
        assert!(rest.is_empty());
    }
}
