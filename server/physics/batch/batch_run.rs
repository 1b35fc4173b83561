//! Runs many orbits side by side in lanes, each to its end: what a region of stability is made of.
//!
//! Every lane gives the bits that [`crate::run::orbit::run`] gives for its orbit alone. A lane whose run has ended takes the next
//! orbit at once, so that dead cells cost nothing; a bounce that is not a common one is done alone, by the orbit itself.

use crate::batch::lanes::{
    Bounced, Far, LaneModel, LaneNumbers, Near, NoisyLanes, OutlineLanes, PointLanes, RodLanes, Rough, Smooth,
    SteeringLanes, WIDTH,
};
use crate::batch::mask::{Mask, bits};
use crate::batch::model::{BatchContact, BatchModel};
use crate::batch::programs::ProgramLanes;
use crate::body::model::Model;
use crate::bounce::state::State;
use crate::numbers::dispatch::{InstructionSet, Kernel, dispatch_on};
use crate::run::cancellation::CancellationCheck;
use crate::run::ending::EndingKind;
use crate::run::orbit::{LaneRunState, Orbit, run};
use crate::run::rules::Rules;

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneRunEnd {
    /// Contacts, the last included.
    pub impacts: u64,
    /// The name of the ending, as [`EndingKind::name`].
    pub outcome: EndingKind,
    /// Largest |θ| at a contact, rad.
    pub max_theta: f64,
}

/// Gives one orbit after the other, each before its first contact and with a number of its own.
pub type NextOrbit<'a> = dyn FnMut() -> Option<(usize, Orbit<Model>)> + 'a;

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
    let mut others = run_those_like_the_first(impacts, watch, next, done, go_on);
    loop {
        match others {
            None => return false,
            Some(left) if left.is_empty() => return true,
            Some(left) => {
                let mut left = left.into_iter();
                others = run_those_like_the_first(impacts, watch, &mut || left.next(), done, go_on);
            }
        }
    }
}

/// Makes the runs that fit into a batch with the first one, or all that fit into none as the first one. Returns the others; `None` once
/// `go_on` returned false.
fn run_those_like_the_first(
    impacts: u64,
    watch: &mut Watch<'_>,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<(usize, Orbit<Model>)>> {
    let mut others = Vec::new();
    let mut first = next();
    let Some((_, orbit)) = &first else { return Some(others) };
    let model_of = |orbit: &Orbit<Model>| BatchModel::of(&orbit.body, orbit.rules());
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
        Some(model) => run_batch_watched(best_path(), model, impacts, watch, &mut alike, done, go_on),
        None => run_alone(impacts, watch, &mut alike, done, go_on),
    };
    is_done.then_some(others)
}

/// Makes one run after the other. Returns false once `go_on` did.
fn run_alone(
    impacts: u64,
    watch: &mut Watch<'_>,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    let mut looks = CancellationCheck::new(go_on);
    while let Some((number, mut orbit)) = next() {
        let (mut max_theta, mut watched) = (0.0_f64, watch.contacts.iter().peekable());
        let ending = looks.begin().then(|| {
            run(&mut orbit, impacts, |contact| {
                max_theta = max_theta.max(contact.state.theta.abs());
                if watched.next_if_eq(&&contact.n).is_some() {
                    (watch.see)(number, contact.state.theta);
                }
                looks.contact()
            })
        });
        let Some(ending) = ending.flatten() else { return false };
        done(number, LaneRunEnd { impacts: orbit.contacts(), outcome: ending.into(), max_theta });
    }
    true
}

/// [`run_all`] of runs that fit into a batch of one model.
pub fn run_batch(
    model: BatchModel,
    impacts: u64,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    run_batch_on(best_path(), model, impacts, next, done, go_on)
}

fn best_path() -> InstructionSet {
    InstructionSet::ALL.into_iter().find(|path| path.is_there()).unwrap_or(InstructionSet::Portable)
}

/// [`run_batch`] with one kind of instructions, to hold all of them together.
pub fn run_batch_on(
    path: InstructionSet,
    model: BatchModel,
    impacts: u64,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    run_batch_watched(path, model, impacts, &mut Watch { contacts: &[], see: &mut |_, _| () }, next, done, go_on)
}

