//! Walks both indices at once and decodes what differs.

use std::iter::Peekable;
use std::path::Path;

use rayon::prelude::*;
use relief_formats::file::{Entry, FormatError, Relief};
use relief_formats::tile::TileKey;
use relief_formats::tiles::Tiles;
use serde_json::{Value, json};

use super::map::Map;
use super::tile::{TileDiff, compare_tile};
use relief_front::error::ToolError;

/// One of the two files.
pub struct Side<'a> {
    path: &'a Path,
    pub tiles: Tiles<'a>,
}

/// Cache of each file's decoded tiles.
const CACHE_BYTES: u64 = 128 << 20;

impl<'a> Side<'a> {
    pub fn new(path: &'a Path, relief: &'a Relief) -> Self {
        Self { path, tiles: Tiles::new(relief, CACHE_BYTES) }
    }

    pub fn relief(&self) -> &Relief {
        self.tiles.relief()
    }

    /// For `map_err` on what reading this file gives.
    pub fn failed(&self) -> impl Fn(FormatError) -> ToolError + Copy + '_ {
        ToolError::of_file(self.path)
    }
}

/// The largest difference of heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// B - A, metres.
    pub difference_m: f64,
    pub a_m: f64,
    pub b_m: f64,
    pub tile: TileKey,
    /// Column and row of the node on its level.
    pub node: [u32; 2],
}

/// What differs on one level.
#[derive(Clone, Debug, Default)]
pub struct LevelDiff {
    /// Tiles that one file or both have.
    pub tiles: u64,
    /// Tiles of both that differ in any plane.
    pub different: u64,
    /// Tiles that one file has alone.
    pub only: [u64; 2],
    /// Nodes of the level whose heights differ.
    pub nodes: u64,
    /// Metres.
    pub largest_m: f64,
}

/// The result.
#[derive(Clone, Debug)]
pub struct Comparison {
    pub identical: bool,
    /// Names and both values of what the headers and the metadata say differently.
    pub facts: Vec<(&'static str, [Value; 2])>,
    /// The finest level first.
    pub levels: Vec<LevelDiff>,
    /// Tiles that both files have and whose plane differs, by plane in file order.
    pub planes: [u64; 5],
    pub largest: Option<Largest>,
    /// Over all nodes of level 0, metres.
    pub rms_m: f64,
}

impl Comparison {
    /// Of files with one content.
    pub fn identical(sides: &[Side<'_>; 2]) -> Self {
        Self { identical: true, facts: facts(sides), levels: vec![], planes: [0; 5], largest: None, rms_m: 0.0 }
    }
}

/// A tile that one of the files has, or that differs.
struct Pair {
    key: TileKey,
    present: [bool; 2],
    planes: [bool; 5],
}

/// Compares tile by tile; deposits the differences on a map where there is one.
///
/// # Errors
/// A damaged file.
pub fn compare(sides: &[Side<'_>; 2], map: Option<&mut Map>) -> Result<Comparison, ToolError> {
    let grid = sides[0].relief().grid();
    let mut out = Comparison { identical: false, facts: facts(sides), ..Comparison::identical(sides) };
    out.levels = vec![LevelDiff::default(); grid.root_level() as usize + 1];
    let pairs = differing_pairs(sides, &mut out.levels)?;
    let same_step = sides[0].relief().step_m() == sides[1].relief().step_m();
    for pair in &pairs {
        let level = &mut out.levels[pair.key.level as usize];
        match pair.present {
            [true, true] => {
                level.different += 1;
                out.planes.iter_mut().zip(pair.planes).for_each(|(count, differs)| *count += u64::from(differs));
            }
            [a, b] => {
                level.only[0] += u64::from(a);
                level.only[1] += u64::from(b);
            }
        }
    }
    let map = map.map(std::sync::Mutex::new);
    let heights = |pair: &&Pair| pair.present != [true, true] || pair.planes[0] || !same_step;
    let diffs: Result<Vec<TileDiff>, ToolError> = pairs
        .iter()
        .filter(heights)
        .collect::<Vec<_>>()
        .par_iter()
        .map(|p| compare_tile(sides, p.key, map.as_ref()))
        .collect();
    let mut sum = 0.0;
    for diff in diffs? {
        let level = &mut out.levels[diff.level as usize];
        level.nodes += diff.nodes;
        sum += diff.weighted_square_sum;
        if let Some(largest) = diff.largest {
            let size = largest.difference_m.abs();
            level.largest_m = level.largest_m.max(size);
            if out.largest.is_none_or(|known| size > known.difference_m.abs()) {
                out.largest = Some(largest);
            }
        }
    }
    out.rms_m = (sum / (f64::from(grid.width(0)) * f64::from(grid.height(0)))).sqrt();
    Ok(out)
}

/// All tiles that are not in both files with the same digests; counts the others too.
fn differing_pairs(sides: &[Side<'_>; 2], levels: &mut [LevelDiff]) -> Result<Vec<Pair>, ToolError> {
    let [mut a, mut b] = [sides[0].relief().entries().peekable(), sides[1].relief().entries().peekable()];
    let same_step = sides[0].relief().step_m() == sides[1].relief().step_m();
    let mut pairs = Vec::new();
    loop {
        let (next_a, next_b) = (peek(&mut a, &sides[0])?, peek(&mut b, &sides[1])?);
        let key = match (next_a, next_b) {
            (None, None) => return Ok(pairs),
            (Some(entry), None) | (None, Some(entry)) => entry.key,
            (Some(a), Some(b)) => a.key.min(b.key),
        };
        levels[key.level as usize].tiles += 1;
        let entry_a = next_a.filter(|entry| entry.key == key);
        let entry_b = next_b.filter(|entry| entry.key == key);
        if entry_a.is_some() {
            a.next();
        }
        if entry_b.is_some() {
            b.next();
        }
        let planes = match (entry_a, entry_b) {
            (Some(a), Some(b)) => std::array::from_fn(|k| a.digests[k] != b.digests[k]),
            _ => [false; 5],
        };
        let present = [entry_a.is_some(), entry_b.is_some()];
        if present != [true, true] || planes.contains(&true) || !same_step {
            pairs.push(Pair { key, present, planes });
        }
    }
}

fn peek<I: Iterator<Item = Result<Entry, FormatError>>>(
    entries: &mut Peekable<I>,
    side: &Side<'_>,
) -> Result<Option<Entry>, ToolError> {
    if let Some(Err(error)) = entries.next_if(Result::is_err) {
        return Err(side.failed()(error));
    }
    Ok(entries.peek().and_then(|entry| entry.as_ref().ok()).copied())
}

/// What headers and metadata say differently.
fn facts(sides: &[Side<'_>; 2]) -> Vec<(&'static str, [Value; 2])> {
    let of = |side: &Side<'_>| {
        let (header, metadata) = (side.relief().header(), side.relief().metadata());
        [
            ("step_m", json!(header.step_m())),
            ("vertical", json!(metadata.vertical)),
            ("fill", json!(metadata.fill)),
            ("resampling", json!(metadata.resampling)),
            ("sources", json!(metadata.sources)),
            ("versions", json!(metadata.versions)),
        ]
    };
    let [a, b] = [of(&sides[0]), of(&sides[1])];
    a.into_iter().zip(b).filter(|(a, b)| a.1 != b.1).map(|((name, a), (_, b))| (name, [a, b])).collect()
}
