//! Counts the codec's token tables over real terrain and prints `codec/tables.rs`' rows.
//!
//! `cargo run --release -p relief-tools --example train_tables -- RASTER...`

use gdal::Dataset;
use relief_formats::codec::lifting::{predict_c, predict_h, predict_v, split};
use relief_formats::codec::rans::SLOTS;
use relief_formats::codec::residual::{BUCKETS, buckets, choose_scales};
use relief_formats::codec::token::{TABLES, TOKENS, low_bits, table_of, tokenize, zigzag};

type Counts = [[f64; TOKENS]; TABLES];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut counts: Counts = [[0.0; TOKENS]; TABLES];
    for path in std::env::args().skip(1) {
        let dataset = Dataset::open(&path)?;
        let (width, height) = dataset.raster_size();
        let data = dataset.rasterband(1)?.read_as::<f32>((0, 0), (width, height), (width, height), None)?;
        let mut one: Counts = [[0.0; TOKENS]; TABLES];
        // Coarser and rougher steps show the tables other scales than the source's own.
        for step in [0.0625f32, 0.25, 1.0, 4.0, 16.0] {
            let q: Vec<i32> =
                data.data().iter().map(|h| (h.clamp(-12_000.0, 12_000.0) / step).round() as i32).collect();
            let mut stride = 1;
            while width / stride > 128 {
                count_level(&q, width, height, stride, &mut one);
                stride *= 2;
            }
        }
        // Every raster counts alike in every table it reaches.
        for (total, row) in counts.iter_mut().zip(&one) {
            let sum: f64 = row.iter().sum();
            if sum > 1000.0 {
                total.iter_mut().zip(row).for_each(|(t, c)| *t += c / sum);
            }
        }
    }
    for row in &counts {
        println!("{}", quantize(row).map(|f| f.to_string()).join(" "));
    }
    Ok(())
}

fn count_level(q: &[i32], width: usize, height: usize, stride: usize, counts: &mut Counts) {
    let n = 64;
    let side = 2 * n + 1;
    let reach = (side - 1) * stride;
    for y in (0..height.saturating_sub(reach)).step_by(reach.max(1)) {
        for x in (0..width.saturating_sub(reach)).step_by(reach.max(1)) {
            let fine: Vec<i32> =
                (0..side * side).map(|k| q[(y + k / side * stride) * width + x + k % side * stride]).collect();
            let (e, new) = split(&fine, n);
            let (mut p, mut a) = (vec![0; n * (n + 1)], vec![0; n * (n + 1)]);
            predict_c(&e, n, &mut p, &mut a);
            let rc: Vec<i32> = new.c.iter().zip(&p).map(|(s, p)| s - p).collect();
            count(&rc, &a[..n * n], counts);
            predict_h(&e, &new.c, &rc, n, &mut p, &mut a);
            let rh: Vec<i32> = new.h.iter().zip(&p).map(|(s, p)| s - p).collect();
            count(&rh, &a, counts);
            predict_v(&e, &new.c, &rc, &rh, n, &mut p, &mut a);
            let rv: Vec<i32> = new.v.iter().zip(&p).map(|(s, p)| s - p).collect();
            count(&rv, &a, counts);
        }
    }
}

fn count(residual: &[i32], activity: &[i32], counts: &mut Counts) {
    let mut bucket = vec![0; residual.len()];
    buckets(activity, &mut bucket);
    let (_, _, scale): (_, _, [u8; BUCKETS]) = choose_scales(&bucket, residual);
    for (&b, &r) in bucket.iter().zip(residual) {
        let t = scale[b as usize];
        counts[table_of(t)][tokenize(zigzag(r), low_bits(t)).0 as usize] += 1.0;
    }
}

/// Integer frequencies, each at least 1, that sum to [`SLOTS`] and cost the fewest bits.
fn quantize(row: &[f64; TOKENS]) -> [u32; TOKENS] {
    let total: f64 = row.iter().sum::<f64>().max(1e-12);
    let mut frequency = [1u32; TOKENS];
    for _ in TOKENS..SLOTS {
        let gain = |k: usize| row[k] / total * (1.0 + 1.0 / f64::from(frequency[k])).log2();
        let best = (0..TOKENS).max_by(|&a, &b| gain(a).total_cmp(&gain(b))).unwrap_or(0);
        frequency[best] += 1;
    }
    frequency
}
