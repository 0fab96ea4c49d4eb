//! A small planet made of numbers, and its truth in f64: heights, positions, deviations.

use relief_shaders::planet::Planet;

/// Heights of all level-0 nodes, in steps.
pub struct TestPlanet {
    pub m: u32,
    pub plane: bool,
    pub a_m: f64,
    pub b_m: f64,
    pub step_m: f64,
    pub unit_m: f64,
    /// Node columns, and rows.
    pub columns: usize,
    pub rows: usize,
    pub q: Vec<i32>,
    /// Least and greatest of `q`.
    pub range: [i32; 2],
}

/// A number that looks random.
pub fn hash(x: u64, y: u64, seed: u64) -> u64 {
    let mut z = x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.wrapping_mul(0xc2b2_ae3d_27d4_eb4f) ^ seed << 17;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// What the ground looks like.
#[derive(Clone, Copy, Debug)]
pub enum Ground {
    /// Octaves of value noise, `most` steps high, with spikes, plateaus and a checkerboard.
    Wild { most: i32, seed: u64 },
    /// Octaves of value noise alone.
    Hills { most: i32, seed: u64 },
}

impl Ground {
    fn at(self, m: u32, i: usize, j: usize, columns: usize) -> i32 {
        match self {
            Self::Hills { most, seed } => noise(m, i, j, columns, seed, f64::from(most)),
            Self::Wild { most, seed } => {
                let base = noise(m, i, j, columns, seed, f64::from(most));
                // Patches of 32 x 32 nodes of each kind.
                match hash(i as u64 / 32, j as u64 / 32, seed) % 8 {
                    0 => most / 3,
                    1 if (i + j).is_multiple_of(2) => base + most / 8,
                    2 if hash(i as u64, j as u64, seed + 1).is_multiple_of(97) => base + most,
                    3 if hash(i as u64, j as u64, seed + 1).is_multiple_of(61) => base - most,
                    _ => base,
                }
            }
        }
    }
}

fn noise(m: u32, i: usize, j: usize, columns: usize, seed: u64, most: f64) -> i32 {
    let mut sum = 0.0;
    for octave in 1..m - 1 {
        let size = 1usize << octave;
        let smooth = |v: usize| {
            let f = (v % size) as f64 / size as f64;
            f * f * (3.0 - 2.0 * f)
        };
        let value = |x: usize, y: usize| {
            (hash((x * size % columns) as u64, y as u64, seed + u64::from(octave)) % 2001) as f64 / 1000.0 - 1.0
        };
        let (x, y, fx, fy) = (i / size, j / size, smooth(i), smooth(j));
        let south = value(x, y) * (1.0 - fx) + value(x + 1, y) * fx;
        let north = value(x, y + 1) * (1.0 - fx) + value(x + 1, y + 1) * fx;
        sum += 0.6f64.powi((m - octave) as i32) * (south * (1.0 - fy) + north * fy);
    }
    (sum * most).round() as i32
}

fn range(q: &[i32]) -> [i32; 2] {
    q.iter().fold([i32::MAX, i32::MIN], |[low, high], &v| [low.min(v), high.max(v)])
}

impl TestPlanet {
    pub fn globe(m: u32, a_m: f64, b_m: f64, step_m: f64, ground: Ground) -> Self {
        Self::globe_of(m, a_m, b_m, step_m, |i, j| ground.at(m, i, j, 2 << m))
    }

    /// A globe whose node (i, j) is so many steps high; each pole's row as its first node.
    pub fn globe_of(m: u32, a_m: f64, b_m: f64, step_m: f64, height: impl Fn(usize, usize) -> i32) -> Self {
        let (columns, rows) = (2 << m, (1 << m) + 1);
        let mut q: Vec<i32> = (0..columns * rows).map(|k| height(k % columns, k / columns)).collect();
        for row in [0, rows - 1] {
            let pole = q[row * columns];
            q[row * columns..][..columns].fill(pole);
        }
        // Kernels know the axes in f32.
        let [a_m, b_m] = [a_m, b_m].map(|v| f64::from(v as f32));
        let range = range(&q);
        Self { m, plane: false, a_m, b_m, step_m, unit_m: 0.0, columns, rows, q, range }
    }

    pub fn plane(m: u32, side_m: f64, step_m: f64, ground: Ground) -> Self {
        let columns = (1 << m) + 1;
        Self::plane_of(m, side_m, step_m, |i, j| ground.at(m, i, j, columns))
    }

    /// A plane whose node (i, j) is so many steps high.
    pub fn plane_of(m: u32, side_m: f64, step_m: f64, height: impl Fn(usize, usize) -> i32) -> Self {
        let columns = (1 << m) + 1;
        let q: Vec<i32> = (0..columns * columns).map(|k| height(k % columns, k / columns)).collect();
        let range = range(&q);
        let unit_m = f64::from((side_m / 2f64.powi(31)) as f32);
        Self { m, plane: true, a_m: 0.0, b_m: 0.0, step_m, unit_m, columns, rows: columns, q, range }
    }

    /// Node (i, j); columns wrap on a globe.
    pub fn node(&self, i: i64, j: i64) -> i32 {
        let i = if self.plane { i } else { i.rem_euclid(self.columns as i64) };
        self.q[j as usize * self.columns + i as usize]
    }

    /// Cells in a row.
    pub fn cells_x(&self) -> i64 {
        if self.plane { self.columns as i64 - 1 } else { self.columns as i64 }
    }

    /// Cells in a column.
    pub fn cells_y(&self) -> i64 {
        self.rows as i64 - 1
    }

    /// S_0 at fractional (column, row), metres.
    pub fn surface_m(&self, x: f64, y: f64) -> f64 {
        let j = (y.floor() as i64).clamp(0, self.cells_y() - 1);
        let i = if self.plane { (x.floor() as i64).clamp(0, self.cells_x() - 1) } else { x.floor() as i64 };
        let (u, v) = (x - i as f64, y - j as f64);
        let h = |di, dj| f64::from(self.node(i + di, j + dj));
        let south = h(0, 0) * (1.0 - u) + h(1, 0) * u;
        let north = h(0, 1) * (1.0 - u) + h(1, 1) * u;
        (south * (1.0 - v) + north * v) * self.step_m
    }

    /// Units of S and T in a cell.
    pub fn cell_units(&self) -> f64 {
        2f64.powi(31 - self.m as i32)
    }

    /// S_0 at (S, T), metres.
    pub fn height_m(&self, s: f64, t: f64) -> f64 {
        self.surface_m(s / self.cell_units(), t / self.cell_units())
    }

    /// What kernels are told, but for the sizes of tables.
    pub fn planet(&self) -> Planet {
        let [min, max] = self.range.map(|q| (f64::from(q) * self.step_m) as f32);
        let (a, b) = (self.a_m, self.b_m);
        Planet {
            m: self.m,
            plane: u32::from(self.plane),
            root_level: self.m - 8,
            a_m: a as f32,
            b_m: b as f32,
            e2: if self.plane { 0.0 } else { ((a - b) * (a + b) / (a * a)) as f32 },
            step_m: self.step_m as f32,
            min_m: min,
            max_m: max,
            unit_x_m: self.unit_m as f32,
            unit_y_m: self.unit_m as f32,
            ..Planet::default()
        }
    }
}
