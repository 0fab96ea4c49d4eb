use std::collections::BTreeSet;

use proptest::prelude::*;
use relief_formats::body::Body;
use relief_formats::file::{Plane, Relief};
use relief_formats::geodesy::node_to_fixed;
use relief_shaders::pages::{NONE, USABLE};

use super::*;
use relief_tests::sample_file::{Sample, wavy_q};

const LONG: Duration = Duration::from_secs(60);

fn small(slots: u32) -> Capacity {
    Capacity::of_slots(slots)
}

fn write(sample: &Sample, change: impl FnOnce(&mut Vec<u8>)) -> Arc<Planet> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.relief");
    sample.write(&path);
    let mut bytes = std::fs::read(&path).unwrap();
    change(&mut bytes);
    Planet::new(Relief::from_bytes(&bytes).unwrap(), 0).unwrap()
}

fn resident(planet: &Arc<Planet>, slots: u32) -> Resident<Ram> {
    Resident::new(Arc::clone(planet), small(slots), Ram::new(small(slots))).unwrap()
}

fn load(resident: &mut Resident<Ram>, keys: &[TileKey]) -> Progress {
    resident.ask(keys.iter().map(|k| pages::key(k.level, k.x, k.y)));
    resident.update(LONG)
}

fn held(resident: &Resident<Ram>) -> BTreeSet<TileKey> {
    let grid = resident.planet().grid();
    let pages = resident.pages();
    (0..=grid.root_level())
        .flat_map(|level| closure::level(grid, level))
        .filter(|k| pages.find(k.level, k.x, k.y) != NONE)
        .collect()
}

#[test]
fn heights_are_the_files_and_what_lacks_comes_after_it_was_asked_for() {
    let planet = write(&Sample::new(Body::earth(), 11), |_| ());
    let grid = planet.grid();
    let mut resident = resident(&planet, 200);
    let (i, j) = (grid.width(0) - 3, 700);
    let (s, t) = (node_to_fixed(grid, 0, i), node_to_fixed(grid, 0, j));
    let coarse = resident.pages().height_m(0, s, t);
    assert_eq!(resident.ask_seen(), 1);
    let progress = resident.update(LONG);
    assert!(progress.loaded > 0 && progress.missing == 0, "{progress:?}");
    let exact = wavy_q(grid, i, j) as f32 / 16.0;
    assert_ne!(coarse, exact, "the stand-in was another height");
    assert_eq!(resident.pages().height_m(0, s, t), exact);
    assert_eq!(resident.ask_seen(), 0, "nothing lacks");
    let word = resident.pages().find(0, 15, 2);
    assert!(word != NONE && word & USABLE != 0);
}

#[test]
fn an_update_without_time_still_ends_and_later_ones_finish() {
    let planet = write(&Sample::new(Body::earth(), 10), |_| ());
    let mut resident = resident(&planet, 100);
    resident.ask([pages::key(0, 0, 0), pages::key(0, 7, 3)]);
    let mut rounds = 0;
    while resident.update(Duration::ZERO).missing > 0 {
        rounds += 1;
        std::thread::sleep(Duration::from_millis(1));
        assert!(rounds < 10_000);
    }
    assert!(rounds > 0 && held(&resident).contains(&TileKey::new(0, 7, 3)));
}

#[test]
fn a_full_atlas_says_so_and_goes_on_with_the_next_view() {
    let planet = write(&Sample::new(Body::earth(), 11), |_| ());
    let grid = planet.grid();
    let mut resident = resident(&planet, 30);
    let all: Vec<TileKey> = closure::level(grid, 0).collect();
    let progress = load(&mut resident, &all);
    assert!(progress.full && progress.missing > 0 && progress.resident == 30, "{progress:?}");
    for key in [TileKey::new(0, 0, 0), TileKey::new(0, 9, 5)] {
        let progress = load(&mut resident, &[key]);
        assert!(!progress.full && progress.missing == 0, "{progress:?}");
        assert!(held(&resident).contains(&key));
    }
}

