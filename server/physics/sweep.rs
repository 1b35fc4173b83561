//! Runs many rods side by side in lanes, each to its end: what a region of stability is made of.
//!
//! Every lane gives the bits that [`crate::map::run`] gives for its rod alone. A lane whose run has ended takes the next
//! rod at once, so that dead cells cost nothing; a flight that is not the common one goes through the scalar contact time.

use crate::contact_time::{self, Step};
use crate::dispatch::{Path, Work, dispatch, dispatch_on};
use crate::impact::{Rod, State, Strike};
use crate::lanes::{Lanes, WIDTH};
use crate::map::{Body, Rules, SPEED_LIMIT};
use crate::number::{Number, Real};
pub use crate::outcome::Outcome;

/// One run to be made.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// What bounces.
    pub rod: Rod,
    /// When it ends.
    pub rules: Rules,
    /// Just before its first contact.
    pub state: State,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Contacts, the last included.
    pub impacts: u64,
    /// The name of the ending, as [`Outcome::name`].
    pub outcome: Outcome,
    /// Largest |θ| at a contact, rad.
    pub max_theta: f64,
}

impl Start {
    /// Whether it can run in lanes: a run that settles goes alone.
    pub fn fits(&self) -> bool {
        self.rules.holds_energy && !self.rules.settles
    }
}

/// Runs of up to `impacts` contacts: `next` gives one after the other with a number of its own, `done` takes them as they
/// end, in any order. `go_on` is asked every few thousand bounces; after a `false` no more are run.
///
/// Every start has to [fit](Start::fits).
pub fn sweep(
    impacts: u64,
    next: impl FnMut() -> Option<(usize, Start)>,
    done: impl FnMut(usize, End),
    go_on: impl FnMut() -> bool,
) {
    dispatch(Sweep { impacts, next, done, go_on });
}

/// [`sweep`] with one kind of instructions, to hold all of them together.
pub fn sweep_on(
    path: Path,
    impacts: u64,
    next: impl FnMut() -> Option<(usize, Start)>,
    done: impl FnMut(usize, End),
    go_on: impl FnMut() -> bool,
) {
    dispatch_on(path, Sweep { impacts, next, done, go_on });
}

struct Sweep<Next, Done, GoOn> {
    impacts: u64,
    next: Next,
    done: Done,
    go_on: GoOn,
}

/// How often `go_on` is asked, in bounces of all lanes.
const LOOK: u64 = 1024;

impl<Next, Done, GoOn> Work for Sweep<Next, Done, GoOn>
where
    Next: FnMut() -> Option<(usize, Start)>,
    Done: FnMut(usize, End),
    GoOn: FnMut() -> bool,
{
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let mut orbits = Orbits::idle();
        for lane in 0..WIDTH {
            orbits.load(lane, (self.next)());
        }
        let mut turns: u64 = 0;
        while orbits.busy != 0 {
            turns += 1;
            if turns.is_multiple_of(LOOK) && !(self.go_on)() {
                return;
            }
            let (mut ended, outcomes) = orbits.bounce(self.impacts);
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize;
                ended &= ended - 1;
                let end =
                    End { impacts: orbits.impacts[lane], outcome: outcomes[lane], max_theta: orbits.max_theta.0[lane] };
                (self.done)(orbits.number[lane], end);
                orbits.load(lane, (self.next)());
            }
        }
    }
}

/// What an orbit holds, in lanes.
struct Orbits {
    rod: Rod<Lanes>,
    state: State<Lanes>,
    energy: Lanes,
    topple_angle: Lanes,
    max_theta: Lanes,
    impacts: [u64; WIDTH],
    number: [usize; WIDTH],
    /// A bit for each lane that has a run.
    busy: u8,
}

/// What an idle lane does: it bounces upright, for ever, and nobody looks.
const IDLE: Start = Start {
    rod: Rod {
        contact_distance: 1.0,
        radius_of_gyration: 1.0,
        gravity: 1.0,
        restitution: 1.0,
        tilt_gain: 1.0,
        strike_gain: 2.0,
        strike_gain_per_energy: 0.0,
        target_energy: 0.0,
    },
    rules: Rules { topple_angle: 1.0, settles: false, holds_energy: true },
    state: State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 },
};

impl Orbits {
    fn idle() -> Self {
        let zero = Lanes::from_f64(0.0);
        let mut orbits = Self {
            rod: IDLE.rod.lift(),
            state: State { theta: zero, x_dot: zero, y_dot: zero, theta_dot: zero },
            energy: zero,
            topple_angle: zero,
            max_theta: zero,
            impacts: [0; WIDTH],
            number: [0; WIDTH],
            busy: 0,
        };
        for lane in 0..WIDTH {
            orbits.put(lane, &IDLE);
        }
        orbits
    }

    /// Gives a lane its next run, or none.
    fn load(&mut self, lane: usize, next: Option<(usize, Start)>) {
        match next {
            Some((number, start)) => {
                self.number[lane] = number;
                self.busy |= 1 << lane;
                self.put(lane, &start);
            }
            None => {
                self.busy &= !(1 << lane);
                self.put(lane, &IDLE);
            }
        }
    }

    fn put(&mut self, lane: usize, start: &Start) {
        let Start { rod, rules, state } = start;
        for (lanes, value) in [
            (&mut self.rod.contact_distance, rod.contact_distance),
            (&mut self.rod.radius_of_gyration, rod.radius_of_gyration),
            (&mut self.rod.gravity, rod.gravity),
            (&mut self.rod.restitution, rod.restitution),
            (&mut self.rod.tilt_gain, rod.tilt_gain),
            (&mut self.rod.strike_gain, rod.strike_gain),
            (&mut self.rod.strike_gain_per_energy, rod.strike_gain_per_energy),
            (&mut self.rod.target_energy, rod.target_energy),
            (&mut self.energy, rod.strike(state).energy),
            (&mut self.topple_angle, rules.topple_angle),
            (&mut self.max_theta, 0.0),
        ] {
            lanes.0[lane] = value;
        }
        self.impacts[lane] = 0;
        self.set_state(lane, state);
    }