/// [`run_batch_on`] of runs that are watched.
pub fn run_batch_watched(
    path: InstructionSet,
    model: BatchModel,
    impacts: u64,
    watch: &mut Watch<'_>,
    next: &mut NextOrbit<'_>,
    done: &mut RunDone<'_>,
    go_on: &mut dyn FnMut() -> bool,
) -> bool {
    macro_rules! run {
        ($model:expr) => {
            dispatch_on(path, BatchRun { model: $model, impacts, watch, next, done, go_on })
        };
    }
    match model {
        BatchModel::Rod { contact, energy_feedback, law, errs, has_vertices } => {
            let (steering, outline) = (SteeringLanes::new(law), has_vertices.then(OutlineLanes::new));
            match contact {
                BatchContact::Smooth => {
                    let rods = RodLanes { surface: Smooth(energy_feedback), steering, outline };
                    if errs { run!(NoisyLanes::new(rods)) } else { run!(rods) }
                }
                BatchContact::Rough(law, slide) => {
                    let rods = RodLanes { surface: Rough::new(law, slide, energy_feedback), steering, outline };
                    if errs { run!(NoisyLanes::new(rods)) } else { run!(rods) }
                }
            }
        }
        BatchModel::Point(energy_feedback) => run!(PointLanes::new(energy_feedback)),
    }
}

struct BatchRun<'a, 'w, 'n, 'd, M> {
    model: M,
    impacts: u64,
    watch: &'a mut Watch<'w>,
    next: &'a mut NextOrbit<'n>,
    done: &'a mut RunDone<'d>,
    go_on: &'a mut dyn FnMut() -> bool,
}

/// Bounces of all lanes between two questions whether to go on.
const LOOK: u64 = 256;

impl<M: LaneModel> Kernel for BatchRun<'_, '_, '_, '_, M> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let mut runs = LaneRuns::idle(self.model, self.impacts, self.watch.contacts);
        for lane in 0..WIDTH {
            runs.load(lane, (self.next)());
        }
        let mut looked = 0;
        while runs.busy != 0 {
            if runs.turn >= looked + LOOK {
                looked = runs.turn;
                if !(self.go_on)() {
                    return false;
                }
            }
            for lane in bits(runs.watched() & runs.busy) {
                (self.watch.see)(runs.number[lane], runs.numbers.moving.state(lane).theta);
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
                (self.done)(runs.number[lane], runs.end(lane));
                runs.load(lane, (self.next)());
            }
        }
        true
    }
}

/// Runs side by side.
struct LaneRuns<'w, M> {
    model: M,
    numbers: LaneNumbers,
    /// The run of each lane, as it was at its last contact that was done alone.
    orbits: [Orbit<Model>; WIDTH],
    /// Contacts of each run.
    impacts: u64,
    /// Contacts of every lane since the start.
    turn: u64,
    /// The turn before a lane's first contact.
    first: [u64; WIDTH],
    /// The turn of its last one.
    last: [u64; WIDTH],
    outcome: [EndingKind; WIDTH],
    number: [usize; WIDTH],
    /// Contacts at which runs are watched.
    watch: &'w [u64],
    /// Place in `watch` of the next one of each lane, and the turn before it.
    place: [usize; WIDTH],
    look: [u64; WIDTH],
    busy: Mask,
    /// Lanes before the first flight of a run that can settle.
    fresh: Mask,
    programs: ProgramLanes,
    /// True where an angle was too large for [`Near`] lately.
    far: bool,
}

/// Rules of a lane that idles, and its state at each contact.
const IDLE_RULES: Rules = Rules { topple_angle: 1.0, settles: false, holds_energy: true, limits: None };
const IDLE_STATE: State = State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 };

impl<'w, M: LaneModel> LaneRuns<'w, M> {
    fn idle(model: M, impacts: u64, watch: &'w [u64]) -> Self {
        let orbit = Orbit::at(model.idle(), IDLE_RULES, IDLE_STATE);
        Self {
            numbers: LaneNumbers::all(orbit.body.rod(), &IDLE_RULES, &IDLE_STATE, orbit.lane_state().energy),
            model,
            orbits: [orbit; WIDTH],
            impacts,
            turn: 0,
            first: [0; WIDTH],
            last: [u64::MAX; WIDTH],
            outcome: [EndingKind::Completed; WIDTH],
            number: [0; WIDTH],
            watch,
            place: [0; WIDTH],
            look: [u64::MAX; WIDTH],
            busy: 0,
            fresh: 0,
            programs: ProgramLanes::new(),
            far: false,
        }
    }

