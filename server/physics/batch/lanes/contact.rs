//! Kinds of contact in the lanes: without friction, or with it.
//!
//! Each has a loop of its own over the lanes, so that the one without pays nothing for the other. Not here: where the table
//! is then, and the flight after ([`super::step`]).

use super::number::Lane;
use super::state::{Lanes, Moving, Rods, Scratch, WIDTH};
use crate::body::Body;
use crate::bounce::friction::{Friction, RestitutionLaw, Slide, actual_branch};
use crate::bounce::strike::{EnergyFeedback, Rod, Strike, TableMotion};

/// A contact point that rises faster does so by more than rounding ([`crate::bounce::strike::Strike::rises`]), at any speed up to the limit, m/s.
const SURE_RISE: f64 = 1e-8;

/// A kind of contact.
pub(crate) trait Surface {
    /// Puts the contact of a body into a lane.
    fn load(&mut self, lane: usize, body: &Body);

    /// The velocities after the strike, in all lanes; those whose run may end here are set apart.
    fn strike<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch);
}

/// Puts what a strike without friction gives into a lane, and the energy that the run should have then. Rounding is kept off the energy,
/// but not where a run can settle.
#[inline(always)]
pub(super) fn struck_smooth<L: Lane>(
    lane: usize,
    rod: &Rod<L>,
    mut strike: Strike<L>,
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
) {
    // A run that may settle holds no energy: its own energy leaves the strike uncorrected.
    let held = if rods.settles(lane) { strike.energy } else { L::from_f64(moving.energy[lane]) };
    let energy = rod.hold_energy(&mut strike, held);
    next.struck(lane, &strike, energy.to_f64(), SURE_RISE, scratch);
}

/// Without friction, with one energy feedback in all lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smooth(pub(crate) EnergyFeedback);

impl Smooth {
    /// The loop for one energy feedback, which is a constant in it.
    #[inline(always)]
    fn strike_by<L: Lane>(
        energy_feedback: EnergyFeedback,
        rods: &Rods,
        moving: &Moving,
        next: &mut Moving,
        scratch: &mut Scratch,
    ) {
        for lane in 0..WIDTH {
            let rod = Rod { energy_feedback, ..rods.rod(lane).lift::<L>() };
            let tilt = scratch.tilt::<L>(lane);
            let before = moving.state(lane).map(L::from_f64);
            let strike = rod.strike_with(&before, &tilt, L::from_f64(rods.leverage(lane)));
            struck_smooth(lane, &rod, strike, rods, moving, next, scratch);
        }
    }
}

impl Surface for Smooth {
    fn load(&mut self, _: usize, _: &Body) {}

    #[inline(always)]
    fn strike<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) {
        macro_rules! by {
            ($($feedback:ident),*) => {
                match self.0 {
                    $(EnergyFeedback::$feedback => {
                        Self::strike_by::<L>(EnergyFeedback::$feedback, rods, moving, next, scratch);
                    })*
                }
            };
        }
        by!(Vertical, Total, OneStrike);
    }
}

/// Same as [`SURE_RISE`], for a contact with friction and l = 0: 1 + l²/ρ² times as much for others ([`crate::bounce::friction::rise_rounding`]).
const ROUGH_SURE_RISE: f64 = 10.0 * SURE_RISE;

/// With friction, of one law and one way to slide in all lanes, and one energy feedback.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Rough {
    coefficient: Lanes,
    law: RestitutionLaw,
    slide: Slide,
    /// True if the tables measure the total energy; else the vertical one.
    total: bool,
}

/// Coefficient of a lane that idles.
const IDLE_COEFFICIENT: f64 = 1.0;

impl Rough {
    /// One strike to the target is for contacts without friction.
    pub(crate) fn new(law: RestitutionLaw, slide: Slide, energy_feedback: EnergyFeedback) -> Self {
        Self { coefficient: [IDLE_COEFFICIENT; WIDTH], law, slide, total: energy_feedback == EnergyFeedback::Total }
    }

    /// The loop for one law and way to slide, which are constants in it.
    #[inline(always)]
    fn strike_by<L: Lane>(
        &self,
        law: RestitutionLaw,
        slide: Slide,
        rods: &Rods,
        moving: &Moving,
        next: &mut Moving,
        scratch: &mut Scratch,
    ) {
        let number = L::from_f64;
        let energy_feedback = if self.total { EnergyFeedback::Total } else { EnergyFeedback::Vertical };
        for lane in 0..WIDTH {
            let rod = Rod { energy_feedback, ..rods.rod(lane).lift::<L>() };
            let tilt = scratch.tilt::<L>(lane);
            let friction = Friction { coefficient: number(self.coefficient[lane]), law, slide };
            let before = moving.state(lane).map(number);
            let strike =
                friction.strike(&rod, &before, &tilt, TableMotion::ByLaw, number(rods.leverage(lane)), actual_branch);
            let lever_squared = rods.lever_squared(lane);
            next.struck(lane, &strike, moving.energy[lane], ROUGH_SURE_RISE * (1.0 + lever_squared), scratch);
        }
    }
}

impl Surface for Rough {
    fn load(&mut self, lane: usize, body: &Body) {
        self.coefficient[lane] = body.friction.map_or(IDLE_COEFFICIENT, |friction| friction.coefficient);
    }

    #[inline(always)]
    fn strike<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) {
        macro_rules! by {
            ($($law:ident $slide:ident),*) => {
                match (self.law, self.slide) {
                    $((RestitutionLaw::$law, Slide::$slide) => {
                        self.strike_by::<L>(RestitutionLaw::$law, Slide::$slide, rods, moving, next, scratch);
                    })*
                }
            };
        }
        by!(Poisson None, Poisson Matched, Newton None, Newton Matched, Stronge None, Stronge Matched);
    }
}
