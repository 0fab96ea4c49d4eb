//! Sampling at points that follow no axis: each node with its own taps, or its own footprint.

use super::axis::Axis;
use super::coverage::cover;
use super::kernel::Kernel;
use super::separable::beside_voids;
use crate::source::raster::{Patch, Raster};
use relief_front::error::ToolError;

/// Most pixels copied out of a raster at a time.
const PATCH_PIXELS: usize = 1 << 21;

/// A raster and the points to sample it at, in pixel-corner coordinates, NaN where there is none.
pub(crate) struct Scattered<'a> {
    pub raster: &'a Raster,
    pub kernel: Kernel,
    /// `nx` points a row.
    pub points: &'a [[f64; 2]],
    pub nx: usize,
    /// For a mean, the corners of each point's footprint; NaN where the kernel serves instead.
    pub footprints: Option<&'a [[[f64; 2]; 4]]>,
}

/// Rows and columns of pixels, ends excluded; may reach beyond the raster.
#[derive(Clone, Copy)]
struct Span {
    x: (i64, i64),
    y: (i64, i64),
}

impl Scattered<'_> {
    /// Writes the height of every point, metres, NaN where void.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub fn sample(&self, heights_m: &mut [f64]) -> Result<(), ToolError> {
        let axes = [Axis::pixels(self.raster.width), Axis::pixels(self.raster.height)];
        let rows = self.points.len().checked_div(self.nx).unwrap_or(0);
        self.part(&axes, 0..self.nx, 0..rows, heights_m)
    }

    fn part(
        &self,
        axes: &[Axis; 2],
        xs: std::ops::Range<usize>,
        ys: std::ops::Range<usize>,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let indices = || ys.clone().flat_map(|y| xs.clone().map(move |x| y * self.nx + x));
        let spans = indices().filter_map(|at| self.span(axes, at));
        let Some(span) = spans
            .reduce(|a, b| Span { x: (a.x.0.min(b.x.0), a.x.1.max(b.x.1)), y: (a.y.0.min(b.y.0), a.y.1.max(b.y.1)) })
        else {
            return Ok(());
        };
        let pixels = (span.x.1 - span.x.0) as usize * (span.y.1 - span.y.0) as usize;
        if pixels > PATCH_PIXELS && xs.len() * ys.len() > 1 {
            let (x_half, y_half) = (xs.start + xs.len() / 2, ys.start + ys.len() / 2);
            if ys.len() >= xs.len() {
                self.part(axes, xs.clone(), ys.start..y_half, heights_m)?;
                return self.part(axes, xs, y_half..ys.end, heights_m);
            }
            self.part(axes, xs.start..x_half, ys.clone(), heights_m)?;
            return self.part(axes, x_half..xs.end, ys, heights_m);
        }
        let columns: Vec<_> = (span.x.0..span.x.1).map(|x| axes[0].stored(x).0).collect();
        let rows: Vec<_> = (span.y.0..span.y.1).map(|y| axes[1].stored(y)).collect();
        let patch = self.raster.gather(&rows, &columns, None)?;
        for at in indices() {
            if let Some(uv) = self.inside(axes, at) {
                heights_m[at] = match self.footprint(at) {
                    Some(quad) => self.mean(axes, &patch, span, uv, quad),
                    None => self.kernel_sum(axes, &patch, span, uv),
                };
            }
        }
        Ok(())
    }

    /// Sample coordinates of a point inside the raster.
    fn inside(&self, axes: &[Axis; 2], at: usize) -> Option<[f64; 2]> {
        let [px, py] = self.points[at];
        Some([axes[0].position(px)?, axes[1].position(py)?])
    }

    fn footprint(&self, at: usize) -> Option<&[[f64; 2]; 4]> {
        self.footprints.map(|all| &all[at]).filter(|quad| quad.iter().flatten().all(|value| value.is_finite()))
    }

    fn span(&self, axes: &[Axis; 2], at: usize) -> Option<Span> {
        let uv = self.inside(axes, at)?;
        let taps = self.kernel.taps() as i64;
        let mut span = [0, 1].map(|axis| {
            let start = self.kernel.start(&axes[axis], uv[axis]);
            (start, start + taps)
        });
        if let Some(quad) = self.footprint(at) {
            for (axis, span) in span.iter_mut().enumerate() {
                let n = axes[axis].n as f64;
                for corner in quad {
                    let value = corner[axis].clamp(0.0, n);
                    *span = (span.0.min(value.floor() as i64), span.1.max(value.ceil() as i64));
                }
            }
        }
        Some(Span { x: span[0], y: span[1] })
    }

    fn kernel_sum(&self, axes: &[Axis; 2], patch: &Patch, span: Span, uv: [f64; 2]) -> f64 {
        let (taps, few) = (self.kernel.taps(), self.kernel.fallback().taps());
        let (mut weights, mut spare) = ([[0.0; 6]; 2], [[0.0; 6]; 2]);
        let begin = [span.x.0, span.y.0];
        let mut starts = [[0; 3]; 2];
        for axis in 0..2 {
            let (kernel, fallback, u) = (self.kernel, self.kernel.fallback(), uv[axis]);
            kernel.weigh(&axes[axis], u, &mut weights[axis][..taps]);
            fallback.weigh(&axes[axis], u, &mut spare[axis][..few]);
            starts[axis] = [kernel.start(&axes[axis], u), fallback.start(&axes[axis], u), axes[axis].home(u)]
                .map(|index| (index - begin[axis]) as usize);
        }
        let mut sum = 0.0;
        for (row, wy) in weights[1][..taps].iter().enumerate() {
            let line = &patch.pixels[(starts[1][0] + row) * patch.nx + starts[0][0]..][..taps];
            let across: f64 = line.iter().zip(&weights[0]).map(|(pixel, wx)| wx * f64::from(*pixel)).sum();
            sum += wy * across;
        }
        match sum.is_nan() {
            false => sum,
            true => beside_voids(patch, starts[0], starts[1], &spare[0][..few], &spare[1][..few]),
        }
    }

    fn mean(&self, axes: &[Axis; 2], patch: &Patch, span: Span, uv: [f64; 2], quad: &[[f64; 2]; 4]) -> f64 {
        let pixel = |column: i64, row: i64| {
            f64::from(patch.pixels[(row - span.y.0) as usize * patch.nx + (column - span.x.0) as usize])
        };
        if pixel(axes[0].home(uv[0]), axes[1].home(uv[1])).is_nan() {
            return f64::NAN;
        }
        let (mut sum, mut total) = (0.0, 0.0);
        cover(quad, (self.raster.width, self.raster.height), |column, row, area| {
            let height = pixel(column as i64, row as i64);
            if !height.is_nan() {
                sum += area * height;
                total += area;
            }
        });
        if total > 0.0 { sum / total } else { self.kernel_sum(axes, patch, span, uv) }
    }
}
