use std::time::Duration;

use super::*;

/// A view by its number, of which one picture is wanted where there is a time.
pub fn ask(view: u64, until: Option<Instant>) -> Ask {
    Ask {
        view,
        what: Arc::new(View::down([0.0; 3], [1, 1])),
        mesh: false,
        places: false,
        arrived: Instant::now(),
        until,
    }
}

fn slot() -> Slot {
    Slot::new(1, Arc::new(|_| ()))
}

#[test]
fn the_latest_view_wins() {
    let (mut slot, now) = (slot(), Instant::now());
    assert!(!slot.is_ready(now));
    slot.ask(ask(1, None));
    slot.ask(ask(2, None));
    assert_eq!(slot.start(1).map(|(ask, seq)| (ask.view, seq)), Some((2, 1)));
    assert!(!slot.is_ready(now), "it is being drawn");
    slot.ask(ask(3, None));
    slot.drawn(5, true);
    assert!(!slot.is_lacking(), "what an earlier view lacked is of no use");
    slot.free();
    assert_eq!(slot.start(2).map(|(ask, seq)| (ask.view, seq)), Some((3, 2)));
}

#[test]
fn who_acknowledges_nothing_waits() {
    let (mut slot, now) = (slot(), Instant::now());
    for k in 0..MOST_UNACKNOWLEDGED {
        slot.ask(ask(k, None));
        assert!(slot.is_ready(now));
        slot.start(k);
        slot.drawn(0, true);
        slot.free();
    }
    slot.ask(ask(9, None));
    assert!(!slot.is_ready(now));
    slot.acknowledge(1);
    assert!(slot.is_ready(now));
    // A number that was never sent does not buy more.
    slot.acknowledge(1_000_000);
    assert_eq!(slot.acknowledged, MOST_UNACKNOWLEDGED);
}

#[test]
fn pictures_follow_while_their_own_tiles_come_in() {
    let (mut slot, now) = (slot(), Instant::now());
    slot.ask(ask(1, None));
    slot.start(1);
    slot.drawn(5, true);
    slot.free();
    slot.loaded(5, false);
    assert!(!slot.is_ready(now), "others' tiles came in");
    slot.loaded(4, false);
    assert!(slot.is_ready(now));
    // One picture only: not before all tiles have come, or none will, or the time.
    let later = now + Duration::from_secs(9);
    slot.ask(ask(2, Some(later)));
    slot.start(2);
    slot.drawn(5, false);
    slot.loaded(1, false);
    assert!(!slot.is_ready(now) && slot.is_ready(later));
    let mut stuck = slot;
    stuck.loaded(1, true);
    assert!(stuck.is_ready(now));
    stuck.start(3);
    stuck.drawn(1, false);
    stuck.loaded(0, false);
    assert!(stuck.is_ready(now));
}
