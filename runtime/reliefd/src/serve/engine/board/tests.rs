use super::*;
use crate::serve::engine::slot::tests::ask;

fn drawn(board: &Board) -> u64 {
    match board.next() {
        Next::Draw { slot, .. } => {
            board.drawn(slot, None, 0);
            board.handed_over(slot);
            board.acknowledge(slot, u64::MAX);
            slot
        }
        _ => 0,
    }
}

#[test]
fn clients_take_turns_and_so_do_their_cameras() {
    let board = Board::default();
    let [a1, a2, a3] = [1; 3].map(|client| board.add(client, Arc::new(|_| ())));
    let b = board.add(2, Arc::new(|_| ()));
    let mut order = Vec::new();
    for _ in 0..6 {
        for slot in [a1, a2, a3, b] {
            board.ask(slot, ask(1, None));
        }
        order.push(drawn(&board));
    }
    assert_eq!(order, [a1, b, a2, b, a3, b]);
}

#[test]
fn a_round_ends_with_loading_while_tiles_are_missing() {
    let board = Board::default();
    let slot = board.add(1, Arc::new(|_| ()));
    board.ask(slot, ask(1, None));
    assert!(matches!(board.next(), Next::Draw { .. }));
    assert!(board.drawn(slot, None, 3));
    board.handed_over(slot);
    assert!(matches!(board.next(), Next::Load));
    // Nothing came yet: go on.
    board.loaded(&Progress { missing: 3, ..Progress::default() }, &[(slot, 3)]);
    assert!(matches!(board.next(), Next::Load));
    board.loaded(&Progress { loaded: 2, missing: 1, ..Progress::default() }, &[(slot, 1)]);
    assert!(matches!(board.next(), Next::Draw { seq: 2, .. }));
    board.stop();
    assert!(matches!(board.next(), Next::Stop));
}

#[test]
fn one_picture_waits_for_its_tiles_but_not_for_what_never_comes() {
    let board = Board::default();
    let slot = board.add(1, Arc::new(|_| ()));
    let until = Instant::now() + std::time::Duration::from_secs(60);
    board.ask(slot, ask(1, Some(until)));
    assert!(matches!(board.next(), Next::Draw { .. }));
    assert!(!board.drawn(slot, Some(until), 1), "it is kept back");
    assert!(matches!(board.next(), Next::Load));
    board.loaded(&Progress { missing: 1, full: true, ..Progress::default() }, &[(slot, 1)]);
    assert!(matches!(board.next(), Next::Draw { .. }));
    assert!(board.drawn(slot, Some(until), 1), "nothing more will come");
}

#[test]
fn loading_that_was_stuck_goes_on_with_another_view() {
    let board = Board::default();
    let [slot, other] = [1, 2].map(|client| board.add(client, Arc::new(|_| ())));
    board.ask(slot, ask(1, None));
    assert!(matches!(board.next(), Next::Draw { .. }));
    board.drawn(slot, None, 9);
    board.loaded(&Progress { missing: 9, full: true, ..Progress::default() }, &[(slot, 9)]);
    board.ask(other, ask(1, None));
    assert!(matches!(board.next(), Next::Draw { .. }));
    board.drawn(other, None, 1);
    assert!(matches!(board.next(), Next::Load));
    assert_eq!(board.lacking(), HashSet::from([slot, other]));
}

#[test]
fn a_client_has_two_pictures_on_their_way_and_no_more() {
    let board = Board::default();
    let slots = [(); 3].map(|()| board.add(1, Arc::new(|_| ())));
    slots.iter().for_each(|&slot| board.ask(slot, ask(1, None)));
    let started = |board: &Board| match board.lock().turn(Instant::now()) {
        Some(Next::Draw { slot, .. }) => Some(slot),
        _ => None,
    };
    for slot in &slots[..2] {
        assert_eq!(started(&board), Some(*slot));
        board.drawn(*slot, None, 0);
        board.lock().served.clear();
    }
    assert_eq!(started(&board), None);
    board.handed_over(slots[0]);
    assert_eq!(started(&board), Some(slots[2]));
}

#[test]
fn who_waits_at_a_board_that_closes_is_told() {
    let board = Board::default();
    let (alive, waits) = (Arc::new(()), Arc::new(()));
    let (in_sink, in_task) = (Arc::clone(&alive), Arc::clone(&waits));
    board.add(1, Arc::new(move |_| drop(Arc::clone(&in_sink))));
    board.run(1, Box::new(move |_| drop(in_task)));
    assert_eq!((Arc::strong_count(&alive), Arc::strong_count(&waits)), (2, 2));
    board.close();
    assert_eq!((Arc::strong_count(&alive), Arc::strong_count(&waits)), (1, 1));
    board.run(1, Box::new(|_| ()));
    assert_eq!(board.len(), 0);
}
