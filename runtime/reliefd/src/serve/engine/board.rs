//! What the engine has to do: shared between its thread and those who ask.
//!
//! Work goes in rounds. In each, every client has at most one of its cameras drawn, the one that
//! waited longest; then tiles are loaded within the time budget. So a client with many cameras slows
//! itself, not others.

use std::collections::{BTreeMap, HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use relief_runtime::planet::Planet;
use relief_runtime::residency::Progress;

use super::drawer::Drawer;
use super::slot::{Ask, Loads, Sink, Slot};

/// Work of another kind, on the engine's thread.
pub type Task = Box<dyn FnOnce(&mut Drawer) + Send>;

/// What is to be done next.
pub(super) enum Next {
    /// Draw a slot's view; the picture would have this number.
    Draw { slot: u64, ask: Ask, seq: u64, sink: Sink },
    /// Something else.
    Run(Task),
    /// The planet's file was replaced.
    Replace(Arc<Planet>),
    /// Load tiles that frames asked for.
    Load,
    /// End.
    Stop,
}

#[derive(Default)]
struct State {
    slots: BTreeMap<u64, Slot>,
    tasks: VecDeque<(u64, Task)>,
    replacement: Option<Arc<Planet>>,
    stopped: bool,
    next_slot: u64,
    /// Clients that had their turn in this round.
    served: HashSet<u64>,
    draws: u64,
    loads: Loads,
    /// The last frames asked for tiles that are not there, and more may come.
    missing: bool,
    /// Nothing more will come.
    stuck: bool,
}

/// The work, and who waits for it.
#[derive(Default)]
pub(super) struct Board {
    state: Mutex<State>,
    wake: Condvar,
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A panic elsewhere leaves the lists as they were.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let result = change(&mut self.lock());
        self.wake.notify_one();
        result
    }

    fn slot<T>(&self, slot: u64, change: impl FnOnce(&mut Slot) -> T) -> Option<T> {
        self.change(|state| state.slots.get_mut(&slot).map(change))
    }

    pub fn add(&self, client: u64, sink: Sink) -> u64 {
        self.change(|state| {
            state.next_slot += 1;
            state.slots.insert(state.next_slot, Slot::new(client, sink));
            state.next_slot
        })
    }

    pub fn remove(&self, slot: u64) {
        self.change(|state| state.slots.remove(&slot));
    }

    pub fn ask(&self, slot: u64, ask: Ask) {
        self.slot(slot, |slot| slot.ask(ask));
    }

    pub fn acknowledge(&self, slot: u64, seq: u64) {
        self.slot(slot, |slot| slot.acknowledge(seq));
    }

    pub fn run(&self, client: u64, task: Task) {
        self.change(|state| state.tasks.push_back((client, task)));
    }

    pub fn replace(&self, planet: Arc<Planet>) {
        self.change(|state| state.replacement = Some(planet));
    }

    pub fn stop(&self) {
        self.change(|state| state.stopped = true);
    }

    /// Cameras and tasks that are there.
    pub fn len(&self) -> usize {
        let state = self.lock();
        state.slots.len() + state.tasks.len()
    }

    /// All views are to be drawn anew.
    pub fn again(&self) {
        self.change(|state| {
            state.slots.values_mut().for_each(Slot::again);
            state.stuck = false;
        });
    }

    /// A picture is drawn. It is sent unless it lacks tiles and was to be whole; true when sent.
    pub fn drawn(&self, slot: u64, until: Option<Instant>, tiles_missing: usize) -> bool {
        self.change(|state| {
            let lacks = tiles_missing > 0;
            state.missing |= lacks && !state.stuck;
            let early = until.is_some_and(|until| lacks && !state.stuck && Instant::now() < until);
            let lacking = lacks.then_some(state.loads);
            if let Some(slot) = state.slots.get_mut(&slot) {
                slot.drawn(lacking, !early);
            }
            !early
        })
    }

    /// The picture was handed over; a slot for one picture has no more to do.
    pub fn handed_over(&self, slot: u64) {
        self.slot(slot, Slot::free);
    }

    /// The view cannot be drawn.
    pub fn forget(&self, slot: u64) {
        self.slot(slot, Slot::forget);
    }

    /// Tiles came in, or nothing is left to come.
    pub fn loaded(&self, progress: &Progress) {
        self.change(|state| {
            state.loads.some += u64::from(progress.loaded > 0);
            let stuck = progress.full && progress.loaded == 0;
            if stuck || progress.missing == 0 {
                state.loads.all += 1;
                state.missing = false;
            }
            state.stuck = stuck;
        });
    }

    /// Waits for work.
    pub fn next(&self) -> Next {
        let mut state = self.lock();
        loop {
            if state.stopped {
                return Next::Stop;
            }
            if let Some(planet) = state.replacement.take() {
                state.missing = false;
                return Next::Replace(planet);
            }
            let now = Instant::now();
            if let Some(next) = state.turn(now) {
                return next;
            }
            // The round is over.
            let worked = !std::mem::take(&mut state.served).is_empty();
            if state.missing {
                return Next::Load;
            }
            if worked {
                continue;
            }
            let due = state.slots.values().filter_map(Slot::due).min();
            state = match due.map(|due| due.saturating_duration_since(now)) {
                None => self.wake.wait(state).unwrap_or_else(PoisonError::into_inner),
                Some(wait) => self.wake.wait_timeout(state, wait).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
    }
}

impl State {
    /// The next client's turn in this round.
    fn turn(&mut self, now: Instant) -> Option<Next> {
        if let Some(at) = self.tasks.iter().position(|(client, _)| !self.served.contains(client))
            && let Some((client, task)) = self.tasks.remove(at)
        {
            self.served.insert(client);
            return Some(Next::Run(task));
        }
        let (served, loads) = (&self.served, self.loads);
        let ready =
            self.slots.iter_mut().filter(|(_, slot)| !served.contains(&slot.client) && slot.is_ready(loads, now));
        let (&number, slot) = ready.min_by_key(|(_, slot)| slot.drawn)?;
        self.draws += 1;
        let (ask, seq) = slot.start(self.draws)?;
        let (client, sink) = (slot.client, Arc::clone(&slot.sink));
        self.served.insert(client);
        Some(Next::Draw { slot: number, ask, seq, sink })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use relief_protocol::view::View;

    fn ask(view: u64) -> Ask {
        Ask {
            view,
            what: Arc::new(View::down([0.0; 3], [1, 1])),
            mesh: false,
            places: false,
            arrived: Instant::now(),
            until: None,
        }
    }

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
                board.ask(slot, ask(1));
            }
            order.push(drawn(&board));
        }
        assert_eq!(order, [a1, b, a2, b, a3, b]);
    }

    #[test]
    fn a_round_ends_with_loading_while_tiles_are_missing() {
        let board = Board::default();
        let slot = board.add(1, Arc::new(|_| ()));
        board.ask(slot, ask(1));
        assert!(matches!(board.next(), Next::Draw { .. }));
        assert!(board.drawn(slot, None, 3));
        board.handed_over(slot);
        assert!(matches!(board.next(), Next::Load));
        // Nothing came yet: go on.
        board.loaded(&Progress { missing: 3, ..Progress::default() });
        assert!(matches!(board.next(), Next::Load));
        board.loaded(&Progress { loaded: 2, missing: 1, ..Progress::default() });
        assert!(matches!(board.next(), Next::Draw { seq: 2, .. }));
        board.stop();
        assert!(matches!(board.next(), Next::Stop));
    }

    #[test]
    fn one_picture_waits_for_its_tiles_but_not_for_what_never_comes() {
        let board = Board::default();
        let slot = board.add(1, Arc::new(|_| ()));
        let until = Instant::now() + std::time::Duration::from_secs(60);
        board.ask(slot, Ask { until: Some(until), ..ask(1) });
        assert!(matches!(board.next(), Next::Draw { .. }));
        assert!(!board.drawn(slot, Some(until), 1), "it is kept back");
        assert!(matches!(board.next(), Next::Load));
        board.loaded(&Progress { missing: 1, full: true, ..Progress::default() });
        assert!(matches!(board.next(), Next::Draw { .. }));
        assert!(board.drawn(slot, Some(until), 1), "nothing more will come");
    }
}
