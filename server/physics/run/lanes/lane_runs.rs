//! Runs side by side in lanes: loading, contacts of all lanes together, and contacts of one lane alone.

use crate::map::body::Body;
use crate::map::polygon::ClearRange;
use crate::map::strike::{PlannedTableMotion, Rod, State};
use crate::map::table::actuator_load::{ActuatorLimits, ActuatorLoad};
use crate::map::table::program::MOST_HEIGHTS;
use crate::numbers::dispatch::{Kernel, Vector};
use crate::numbers::lanes::vector::run_apart;
use crate::numbers::lanes::{MOST_LANES, Packs};
use crate::numbers::number::Arithmetic;
use crate::run::ending::EndingKind;
use crate::run::lanes::bounce::{ErrorLanes, Lanes};
use crate::run::lanes::model::BatchModel;
use crate::run::orbit::{LaneRunState, Orbit};
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

/// The lanes of a mask.
pub(super) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane
        })
    })
}

/// Runs side by side.
pub(super) struct LaneRuns<'w, V: Vector> {
    lanes: Lanes<V>,
    is_plain: bool,
    /// The run of each lane, as it was at its last contact that was done alone.
    orbits: Vec<Orbit>,
    idle: Orbit,
    /// Contacts of each run.
    impacts: u64,
    /// Contacts of every lane since the start.
    pub(super) turn: u64,
    /// The turn before a lane's first contact.
    first: [u64; MOST_LANES],
    /// The turn of its last one.
    last: [u64; MOST_LANES],
    pub(super) outcome: [EndingKind; MOST_LANES],
    pub(super) number: [usize; MOST_LANES],
    /// Contacts at which runs are watched.
    watch: &'w [u64],
    /// Place in `watch` of the next one of each lane, and the turn before it.
    place: [usize; MOST_LANES],
    look: [u64; MOST_LANES],
    pub(super) busy: u32,
    /// Lanes before the first flight of a run that can settle.
    fresh: u32,
    programs: ProgramLanes,
}

/// A rod that bounces upright, for ever.
// At its own energy, so that no feedback changes it.
const IDLE_ROD: Rod = Rod { gravity: 1.0, target_energy: 1.5, ..Rod::lossless(1.0, 1.0, 1.0) };
const IDLE_RULES: Rules = Rules { topple_angle: 1.0, holds_energy: true, ..Rules::BARE_MAP };
const IDLE_STATE: State = State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 };

const UNLIMITED: ActuatorLimits =
    ActuatorLoad { tilt: f64::INFINITY, tilt_rate: f64::INFINITY, speed: f64::INFINITY, stroke: f64::INFINITY };

/// Stands for the first flight until it is over, s: so short that no flight is too short beside it, and its share still normal.
const BEFORE_FLIGHT: f64 = 1e-200;

/// A body with the parts of another that bounces upright, for ever.
fn idle_body(body: &Body) -> Body {
    let rod = Rod { energy_feedback: body.rod.energy_feedback, ..IDLE_ROD };
    let point = Rod { contact_distance: 0.0, target_energy: 0.5, ..rod };
    let body = Body { program: None, noise: None, drag: None, outline: None, ..body.map(|_| 0.0) };
    Body { rod: if body.is_point { point } else { rod }, ..body }
}

/// At most so many contacts of all lanes.
struct Together<'a, 'c, V: Vector, const PLAIN: bool> {
    runs: &'a mut LaneRuns<'c, V>,
    most: u64,
}

impl<V: Vector, const PLAIN: bool> Kernel for Together<'_, '_, V, PLAIN> {
    type Output = u32;

    #[inline(always)]
    fn call<W: Vector>(self) -> u32 {
        self.runs.together_as::<PLAIN>(self.most)
    }
}

impl<'w, V: Vector> LaneRuns<'w, V> {
    /// Idle lanes for runs of one model, such as the one of `body`.
    pub(super) fn idle(model: BatchModel, body: &Body, impacts: u64, watch: &'w [u64]) -> Self {
        let idle = idle_body(body);
        let zero = Packs::from_f64(0.0);
        let number = Packs::from_f64;
        let plan = PlannedTableMotion { alpha: 0.0, normal_velocity: 0.0, tangential_velocity: 0.0 };
        let run =
            LaneRunState { plan: model.plans.then_some(plan), ..Orbit::at(idle, IDLE_RULES, IDLE_STATE).lane_state() };
        let lanes = Lanes {
            body: idle.map(number),
            leverage: number(1.0),
            topple_angle: number(1.0),
            half_length: number(f64::INFINITY),
            run: run.map(number),
            max_theta: zero,
            flight_time: zero,
            clear: model.has_vertices.then(|| ClearRange::ALL.map(number)),
            errors: model.errs.then(|| ErrorLanes::exact(model)),
            has_ends: model.has_ends,
            limits: model.has_limits.then_some(ActuatorLoad { tilt: zero, tilt_rate: zero, speed: zero, stroke: zero }),
            follows_place: model.has_ends || model.errs_in_state || idle.depends_on_place(),
            may_sense_late: (model.lags || model.errs_in_state) && !model.plans,
            plan_mismatch: zero,
            holds_energy: model.friction.is_none() && !model.errs,
        };
        let idle = Orbit::at(idle, IDLE_RULES, IDLE_STATE);
        let mut runs = Self {
            lanes,
            is_plain: model.is_plain_rod(),
            orbits: vec![idle; Packs::<V>::LANES],
            idle,
            impacts,
            turn: 0,
            first: [0; MOST_LANES],
            last: [u64::MAX; MOST_LANES],
            outcome: [EndingKind::Completed; MOST_LANES],
            number: [0; MOST_LANES],
            watch,
            place: [0; MOST_LANES],
            look: [u64::MAX; MOST_LANES],
            busy: 0,
            fresh: 0,
            programs: ProgramLanes::new(),
        };
        for lane in 0..Packs::<V>::LANES {
            runs.load(lane, None);
        }
        runs
    }

