//! Search for the tilt and speed of a table with friction that give a body the velocities of a throw.
//!
//! For each tilt, one speed of the table gives the vertical velocity ẏ⁺. The tilts are looked through from level to both sides until the
//! spin θ̇⁺ changes sides of the wanted one, so that of several tilts the least is found. Both searches are Newton's with halving,
//! on the exact strike in dual numbers.

use crate::bounce::friction::{Friction, Slide, actual_branch, tangential_velocity};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::table_motion::{PlannedTableMotion, TableMotion};
use crate::bounce::tilt::Tilt;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use std::f64::consts::FRAC_PI_2;

/// Number of tilts that are tried on each side.
const TILTS: u32 = 96;

/// Largest number of steps of one root, and of doublings of a speed.
const MAX_STEPS: u32 = 128;

/// Largest error of a spin that counts as found, as a share of the spins involved.
const FOUND: f64 = 1e-10;

/// A root of a strike: the value of a quantity and its slope.
type ValueAndSlope = (f64, f64);

struct Search<'a> {
    rod: &'a Rod,
    friction: &'a Friction,
    state: &'a State,
    rise: f64,
    spin: f64,
    steps: u32,
}

/// A tilt, and the strike there that gives the wanted rise.
#[derive(Clone, Copy)]
struct Candidate {
    alpha: f64,
    /// Speed at which table and contact point approach each other along the normal, m/s.
    approach: f64,
    /// θ̇⁺ less the wanted one, rad/s.
    miss: f64,
    /// Derivative by α.
    slope: f64,
}

/// Motion of the table that gives ẏ⁺ = `rise` (m/s) and θ̇⁺ = `spin` (rad/s) with the least tilt, and the steps that it took.
///
/// # Errors
/// Least and largest spin that is reached, if any tilt gives the rise.
pub(super) fn motion(
    rod: &Rod,
    friction: &Friction,
    state: &State,
    rise: f64,
    spin: f64,
) -> Result<(PlannedTableMotion, u32), Option<(f64, f64)>> {
    let mut search = Search { rod, friction, state, rise, spin, steps: 0 };
    let level = search.candidate(0.0);
    let mut nearest = [level, level];
    let mut reach: Option<(f64, f64)> = None;
    let mut widen = |miss: f64| {
        let (least, most) = reach.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
        reach = Some((least.min(spin + miss), most.max(spin + miss)));
    };
    if let Some(level) = level {
        widen(level.miss);
    }
    for ring in 1..=TILTS {
        let tilt = FRAC_PI_2 * f64::from(ring) / f64::from(TILTS + 1);
        let mut found: Option<Candidate> = None;
        for (last, alpha) in nearest.iter_mut().zip([tilt, -tilt]) {
            let next = search.candidate(alpha);
            if let (Some(from), Some(to)) = (*last, next)
                && let Some(root) = search.between(&from, &to)
                && found.is_none_or(|found| root.alpha.abs() < found.alpha.abs())
            {
                found = Some(root);
            }
            if let Some(next) = next {
                widen(next.miss);
            }
            *last = next;
        }
        if let Some(found) = found {
            return Ok((search.motion(found.alpha, found.approach), search.steps));
        }
    }
    Err(reach)
}

impl Search<'_> {
    /// Vertical velocity and spin after a strike, differentiated by tilt and approach.
    fn strike(&mut self, alpha: f64, approach: f64) -> (Dual<2>, Dual<2>) {
        self.steps += 1;
        let (rod, state) = (self.rod.lift::<Dual<2>>(), self.state.map(Dual::<2>::from_f64));
        let plan = guided(&rod, self.friction.slide, &state, Dual::along(alpha, 0, 1.0), Dual::along(approach, 1, 1.0));
        let tilt = Tilt::new(state.theta, plan.alpha, state.theta - plan.alpha);
        let strike = self.friction.map(Dual::from_f64).strike(
            &rod,
            &state,
            &tilt,
            TableMotion::Planned(&plan),
            rod.leverage(),
            actual_branch,
        );
        (strike.after.y_dot, strike.after.theta_dot)
    }

    fn motion(&self, alpha: f64, approach: f64) -> PlannedTableMotion {
        guided(self.rod, self.friction.slide, self.state, alpha, approach)
    }

    /// The strike at a tilt that gives the rise; `None` if no speed does.
    fn candidate(&mut self, alpha: f64) -> Option<Candidate> {
        let mut fast = self.rise - self.state.y_dot;
        let mut doublings = 0;
        while self.strike(alpha, fast).0.value < self.rise {
            fast *= 2.0;
            doublings += 1;
            if doublings == MAX_STEPS || !fast.is_finite() {
                return None;
            }
        }
        let approach = root_between(0.0, fast, |approach| {
            let (rise, _) = self.strike(alpha, approach);
            Some((rise.value - self.rise, rise.partials[1]))
        })?;
        let (rise, spin) = self.strike(alpha, approach);
        // The approach follows the tilt so that the rise stays.
        let follow = rise.partials[0] / rise.partials[1];
        let slope = spin.partials[0] - spin.partials[1] * follow;
        Some(Candidate { alpha, approach, miss: spin.value - self.spin, slope })
    }

    /// The strike between two tilts that gives the spin, if that lies between theirs.
    fn between(&mut self, from: &Candidate, to: &Candidate) -> Option<Candidate> {
        if (from.miss < 0.0) == (to.miss < 0.0) && from.miss != 0.0 {
            return None;
        }
        if from.miss == 0.0 {
            return Some(*from);
        }
        let (low, high) = if from.miss < 0.0 { (from.alpha, to.alpha) } else { (to.alpha, from.alpha) };
        let alpha = root_between(low, high, |alpha| {
            let candidate = self.candidate(alpha)?;
            Some((candidate.miss, candidate.slope))
        })?;
        let scale = self.spin.abs() + self.state.theta_dot.abs() + self.rise / self.rod.contact_distance;
        // A jump of the strike is no root.
        self.candidate(alpha).filter(|candidate| candidate.miss.abs() <= FOUND * scale)
    }
}

/// Motion of a table that comes towards the contact point at a relative speed `approach` along its normal.
fn guided<N: Number>(rod: &Rod<N>, slide: Slide, state: &State<N>, alpha: N, approach: N) -> PlannedTableMotion<N> {
    let tilt = Tilt::new(state.theta, alpha, state.theta - alpha);
    let arm = rod.contact_distance * tilt.sin_beta;
    let normal_velocity = tilt.cos_alpha * state.y_dot - tilt.sin_alpha * state.x_dot + arm * state.theta_dot;
    PlannedTableMotion {
        alpha,
        normal_velocity: normal_velocity + approach,
        tangential_velocity: match slide {
            Slide::None => N::from_f64(0.0),
            Slide::Matched => tangential_velocity(rod, state, &tilt),
        },
    }
}

/// Root of a function that is below 0 at `low` and not at `high`, by Newton's steps, or halves where those leave the bracket.
fn root_between(mut low: f64, mut high: f64, mut function: impl FnMut(f64) -> Option<ValueAndSlope>) -> Option<f64> {
    let mut at = 0.5 * (low + high);
    for _ in 0..MAX_STEPS {
        let (value, slope) = function(at)?;
        if value < 0.0 {
            low = at;
        } else {
            high = at;
        }
        let newton = at - value / slope;
        let inside = newton > low.min(high) && newton < low.max(high);
        let next = if inside { newton } else { 0.5 * (low + high) };
        if next == at || value == 0.0 || (next - at).abs() <= f64::EPSILON * at.abs() {
            return Some(at);
        }
        at = next;
    }
    Some(at)
}
