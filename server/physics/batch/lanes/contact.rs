//! Kinds of contact in the lanes: without friction, or with it.
//!
//! Each has a loop of its own over the lanes, so that the one without pays nothing for the other. Not here: where the table
//! is then, and the flight after ([`super::step`]).

use super::number::Lane;
use super::state::{Lanes, Moving, Rods, Scratch, WIDTH};
use crate::body::general::GeneralBody;
use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::friction::{Friction, RestitutionLaw, Slide, actual_branch};
use crate::bounce::rod::Rod;
use crate::run::ending::Ending;
use crate::run::orbit::LaneRunState;
use crate::run::rules::Rules;
use crate::table::control_law::Steering;

/// A contact point that rises faster does so by more than rounding ([`crate::bounce::strike::Strike::rises`]), at any speed up to the limit, m/s.
const SURE_RISE: f64 = 1e-8;

/// A kind of contact.
pub(crate) trait Surface {
    /// Parameter that differs from lane to lane.
    type Of: Copy;

    /// That of a lane that idles.
    const IDLE: Self::Of;

    /// Puts another into a lane.
    fn set(&mut self, lane: usize, of: Self::Of);

    /// The velocities after the strike, in all lanes; those whose run may end here are set apart.
    fn strike<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch);

    /// One contact of one lane by the map itself: where the run is then, or why it ends.
    fn contact(&self, rods: &Rods, lane: usize, midst: LaneRunState) -> Result<LaneRunState, Ending>;
}

/// Without friction, with one energy feedback in all lanes; rounding is kept off the energy, but not where a run can settle.
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
        let number = L::from_f64;
        for lane in 0..WIDTH {
            let rod = Rod { energy_feedback, ..rods.rod(lane).lift::<L>() };
            let tilt = scratch.tilt::<L>(lane);
            let mut strike = rod.strike_with(&moving.state(lane).map(number), &tilt, number(rods.leverage(lane)));
            // A run that may settle holds no energy: its own energy leaves the strike uncorrected.
            let held = if rods.settles(lane) { strike.energy } else { number(moving.energy[lane]) };
            let energy = rod.hold_energy(&mut strike, held);
            next.struck(lane, &strike, energy.to_f64(), SURE_RISE, scratch);
        }
    }
}

impl Surface for Smooth {
    type Of = ();
    const IDLE: () = ();

    #[inline(always)]
    fn set(&mut self, _: usize, (): ()) {}

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

    fn contact(&self, rods: &Rods, lane: usize, midst: LaneRunState) -> Result<LaneRunState, Ending> {
        let rod = Rod { energy_feedback: self.0, ..rods.rod(lane) };
        midst.advance(rod, Rules { holds_energy: !rods.settles(lane), ..rods.rules(lane) })
    }
}

/// Same as [`SURE_RISE`], for a contact with friction and l = 0: 1 + l²/ρ² times as much for others ([`crate::bounce::friction::rise_rounding`]).
const ROUGH_SURE_RISE: f64 = 10.0 * SURE_RISE;

/// With friction, of one law and one way to slide in all lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Rough {
    coefficient: Lanes,
    law: RestitutionLaw,
    slide: Slide,
}

impl Rough {
    pub(crate) fn new(law: RestitutionLaw, slide: Slide) -> Self {
        Self { coefficient: [Self::IDLE; WIDTH], law, slide }
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
        for lane in 0..WIDTH {
            let rod = rods.rod(lane).lift::<L>();
            let tilt = scratch.tilt::<L>(lane);
            let friction = Friction { coefficient: self.coefficient[lane], law, slide };
            let before = moving.state(lane).map(number);
            let strike = friction.strike(&rod, &before, &tilt, None, number(rods.leverage(lane)), actual_branch);
            let lever_squared = rods.lever_squared(lane);
            next.struck(lane, &strike, moving.energy[lane], ROUGH_SURE_RISE * (1.0 + lever_squared), scratch);
        }
    }
}

impl Surface for Rough {
    type Of = f64;
    const IDLE: f64 = 1.0;

    #[inline(always)]
    fn set(&mut self, lane: usize, coefficient: f64) {
        self.coefficient[lane] = coefficient;
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

    fn contact(&self, rods: &Rods, lane: usize, midst: LaneRunState) -> Result<LaneRunState, Ending> {
        let friction = Friction { coefficient: self.coefficient[lane], law: self.law, slide: self.slide };
        let general = GeneralBody {
            rod: rods.rod(lane),
            steering: Steering::TiltGain,
            program: None,
            friction: Some(friction),
            noise: None,
            outline: None,
        };
        midst.advance(general, rods.rules(lane))
    }
}
