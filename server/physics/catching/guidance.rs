//! Guidance of the table: the motion for each coming contact, by the strategy of the catch.

use crate::catching::aim::{Aim, GainSchedule};
use crate::catching::outcome::{CatchNote, Escape};
use crate::catching::plan::{
    LearnedRestitution, NextStrike, PlanFailure, PlanProblem, Replanner, StrikesReason, believed_body, choose_plan,
};
use crate::catching::settings::{Approach, CatchSettings, DEFAULT_RATIO, MOST_PLANNED_TILT};
use crate::map::body::{Body, PreImpact};
use crate::map::bounce::Guide;
use crate::map::strike::{PlannedTableMotion, Rod, State, Strike};
use crate::map::table::control_law::Gains;
use crate::map::table::noise::ContactErrors;
use crate::map::table::sensing::SensedContact;
use crate::scene::Scene;

/// Largest tilt of a strike by the gain schedule, rad. A steeper table turns a body more than it lifts it.
const STEEPEST: f64 = 0.6;

type AimedStrike = (f64, PlannedTableMotion);

/// Guide of a catch. It decides contact by contact, from what it senses and believes.
pub struct Catcher<'a> {
    /// The body with the restitution that the table believes in.
    believed: Body,
    /// The strategy with its numbers, as it was used.
    pub(super) approach: Approach,
    /// The strategy of the coming strike: another one once a plan is done or was given up.
    now: Approach,
    body: &'a Body,
    scene: &'a Scene,
    settings: &'a CatchSettings,
    /// Reason for the number of strikes of a plan that chose it.
    pub(super) strikes_reason: Option<StrikesReason>,
    /// Restitution that the strikes of the plan have shown.
    learned: LearnedRestitution,
    /// Makes the plan again at each strike.
    planner: Option<Replanner>,
    /// Height ratio that the strike of the coming contact aims at; `None` if the table meets the body at the speed of the contact point and
    /// stays with it, and an error if it cannot go on.
    pub(super) aimed: Result<Option<f64>, Escape>,
    notes: Vec<CatchNote>,
    /// Asked now and then whether to go on. Once it says `false`, decisions mean nothing any more.
    pub(super) go_on: &'a mut dyn FnMut() -> bool,
}

impl<'a> Catcher<'a> {
    /// A guide by `approach` for a body on its table. A plan without a number of strikes chooses it at its first contact.
    pub(super) fn new(
        body: &'a Body,
        scene: &'a Scene,
        approach: Approach,
        settings: &'a CatchSettings,
        go_on: &'a mut dyn FnMut() -> bool,
    ) -> Self {
        let believed = Rod { restitution: scene.specified_restitution(), ..body.rod };
        let believed = believed_body(believed, body.friction.map_or(0.0, |friction| friction.coefficient));
        Self {
            believed: Body { drag: body.drag, ..believed },
            approach,
            now: approach,
            body,
            scene,
            settings,
            strikes_reason: None,
            learned: LearnedRestitution::default(),
            planner: None,
            aimed: Ok(None),
            notes: Vec::new(),
            go_on,
        }
    }

    /// The facts that were noticed, and the restitution that strikes showed in place of the one that the table believed in.
    pub(super) fn into_notes(mut self, assumed: f64) -> Vec<CatchNote> {
        let shown = self.believed.rod.restitution;
        if shown != assumed {
            self.notes.push(CatchNote::LearnedRestitution { assumed, shown });
        }
        self.notes
    }

    /// A strike of `ratio` at the tilt of the gain schedule.
    fn bounce_down(&self, seen: &PreImpact, sensed: &State, ratio: f64) -> Result<AimedStrike, Escape> {
        let alpha = self.gains(seen, ratio)?.tilt(seen.x, sensed).clamp(-STEEPEST, STEEPEST);
        self.aim(seen, alpha, ratio)
    }

    fn gains(&self, seen: &PreImpact, ratio: f64) -> Result<Gains, Escape> {
        let speed = -self.believed.rod.contact_speed(&seen.state);
        let CatchSettings { state_weights, input_weight, .. } = *self.settings;
        GainSchedule { body: *self.body, ratio, state_weights, input_weight }
            .gain(speed)
            .map_err(|_| Escape::NoLaw(speed))
    }

