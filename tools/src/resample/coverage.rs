//! How much of each pixel a quadrilateral covers.

/// Calls `add(column, row, area)` for every pixel of an `nx` x `ny` raster that the convex
/// quadrilateral covers in part, in pixel-corner coordinates.
pub(crate) fn cover(quad: &[[f64; 2]; 4], (nx, ny): (usize, usize), mut add: impl FnMut(usize, usize, f64)) {
    let range = |values: &mut dyn Iterator<Item = f64>, n: usize| {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        (low.floor().max(0.0) as usize, high.ceil().clamp(0.0, n as f64) as usize)
    };
    let (row_from, row_to) = range(&mut quad.iter().map(|p| p[1]), ny);
    let (mut strip, mut piece, mut spare) = (Vec::new(), Vec::new(), Vec::new());
    for row in row_from..row_to {
        clip(quad, 1, row as f64, 1.0, &mut spare);
        clip(&spare, 1, row as f64 + 1.0, -1.0, &mut strip);
        let (from, to) = range(&mut strip.iter().map(|p: &[f64; 2]| p[0]), nx);
        for column in from..to {
            clip(&strip, 0, column as f64, 1.0, &mut spare);
            clip(&spare, 0, column as f64 + 1.0, -1.0, &mut piece);
            let area = area(&piece);
            if area > 0.0 {
                add(column, row, area);
            }
        }
    }
}

/// Keeps the part of a convex polygon with `side * (coordinate - at) >= 0`.
fn clip(polygon: &[[f64; 2]], axis: usize, at: f64, side: f64, kept: &mut Vec<[f64; 2]>) {
    kept.clear();
    for (n, point) in polygon.iter().enumerate() {
        let next = polygon[(n + 1) % polygon.len()];
        let (here, there) = (side * (point[axis] - at), side * (next[axis] - at));
        if here >= 0.0 {
            kept.push(*point);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            let t = here / (here - there);
            let mut crossing = [point[0] + t * (next[0] - point[0]), point[1] + t * (next[1] - point[1])];
            crossing[axis] = at;
            kept.push(crossing);
        }
    }
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let Some(origin) = polygon.first() else {
        return 0.0;
    };
    let from = |p: &[f64; 2]| [p[0] - origin[0], p[1] - origin[1]];
    let twice: f64 = polygon
        .windows(2)
        .map(|edge| {
            let (a, b) = (from(&edge[0]), from(&edge[1]));
            a[0] * b[1] - a[1] * b[0]
        })
        .sum();
    0.5 * twice.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covered(quad: [[f64; 2]; 4]) -> Vec<(usize, usize, f64)> {
        let mut found = Vec::new();
        cover(&quad, (4, 4), |column, row, area| found.push((column, row, area)));
        found
    }

    #[test]
    fn boxes_and_diamonds() {
        let square = covered([[0.5, 0.0], [1.5, 0.0], [1.5, 1.0], [0.5, 1.0]]);
        assert_eq!(square, [(0, 0, 0.5), (1, 0, 0.5)]);
        let diamond = covered([[2.0, 1.0], [3.0, 2.0], [2.0, 3.0], [1.0, 2.0]]);
        assert_eq!(diamond, [(1, 1, 0.5), (2, 1, 0.5), (1, 2, 0.5), (2, 2, 0.5)]);
        let clockwise = covered([[1.0, 2.0], [2.0, 3.0], [3.0, 2.0], [2.0, 1.0]]);
        assert_eq!(clockwise, diamond);
    }

    #[test]
    fn parts_add_up_and_what_lies_outside_is_left_out() {
        let quad = [[0.3, 0.2], [3.7, 0.9], [3.1, 3.6], [0.1, 2.8]];
        let sum: f64 = covered(quad).iter().map(|(_, _, area)| area).sum();
        assert!((sum - area(&quad)).abs() < 1e-12);
        assert!(covered([[-3.0, -3.0], [-1.0, -3.0], [-1.0, -1.0], [-3.0, -1.0]]).is_empty());
        let half: f64 = covered([[-1.0, 1.0], [1.0, 1.0], [1.0, 2.0], [-1.0, 2.0]]).iter().map(|p| p.2).sum();
        assert_eq!(half, 1.0);
    }
}