#[test]
fn an_absent_tile_that_finer_ones_touch_is_never_loaded_and_its_ancestor_stands_in() {
    let absent = |key: TileKey| key.level < 2 && key.x >> (1 - key.level) != 0;
    let planet = write(&Sample { absent, ..Sample::new(Body::earth(), 10) }, |_| ());
    let mut resident = resident(&planet, 100);
    let progress = load(&mut resident, &[TileKey::new(0, 7, 1), TileKey::new(0, 0, 0)]);
    assert_eq!(progress.missing, 0);
    let held = held(&resident);
    assert!(!held.contains(&TileKey::new(0, 7, 1)) && !held.contains(&TileKey::new(1, 3, 0)));
    assert!(held.contains(&TileKey::new(2, 1, 0)) && held.contains(&TileKey::new(0, 0, 0)));
    // Its western neighbour over the seam is absent: present, but not to be refined.
    assert_eq!(resident.pages().find(0, 0, 0) & USABLE, 0);
    assert_eq!(resident.damaged().count(), 0);
    assert_eq!(resident.ask([pages::key(0, 7, 1)]), 0);
}

/// Flips a byte of a plane of a tile.
fn damage(key: TileKey, plane: Plane) -> impl FnOnce(&mut Vec<u8>) {
    move |bytes| {
        let relief = Relief::from_bytes(bytes).unwrap();
        let entry = relief.find(key).unwrap().unwrap();
        let at = relief.plane_bytes(&entry, plane).as_ptr() as usize - relief.bytes().as_ptr() as usize;
        let length = relief.plane_bytes(&entry, plane).len();
        bytes[at + length / 2] ^= 0x5a;
    }
}

#[test]
fn a_damaged_tile_is_an_error_for_itself_only() {
    let bad = TileKey::new(1, 1, 0);
    for plane in [Plane::Nodes, Plane::Hext, Plane::Deviation] {
        let planet = write(&Sample::new(Body::earth(), 11), damage(bad, plane));
        let mut resident = resident(&planet, 200);
        let good = TileKey::new(0, 14, 6);
        let progress = load(&mut resident, &[TileKey::new(0, 2, 0), bad, good]);
        assert_eq!(progress.missing, 0, "{plane:?}");
        let damaged: Vec<TileKey> = resident.damaged().map(|(key, _)| key).collect();
        assert!(damaged.contains(&bad), "{plane:?}: {damaged:?}");
        let (held, pages) = (held(&resident), resident.pages());
        assert!(!held.contains(&bad) && held.contains(&bad.parent()) && held.contains(&good));
        assert_ne!(pages.find(0, 14, 6) & USABLE, 0);
        // Asked again, it is remembered and its ancestor counts.
        assert_eq!(resident.ask([pages::key(1, 1, 0), pages::key(0, 2, 0)]), 0);
        assert_eq!(resident.damage_met().map(|(key, _)| key), Some(bad), "{plane:?}");
        assert_eq!(resident.ask([pages::key(0, 14, 6)]), 0);
        assert!(resident.damage_met().is_none(), "what does not need it does not meet it");
    }
}

#[test]
fn a_file_that_is_cut_while_it_is_open_is_an_error_for_what_is_read_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.relief");
    Sample::new(Body::earth(), 11).write(&path);
    let planet = Planet::new(Relief::open(&path).unwrap(), 0).unwrap();
    let mut resident = resident(&planet, 200);
    assert_eq!(load(&mut resident, &[TileKey::new(0, 2, 0)]).missing, 0);
    std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(5000).unwrap();
    let late = TileKey::new(0, 14, 6);
    assert_eq!(load(&mut resident, &[late, TileKey::new(0, 2, 0)]).missing, 0);
    let held = held(&resident);
    assert!(held.contains(&TileKey::new(0, 2, 0)) && !held.contains(&late));
    let (_, error) = resident.damaged().find(|(key, _)| *key == late).unwrap();
    assert!(error.to_string().contains("cut to 5000"), "{error}");
}

