//! Runs many rods side by side in lanes, each to its end: what a region of stability is made of.
//!
//! Every lane gives the bits that [`crate::map::run`] gives for its rod alone. A lane whose run has ended takes the next
//! rod at once, so that dead cells cost nothing; a bounce that is not a common one is done alone, by the map itself.

use crate::dispatch::{Path, Work, dispatch, dispatch_on};
use crate::impact::{Rod, State};
use crate::lanes::{Bounced, Far, Moving, Near, Rods, Scratch, WIDTH, bounce};
use crate::map::{Rules, contact};
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
    fn energy(&self) -> f64 {
        self.rod.strike(&self.state).energy
    }

    /// Whether it can run in lanes: a run that settles goes alone.
    pub fn fits(&self) -> bool {
        self.rules.holds_energy && !self.rules.settles && self.rules.limits.is_none()
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

/// [`sweep`] over all of `starts`: their ends, in the same order. None once `go_on` said `false`.
pub fn sweep_all(impacts: u64, starts: &[Start], go_on: &mut dyn FnMut() -> bool) -> Option<Vec<End>> {
    let mut ends = vec![None; starts.len()];
    let mut starts = starts.iter().copied().enumerate();
    sweep(impacts, || starts.next(), |number, end| ends[number] = Some(end), go_on);
    ends.into_iter().collect()
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
        let mut orbits = Orbits::idle(self.impacts);
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
struct Orbits {
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
    outcome: [Outcome; WIDTH],
    number: [usize; WIDTH],
    busy: Mask,
    /// Whether an angle was too large for [`Near`] lately.
    far: bool,
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
    rules: Rules { topple_angle: 1.0, settles: false, holds_energy: true, limits: None },
    state: State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 },
};

impl Orbits {
    fn idle(impacts: u64) -> Self {
        Self {
            rods: Rods::all(&IDLE.rod, IDLE.rules.topple_angle),
            moving: Moving::all(&IDLE.state, IDLE.energy()),
            impacts,
            turn: 0,
            first: [0; WIDTH],
            last: [u64::MAX; WIDTH],
            outcome: [Outcome::Completed; WIDTH],
            number: [0; WIDTH],
            busy: 0,
            far: false,
        }
    }

    /// Gives a lane its next run, or none.
    fn load(&mut self, lane: usize, next: Option<(usize, Start)>) {
        let (start, last) = match next {
            Some((number, start)) => {
                self.number[lane] = number;
                self.busy |= 1 << lane;
                (start, self.turn.saturating_add(self.impacts))
            }
            None => {
                self.busy &= !(1 << lane);
                (IDLE, u64::MAX)
            }
        };
        self.rods.set(lane, &start.rod, start.rules.topple_angle);
        self.moving.set(lane, &start.state, start.energy());
        self.moving.max_theta[lane] = 0.0;
        (self.first[lane], self.last[lane]) = (self.turn, last);
        self.outcome[lane] = Outcome::Completed;
    }

    fn end(&self, lane: usize) -> End {
        End {
            impacts: self.turn - self.first[lane],
            outcome: self.outcome[lane],
            max_theta: self.moving.max_theta[lane],
        }
    }

    /// The lanes whose last contact is behind them.
    fn completed(&self) -> Mask {
        (0..WIDTH).filter(|&lane| self.turn >= self.last[lane]).fold(0, |mask, lane| mask | 1 << lane)
    }

    /// Contacts of all lanes with the flights after them: at most `most`, up to the next that is somebody's last, or that is
    /// not a common one for all. Those lanes are left before it, and told.
    #[inline(always)]
    fn together(&mut self, most: u64) -> Mask {
        let most = self.last.iter().map(|last| last - self.turn).fold(most, u64::min);
        let (mut next, mut scratch) = (self.moving, Scratch::new());
        for _ in 0..most {
            self.turn += 1;
            let mut bounced = Bounced { near: false, common: false };
            if !self.far {
                bounced = bounce::<Near>(&self.rods, &self.moving, &mut next, &mut scratch);
                self.far = !bounced.near;
            }
            if self.far {
                bounced = bounce::<Far>(&self.rods, &self.moving, &mut next, &mut scratch);
                self.far = !bounced.near;
            }
            if !bounced.common {
                return self.take_common(&next, &scratch.apart);
            }
            self.moving = next;
        }
        0
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
    fn alone(&mut self, lane: usize) -> Option<Outcome> {
        let (rod, state) = (self.rods.rod(lane), self.moving.state(lane));
        let max_theta = &mut self.moving.max_theta[lane];
        *max_theta = max_theta.max(state.theta.abs());
        let rules = Rules { topple_angle: self.rods.topple_angle(lane), ..IDLE.rules };
        match contact(rod, rules, state, self.moving.energy[lane]) {
            Ok((state, energy)) => {
                self.moving.set(lane, &state, energy);
                None
            }
            Err(ending) => Some(ending.into()),
        }
    }
}