    /// Gives a lane its next run, or none.
    fn load(&mut self, lane: usize, next: Option<(usize, Orbit<Model>)>) {
        let last = match next {
            Some((number, orbit)) => {
                self.number[lane] = number;
                self.busy |= 1 << lane;
                self.orbits[lane] = orbit;
                self.turn.saturating_add(self.impacts)
            }
            None => {
                self.busy &= !(1 << lane);
                self.orbits[lane] = Orbit::at(self.model.idle(), IDLE_RULES, IDLE_STATE);
                u64::MAX
            }
        };
        let orbit = &self.orbits[lane];
        let (rules, midst) = (*orbit.rules(), orbit.lane_state());
        self.numbers.rods.set(lane, orbit.body.rod(), &rules);
        self.model.load(lane, &orbit.body, &midst);
        self.numbers.moving.set(lane, &midst.state, midst.energy);
        self.numbers.moving.max_theta[lane] = 0.0;
        self.programs.load(lane, orbit.body.rod(), orbit.body.program());
        self.fresh &= !(1 << lane);
        self.fresh |= Mask::from(rules.settles) << lane;
        (self.first[lane], self.last[lane]) = (self.turn, last);
        self.outcome[lane] = EndingKind::Completed;
        (self.place[lane], self.look[lane]) = (0, self.turn_before(lane, 0));
    }

    /// The turn before a watched contact of a lane; the last of all turns beyond them.
    fn turn_before(&self, lane: usize, place: usize) -> u64 {
        let contact = self.watch.get(place).filter(|_| self.busy & 1 << lane != 0);
        contact.map_or(u64::MAX, |contact| self.first[lane].saturating_add(contact - 1))
    }

    /// Goes on to the next watched contact of a lane.
    fn look_ahead(&mut self, lane: usize) {
        self.place[lane] += 1;
        self.look[lane] = self.turn_before(lane, self.place[lane]);
    }

    /// The lanes whose coming contact is watched.
    fn watched(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn == self.look[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    fn end(&self, lane: usize) -> LaneRunEnd {
        LaneRunEnd {
            impacts: self.turn - self.first[lane],
            outcome: self.outcome[lane],
            max_theta: self.numbers.moving.max_theta[lane],
        }
    }

    /// The lanes whose last contact is behind them.
    fn completed(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn >= self.last[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Computes contacts of all lanes with the flights after them: at most `most`, and only up to the next contact that is watched, the last
    /// of a run, or not a common one. Returns the lanes that stopped before such a contact.
    #[inline(always)]
    fn together(&mut self, most: u64) -> Mask {
        let stops = self.last.iter().chain(&self.look);
        let most = stops.map(|turn| turn - self.turn).fold(most, u64::min);
        for _ in 0..most {
            self.turn += 1;
            let LaneNumbers { rods, moving, next, scratch } = &mut self.numbers;
            if self.programs.lanes != 0 {
                self.programs.aim(rods);
            }
            let mut bounced = Bounced { near: false, common: false };
            if !self.far {
                bounced = self.model.bounce::<Near>(rods, moving, next, scratch);
                self.far = !bounced.near;
            }
            if self.far {
                bounced = self.model.bounce::<Far>(rods, moving, next, scratch);
                self.far = !bounced.near;
            }
            if self.fresh != 0 {
                self.begin();
            }
            if !bounced.common {
                return self.take_common();
            }
            let LaneNumbers { moving, next, scratch, .. } = &mut self.numbers;
            moving.take_all(next);
            self.model.arrive(moving, scratch);
        }
        0
    }

    /// Keeps the first flights of runs that can settle; those that were no common ones are made alone.
    #[inline(never)]
    fn begin(&mut self) {
        for lane in bits(std::mem::take(&mut self.fresh)) {
            if let Some(first_flight) = self.numbers.scratch.flight_time(lane) {
                self.numbers.rods.begin(lane, first_flight);
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn take_common(&mut self) -> Mask {
        let LaneNumbers { moving, next, scratch, .. } = &mut self.numbers;
        let mut mask = 0;
        for lane in 0..WIDTH {
            if scratch.apart[lane] == 0 {
                moving.take(lane, next);
                self.model.arrive_in(lane, next, scratch);
            } else {
                mask |= 1 << lane;
            }
        }
        mask
    }

    /// One contact of one lane: how its run ends there, if it does.
    #[cold]
    #[inline(never)]
    fn alone(&mut self, lane: usize) -> Option<EndingKind> {
        let state = self.numbers.moving.state(lane);
        let max_theta = &mut self.numbers.moving.max_theta[lane];
        *max_theta = max_theta.max(state.theta.abs());
        let orbit = &mut self.orbits[lane];
        let mut midst = LaneRunState {
            n: self.turn - self.first[lane] - 1,
            state,
            energy: self.numbers.moving.energy[lane],
            first_flight: self.numbers.rods.first_flight(lane),
            ..orbit.lane_state()
        };
        self.model.save(lane, &mut midst);
        orbit.set_lane_state(&midst);
        if let Some(ending) = orbit.advance().ending {
            return Some(ending.into());
        }
        let midst = orbit.lane_state();
        self.numbers.moving.set(lane, &midst.state, midst.energy);
        self.numbers.rods.begin(lane, midst.first_flight);
        self.model.load(lane, &orbit.body, &midst);
        None
    }
}