    fn set_state(&mut self, lane: usize, state: &State) {
        self.state.theta.0[lane] = state.theta;
        self.state.x_dot.0[lane] = state.x_dot;
        self.state.y_dot.0[lane] = state.y_dot;
        self.state.theta_dot.0[lane] = state.theta_dot;
    }

    /// One contact of every lane and the flight to the next: a bit for each run that ended, and how.
    #[inline(always)]
    fn bounce(&mut self, impacts: u64) -> (u8, [Outcome; WIDTH]) {
        let mut strike = self.rod.strike(&self.state);
        let push = strike.push;
        let size = self.state.theta.magnitude();
        self.energy = strike.hold_energy(self.energy);
        let State { x_dot, y_dot, theta_dot, .. } = strike.after;
        let spin = self.rod.contact_distance * theta_dot;
        let speed_squared = x_dot * x_dot + y_dot * y_dot + spin * spin;
        let flight = self.rod.flight(&strike);
        let start = contact_time::guess(&flight);
        let gap = flight.gap(start);
        let step = Step::new(&flight, start, &gap);
        let bulge = flight.bulge();
        self.state = flight.end(step.refined);
        let (mut ended, mut rare) = (0_u8, 0_u8);
        for lane in 0..WIDTH {
            self.impacts[lane] += 1;
            self.max_theta.0[lane] = self.max_theta.0[lane].max(size.0[lane]);
            // All of these are false where something is not a number, so the tests are for what is common.
            let goes_on = (size.0[lane] < self.topple_angle.0[lane])
                & (push.0[lane] < 0.0)
                & (speed_squared.0[lane] <= SPEED_LIMIT * SPEED_LIMIT)
                & (strike.contact_rise.0[lane] > 0.0);
            let common = (bulge.0[lane] <= flight.gravity.0[lane])
                & (gap.slope.0[lane] < 0.0)
                & (start.0[lane] > 0.0)
                & (step.left_out.0[lane] <= step.negligible.0[lane]);
            ended |= u8::from(!goes_on | (self.impacts[lane] >= impacts)) << lane;
            rare |= u8::from(goes_on & !common) << lane;
        }
        let mut outcomes = [Outcome::Completed; WIDTH];
        rare &= self.busy;
        while rare != 0 {
            let lane = rare.trailing_zeros() as usize;
            rare &= rare - 1;
            match fly_alone(pick_rod(&self.rod, lane), pick_strike(&strike, lane)) {
                Some(state) => self.set_state(lane, &state),
                None => {
                    ended |= 1 << lane;
                    outcomes[lane] = Outcome::Diverged;
                }
            }
        }
        ended &= self.busy;
        let mut look = ended;
        while look != 0 {
            let lane = look.trailing_zeros() as usize;
            look &= look - 1;
            // In the order of `Orbit::advance`.
            if size.0[lane] >= self.topple_angle.0[lane] {
                outcomes[lane] = Outcome::Toppled;
            } else if push.0[lane] >= 0.0 {
                outcomes[lane] = Outcome::Separating;
            } else if speed_squared.0[lane].is_nan() || speed_squared.0[lane] > SPEED_LIMIT * SPEED_LIMIT {
                outcomes[lane] = Outcome::Diverged;
            } else if strike.contact_rise.0[lane] <= 0.0 {
                outcomes[lane] = Outcome::Sinking;
            }
        }
        (ended, outcomes)
    }
}

/// The flight of one lane, by the scalar contact time.
#[cold]
#[inline(never)]
fn fly_alone(rod: Rod, strike: Strike) -> Option<State> {
    Some(rod.fly(&strike).ok()?.1)
}

fn pick_rod(rod: &Rod<Lanes>, lane: usize) -> Rod {
    Rod {
        contact_distance: rod.contact_distance.0[lane],
        radius_of_gyration: rod.radius_of_gyration.0[lane],
        gravity: rod.gravity.0[lane],
        restitution: rod.restitution.0[lane],
        tilt_gain: rod.tilt_gain.0[lane],
        strike_gain: rod.strike_gain.0[lane],
        strike_gain_per_energy: rod.strike_gain_per_energy.0[lane],
        target_energy: rod.target_energy.0[lane],
    }
}

fn pick_strike(strike: &Strike<Lanes>, lane: usize) -> Strike {
    let pick = |lanes: Lanes| lanes.0[lane];
    let State { theta, x_dot, y_dot, theta_dot } = strike.after;
    Strike {
        after: State { theta: pick(theta), x_dot: pick(x_dot), y_dot: pick(y_dot), theta_dot: pick(theta_dot) },
        alpha: pick(strike.alpha),
        sin_cos_theta: (pick(strike.sin_cos_theta.0), pick(strike.sin_cos_theta.1)),
        normal_velocity: pick(strike.normal_velocity),
        push: pick(strike.push),
        approach: pick(strike.approach),
        table_velocity: (pick(strike.table_velocity.0), pick(strike.table_velocity.1)),
        impulse_normal: pick(strike.impulse_normal),
        contact_rise: pick(strike.contact_rise),
        speed_squared: pick(strike.speed_squared),
        energy: pick(strike.energy),
        energy_gain: pick(strike.energy_gain),
    }
}
