//! Runs many rods side by side in lanes, each to its end: what a region of stability is made of.
//!
//! Every lane gives the bits that [`crate::run::orbit::run`] gives for its rod alone. A lane whose run has ended takes the next
//! rod at once, so that dead cells cost nothing; a bounce that is not a common one is done alone, by the map itself.

use crate::batch::lanes::{Bounced, Far, Moving, Near, Rods, Rough, Scratch, Smooth, Surface, WIDTH, bounce_lanes};
use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::friction::{RestitutionLaw, Slide};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::numbers::dispatch::{InstructionSet, Kernel, dispatch, dispatch_on};
use crate::run::ending::EndingKind;
use crate::run::orbit::LaneRunState;
use crate::run::rules::Rules;

/// One run to be made.
#[derive(Clone, Copy, Debug)]
pub struct RunStart {
    /// Body that bounces.
    pub rod: Rod,
    /// Rules that end it.
    pub rules: Rules,
    /// Just before its first contact.
    pub state: State,
}

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

impl RunStart {
    fn energy(&self) -> f64 {
        self.rod.strike(&self.state).energy
    }
}

/// Runs of up to `impacts` contacts: `next` gives one after the other with a number of its own, `done` takes them as they
/// end, in any order. `go_on` is asked every few thousand bounces; after a `false` no more are run.
///
/// No table may be limited: lanes do not look. All have the energy feedback [`EnergyFeedback::Vertical`].
pub fn run_batch(
    impacts: u64,
    next: impl FnMut() -> Option<(usize, RunStart)>,
    done: impl FnMut(usize, LaneRunEnd),
    go_on: impl FnMut() -> bool,
) {
    run_batch_with_feedback(EnergyFeedback::Vertical, impacts, next, done, go_on);
}

/// [`run_batch`] of tables with one energy feedback, whatever that of the rods is.
pub fn run_batch_with_feedback(
    feedback: EnergyFeedback,
    impacts: u64,
    mut next: impl FnMut() -> Option<(usize, RunStart)>,
    done: impl FnMut(usize, LaneRunEnd),
    go_on: impl FnMut() -> bool,
) {
    let next = || next().map(|(number, start)| (number, start, ()));
    dispatch(BatchRun { surface: Smooth(feedback), impacts, next, done, go_on });
}

/// [`run_batch`] with friction of one law and one way to slide: `next` gives its coefficient too.
pub fn run_batch_with_friction(
    (law, slide): (RestitutionLaw, Slide),
    impacts: u64,
    next: impl FnMut() -> Option<(usize, RunStart, f64)>,
    done: impl FnMut(usize, LaneRunEnd),
    go_on: impl FnMut() -> bool,
) {
    dispatch(BatchRun { surface: Rough::new(law, slide), impacts, next, done, go_on });
}

/// [`run_batch_with_feedback`] over all of `starts`, with the feedback of the first: their ends, in the same order. None once `go_on`
/// said `false`.
pub fn run_all(impacts: u64, starts: &[RunStart], go_on: &mut dyn FnMut() -> bool) -> Option<Vec<LaneRunEnd>> {
    let feedback = starts.first().map_or(EnergyFeedback::Vertical, |first| first.rod.energy_feedback);
    let mut ends = vec![None; starts.len()];
    let mut starts = starts.iter().copied().enumerate();
    run_batch_with_feedback(feedback, impacts, || starts.next(), |number, end| ends[number] = Some(end), go_on);
    ends.into_iter().collect()
}

/// [`run_batch`] with one kind of instructions, to hold all of them together.
pub fn run_batch_on(
    path: InstructionSet,
    impacts: u64,
    mut next: impl FnMut() -> Option<(usize, RunStart)>,
    done: impl FnMut(usize, LaneRunEnd),
    go_on: impl FnMut() -> bool,
) {
    let next = || next().map(|(number, start)| (number, start, ()));
    dispatch_on(path, BatchRun { surface: Smooth(EnergyFeedback::Vertical), impacts, next, done, go_on });
}

/// [`run_batch_with_friction`] with one kind of instructions.
pub fn run_batch_with_friction_on(
    path: InstructionSet,
    (law, slide): (RestitutionLaw, Slide),
    impacts: u64,
    next: impl FnMut() -> Option<(usize, RunStart, f64)>,
    done: impl FnMut(usize, LaneRunEnd),
    go_on: impl FnMut() -> bool,
) {
    dispatch_on(path, BatchRun { surface: Rough::new(law, slide), impacts, next, done, go_on });
}

struct BatchRun<S, Next, Done, GoOn> {
    surface: S,
    impacts: u64,
    next: Next,
    done: Done,
    go_on: GoOn,
}

/// Bounces of all lanes between two questions whether to go on.
const LOOK: u64 = 256;

impl<S, Next, Done, GoOn> Kernel for BatchRun<S, Next, Done, GoOn>
where
    S: Surface,
    Next: FnMut() -> Option<(usize, RunStart, S::Of)>,
    Done: FnMut(usize, LaneRunEnd),
    GoOn: FnMut() -> bool,
{
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let mut orbits = LaneRuns::idle(self.surface, self.impacts);
        for lane in 0..WIDTH {
            orbits.load(lane, (self.next)());
        }
        let mut looked = 0;
        while orbits.busy != 0 {
            if orbits.turn >= looked + LOOK {
                looked = orbits.turn;
                if !(self.go_on)() {
                    return;
                }
            }
            let apart = orbits.together(LOOK) & orbits.busy;
            let mut ended = orbits.completed();
            for lane in bits(apart) {
                if let Some(outcome) = orbits.alone(lane) {
                    ended |= 1 << lane;
                    orbits.outcome[lane] = outcome;
                }
            }
            for lane in bits(ended & orbits.busy) {
                (self.done)(orbits.number[lane], orbits.end(lane));
                orbits.load(lane, (self.next)());
            }
        }
    }
}

