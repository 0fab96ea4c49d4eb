//! A plane built again against the stored one.

use relief_formats::derive::{Field, decode_deviation};
use relief_formats::file::FormatError;
use relief_formats::tile::{TILE_NODES, TileKey};

use super::check::Check;
use super::finding::{Findings, Place};
use super::map::Map;

/// Where differences go.
pub(super) struct Compare<'a> {
    pub map: &'a Map<'a>,
    pub findings: &'a Findings,
}

impl Compare<'_> {
    /// Codes of deviations: neither too low nor needlessly high.
    ///
    /// # Errors
    /// A plane that does not decode.
    pub fn deviations(&self, key: TileKey, built: &Field<u8>) -> Result<(), FormatError> {
        let Some(stored) = self.map.tiles.deviations(key)? else { return Ok(()) };
        let words = |built: u8, stored: u8| {
            format!("at most {} steps, built from level 0: {}", decode_deviation(stored), decode_deviation(built))
        };
        self.samples(Check::DeviationLow, key, 1, built.data(), &stored, |&built, &stored| {
            (stored < built).then(|| words(built, stored))
        });
        self.samples(Check::DeviationHigh, key, 1, built.data(), &stored, |&built, &stored| {
            (stored > built).then(|| words(built, stored))
        });
        Ok(())
    }

    /// One finding for a tile's plane, at its first bad sample; entries are `spacing` nodes apart.
    /// True if there is one.
    pub fn samples<T>(
        &self,
        check: Check,
        key: TileKey,
        spacing: usize,
        built: &[T],
        stored: &[T],
        fault: impl Fn(&T, &T) -> Option<String>,
    ) -> bool {
        let mut faults =
            built.iter().zip(stored).enumerate().filter_map(|(at, (built, stored))| Some((at, fault(built, stored)?)));
        let Some((at, what)) = faults.next() else { return false };
        let count = 1 + faults.count();
        let side = if spacing == 1 { TILE_NODES } else { TILE_NODES / spacing };
        let node = (at % side * spacing, at / side * spacing);
        let place = Place::node(self.map.relief.body(), &self.map.grid, key, node);
        self.findings.add(check, place, format!("{what} ({count} in the tile)"));
        true
    }
}
