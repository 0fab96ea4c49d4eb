//! Level-0 nodes of a baked file against the independent f64 resampler in Python.

use std::path::Path;
use std::process::Command;

use relief_formats::file::Relief;
use relief_formats::tile::{TILE_CELLS, TILE_NODES, TileKey};
use relief_formats::tiles::Tiles;

use super::Folder;

/// What the oracle says of one node.
const VOID: u8 = 0;
const FILLED: u8 = 2;
const EITHER: u8 = 3;

/// Heights at nodes, row-major, south row first.
struct Expected {
    low_m: Vec<f64>,
    high_m: Vec<f64>,
    state: Vec<u8>,
}

/// How a file and the oracle agree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Agreement {
    /// Nodes that were compared.
    pub nodes: usize,
    /// Of them those with a measured height.
    pub measured: usize,
    /// Nodes whose height is off by more than half a step plus 1 mm.
    pub off: usize,
    /// The largest difference, metres.
    pub worst_m: f64,
    /// Nodes whose fill flag is wrong.
    pub flags: usize,
}

impl Agreement {
    /// True when there is nothing to object to.
    pub fn holds(&self) -> bool {
        self.measured > 0 && self.off == 0 && self.flags == 0
    }
}

/// What to compare and how.
pub struct Question<'a> {
    pub source: &'a Path,
    /// Arguments of the oracle.
    pub options: &'a [&'a str],
    /// At most so many tiles, the first and the last among them.
    pub tiles: usize,
    /// Columns by which the oracle's nodes are shifted, to see the comparison fail.
    pub shift: i64,
    /// Relative error that the stored samples have already.
    pub relative: f64,
}

impl<'a> Question<'a> {
    pub fn new(source: &'a Path, options: &'a [&'a str], tiles: usize) -> Self {
        Self { source, options, tiles, shift: 0, relative: 0.0 }
    }

    /// Compares tiles of level 0 spread over those the file has.
    pub fn ask(&self, file: &Path) -> Agreement {
        let relief = Relief::open(file).unwrap();
        let grid = relief.grid();
        let keys: Vec<_> = relief.entries().map(|e| e.unwrap().key).filter(|key| key.level == 0).collect();
        let last = keys.len() - 1;
        let count = self.tiles.min(keys.len());
        let keys: Vec<_> = (0..count).map(|n| keys[n * last / (count - 1).max(1)]).collect();
        let tiles = Tiles::new(&relief, 64 << 20);
        let tolerance_m = relief.step_m() / 2.0 + 1e-3;
        let mut agreement = Agreement::default();
        for (key, expected) in keys.iter().zip(self.expected(grid.m, grid.plane, &keys)) {
            let (nodes, filled) = (tiles.nodes(*key).unwrap(), tiles.filled(*key).unwrap());
            assert_eq!(nodes.len(), expected.state.len());
            for (n, &state) in expected.state.iter().enumerate() {
                agreement.nodes += 1;
                let wrong_flag = match state {
                    EITHER => false,
                    state => filled[n] != (state == VOID || state == FILLED),
                };
                agreement.flags += usize::from(wrong_flag);
                if state == VOID || (state == EITHER && filled[n]) {
                    continue;
                }
                agreement.measured += usize::from(state != FILLED);
                let height_m = f64::from(nodes[n]) * relief.step_m();
                let off_m = (expected.low_m[n] - height_m).max(height_m - expected.high_m[n]);
                agreement.worst_m = agreement.worst_m.max(off_m);
                // A NaN on either side is off too.
                let size_m = expected.high_m[n].abs().max(expected.low_m[n].abs());
                let within = off_m <= tolerance_m + self.relative * size_m;
                agreement.off += usize::from(!within);
            }
        }
        agreement
    }

    fn expected(&self, m: u32, plane: bool, keys: &[TileKey]) -> Vec<Expected> {
        let folder = Folder::new();
        let out = folder.path("heights.bin");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/python/oracle_resample.py");
        let python = std::env::var("RELIEF_PYTHON").unwrap_or_else(|_| "/usr/bin/python3".into());
        let mut command = Command::new(python);
        command.arg(script).arg(self.source).arg("--out").arg(&out).args(["--m", &m.to_string()]).args(self.options);
        command.args(["--body", if plane { "plane" } else { "globe" }]);
        for key in keys {
            let (x, y) = (i64::from(key.x * TILE_CELLS) + self.shift, key.y * TILE_CELLS);
            command.args(["--window", &format!("0,{x},{y},{TILE_NODES},{TILE_NODES}")]);
        }
        let answer = command.output().unwrap();
        assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
        let bytes = std::fs::read(out).unwrap();
        let n = TILE_NODES * TILE_NODES;
        assert_eq!(bytes.len(), keys.len() * n * 17);
        let heights = |part: &[u8]| part.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        bytes
            .chunks_exact(n * 17)
            .map(|one| Expected {
                low_m: heights(&one[..n * 8]),
                high_m: heights(&one[n * 8..n * 16]),
                state: one[n * 16..].to_vec(),
            })
            .collect()
    }
}
