//! Where the sea's surface lies above the ellipsoid, roughly: for the colours of pictures.
//!
//! Heights are above the ellipsoid once a geoid was added; the plain of the Ganges then
//! lies at -50 m and is no sea. See `data/PROVENANCE.md`.

/// Rows from the South Pole to the North Pole, every second degree.
pub const ROWS: usize = 91;
/// Columns from longitude -180, every second degree; the last one's neighbour is the first.
pub const COLUMNS: usize = 180;

static CENTIMETRES: &[u8; 2 * ROWS * COLUMNS] = include_bytes!("../../data/egm96_2deg.bin");

/// EGM96 at the nodes of the coarse grid, metres, south row first.
#[must_use]
pub fn egm96_m() -> Vec<f32> {
    CENTIMETRES.chunks_exact(2).map(|b| f32::from(i16::from_le_bytes([b[0], b[1]])) / 100.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_extremes_are_where_they_are() {
        let sea = egm96_m();
        let at = |lon: usize, lat: usize| sea[(lat + 90) / 2 * COLUMNS + (lon + 180) / 2];
        // South of Sri Lanka -105 m, at New Guinea above 70 m; the poles 13.6 and -29.5 m.
        assert!((at(78, 4) + 105.0).abs() < 2.0, "{}", at(78, 4));
        assert!(sea.iter().fold(0f32, |a, &b| a.max(b)) > 70.0);
        assert!((sea[sea.len() - 1] - 13.6).abs() < 0.1 && (sea[0] + 29.5).abs() < 0.1);
    }
}
