//! A map of the differences: each pixel shows the largest one in it.

use std::path::Path;

use relief_formats::grid::Grid;

use relief_front::error::ToolError;
use relief_front::picture::{ColourMap, ColourMapInput, colour_map, write_png};

/// Columns of the map at most.
const COLUMNS: u32 = 1024;

pub struct Map {
    columns: usize,
    rows: usize,
    /// log2 of the level-0 nodes along a pixel's side.
    shift: u32,
    /// B - A in metres, southernmost row first.
    values: Vec<f32>,
}

impl Map {
    pub fn new(grid: Grid) -> Self {
        let shift = (grid.width(0) / COLUMNS).max(1).ilog2();
        let (columns, rows) = ((grid.width(0) >> shift) as usize, (grid.height(0) >> shift) as usize);
        Self { columns, rows, shift, values: vec![0.0; columns * rows] }
    }

    /// Enters differences at nodes (column, row, B - A) of a level. Independent of the order.
    pub fn deposit(&mut self, level: u32, spots: &[(u32, u32, f32)]) {
        let side = ((1usize << level) >> self.shift).max(1);
        for &(i, j, difference_m) in spots {
            let (x, y) = (((i << level) >> self.shift) as usize, ((j << level) >> self.shift) as usize);
            for row in y..(y + side).min(self.rows) {
                for value in &mut self.values[row * self.columns + x..][..side.min(self.columns - x)] {
                    if (difference_m.abs(), difference_m) > (value.abs(), *value) {
                        *value = difference_m;
                    }
                }
            }
        }
    }

    /// Writes the map with a bar from the largest difference downwards to the largest upwards.
    pub fn write(&self, path: &Path) -> Result<(), ToolError> {
        let most = self.values.iter().fold(0.0f32, |most, v| most.max(v.abs()));
        let most = if most > 0.0 { most } else { 1.0 };
        let values: Vec<f32> = self.values.chunks_exact(self.columns).rev().flatten().copied().collect();
        let input = ColourMapInput {
            width: self.columns,
            height: self.rows,
            values: &values,
            map: ColourMap::Signed,
            range: Some([-most, most]),
            legend: true,
        };
        let (image, _) = colour_map(&input)
            .map_err(|error| ToolError::usage(error.to_string(), "a map has at least one pixel", "leave --png out"))?;
        write_png(path, &image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_keeps_its_largest_difference() {
        let mut map = Map::new(Grid::new(11, false));
        assert_eq!((map.columns, map.rows, map.shift), (1024, 512, 2));
        map.deposit(0, &[(8, 4, 1.0), (9, 5, -3.0), (11, 7, 3.0), (4095, 2047, -0.5)]);
        assert_eq!((map.values[1024 + 2], map.values[512 * 1024 - 1]), (3.0, -0.5));
        // A node of level 4 stands for 16 x 16 nodes of level 0: 4 x 4 pixels.
        map.deposit(4, &[(1, 1, 2.0)]);
        let filled = map.values.iter().filter(|&&v| v == 2.0).count();
        assert_eq!((filled, map.values[4 * 1024 + 4], map.values[7 * 1024 + 7]), (16, 2.0, 2.0));
    }
}
