//! The way of a ray between two row lines: one cell, or two when it crosses a column.

/// Part of a slab within one cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Piece {
    /// Offset of the cell's near left node from the ray's strip, in the near row.
    pub near: isize,
    /// The same in the far row.
    pub far: isize,
    /// Share of the cell on the ray's left at the near row line, the cell's sides continued.
    pub left: f32,
    /// Cells that the ray moves across in the slab.
    pub shear: f32,
    /// Shares of the slab behind the ray where it enters and leaves the cell.
    pub from: f32,
    /// See `from`.
    pub to: f32,
}

/// A slab as the rays of one row see it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slab {
    /// The first piece; the second is unused when a ray stays in its column.
    pub pieces: [Piece; 2],
    /// Number of pieces.
    pub count: usize,
}

/// The slab after a row line, for rays at share `phase` of their strip. The near row has share
/// `near_phase` of the strip left of its nodes, the far row's nodes are `slip` strips on.
pub fn slab(phase: f64, near_phase: f64, slip: i64, shear: f64) -> Slab {
    let place = phase - near_phase;
    let column = place.floor();
    let left = place - column;
    let near = column as isize;
    let piece = |step: isize, from: f64, to: f64| Piece {
        near: near + step,
        far: near + step + slip as isize,
        left: (left - step as f64) as f32,
        shear: shear as f32,
        from: from as f32,
        to: to as f32,
    };
    let end = left + shear;
    let crossing = if end > 1.0 {
        Some((1, (1.0 - left) / shear))
    } else if end < 0.0 {
        Some((-1, left / -shear))
    } else {
        None
    };
    match crossing {
        Some((step, at)) if at <= 0.0 => Slab { pieces: [piece(step, 0.0, 1.0), Piece::default()], count: 1 },
        Some((step, at)) => Slab { pieces: [piece(0, 0.0, at), piece(step, at, 1.0)], count: 2 },
        None => Slab { pieces: [piece(0, 0.0, 1.0), Piece::default()], count: 1 },
    }
}
