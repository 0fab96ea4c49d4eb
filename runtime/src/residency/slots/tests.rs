use std::collections::HashSet;

use proptest::prelude::*;
use relief_shaders::pages::{NONE, Pages, SLOT_MASK};
use relief_shaders::planet::Planet;

use super::*;

/// Every page whose touching coarser pages are there may be asked for or entered, in any order.
fn run(capacity: u32, plane: bool, steps: &[(u8, u32)]) -> Result<(), TestCaseError> {
    let grid = Grid::new(11, plane);
    let mut slots = Slots::new(grid, capacity, 10);
    let mut broken: HashSet<TileKey> = HashSet::new();
    let mut used: HashSet<TileKey> = HashSet::new();
    for &(what, pick) in steps {
        let level = pick % (grid.root_level() + 1);
        let tiles = grid.tiles_x(level) * grid.tiles_y(level);
        let n = (pick >> 3) % tiles;
        let key = TileKey::new(level, n % grid.tiles_x(level), n / grid.tiles_x(level));
        match what % 8 {
            0 => {
                slots.next_round();
                used.clear();
            }
            1 if slots.touch(key) => {
                mark(&slots, key, &mut used);
            }
            2 => {
                broken.insert(key);
            }
            _ => {
                let rests = |k: &TileKey| slots.find(*k).is_some() || broken.contains(k);
                if broken.contains(&key) || !closure::touching(grid, key).iter().all(rests) {
                    continue;
                }
                let before: HashSet<TileKey> = slots.held.keys().copied().collect();
                // What it rests on counts as used, whether it finds room or not.
                closure::touching(grid, key).into_iter().for_each(|k| mark(&slots, k, &mut used));
                if slots.enter(key).is_some() {
                    mark(&slots, key, &mut used);
                } else {
                    prop_assert!(before.len() as u32 == capacity && before.iter().all(|k| used.contains(k)));
                }
                let after: HashSet<TileKey> = slots.held.keys().copied().collect();
                for gone in before.difference(&after) {
                    prop_assert!(!used.contains(gone), "{gone:?} was in use");
                }
            }
        }
        check(grid, &slots, capacity)?;
    }
    Ok(())
}

fn mark(slots: &Slots, key: TileKey, used: &mut HashSet<TileKey>) {
    if slots.held.contains_key(&key) && used.insert(key) {
        closure::touching(slots.grid, key).into_iter().for_each(|k| mark(slots, k, used));
    }
}

fn check(grid: Grid, slots: &Slots, capacity: u32) -> Result<(), TestCaseError> {
    let planet =
        Planet { table_bits: 10, root_level: grid.root_level(), plane: u32::from(grid.plane), ..Planet::default() };
    let pages = Pages { planet: &planet, table: slots.table(), heights: &[], bounds: &[], seen: &[] };
    let mut taken = HashSet::new();
    for level in 0..=grid.root_level() {
        for key in closure::level(grid, level) {
            let word = pages.find(level, key.x, key.y);
            let held = slots.held.get(&key);
            prop_assert_eq!(held.is_some(), word != NONE, "the table says what is held");
            let Some(held) = held else { continue };
            prop_assert_eq!(held.slot, word & SLOT_MASK);
            prop_assert!(held.slot < capacity && taken.insert(held.slot), "a slot of its own");
            let below = closure::touching(grid, key);
            let usable = |k: &TileKey| slots.held.get(k).is_some_and(|h| h.usable);
            prop_assert_eq!(word & USABLE != 0, below.iter().all(usable), "usable when all it rests on are");
            for k in &below {
                if let Some(coarser) = slots.held.get(k) {
                    prop_assert!(coarser.used >= held.used);
                }
            }
        }
    }
    prop_assert_eq!(taken.len() + slots.free.len(), capacity as usize);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn pages_in_use_stay_and_the_table_is_true(
        capacity in 6u32..60, plane: bool,
        steps in prop::collection::vec((any::<u8>(), any::<u32>()), 0..400),
    ) {
        run(capacity, plane, &steps)?;
    }
}

#[test]
fn the_least_recently_used_leaf_leaves() {
    let grid = Grid::new(9, false);
    let mut slots = Slots::new(grid, 4, 8);
    let key = TileKey::new;
    for k in [key(1, 0, 0), key(1, 1, 0), key(0, 0, 0), key(0, 1, 0)] {
        assert_eq!(slots.enter(k).map(|(_, dropped)| dropped), Some(false));
    }
    assert_eq!(slots.enter(key(0, 2, 0)), None, "all are in use");
    slots.next_round();
    slots.touch(key(0, 0, 0));
    assert_eq!(slots.room(10), 1);
    let (slot, dropped) = slots.enter(key(0, 2, 0)).unwrap();
    assert!(dropped && slots.find(key(0, 1, 0)).is_none() && slots.find(key(0, 2, 0)) == Some(slot));
}
