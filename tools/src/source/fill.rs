//! Voids filled smoothly: pull-push interpolation (Gortler et al. 1996, "The Lumigraph", 3.4)
//! on the raster's own pixels, so that a fill depends on the place alone.

/// One level of the pyramid: values, and how much each is worth (0 to 1).
struct Level {
    nx: usize,
    ny: usize,
    values: Vec<f32>,
    weights: Vec<f32>,
}

/// A copy of `heights_m` (`nx` wide) whose NaNs are interpolated from the rim of their void.
/// With `wraps` the first column follows the last.
pub(crate) fn pull_push(heights_m: &[f32], nx: usize, wraps: bool) -> Vec<f32> {
    let ny = heights_m.len() / nx.max(1);
    let mut filled = heights_m.to_vec();
    if nx == 0 || heights_m.iter().all(|height| height.is_nan()) {
        return filled;
    }
    let mut levels: Vec<Level> = Vec::new();
    let is_whole = |level: &Level| level.weights.iter().all(|weight| *weight >= 1.0);
    let mut next = pull(nx, ny, &|at| match heights_m[at] {
        height if height.is_nan() => (0.0, 0.0),
        height => (height, 1.0),
    });
    while !is_whole(&next) && (next.nx > 1 || next.ny > 1) {
        let coarser = pull(next.nx, next.ny, &|at| (next.values[at], next.weights[at]));
        levels.push(next);
        next = coarser;
    }
    while let Some(mut finer) = levels.pop() {
        let wraps = wraps && finer.nx == 2 * next.nx;
        for at in 0..finer.values.len() {
            let weight = finer.weights[at];
            if weight < 1.0 {
                let coarse = push(&next, at % finer.nx, at / finer.nx, wraps);
                finer.values[at] = weight * finer.values[at] + (1.0 - weight) * coarse;
            }
        }
        next = finer;
    }
    let wraps = wraps && nx == 2 * next.nx;
    for (at, height) in filled.iter_mut().enumerate() {
        if height.is_nan() {
            *height = push(&next, at % nx, at / nx, wraps);
        }
    }
    filled
}

/// The next coarser level: means of 2 x 2, weighted.
fn pull(nx: usize, ny: usize, at: &dyn Fn(usize) -> (f32, f32)) -> Level {
    let (half_x, half_y) = (nx.div_ceil(2), ny.div_ceil(2));
    let mut level = Level { nx: half_x, ny: half_y, values: Vec::new(), weights: Vec::new() };
    for y in 0..half_y {
        for x in 0..half_x {
            let (mut sum, mut total) = (0.0, 0.0);
            for row in 2 * y..(2 * y + 2).min(ny) {
                for column in 2 * x..(2 * x + 2).min(nx) {
                    let (value, weight) = at(row * nx + column);
                    sum += weight * value;
                    total += weight;
                }
            }
            level.values.push(if total > 0.0 { sum / total } else { 0.0 });
            level.weights.push(f32::min(total, 1.0));
        }
    }
    level
}

/// The coarser level's value at a finer pixel's centre, bilinear.
fn push(coarse: &Level, x: usize, y: usize, wraps: bool) -> f32 {
    let beside = |at: usize, n: usize, wraps: bool| {
        let near = at / 2;
        let far = if at.is_multiple_of(2) { near as i64 - 1 } else { near as i64 + 1 };
        let far = if wraps { far.rem_euclid(n as i64) } else { far.clamp(0, n as i64 - 1) };
        (near, far as usize)
    };
    let ((x0, x1), (y0, y1)) = (beside(x, coarse.nx, wraps), beside(y, coarse.ny, false));
    let line = |row: usize| 0.75 * coarse.values[row * coarse.nx + x0] + 0.25 * coarse.values[row * coarse.nx + x1];
    0.75 * line(y0) + 0.25 * line(y1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hole_in_a_slope_is_closed_and_the_rest_is_kept() {
        let slope: Vec<f32> = (0..64 * 64).map(|at| (at % 64) as f32).collect();
        let mut holed = slope.clone();
        for row in 20..30 {
            holed[row * 64 + 20..row * 64 + 34].fill(f32::NAN);
        }
        let filled = pull_push(&holed, 64, false);
        for (at, (was, now)) in slope.iter().zip(&filled).enumerate() {
            match holed[at].is_nan() {
                true => assert!((was - now).abs() < 4.0 && *now >= 0.0 && *now <= 63.0, "{at}: {was} {now}"),
                false => assert_eq!(was, now),
            }
        }
    }

    #[test]
    fn one_height_fills_everything_and_the_seam_is_seen() {
        let mut single = vec![f32::NAN; 30 * 7];
        single[100] = 5.0;
        assert!(pull_push(&single, 30, false).iter().all(|height| *height == 5.0));
        let mut ring = vec![f32::NAN; 64];
        ring[16] = 0.0;
        ring[63] = 10.0;
        let (open, closed) = (pull_push(&ring, 64, false), pull_push(&ring, 64, true));
        assert!(closed[0] > open[0], "{} {}", closed[0], open[0]);
        assert!(pull_push(&[f32::NAN; 4], 2, false).iter().all(|height| height.is_nan()));
    }
}
