//! Runs side by side in lanes: loading, contacts of all lanes together, and contacts of one lane alone.

use crate::batch::lanes::{Bounced, Far, LaneModel, LaneNumbers, Near, WIDTH};
use crate::batch::mask::{Mask, bits};
use crate::batch::programs::ProgramLanes;
use crate::bounce::strike::State;
use crate::run::ending::EndingKind;
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

/// Runs side by side.
pub(super) struct LaneRuns<'w, M> {
    model: M,
    numbers: LaneNumbers,
    /// The run of each lane, as it was at its last contact that was done alone.
    orbits: [Orbit; WIDTH],
    /// Contacts of each run.
    impacts: u64,
    /// Contacts of every lane since the start.
    pub(super) turn: u64,
    /// The turn before a lane's first contact.
    first: [u64; WIDTH],
    /// The turn of its last one.
    last: [u64; WIDTH],
    pub(super) outcome: [EndingKind; WIDTH],
    pub(super) number: [usize; WIDTH],
    /// Contacts at which runs are watched.
    watch: &'w [u64],
    /// Place in `watch` of the next one of each lane, and the turn before it.
    place: [usize; WIDTH],
    look: [u64; WIDTH],
    pub(super) busy: Mask,
    /// Lanes before the first flight of a run that can settle.
    fresh: Mask,
    programs: ProgramLanes,
    /// True where an angle was too large for [`Near`] lately.
    far: bool,
}

/// Rules of a lane that idles, and its state at each contact.
const IDLE_RULES: Rules =
    Rules { topple_angle: 1.0, settles: false, holds_energy: true, limits: None, half_length: f64::INFINITY };
const IDLE_STATE: State = State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 };

impl<'w, M: LaneModel> LaneRuns<'w, M> {
    pub(super) fn idle(model: M, impacts: u64, watch: &'w [u64]) -> Self {
        let orbit = Orbit::at(model.idle(), IDLE_RULES, IDLE_STATE);
        Self {
            numbers: LaneNumbers::all(&orbit.body.rod, &IDLE_RULES, &IDLE_STATE, orbit.lane_state().energy),
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
                self.orbits[lane] = Orbit::at(self.model.idle(), IDLE_RULES, IDLE_STATE);
                u64::MAX
            }
        };
        let orbit = &self.orbits[lane];
        let (rules, lane_state) = (*orbit.rules(), orbit.lane_state());
        self.numbers.rods.set(lane, &orbit.body.rod, &rules);
        self.model.load(lane, &orbit.body, &lane_state);
        self.numbers.moving.set(lane, &lane_state.state, lane_state.energy);
        self.numbers.moving.max_theta[lane] = 0.0;
        self.programs.load(lane, &orbit.body.rod, orbit.body.program.as_ref());
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

    /// θ in a lane, rad.
    pub(super) fn theta(&self, lane: usize) -> f64 {
        self.numbers.moving.state(lane).theta
    }

    /// Goes on to the next watched contact of a lane.
    pub(super) fn look_ahead(&mut self, lane: usize) {
        self.place[lane] += 1;
        self.look[lane] = self.turn_before(lane, self.place[lane]);
    }

    /// The lanes whose coming contact is watched.
    pub(super) fn watched(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn == self.look[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    pub(super) fn end(&self, lane: usize) -> LaneRunEnd {
        LaneRunEnd {
            impacts: self.turn - self.first[lane],
            outcome: self.outcome[lane],
            max_theta: self.numbers.moving.max_theta[lane],
        }
    }

    /// The lanes whose last contact is behind them.
    pub(super) fn completed(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn >= self.last[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Computes contacts of all lanes with the flights after them: at most `most`, and only up to the next contact that is watched, the last
    /// of a run, or not a common one. Returns the lanes that stopped before such a contact.
    #[inline(always)]
    pub(super) fn together(&mut self, most: u64) -> Mask {
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
    pub(super) fn alone(&mut self, lane: usize) -> Option<EndingKind> {
        let size = self.theta(lane).abs();
        let max_theta = &mut self.numbers.moving.max_theta[lane];
        *max_theta = max_theta.max(size);
        let orbit = self.bring_on(lane, self.turn - 1);
        if let Some(ending) = orbit.advance().ending {
            return Some(ending.into());
        }
        let lane_state = orbit.lane_state();
        self.numbers.moving.set(lane, &lane_state.state, lane_state.energy);
        self.numbers.rods.begin(lane, lane_state.first_flight);
        self.model.load(lane, &self.orbits[lane].body, &lane_state);
        None
    }

    /// Takes a run out of its lane. Returns its number, the run before its coming contact, and the largest |θ| so far, rad.
    pub(super) fn take_out(&mut self, lane: usize) -> (usize, Orbit, f64) {
        self.busy &= !(1 << lane);
        let max_theta = self.numbers.moving.max_theta[lane];
        (self.number[lane], *self.bring_on(lane, self.turn), max_theta)
    }

    /// Brings the run of a lane to where the lane is, after so many contacts of every lane.
    fn bring_on(&mut self, lane: usize, turn: u64) -> &mut Orbit {
        let orbit = &mut self.orbits[lane];
        let mut lane_state = LaneRunState {
            n: turn - self.first[lane],
            state: self.numbers.moving.state(lane),
            energy: self.numbers.moving.energy[lane],
            first_flight: self.numbers.rods.first_flight(lane),
            ..orbit.lane_state()
        };
        self.model.save(lane, &mut lane_state);
        orbit.set_lane_state(&lane_state);
        orbit
    }
}
