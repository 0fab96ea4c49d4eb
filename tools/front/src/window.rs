//! Windows on the command line, and the samples of a level in them.

use std::str::FromStr;

use relief_formats::body::Body;
use relief_formats::file::Relief;

use crate::error::ToolError;

/// Where the samples of a level lie, as a raster of the whole map: AT the nodes (a globe's rows
/// run from pole to pole inclusive, its columns go round once), or in the middle of each 2 x 2 cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples {
    /// Distinct columns.
    pub columns: u32,
    /// Rows, southernmost first.
    pub rows: u32,
    /// True when the last column is followed by the first.
    pub wraps: bool,
    /// Coordinates of sample (0, 0) and the spacing of samples, [x, y, dx, dy]: degrees on a
    /// globe, CRS units on a plane.
    pub frame: [f64; 4],
}

impl Samples {
    /// The samples of a level that the grid has.
    #[must_use]
    pub fn of(relief: &Relief, level: u32, over_cells: bool) -> Self {
        let (grid, scale) = (relief.grid(), f64::from(1u32 << level));
        let [x, y, dx, dy] = match *relief.body() {
            Body::Plane { x0, y0, dx, dy, .. } => [x0, y0, dx * scale, dy * scale],
            Body::Ellipsoid { .. } => [-180.0, -90.0, grid.spacing_deg(level), grid.spacing_deg(level)],
        };
        Self {
            columns: grid.width(level) >> u32::from(over_cells),
            rows: (grid.height(level) >> u32::from(over_cells)) + u32::from(!grid.plane && !over_cells),
            wraps: !grid.plane,
            frame: if over_cells { [x + dx, y + dy, 2.0 * dx, 2.0 * dy] } else { [x, y, dx, dy] },
        }
    }

    /// GDAL's geotransform of a raster of a rectangle's samples with north up: they are its pixels'
    /// centres.
    #[must_use]
    pub fn geo_transform(&self, rectangle: Rectangle) -> [f64; 6] {
        let [x, y, dx, dy] = self.frame;
        let west = x + dx * (rectangle.column as f64 - 0.5);
        let north = y + dy * (f64::from(rectangle.row + rectangle.rows) - 0.5);
        [west, dx, 0.0, north, 0.0, -dy]
    }
}

/// West, south, east, north: degrees on a globe, CRS units on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least longitude or X.
    pub west: f64,
    /// Least latitude or Y.
    pub south: f64,
    /// Greatest longitude or X; on a globe `west` to `west` + 360.
    pub east: f64,
    /// Greatest latitude or Y.
    pub north: f64,
}

impl FromStr for Bounds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse::<f64>()).collect();
        match numbers.as_deref() {
            Ok(&[west, south, east, north]) if [west, south, east, north].iter().all(|v| v.is_finite()) => {
                Ok(Self { west, south, east, north })
            }
            _ => Err("must be four numbers W,S,E,N (use = before a negative one: --window=-10,40,5,50)".into()),
        }
    }
}

/// A rectangle of samples; `column` may lie outside 0..columns where it wraps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle {
    /// First column.
    pub column: i64,
    /// First row, southernmost first.
    pub row: u32,
    /// Columns.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
}

impl Bounds {
    /// The whole map as far as it has samples.
    #[must_use]
    pub fn whole(samples: &Samples) -> Self {
        let [x, y, dx, dy] = samples.frame;
        if samples.wraps {
            return Self { west: -180.0, south: -90.0, east: 180.0, north: 90.0 };
        }
        let (columns, rows) = (f64::from(samples.columns - 1), f64::from(samples.rows - 1));
        Self { west: x, south: y, east: x + dx * columns, north: y + dy * rows }
    }

    /// Checks the order of the sides; on a globe an east side west of the west side lies beyond
    /// the antimeridian.
    ///
    /// # Errors
    /// [`ToolError::Usage`] for sides that enclose nothing.
    pub fn ordered(self, globe: bool) -> Result<Self, ToolError> {
        let Self { west, south, east, north } = self;
        let refused = |what: String, rule: &str| {
            Err(ToolError::usage(format!("--window: {what}"), rule, "give W,S,E,N in this order"))
        };
        if south >= north {
            return refused(format!("south {south}, north {north}"), "south lies below north");
        }
        if !globe {
            if west >= east {
                return refused(format!("west {west}, east {east}"), "west lies below east");
            }
            return Ok(self);
        }
        if south < -90.0 || north > 90.0 {
            return refused(format!("south {south}, north {north}"), "latitudes lie within -90 to 90 degrees");
        }
        if west.abs() > 360.0 || east.abs() > 720.0 {
            return refused(format!("west {west}, east {east}"), "longitudes lie within -360 to 720 degrees");
        }
        let east = if east <= west { east + 360.0 } else { east };
        if east <= west || east - west > 360.0 {
            return refused(format!("west {west}, east {}", self.east), "a window is at most 360 degrees wide");
        }
        Ok(Self { east, ..self })
    }

    /// The samples that lie in an ordered window, its sides included; none where no sample does.
    #[must_use]
    pub fn samples(&self, samples: &Samples) -> Option<Rectangle> {
        // A millionth of a sample: what degrees written in decimals may be off.
        const SLACK: f64 = 1e-6;
        let [x, y, dx, dy] = samples.frame;
        let first = |low: f64, at: f64, step: f64| ((low - at) / step - SLACK).ceil();
        let last = |high: f64, at: f64, step: f64| ((high - at) / step + SLACK).floor();
        let (mut column, mut column_end) = (first(self.west, x, dx), last(self.east, x, dx) + 1.0);
        if samples.wraps {
            column_end = column_end.min(column + f64::from(samples.columns));
        } else {
            (column, column_end) = (column.max(0.0), column_end.min(f64::from(samples.columns)));
        }
        let row = first(self.south, y, dy).max(0.0);
        let row_end = (last(self.north, y, dy) + 1.0).min(f64::from(samples.rows));
        (column < column_end && row < row_end).then_some(Rectangle {
            column: column as i64,
            row: row as u32,
            columns: (column_end - column) as u32,
            rows: (row_end - row) as u32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(text: &str) -> Bounds {
        text.parse().unwrap()
    }

    #[test]
    fn four_numbers_or_an_error() {
        assert_eq!(bounds("-10, 2,3.5,4e1"), Bounds { west: -10.0, south: 2.0, east: 3.5, north: 40.0 });
        for bad in ["", "1,2,3", "1,2,3,4,5", "1,2,3,x", "1,2,3,nan", "1,2,3,inf"] {
            assert!(bad.parse::<Bounds>().is_err(), "{bad}");
        }
    }

    #[test]
    fn sides_are_in_order() {
        assert_eq!(bounds("170,-20,-170,20").ordered(true).unwrap().east, 190.0);
        assert_eq!(bounds("-180,-90,180,90").ordered(true).unwrap().east, 180.0);
        for bad in ["0,10,5,10", "0,20,5,10", "0,-91,5,0", "0,0,361,1", "-400,0,0,1"] {
            assert!(bounds(bad).ordered(true).is_err(), "{bad}");
        }
        assert!(bounds("5,0,4,1").ordered(false).is_err());
        assert!(bounds("1e6,2e6,3e6,4e6").ordered(false).is_ok());
    }
}