/// A bit for each lane.
type Mask = u16;

/// The lanes of a mask.
fn bits(mut mask: Mask) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane
        })
    })
}

/// Orbits side by side.
struct LaneRuns<S> {
    surface: S,
    rods: Rods,
    moving: Moving,
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
    busy: Mask,
    /// Lanes before the first flight of a run that can settle.
    fresh: Mask,
    /// True where an angle was too large for [`Near`] lately.
    far: bool,
}

/// Run of an idle lane: it bounces upright, for ever, and nobody looks.
const IDLE: RunStart = RunStart {
    rod: Rod {
        contact_distance: 1.0,
        radius_of_gyration: 1.0,
        gravity: 1.0,
        restitution: 1.0,
        tilt_gain: 1.0,
        strike_gain: 2.0,
        strike_gain_per_energy: 0.0,
        // Its own energy, so that no feedback changes it.
        target_energy: 1.5,
        energy_feedback: EnergyFeedback::Vertical,
    },
    rules: Rules { topple_angle: 1.0, settles: false, holds_energy: true, limits: None },
    state: State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 },
};

impl<S: Surface> LaneRuns<S> {
    fn idle(surface: S, impacts: u64) -> Self {
        Self {
            surface,
            rods: Rods::all(&IDLE.rod, &IDLE.rules),
            moving: Moving::all(&IDLE.state, IDLE.energy()),
            impacts,
            turn: 0,
            first: [0; WIDTH],
            last: [u64::MAX; WIDTH],
            outcome: [EndingKind::Completed; WIDTH],
            number: [0; WIDTH],
            busy: 0,
            fresh: 0,
            far: false,
        }
    }

    /// Gives a lane its next run, or none.
    fn load(&mut self, lane: usize, next: Option<(usize, RunStart, S::Of)>) {
        let (start, of, last) = match next {
            Some((number, start, of)) => {
                self.number[lane] = number;
                self.busy |= 1 << lane;
                (start, of, self.turn.saturating_add(self.impacts))
            }
            None => {
                self.busy &= !(1 << lane);
                (IDLE, S::IDLE, u64::MAX)
            }
        };
        self.rods.set(lane, &start.rod, &start.rules);
        self.surface.set(lane, of);
        self.moving.set(lane, &start.state, start.energy());
        self.moving.max_theta[lane] = 0.0;
        self.fresh &= !(1 << lane);
        self.fresh |= u16::from(start.rules.settles) << lane;
        (self.first[lane], self.last[lane]) = (self.turn, last);
        self.outcome[lane] = EndingKind::Completed;
    }

    fn end(&self, lane: usize) -> LaneRunEnd {
        LaneRunEnd {
            impacts: self.turn - self.first[lane],
            outcome: self.outcome[lane],
            max_theta: self.moving.max_theta[lane],
        }
    }

    /// The lanes whose last contact is behind them.
    fn completed(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn >= self.last[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Computes contacts of all lanes with the flights after them: at most `most`, and only up to the next contact that is the last of a
    /// run or not a common one. Returns the lanes that stopped before such a contact.
    #[inline(always)]
    fn together(&mut self, most: u64) -> Mask {
        let most = self.last.iter().map(|last| last - self.turn).fold(most, u64::min);
        let (mut next, mut scratch) = (self.moving, Scratch::new());
        for _ in 0..most {
            self.turn += 1;
            let mut bounced = Bounced { near: false, common: false };
            if !self.far {
                bounced = bounce_lanes::<Near, S>(&self.surface, &self.rods, &self.moving, &mut next, &mut scratch);
                self.far = !bounced.near;
            }
            if self.far {
                bounced = bounce_lanes::<Far, S>(&self.surface, &self.rods, &self.moving, &mut next, &mut scratch);
                self.far = !bounced.near;
            }
            if self.fresh != 0 {
                self.begin(&scratch);
            }
            if !bounced.common {
                return self.take_common(&next, &scratch.apart);
            }
            self.moving = next;
        }
        0
    }

    /// Keeps the first flights of runs that can settle; those that were no common ones are made alone.
    #[inline(never)]
    fn begin(&mut self, scratch: &Scratch) {
        for lane in bits(std::mem::take(&mut self.fresh)) {
            if let Some(first_flight) = scratch.flight_time(lane) {
                self.rods.begin(lane, first_flight);
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn take_common(&mut self, next: &Moving, apart: &[u64; WIDTH]) -> Mask {
        let mut mask = 0;
        for (lane, apart) in apart.iter().enumerate() {
            if *apart == 0 { self.moving.take(lane, next) } else { mask |= 1 << lane }
        }
        mask
    }

    /// One contact of one lane: how its run ends there, if it does.
    #[cold]
    #[inline(never)]
    fn alone(&mut self, lane: usize) -> Option<EndingKind> {
        let theta = self.moving.state(lane).theta;
        let max_theta = &mut self.moving.max_theta[lane];
        *max_theta = max_theta.max(theta.abs());
        match self.surface.contact(&self.rods, lane, self.rods.midst(&self.moving, lane)) {
            Ok(LaneRunState { state, energy, first_flight }) => {
                self.moving.set(lane, &state, energy);
                self.rods.begin(lane, first_flight);
                None
            }
            Err(ending) => Some(ending.into()),
        }
    }
}
