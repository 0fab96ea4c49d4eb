//! What the engine has to do: shared between its thread and those who ask.
//!
//! Work goes in rounds. In each, every client has at most one of its cameras drawn, the one that
//! waited longest; then tiles are loaded within the time budget. So a client with many cameras slows
//! itself, not others. Nor does a client get more pictures than it takes: two at a time may be on
//! their way to it.

use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use relief_runtime::planet::Planet;
use relief_runtime::residency::Progress;

use super::drawer::Drawer;
use super::slot::{Ask, Sink, Slot};

/// Pictures of a client that are drawn, packed or sent: this, not its cameras, bounds the memory that
/// a client who reads slowly takes.
const MOST_ON_THEIR_WAY: usize = 2;

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
    /// The last frames asked for tiles that are not there, and more may come.
    missing: bool,
    /// Nothing more will come, for the views as they are.
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
            if !state.stopped {
                state.slots.insert(state.next_slot, Slot::new(client, sink));
            }
            state.next_slot
        })
    }

    pub fn remove(&self, slot: u64) {
        // The sink is dropped without the lock: it may hold anything.
        let _removed = self.change(|state| {
            state.views_changed();
            state.slots.remove(&slot)
        });
    }

    pub fn ask(&self, slot: u64, ask: Ask) {
        self.change(|state| {
            state.views_changed();
            if let Some(slot) = state.slots.get_mut(&slot) {
                slot.ask(ask);
            }
        });
    }

    pub fn acknowledge(&self, slot: u64, seq: u64) {
        self.slot(slot, |slot| slot.acknowledge(seq));
    }

    pub fn run(&self, client: u64, task: Task) {
        self.change(|state| {
            if !state.stopped {
                state.tasks.push_back((client, task));
            }
        });
    }

    pub fn replace(&self, planet: Arc<Planet>) {
        self.change(|state| state.replacement = Some(planet));
    }

    pub fn stop(&self) {
        self.change(|state| state.stopped = true);
    }

    /// Nobody works here any more: all who wait are told so by their sinks' and tasks' end.
    pub fn close(&self) {
        let _dropped = self.change(|state| {
            state.stopped = true;
            (std::mem::take(&mut state.slots), std::mem::take(&mut state.tasks))
        });
    }

    /// Cameras whose views lack tiles.
    pub fn lacking(&self) -> HashSet<u64> {
        self.lock().slots.iter().filter(|(_, slot)| slot.is_lacking()).map(|(&number, _)| number).collect()
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
            state.views_changed();
        });
    }

    /// A picture is drawn. It is sent unless it lacks tiles and was to be whole; true when sent.
    pub fn drawn(&self, slot: u64, until: Option<Instant>, tiles_missing: usize) -> bool {
        self.change(|state| {
            let lacks = tiles_missing > 0;
            state.missing |= lacks && !state.stuck;
            let early = until.is_some_and(|until| lacks && !state.stuck && Instant::now() < until);
            if let Some(slot) = state.slots.get_mut(&slot) {
                slot.drawn(tiles_missing, !early);
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

    /// Tiles came in, or nothing is left to come; `left` says of cameras how many of the tiles that
    /// they lacked are still to come.
    pub fn loaded(&self, progress: &Progress, left: &[(u64, usize)]) {
        self.change(|state| {
            state.stuck = progress.full && progress.loaded == 0;
            state.missing = progress.missing > 0 && !state.stuck;
            for (slot, left) in left {
                if let Some(slot) = state.slots.get_mut(slot) {
                    slot.loaded(*left, state.stuck);
                }
            }
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
    /// Other tiles may be wanted now, or find room.
    fn views_changed(&mut self) {
        self.missing |= std::mem::take(&mut self.stuck);
    }

    /// The next client's turn in this round.
    fn turn(&mut self, now: Instant) -> Option<Next> {
        if let Some(at) = self.tasks.iter().position(|(client, _)| !self.served.contains(client))
            && let Some((client, task)) = self.tasks.remove(at)
        {
            self.served.insert(client);
            return Some(Next::Run(task));
        }
        let mut on_their_way: HashMap<u64, usize> = HashMap::new();
        for slot in self.slots.values().filter(|slot| slot.is_busy()) {
            *on_their_way.entry(slot.client).or_default() += 1;
        }
        let may = |slot: &Slot| {
            !self.served.contains(&slot.client)
                && on_their_way.get(&slot.client).is_none_or(|&count| count < MOST_ON_THEIR_WAY)
                && slot.is_ready(now)
        };
        let ready = self.slots.iter_mut().filter(|(_, slot)| may(slot));
        let (&number, slot) = ready.min_by_key(|(_, slot)| slot.drawn)?;
        self.draws += 1;
        let (ask, seq) = slot.start(self.draws)?;
        let (client, sink) = (slot.client, Arc::clone(&slot.sink));
        self.served.insert(client);
        Some(Next::Draw { slot: number, ask, seq, sink })
    }
}

#[cfg(test)]
mod tests;
