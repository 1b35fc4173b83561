//! Runs many orbits side by side in lanes, each to its end: what a region of stability is made of.
//!
//! Every lane gives the bits that [`crate::run::orbit::run`] gives for its orbit alone. A lane whose run has ended takes the next
//! orbit at once, so that dead cells cost nothing; a bounce that is not a common one is done alone, by the orbit itself.

use crate::numbers::dispatch::{InstructionSet, Kernel, Vector, dispatch_on};
use crate::numbers::lanes::Packs;
use crate::run::cancellation::CancellationCheck;
pub use crate::run::lanes::lane_runs::LaneRunEnd;
use crate::run::lanes::lane_runs::{LaneRuns, bits};
use crate::run::lanes::model::BatchModel;
use crate::run::orbit::{Orbit, run};

/// Price of beginning a run, in contacts.
const BEGINNING: u64 = 8;

/// Gives one orbit after the other, each before its first contact and with a number of its own.
pub type NextOrbit<'a> = dyn FnMut() -> Option<(usize, Orbit)> + 'a;

/// Takes runs as they end, in any order.
pub type RunDone<'a> = dyn FnMut(usize, LaneRunEnd) + 'a;

/// Contacts of each run at which angles are looked at.
pub struct Watch<'a> {
    /// Numbers of the contacts, from 1, in order.
    pub contacts: &'a [u64],
    /// Takes the number of a run and θ, rad, just before such a contact; of each run in the order of its contacts. The run may end there.
    pub see: &'a mut dyn FnMut(usize, f64),
}

/// Makes runs of up to `impacts` contacts, in lanes where they fit ([`BatchModel::of`]). Returns false once `go_on` did: it is asked
/// every few thousand bounces, and every hundred contacts outside lanes.
pub fn run_all(
    impacts: u64,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    run_watched(impacts, &mut Watch { contacts: &[], see: &mut |_, _| () }, next, done, go_on)
}

/// [`run_all`] of runs that are watched.
pub fn run_watched(
    impacts: u64,
    watch: &mut Watch<'_>,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    let mut task = RunTask { impacts, watch, done, go_on };
    let mut others = task.run_those_like_the_first(next);
    loop {
        match others {
            None => return false,
            Some(left) if left.is_empty() => return true,
            Some(left) => {
                let mut left = left.into_iter();
                others = task.run_those_like_the_first(&mut || left.next());
            }
        }
    }
}

/// [`run_all`] of runs that fit into a batch of one model, with one kind of instructions.
pub fn run_batch_on(
    path: InstructionSet,
    model: BatchModel,
    impacts: u64,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    let mut watch = Watch { contacts: &[], see: &mut |_, _| () };
    RunTask { impacts, watch: &mut watch, done, go_on }.run_in_lanes(path, model, next)
}

/// Most runs that are faster one after the other than side by side: a bounce of all lanes takes as long as that of two runs alone.
const FEW: u32 = 2;

/// Runs to be made: the number of their contacts, and those who look at them.
struct RunTask<'a, 'w, 'd> {
    impacts: u64,
    watch: &'a mut Watch<'w>,
    done: &'a mut RunDone<'d>,
    go_on: &'a mut dyn FnMut() -> bool,
}

impl RunTask<'_, '_, '_> {
    /// Makes the runs that fit into a batch with the first one, or all that fit into none as the first one. Returns the others; `None` once
    /// `go_on` returned false.
    fn run_those_like_the_first(&mut self, next: &mut NextOrbit<'_>) -> Option<Vec<(usize, Orbit)>> {
        let mut others = Vec::new();
        let mut first = next();
        let Some((_, orbit)) = &first else { return Some(others) };
        let model_of = |orbit: &Orbit| BatchModel::of(&orbit.body, orbit.rules());
        let model = model_of(orbit);
        let mut alike = || {
            first.take().or_else(|| {
                loop {
                    let (number, orbit) = next()?;
                    if model_of(&orbit) == model {
                        return Some((number, orbit));
                    }
                    others.push((number, orbit));
                }
            })
        };
        let is_done = match model {
            Some(model) => self.run_in_lanes(InstructionSet::best(), model, &mut alike),
            None => self.run_alone(&mut || alike().map(|(number, orbit)| (number, orbit, 0.0))),
        };
        is_done.then_some(others)
    }

    /// Makes one run after the other, each from where it is: `next` gives its number, the run and the largest |θ| so far, rad. Returns false
    /// once `go_on` did.
    #[inline(never)]
    fn run_alone(&mut self, next: &mut dyn FnMut() -> Option<(usize, Orbit, f64)>) -> bool {
        let Self { impacts, watch, done, go_on } = self;
        let mut looks = CancellationCheck::new(*go_on);
        while let Some((number, mut orbit, mut max_theta)) = next() {
            let before = orbit.contacts();
            let mut watched = watch.contacts.iter().skip_while(|contact| **contact <= before).peekable();
            let ending = looks.pass(BEGINNING).then(|| {
                run(&mut orbit, *impacts, |contact| {
                    max_theta = max_theta.max(contact.state.theta.abs());
                    if watched.next_if_eq(&&contact.n).is_some() {
                        (watch.see)(number, contact.state.theta);
                    }
                    looks.pass(1)
                })
            });
            let Some(ending) = ending.flatten() else { return false };
            done(number, LaneRunEnd { impacts: orbit.contacts(), outcome: ending.into(), max_theta });
        }
        true
    }

    /// Makes runs of one model in lanes. Returns false once `go_on` did.
    fn run_in_lanes(&mut self, path: InstructionSet, model: BatchModel, next: &mut NextOrbit<'_>) -> bool {
        dispatch_on(path, BatchRun { model, task: self, next })
    }
}

struct BatchRun<'a, 't, 'w, 'd, 'n> {
    model: BatchModel,
    task: &'a mut RunTask<'t, 'w, 'd>,
    next: &'a mut NextOrbit<'n>,
}

/// Bounces of all lanes between two questions whether to go on.
const LOOK: u64 = 256;

impl Kernel for BatchRun<'_, '_, '_, '_, '_> {
    type Output = bool;

    #[inline(always)]
    fn call<V: Vector>(self) -> bool {
        let Self { model, task, next } = self;
        let Some(first) = next() else { return true };
        let mut runs = LaneRuns::<V>::idle(model, &first.1.body, task.impacts, task.watch.contacts);
        runs.load(0, Some(first));
        for lane in 1..Packs::<V>::LANES {
            runs.load(lane, next());
        }
        let mut looked = 0;
        while runs.busy != 0 {
            // Lanes idle only when there are no more runs to come.
            if runs.busy.count_ones() <= FEW {
                let mut lanes = bits(runs.busy);
                return task.run_alone(&mut || lanes.next().map(|lane| runs.take_out(lane)));
            }
            if runs.turn >= looked + LOOK {
                looked = runs.turn;
                if !(task.go_on)() {
                    return false;
                }
            }
            for lane in bits(runs.watched() & runs.busy) {
                (task.watch.see)(runs.number[lane], runs.theta(lane));
                runs.look_ahead(lane);
            }
            let apart = runs.together(LOOK) & runs.busy;
            let mut ended = runs.completed();
            for lane in bits(apart) {
                if let Some(outcome) = runs.alone(lane) {
                    ended |= 1 << lane;
                    runs.outcome[lane] = outcome;
                }
            }
            for lane in bits(ended & runs.busy) {
                (task.done)(runs.number[lane], runs.end(lane));
                runs.load(lane, next());
            }
        }
        true
    }
}
