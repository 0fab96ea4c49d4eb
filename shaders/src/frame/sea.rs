//! Sea level above the ellipsoid, for the colours of the ground.

/// Rows of the grid, from the South Pole to the North Pole.
pub const SEA_ROWS: u32 = 91;
/// Columns of the grid from longitude -180 on; the last one's neighbour is the first.
pub const SEA_COLUMNS: u32 = 180;

/// Values of the grid: as many as a uniform of 64 KiB holds.
pub const SEA_NODES: usize = (SEA_ROWS * SEA_COLUMNS) as usize;

/// Sea level at (S, T), metres, between the nodes of a grid of [`SEA_ROWS`] x [`SEA_COLUMNS`].
#[must_use]
pub fn sea_level_m(grid_m: &[f32], s: u32, t: u32) -> f32 {
    let x = s as f32 * (SEA_COLUMNS as f32 / 4_294_967_296.0);
    let y = t as f32 * ((SEA_ROWS - 1) as f32 / 2_147_483_648.0);
    // The greatest S rounds to a whole turn.
    let (column, row) = (x as u32 % SEA_COLUMNS, (y as u32).min(SEA_ROWS - 2));
    let (u, v) = (x - x.floor(), y - row as f32);
    let east = (column + 1) % SEA_COLUMNS;
    let node = |x: u32, y: u32| grid_m[(y * SEA_COLUMNS + x) as usize];
    let south = node(column, row) + (node(east, row) - node(column, row)) * u;
    let north = node(column, row + 1) + (node(east, row + 1) - node(column, row + 1)) * u;
    south + (north - south) * v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_hit_and_the_seam_is_closed() {
        let grid: Vec<f32> = (0..SEA_ROWS * SEA_COLUMNS).map(|k| (k % 1009) as f32).collect();
        let node = |x: u32, y: u32| grid[(y * SEA_COLUMNS + x) as usize];
        assert_eq!(sea_level_m(&grid, 0, 0), node(0, 0));
        assert_eq!(sea_level_m(&grid, 1 << 31, 1 << 30), node(90, 45));
        assert_eq!(sea_level_m(&grid, 0, 1 << 31), node(0, 90));
        let (before, after) = (sea_level_m(&grid, u32::MAX, 1 << 30), sea_level_m(&grid, 0, 1 << 30));
        assert!((before - after).abs() < 1e-2, "{before} {after}");
    }
}
