//! Triangles of longest-edge bisection that keep a plane within given bounds, from the file's
//! deviations alone.
//!
//! `cargo run --release -p relief-formats --example bisection -- FILE BOUND_M...` prints
//! `{"triangles": [...]}`: an active node turns two triangles into four, one into two on the edge.

use std::path::Path;

use relief_formats::derive::decode_deviation;
use relief_formats::file::Relief;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = args.first().ok_or("a .relief file is wanted")?;
    let bounds_m = args[1..].iter().map(|a| a.parse()).collect::<Result<Vec<f32>, _>>()?;
    let relief = Relief::open(Path::new(file))?;
    let (grid, step_m) = (relief.grid(), relief.step_m() as f32);
    if !grid.plane {
        return Err("a plane's file is wanted: Delatin knows no globe".into());
    }
    let tiles = Tiles::new(&relief, 64 << 20);
    let mut triangles = vec![2u64; bounds_m.len()];
    let mut count = |code: u8, edge: bool| {
        for (triangles, bound_m) in triangles.iter_mut().zip(&bounds_m) {
            if decode_deviation(code) * step_m > *bound_m {
                *triangles += if edge { 1 } else { 2 };
            }
        }
    };
    for key in relief.entries().map(|e| e.map(|e| e.key)) {
        let key: TileKey = key?;
        let Some(codes) = tiles.deviations(key)? else { continue };
        let last = grid.tiles_x(key.level) - 1;
        // A node on two tiles' border belongs to the western or southern one's neighbour.
        let size = |tile: u32| TILE_CELLS as usize + usize::from(tile == last);
        for row in 0..size(key.y) {
            for column in 0..size(key.x) {
                let edge = |tile: u32, at: usize| (tile == 0 && at == 0) || (tile == last && at == TILE_CELLS as usize);
                count(codes[row * TILE_NODES + column], edge(key.x, column) || edge(key.y, row));
            }
        }
    }
    println!("{{\"triangles\": {triangles:?}}}");
    Ok(())
}
