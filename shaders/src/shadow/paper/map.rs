//! Stage 1 of paper 001: the mip pyramid and the map of local extremes.

/// The mip pyramid and the map of local extremes; all levels one after the other, finest first,
/// rows from the south.
#[derive(Clone, Debug)]
pub struct PaperMap {
    /// 2^m x 2^m texels.
    pub m: u32,
    /// Metres between texels, eastwards and northwards.
    pub spacing_m: [f32; 2],
    /// H_0 to H_m, metres.
    pub heights_m: Vec<f32>,
    /// H_ext of levels 0 to m - 2: least and greatest, metres.
    pub extremes_m: Vec<[f32; 2]>,
}

/// Index of the first texel of a level of a pyramid whose level 0 has 2^m x 2^m.
#[must_use]
pub fn paper_level_start(m: u32, level: u32) -> u32 {
    (0..level).map(|k| 1 << (2 * (m - k))).sum()
}

impl PaperMap {
    /// Stage 1 of the paper, from the heights of level 0.
    ///
    /// # Panics
    /// When there are not 2^m x 2^m heights.
    #[must_use]
    pub fn new(m: u32, spacing_m: [f32; 2], heights_m: Vec<f32>) -> Self {
        let side = 1usize << m;
        assert_eq!(heights_m.len(), side * side, "heights of 2^{m} x 2^{m} texels");
        let mut map = Self { m, spacing_m, heights_m, extremes_m: Vec::new() };
        for level in 1..=m {
            let side = side >> level;
            let mean = |i: usize, j: usize| {
                let at = |di, dj| map.paper_height_m(level - 1, (2 * i + di) as i32, (2 * j + dj) as i32);
                0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
            };
            let next: Vec<f32> = (0..side * side).map(|k| mean(k % side, k / side)).collect();
            map.heights_m.extend(next);
        }
        let half = side / 2;
        let mut finer: Vec<[f32; 2]> = (0..half * half)
            .map(|k| {
                let corners = (0..9).map(|n| [2 * (k % half) + n % 3, 2 * (k / half) + n / 3]);
                let samples = corners.map(|[x, y]| map.paper_bilinear_m(0, x as f32, y as f32));
                samples.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)])
            })
            .collect();
        for level in 1..m {
            let side = half >> level;
            let texel = |k: usize| {
                let [i, j] = [2 * (k % side), 2 * (k / side)];
                let four = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]].map(|[i, j]| finer[j * 2 * side + i]);
                four.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], h| [a.min(h[0]), b.max(h[1])])
            };
            let next = (0..side * side).map(texel).collect();
            map.extremes_m.extend(std::mem::replace(&mut finer, next));
        }
        map
    }

    /// H_level at a texel; beyond the map its edge's.
    #[must_use]
    pub fn paper_height_m(&self, level: u32, column: i32, row: i32) -> f32 {
        let side = 1i32 << (self.m - level);
        let [i, j] = [column.clamp(0, side - 1), row.clamp(0, side - 1)];
        self.heights_m[(paper_level_start(self.m, level) as i32 + j * side + i) as usize]
    }

    /// H_level at a point in texels of level 0, bilinear between centres.
    #[must_use]
    pub fn paper_bilinear_m(&self, level: u32, x: f32, y: f32) -> f32 {
        let scale = 1.0 / (1u32 << level) as f32;
        let [x, y] = [x * scale - 0.5, y * scale - 0.5];
        let [i, j] = [x.floor(), y.floor()];
        let [u, v] = [x - i, y - j];
        let at = |di: i32, dj: i32| self.paper_height_m(level, i as i32 + di, j as i32 + dj);
        let low = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
        let high = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
        low + (high - low) * v
    }

    /// H_ext at a texel of a level.
    #[must_use]
    pub fn paper_extremes_m(&self, level: u32, column: i32, row: i32) -> [f32; 2] {
        let side = 1i32 << (self.m - 1 - level);
        self.extremes_m[(paper_level_start(self.m - 1, level) as i32 + row * side + column) as usize]
    }
}