    /// The coming strike of a plan of `strikes` strikes of `ratio` and a stop.
    fn planned(
        &mut self,
        seen: &PreImpact,
        sensed: &State,
        (strikes, ratio): (u32, f64),
    ) -> Result<AimedStrike, Escape> {
        let coming = PreImpact { state: *sensed, ..*seen };
        if let Some(shown) = self.learned.seen(&self.believed, &coming) {
            self.believed.rod.restitution = shown;
        }
        let most_tilt = self.scene.limits().map_or(MOST_PLANNED_TILT, |limits| limits.tilt.min(MOST_PLANNED_TILT));
        let is_first = self.planner.is_none();
        let next = match &mut self.planner {
            Some(planner) => {
                planner.believe(self.believed.rod.restitution);
                planner.next(&coming, self.go_on)
            }
            None => self.begin_plan(&coming, strikes, ratio),
        };
        match next {
            Ok(NextStrike { alpha, ratio }) if ratio > 0.0 && (is_first || alpha.abs() <= most_tilt) => {
                self.learned.aimed(&self.believed, &coming, alpha, ratio);
                self.aim(seen, alpha, ratio)
            }
            Ok(NextStrike { alpha, ratio }) if ratio == 0.0 => {
                self.now = Approach::BounceDown(DEFAULT_RATIO);
                // A strike without a flight has no gain of its own: it takes that of strikes that keep the height.
                let gains = self.gains(seen, 1.0)?;
                self.aim(seen, alpha + gains.tilt(seen.x, sensed), ratio)
            }
            Err(failure) if is_first => Err(Escape::NoPlan(failure)),
            Ok(_) | Err(_) => {
                self.now = Approach::BounceDown(DEFAULT_RATIO);
                self.notes.push(CatchNote::PlanGivenUp(seen.n));
                self.bounce_down(seen, sensed, DEFAULT_RATIO)
            }
        }
    }

    fn begin_plan(&mut self, coming: &PreImpact, strikes: u32, ratio: f64) -> Result<NextStrike, PlanFailure> {
        let mut problem = PlanProblem { body: self.believed, strikes, ratio };
        if self.settings.strikes.is_none() {
            // Where no plan is within the limits, the run tells which limit the one of least tilt passes.
            let within = choose_plan(&problem, coming, self.scene.limits().as_ref(), self.go_on);
            let chosen = match (within, self.scene.limits()) {
                (Err(_), Some(_)) => choose_plan(&problem, coming, None, self.go_on),
                (within, _) => within,
            }?;
            problem.strikes = chosen.strikes;
            self.approach = Approach::Plan { strikes: chosen.strikes, ratio };
            self.strikes_reason = Some(chosen.reason);
        }
        let mut planner = Replanner::new(problem)?;
        let next = planner.next(coming, self.go_on);
        self.planner = Some(planner);
        next
    }

    /// A strike at tilt `alpha` (rad) with the height ratio `ratio`.
    fn aim(&self, seen: &PreImpact, alpha: f64, ratio: f64) -> Result<AimedStrike, Escape> {
        let aim = Aim::new(&self.believed, &seen.state, alpha);
        let impulse = aim.impulse_for(ratio);
        // An impulse that is not a number does not push either.
        if impulse.gt(&0.0) { Ok((ratio, aim.motion(impulse))) } else { Err(Escape::NoLift(alpha)) }
    }

    /// A contact with the place and the velocities that the table senses, and the error with which it senses the angle, rad.
    fn sensed(&self, seen: &PreImpact, angle_error: f64) -> (PreImpact, f64) {
        let errors = ContactErrors { angle: angle_error, ..self.body.errors(seen.n) };
        // It carries errors on to the strike as without air.
        let body = Body { drag: None, ..*self.body };
        let sensed = body.sensed(&errors, body.rod.gravity, seen.x, &seen.state, None);
        sensed.map_or((*seen, angle_error), |SensedContact { x, state, angle_error }| {
            (PreImpact { x, state, ..*seen }, angle_error)
        })
    }

    /// The strike of a coming contact; `None` if the table follows the body.
    fn strike(&mut self, seen: &PreImpact, angle_error: f64) -> Result<Option<AimedStrike>, Escape> {
        if self.believed.rod.contact_speed(&seen.state) >= 0.0 {
            // Struck early or late while it rises.
            return Ok(None);
        }
        let sensed = State { theta: seen.state.theta + angle_error, ..seen.state };
        match self.now {
            Approach::BounceDown(ratio) => self.bounce_down(seen, &sensed, ratio).map(Some),
            Approach::Plan { strikes, ratio } => self.planned(seen, &sensed, (strikes, ratio)).map(Some),
            Approach::Brake(_) => Ok(None),
        }
    }
}

impl Guide for Catcher<'_> {
    fn motion(&mut self, seen: &PreImpact, angle_error: f64) -> Option<PlannedTableMotion> {
        let errors = self.scene.leaning_errors();
        let (sensed, angle_error) = self.sensed(seen, angle_error);
        let strike = self.strike(&sensed, angle_error + errors.angle_bias);
        self.aimed = strike.map(|strike| strike.map(|(ratio, _)| ratio));
        strike.ok().flatten().map(|(_, motion)| errors.executed(&motion))
    }

    fn stays(&self, strike: &Strike) -> bool {
        strike.contact_rise < self.settings.hold_speed
    }
}
