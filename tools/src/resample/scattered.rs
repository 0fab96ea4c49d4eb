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
    pub points: Vec<[f64; 2]>,
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

/// A raster's axes and the sample coordinates of each point, NaN outside.
struct Places {
    axes: [Axis; 2],
    uv: Vec<[f64; 2]>,
}

impl Scattered<'_> {
    /// Writes the height of every point, metres, NaN where void.
    ///
    /// # Errors
    /// Those of reading the raster.
    pub fn sample(mut self, heights_m: &mut [f64]) -> Result<(), ToolError> {
        let axes = [Axis::pixels(self.raster.width), Axis::pixels(self.raster.height)];
        let rows = self.points.len().checked_div(self.nx).unwrap_or(0);
        let mut uv = std::mem::take(&mut self.points);
        for place in &mut uv {
            *place = match (axes[0].position(place[0]), axes[1].position(place[1])) {
                (Some(u), Some(v)) => [u, v],
                _ => [f64::NAN; 2],
            };
        }
        self.part(&Places { axes, uv }, 0..self.nx, 0..rows, heights_m)
    }

    fn part(
        &self,
        places: &Places,
        xs: std::ops::Range<usize>,
        ys: std::ops::Range<usize>,
        heights_m: &mut [f64],
    ) -> Result<(), ToolError> {
        let indices = || ys.clone().flat_map(|y| xs.clone().map(move |x| y * self.nx + x));
        let spans = indices().filter_map(|at| self.span(places, at));
        let Some(span) = spans
            .reduce(|a, b| Span { x: (a.x.0.min(b.x.0), a.x.1.max(b.x.1)), y: (a.y.0.min(b.y.0), a.y.1.max(b.y.1)) })
        else {
            return Ok(());
        };
        let pixels = (span.x.1 - span.x.0) as usize * (span.y.1 - span.y.0) as usize;
        if pixels > PATCH_PIXELS && xs.len() * ys.len() > 1 {
            let (x_half, y_half) = (xs.start + xs.len() / 2, ys.start + ys.len() / 2);
            if ys.len() >= xs.len() {
                self.part(places, xs.clone(), ys.start..y_half, heights_m)?;
                return self.part(places, xs, y_half..ys.end, heights_m);
            }
            self.part(places, xs.start..x_half, ys.clone(), heights_m)?;
            return self.part(places, x_half..xs.end, ys, heights_m);
        }
        let axes = &places.axes;
        let columns: Vec<_> = (span.x.0..span.x.1).map(|x| axes[0].stored(x).0).collect();
        let rows: Vec<_> = (span.y.0..span.y.1).map(|y| axes[1].stored(y)).collect();
        let patch = self.raster.gather(&rows, &columns, None)?;
        for at in indices() {
            let uv = places.uv[at];
            if uv[0].is_nan() {
                continue;
            }
            heights_m[at] = match self.footprint(at) {
                Some(quad) => self.mean(axes, &patch, span, uv, quad),
                None => self.kernel_sum(axes, &patch, span, uv),
            };
        }
        Ok(())
    }

    fn footprint(&self, at: usize) -> Option<&[[f64; 2]; 4]> {
        self.footprints.map(|all| &all[at]).filter(|quad| quad.iter().flatten().all(|value| value.is_finite()))
    }

    fn span(&self, Places { axes, uv }: &Places, at: usize) -> Option<Span> {
        let uv = uv[at];
        if uv[0].is_nan() {
            return None;
        }
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
        let sum = match self.kernel.taps() {
            1 => self.weighted::<1>(axes, patch, span, uv),
            2 => self.weighted::<2>(axes, patch, span, uv),
            4 => self.weighted::<4>(axes, patch, span, uv),
            _ => self.weighted::<6>(axes, patch, span, uv),
        };
        if sum.is_nan() { self.beside_voids(axes, patch, span, uv) } else { sum }
    }

    /// The kernel's sum, NaN with a void among its K x K taps.
    #[inline]
    fn weighted<const K: usize>(&self, axes: &[Axis; 2], patch: &Patch, span: Span, uv: [f64; 2]) -> f64 {
        let mut weights = [[0.0; K]; 2];
        let begin = [span.x.0, span.y.0];
        let [x, y] = [0, 1].map(|axis| {
            self.kernel.weigh(&axes[axis], uv[axis], &mut weights[axis]);
            (self.kernel.start(&axes[axis], uv[axis]) - begin[axis]) as usize
        });
        let mut sum = 0.0;
        for (row, wy) in weights[1].iter().enumerate() {
            let line = &patch.pixels[(y + row) * patch.nx + x..][..K];
            let across: f64 = line.iter().zip(&weights[0]).map(|(pixel, wx)| wx * f64::from(*pixel)).sum();
            sum += wy * across;
        }
        sum
    }

    #[cold]
    fn beside_voids(&self, axes: &[Axis; 2], patch: &Patch, span: Span, uv: [f64; 2]) -> f64 {
        let fallback = self.kernel.fallback();
        let few = fallback.taps();
        let mut weights = [[0.0; 6]; 2];
        let begin = [span.x.0, span.y.0];
        let starts = [0, 1].map(|axis| {
            let (place, u) = (&axes[axis], uv[axis]);
            fallback.weigh(place, u, &mut weights[axis][..few]);
            [self.kernel.start(place, u), fallback.start(place, u), place.home(u)]
                .map(|index| (index - begin[axis]) as usize)
        });
        beside_voids(patch, starts[0], starts[1], &weights[0][..few], &weights[1][..few])
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