#[test]
fn a_tile_that_the_file_lacks_comes_unless_what_it_rests_on_is_damaged() {
    let sample = Sample { absent: |key: TileKey| key.level == 0, ..Sample::new(Body::earth(), 10) };
    let (good, lost) = (TileKey::new(0, 5, 2), TileKey::new(0, 1, 1));
    for (change, works) in [(None, true), (Some(TileKey::new(1, 0, 0)), false)] {
        let planet = write(&sample, |bytes| change.into_iter().for_each(|key| damage(key, Plane::Deviation)(bytes)));
        let mut resident = resident(&planet, 100);
        let progress = load(&mut resident, &[lost, good]);
        assert_eq!(progress.missing, 0);
        assert!(resident.pages().find(0, good.x, good.y) & USABLE != 0 && held(&resident).contains(&good));
        assert_eq!(held(&resident).contains(&lost), works);
        assert_eq!(resident.damaged().any(|(key, _)| key == lost), !works);
        assert_eq!(resident.ask([pages::key(0, lost.x, lost.y)]), 0, "nothing lacks that can come");
    }
}

#[test]
fn what_a_view_lacks_is_asked_for_again_while_others_are_drawn() {
    let bad = TileKey::new(1, 1, 0);
    let planet = write(&Sample::new(Body::earth(), 11), damage(bad, Plane::Nodes));
    let mut resident = resident(&planet, 200);
    let late = pages::key(0, 14, 6);
    assert_eq!(resident.ask([late, pages::key(0, 2, 0)]), 2);
    let lacked = resident.lacked().to_vec();
    // Another view's round: what is not asked for is forgotten, until it is asked for again.
    resident.update(Duration::ZERO);
    assert_eq!((resident.ask([]), resident.still_lacks(&lacked)), (0, 2));
    resident.update(LONG);
    assert_eq!(resident.still_lacks(&[late]), 1);
    resident.ask(lacked.iter().copied());
    resident.update(LONG);
    // Once for what finer tiles rest on, which is found to be damaged.
    resident.ask(lacked.iter().copied());
    resident.update(LONG);
    assert_eq!(resident.still_lacks(&lacked), 0, "{:?}", held(&resident));
}

#[test]
fn a_damaged_root_is_refused_at_once() {
    let planet = write(&Sample::new(Body::earth(), 9), damage(TileKey::new(1, 1, 0), Plane::Nodes));
    let error = Resident::new(Arc::clone(&planet), small(64), Ram::new(small(64))).err();
    assert!(matches!(error, Some(FormatError::Tile { .. })), "{error:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    /// A naive model: what a view asks for and all that touches it, level by level, is there.
    #[test]
    fn what_is_asked_for_is_there_with_all_it_rests_on(
        views in prop::collection::vec(prop::collection::vec((0u32..3, any::<u32>()), 1..4), 1..5),
        plane: bool,
    ) {
        let body = match plane {
            true => Body::Plane { crs_wkt: String::new(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 },
            false => Body::earth(),
        };
        let planet = write(&Sample::new(body, 11), |_| ());
        let grid = planet.grid();
        let mut resident = resident(&planet, 64);
        for view in views {
            let keys: Vec<TileKey> = view
                .iter()
                .map(|&(level, pick)| TileKey::new(level, pick % grid.tiles_x(level), (pick >> 8) % grid.tiles_y(level)))
                .collect();
            let progress = load(&mut resident, &keys);
            prop_assert_eq!(progress.missing, 0);
            prop_assert_eq!(progress.resident, held(&resident).len());
            let held = held(&resident);
            let mut wanted: Vec<TileKey> = keys;
            while let Some(key) = wanted.pop() {
                prop_assert!(held.contains(&key), "{:?}", key);
                prop_assert!(resident.pages().find(key.level, key.x, key.y) & USABLE != 0);
                wanted.extend(closure::touching(grid, key));
            }
        }
    }
}