    pub(super) fn load(&mut self, lane: usize, next: Option<(usize, Orbit)>) {
        let last = match next {
            Some((number, orbit)) => {
                self.number[lane] = number;
                self.busy |= 1 << lane;
                self.orbits[lane] = orbit;
                self.turn.saturating_add(self.impacts)
            }
            None => {
                self.busy &= !(1 << lane);
                self.orbits[lane] = self.idle;
                u64::MAX
            }
        };
        let Self { orbits, lanes, .. } = self;
        let orbit = &orbits[lane];
        let Rules { topple_angle, settles, half_length, limits, .. } = *orbit.rules();
        let mut put = |packs: &mut Packs<V>, number: f64| packs.put(lane, number);
        lanes.body.zip(&orbit.body, &mut put);
        lanes.leverage.put(lane, orbit.body.rod.leverage());
        lanes.topple_angle.put(lane, topple_angle);
        lanes.half_length.put(lane, half_length);
        if let Some(lanes) = &mut lanes.limits {
            lanes.zip(&limits.unwrap_or(UNLIMITED), &mut put);
        }
        lanes.max_theta.put(lane, 0.0);
        if let Some(clear) = &mut lanes.clear {
            clear.zip(&orbit.body.outline.map_or(ClearRange::ALL, |outline| outline.clear), &mut put);
        }
        self.programs.load(lane, &orbit.body);
        self.put(lane);
        self.fresh &= !(1 << lane);
        if settles {
            self.fresh |= 1 << lane;
            self.lanes.run.first_flight.put(lane, BEFORE_FLIGHT);
        }
        (self.first[lane], self.last[lane]) = (self.turn, last);
        self.outcome[lane] = EndingKind::Completed;
        (self.place[lane], self.look[lane]) = (0, self.turn_before(lane, 0));
    }

    /// Puts the state of a lane's orbit into the lane.
    fn put(&mut self, lane: usize) {
        let orbit = &self.orbits[lane];
        let (run, lane_state) = (&mut self.lanes.run, orbit.lane_state());
        let is_mismatched = self.busy & 1 << lane != 0 && lane_state.plan.is_some() != run.plan.is_some();
        self.lanes.plan_mismatch.put(lane, f64::from(u8::from(is_mismatched)));
        run.zip(&lane_state, &mut |packs, number| packs.put(lane, number));
        if let Some(errors) = &mut self.lanes.errors {
            errors.put(lane, orbit.body.noise, orbit.body.rod.restitution, orbit.contacts());
        }
    }

    /// The turn before a watched contact of a lane; the last of all turns beyond them.
    fn turn_before(&self, lane: usize, place: usize) -> u64 {
        let contact = self.watch.get(place).filter(|_| self.busy & 1 << lane != 0);
        contact.map_or(u64::MAX, |contact| self.first[lane].saturating_add(contact - 1))
    }

    /// θ in a lane, rad.
    pub(super) fn theta(&self, lane: usize) -> f64 {
        self.lanes.run.state.theta.lane(lane)
    }

    pub(super) fn look_ahead(&mut self, lane: usize) {
        self.place[lane] += 1;
        self.look[lane] = self.turn_before(lane, self.place[lane]);
    }

    /// The lanes whose coming contact is watched.
    pub(super) fn watched(&self) -> u32 {
        self.lanes_where(|lane| self.turn == self.look[lane])
    }

    pub(super) fn end(&self, lane: usize) -> LaneRunEnd {
        LaneRunEnd {
            impacts: self.turn - self.first[lane],
            outcome: self.outcome[lane],
            max_theta: self.lanes.max_theta.lane(lane),
        }
    }

    /// The lanes whose last contact is behind them.
    pub(super) fn completed(&self) -> u32 {
        self.lanes_where(|lane| self.turn >= self.last[lane])
    }

