//! Every plane of every tile decoded and compared with its digest.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use relief_formats::codec::CodecError;
use relief_formats::file::index::content_id;
use relief_formats::file::{Entry, FormatError, Relief};
use relief_formats::tiles::Tiles;

use super::check::Check;
use super::finding::{Findings, Place};

/// Decodes all tiles; `step` is called once for each.
pub(super) fn planes(relief: &Relief, tiles: &Tiles<'_>, findings: &Findings, step: impl Fn() + Sync) {
    let reported = Mutex::new(BTreeSet::new());
    (0..relief.tile_count()).into_par_iter().for_each(|n| {
        if let Ok(entry) = relief.entry(n) {
            tile(tiles, &entry, findings, &reported);
        }
        step();
    });
    // 128 bytes a tile, and the file has as many for it.
    let entries: Vec<Entry> = relief.entries().flatten().collect();
    if content_id(&relief.header().identity_bytes(), entries.iter()) != relief.header().content_id {
        findings.add(Check::ContentId, Place::byte(104), "the header's identity is not that of its tiles");
    }
}

/// The planes that were reported: a tile's error shows again in all its descendants.
type Reported = Mutex<BTreeSet<(u32, u64, &'static str)>>;

fn tile(tiles: &Tiles<'_>, entry: &Entry, findings: &Findings, reported: &Reported) {
    let relief = tiles.relief();
    let (grid, body, key) = (relief.grid(), relief.body(), entry.key);
    let report = |error: FormatError| match error {
        FormatError::Tile { key, plane, error } => {
            let first =
                reported.lock().unwrap_or_else(PoisonError::into_inner).insert((key.level, key.morton(), plane));
            if first {
                let check = if error == CodecError::Digest { Check::PlaneDigest } else { Check::PlaneDecodes };
                findings.add(check, Place::tile(body, &grid, key), format!("{plane}: {error}"));
            }
        }
        other => findings.add(Check::PlaneDecodes, Place::tile(body, &grid, key), other.to_string()),
    };
    match tiles.nodes(key) {
        Ok(nodes) => {
            let (min_q, max_q) = nodes.iter().fold((i32::MAX, i32::MIN), |(low, high), &q| (low.min(q), high.max(q)));
            if (min_q, max_q) != (entry.min_q, entry.max_q) {
                let what = format!("nodes {min_q} to {max_q}, index {} to {} steps", entry.min_q, entry.max_q);
                findings.add(Check::TileRange, Place::tile(body, &grid, key), what);
            }
        }
        Err(error) => {
            report(error);
            // The planes that are coded against the nodes say nothing more.
            let _ = tiles.filled(key).map_err(report);
            return;
        }
    }
    let _ = tiles.mip(key).map_err(report);
    let _ = tiles.extremes(key).map_err(report);
    let _ = tiles.deviations(key).map_err(report);
    let _ = tiles.filled(key).map_err(report);
}
