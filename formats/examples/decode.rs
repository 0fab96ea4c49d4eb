//! Times opening a file, its first coarse level, and decoding all of level 0.
//!
//! `cargo run --release -p relief-formats --example decode -- FILE [--threads N] [--first-only]`
//! prints `{"open_s", "first_level_s", "decode_s", "samples"}`.

use std::path::Path;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

use relief_formats::file::Relief;
use relief_formats::tile::TileKey;
use relief_formats::tiles::Tiles;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = args.first().ok_or("a .relief file is wanted")?;
    let threads = match args.iter().position(|a| a == "--threads") {
        Some(at) => args.get(at + 1).ok_or("--threads wants a number")?.parse()?,
        None => std::thread::available_parallelism()?.get(),
    };

    let start = Instant::now();
    let relief = Relief::open(Path::new(file))?;
    let open_s = start.elapsed().as_secs_f64();
    let grid = relief.grid();
    let root = grid.root_level();
    let tiles = Tiles::new(&relief, 64 << 20);
    for x in 0..grid.tiles_x(root) {
        tiles.nodes(TileKey::new(root, x, 0))?;
    }
    let first_level_s = start.elapsed().as_secs_f64();
    if args.iter().any(|a| a == "--first-only") {
        println!("{{\"open_s\": {open_s}, \"first_level_s\": {first_level_s}}}");
        return Ok(());
    }

    // Level-0 tiles in file order, so that a thread meets siblings and cousins one after another.
    let keys: Vec<TileKey> = relief.entries().filter_map(Result::ok).map(|e| e.key).filter(|k| k.level == 0).collect();
    let samples = AtomicU64::new(0);
    let next = AtomicUsize::new(0);
    const RUN: usize = 64;
    let start = Instant::now();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| -> Result<(), relief_formats::file::FormatError> {
                    let tiles = Tiles::new(&relief, 64 << 20).trusting();
                    loop {
                        let from = next.fetch_add(RUN, Ordering::Relaxed);
                        let Some(run) = keys.get(from..(from + RUN).min(keys.len())) else { return Ok(()) };
                        for &key in run {
                            samples.fetch_add(tiles.nodes(key)?.len() as u64, Ordering::Relaxed);
                        }
                        if run.is_empty() {
                            return Ok(());
                        }
                    }
                })
            })
            .collect();
        workers.into_iter().try_for_each(|w| w.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })?;
    let decode_s = start.elapsed().as_secs_f64();
    println!(
        "{{\"open_s\": {open_s}, \"first_level_s\": {first_level_s}, \"decode_s\": {decode_s}, \"samples\": {}}}",
        samples.load(Ordering::Relaxed)
    );
    Ok(())
}