    fn lanes_where(&self, holds: impl Fn(usize) -> bool) -> u32 {
        (0..Packs::<V>::LANES).filter(|&lane| holds(lane)).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Computes contacts of all lanes with the flights after them: at most `most`, and only up to the next contact that is watched, the last
    /// of a run, or not a common one. Returns the lanes that stopped before such a contact.
    #[inline(always)]
    pub(super) fn together(&mut self, most: u64) -> u32 {
        let lanes = 0..Packs::<V>::LANES;
        let most = lanes.fold(most, |most, lane| most.min(self.last[lane].min(self.look[lane]) - self.turn));
        // Each by a call of its own: one function with both takes the compiler many times as long.
        if self.is_plain {
            run_apart::<V, _>(Together::<V, true> { runs: self, most })
        } else {
            run_apart::<V, _>(Together::<V, false> { runs: self, most })
        }
    }

    #[inline(always)]
    fn together_as<const PLAIN: bool>(&mut self, most: u64) -> u32 {
        for _ in 0..most {
            self.turn += 1;
            if self.programs.lanes != 0 {
                self.programs.aim(self.lanes.body.rod.target_energy.lanes_mut());
            }
            let apart = self.lanes.bounce::<PLAIN>();
            if self.fresh != 0 {
                self.begin(!apart);
            }
            if apart & self.busy != 0 {
                return apart;
            }
        }
        0
    }

    /// Keeps the first flights of runs that can settle; those that were no common ones are made alone.
    #[inline(never)]
    fn begin(&mut self, common: u32) {
        for lane in bits(std::mem::take(&mut self.fresh) & common) {
            let first_flight = self.lanes.flight_time.lane(lane);
            self.lanes.run.first_flight.put(lane, first_flight);
        }
    }

    /// One contact of one lane: how its run ends there, if it does.
    #[cold]
    #[inline(never)]
    pub(super) fn alone(&mut self, lane: usize) -> Option<EndingKind> {
        let size = self.theta(lane).abs();
        let max_theta = self.lanes.max_theta.lane(lane).max(size);
        self.lanes.max_theta.put(lane, max_theta);
        let orbit = self.bring_on(lane, self.turn - 1);
        if let Some(ending) = orbit.advance().ending {
            return Some(ending.into());
        }
        self.put(lane);
        None
    }

    /// Takes a run out of its lane. Returns its number, the run before its coming contact, and the largest |θ| so far, rad.
    pub(super) fn take_out(&mut self, lane: usize) -> (usize, Orbit, f64) {
        self.busy &= !(1 << lane);
        let max_theta = self.lanes.max_theta.lane(lane);
        (self.number[lane], *self.bring_on(lane, self.turn), max_theta)
    }

    /// Brings the run of a lane to where the lane is, after so many contacts of every lane.
    fn bring_on(&mut self, lane: usize, turn: u64) -> &mut Orbit {
        let mut lane_state = self.lanes.run.map(|packs| packs.lane(lane));
        let orbit = &mut self.orbits[lane];
        if lane_state.first_flight == BEFORE_FLIGHT {
            lane_state.first_flight = 0.0;
        }
        if self.lanes.plan_mismatch.lane(lane) != 0.0 {
            lane_state.plan = orbit.coming().plan;
        }
        orbit.set_lane_state(turn - self.first[lane], &lane_state);
        orbit
    }
}

/// Programs of heights of the tables in the lanes: another target for each strike.
struct ProgramLanes {
    /// Lanes whose tables have one.
    lanes: u32,
    /// Target energies of one cycle, m²/s².
    targets: [[f64; MOST_HEIGHTS]; MOST_LANES],
    count: [usize; MOST_LANES],
    /// Place of the coming strike in the cycle.
    next: [usize; MOST_LANES],
}

impl ProgramLanes {
    fn new() -> Self {
        Self { lanes: 0, targets: [[0.0; MOST_HEIGHTS]; MOST_LANES], count: [1; MOST_LANES], next: [0; MOST_LANES] }
    }

    /// Begins the program of the table in a lane, if it has one.
    fn load(&mut self, lane: usize, body: &Body) {
        self.lanes &= !(1 << lane);
        let Some(program) = body.program else { return };
        self.lanes |= 1 << lane;
        for (n, target) in (1..).zip(&mut self.targets[lane]) {
            *target = program.applied(&body.rod, n).target_energy;
        }
        (self.count[lane], self.next[lane]) = (program.heights().len(), 0);
    }

    /// Aims tables at the heights of their coming strikes: their target energies.
    #[inline(never)]
    fn aim(&mut self, target_energies: &mut [f64]) {
        for lane in bits(self.lanes) {
            let next = self.next[lane];
            target_energies[lane] = self.targets[lane][next];
            self.next[lane] = if next + 1 == self.count[lane] { 0 } else { next + 1 };
        }
    }
}
