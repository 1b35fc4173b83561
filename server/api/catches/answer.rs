//! The answer of `catches`: the strikes, the hold, what they ask of the table, and how the catch ends.

use std::borrow::Cow;

use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Candidate, Catch, CatchDemand, CatchFailure, Reach};
use equipoise_physics::catching::plan::{FEWEST_STRIKES, MOST_TRIED, StrikesReason};
use equipoise_physics::catching::settings::Approach;
use equipoise_physics::control::lqr::DesignFailure;
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::catches::columns::{OF_HOLD, of_strikes, to_table};
use crate::api::catches::outcome::{CatchOutcomeAnswer, note_text};
use crate::api::catches::request::CatchOptions;
use crate::api::formats::Tabular;
use crate::api::scene::{Derived, scene_to_json};
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::{Refusal, lacking};
use crate::api::shared::table::Table;
use crate::api::shared::table::stacked::stacked;
use crate::api::shared::weights::Weights;
use crate::charts::significant;

/// A strategy with its numbers; those that it does not have are null.
#[derive(Debug, Clone, Copy, Serialize)]
struct ApproachAnswer {
    strategy: &'static str,
    ratio: Option<f64>,
    strikes: Option<u32>,
    brake: Option<f64>,
}

impl From<Approach> for ApproachAnswer {
    fn from(approach: Approach) -> Self {
        let none = Self { strategy: approach.strategy().name(), ratio: None, strikes: None, brake: None };
        match approach {
            Approach::BounceDown { ratio } => Self { ratio: Some(ratio), ..none },
            Approach::Plan { strikes, ratio } => Self { ratio: Some(ratio), strikes: Some(strikes), ..none },
            Approach::Brake { deceleration } => Self { brake: Some(deceleration), ..none },
        }
    }
}

/// The settings that were used, defaults included.
#[derive(Debug, Clone, Copy, Serialize)]
struct SettingsAnswer {
    #[serde(flatten)]
    approach: ApproachAnswer,
    weights: Weights,
    hold_speed: f64,
    hold: f64,
    hold_samples: u64,
}

/// The strategy that was used.
#[derive(Debug, Clone, Serialize)]
pub(super) struct StrategyAnswer {
    pub(super) name: &'static str,
    pub(super) reason: String,
}

/// Largest load on the table, and the least friction of the contact. Tilt rate and stroke are null if the table did not move from one strike to
/// another.
#[derive(Debug, Clone, Copy, Serialize)]
struct DemandAnswer {
    tilt: f64,
    tilt_rate: Option<f64>,
    speed: f64,
    stroke: Option<f64>,
    travel: f64,
    normal_force: f64,
    friction: Option<f64>,
}

impl From<CatchDemand> for DemandAnswer {
    fn from(CatchDemand { load, moves, travel, least_friction, most_normal_force }: CatchDemand) -> Self {
        let ActuatorLoad { tilt, tilt_rate, speed, stroke } = load;
        let friction = Some(least_friction).filter(|friction| friction.is_finite());
        let (tilt_rate, stroke) = (moves.then_some(tilt_rate), moves.then_some(stroke));
        Self { tilt, tilt_rate, speed, stroke, travel, normal_force: most_normal_force, friction }
    }
}

/// A strategy that was compared with the others.
#[derive(Debug, Clone, Serialize)]
struct CandidateAnswer {
    #[serde(flatten)]
    approach: ApproachAnswer,
    taken: bool,
    outcome: CatchOutcomeAnswer,
    contact_from: Option<f64>,
    demand: DemandAnswer,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct ReachAnswer {
    theta: f64,
    limit: Option<f64>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct UprightAnswer {
    theta_1mrad: Option<f64>,
    x_1mm: Option<f64>,
}

/// Answer of `/v1/catches`.
#[derive(Debug, Clone, Serialize)]
pub struct CatchAnswer {
    scene: Json,
    derived: Derived,
    model: ModelChoice,
    settings: SettingsAnswer,
    pub(super) strategy: StrategyAnswer,
    candidates: Vec<CandidateAnswer>,
    /// The outcome.
    pub outcome: CatchOutcomeAnswer,
    pub(super) strikes: Table,
    pub(super) hold: Table,
    error_bound: Option<f64>,
    pub(super) contact_from: Option<f64>,
    upright_within: UprightAnswer,
    demand: DemandAnswer,
    reach: Option<ReachAnswer>,
    pub(super) notes: Vec<String>,
    /// The catch and its scene, for the picture.
    #[serde(skip)]
    pub(super) drawn: (Scene, Catch),
}

impl CatchAnswer {
    /// Catches the body of a scene.
    ///
    /// # Errors
    /// The reason for which there is no catch, or cancelled work.
    pub fn compute(scene: &Scene, options: &CatchOptions, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let caught = catch(scene, &options.settings, go_on).map_err(|why| refusal(scene, why))?;
        let friction = scene.number(Name::Friction).unwrap_or(0.0);
        let samples = caught.hold.as_ref().map_or(&[][..], |hold| &hold.samples);
        let end =
            caught.hold.as_ref().map(|hold| hold.t_end).or(caught.strikes.last().map(|last| last.t)).unwrap_or(0.0);
        let ends = |contact_from: Option<f64>| contact_from.map_or(end, |t| t + options.settings.hold);
        let candidate = |candidate: &Candidate| CandidateAnswer {
            approach: candidate.approach.into(),
            taken: candidate.taken,
            outcome: CatchOutcomeAnswer::new(
                &candidate.outcome,
                candidate.contact_from,
                ends(candidate.contact_from),
                friction,
            ),
            contact_from: candidate.contact_from,
            demand: candidate.demand.into(),
        };
        let (theta_1mrad, x_1mm) = caught.hold.as_ref().map_or((None, None), |hold| (hold.theta_within, hold.x_within));
        Ok(Self {
            scene: scene_to_json(scene),
            derived: Derived::of(scene),
            model: ModelChoice::of(scene),
            settings: SettingsAnswer {
                approach: caught.approach.into(),
                weights: Weights::new(options.settings.state_weights, options.settings.input_weight),
                hold_speed: options.settings.hold_speed,
                hold: options.settings.hold,
                hold_samples: options.hold_samples,
            },
            strategy: StrategyAnswer { name: caught.approach.strategy().name(), reason: reason(&caught) },
            candidates: caught.candidates.iter().map(candidate).collect(),
            outcome: CatchOutcomeAnswer::new(&caught.outcome, caught.contact_from, end, friction),
            strikes: to_table(of_strikes(), &caught.strikes),
            hold: to_table(OF_HOLD.iter().copied(), &thinned(samples, options.hold_samples)),
            error_bound: caught.hold.as_ref().map(|hold| hold.error_bound).filter(|bound| bound.is_finite()),
            contact_from: caught.contact_from,
            upright_within: UprightAnswer { theta_1mrad, x_1mm },
            demand: caught.demand.into(),
            reach: caught
                .reach
                .map(|Reach { theta, limit }| ReachAnswer { theta, limit: Some(limit).filter(|it| it.is_finite()) }),
            notes: caught.notes.iter().map(note_text).collect(),
            drawn: (*scene, caught),
        })
    }

    /// Number of strikes.
    pub fn strike_count(&self) -> u64 {
        self.strikes.rows() as u64
    }
}

/// Every so many of the samples, and the last: at most `most`.
fn thinned(samples: &[HoldSample], most: u64) -> Vec<HoldSample> {
    let last = samples.len().saturating_sub(1);
    let most = usize::try_from(most).unwrap_or(usize::MAX).max(2);
    let step = last.div_ceil(most - 1).max(1);
    let chosen = samples.iter().enumerate().filter(|(index, _)| index % step == 0 || *index == last);
    chosen.map(|(_, sample)| *sample).collect()
}

/// The reason for which there is no catch.
fn refusal(scene: &Scene, why: CatchFailure) -> Refusal {
    match why {
        CatchFailure::Stopped => Refusal::Cancelled,
        // Requests are not read so far with such a scene.
        CatchFailure::Point => Refusal::At("/scene", lacking(scene, Analysis::Catch).unwrap_or_default()),
        CatchFailure::NoLaw(why) => {
            Refusal::At("/weights", format!("no state feedback holds the body in contact: {}", no_law(why)))
        }
    }
}

/// The reason for which weights give no law, in a sentence.
fn no_law(why: DesignFailure) -> String {
    match why {
        DesignFailure::Diverging => {
            "the Riccati equation has no solution that the doubling finds; give theta and, without x, x_dot a weight above 0".to_owned()
        }
        DesignFailure::Inaccurate(residual) => format!(
            "the Riccati equation is solved only to {residual:e} of the solution: weights or lengths are too far apart for doubles"
        ),
        DesignFailure::Unseen(spectral_radius) => {
            format!("a deviation without a weight does not die out (spectral radius {spectral_radius})")
        }
    }
}

/// The reason for the strategy, and for the number of strikes of a plan that chose it.
fn reason(caught: &Catch) -> String {
    let three = |value: f64| significant(value, 3);
    let strikes = caught.strikes_reason.zip(strikes_of(&caught.approach)).map(|(reason, strikes)| match reason {
        StrikesReason::FewestWithin(tilt) => {
            format!("; its {strikes} strikes are the fewest with all tilts within {} rad", three(tilt))
        }
        StrikesReason::LeastTilt(tilt) => format!(
            "; no number of strikes from {FEWEST_STRIKES} to {MOST_TRIED} keeps all tilts within {} rad, and more than {strikes} hardly lower them",
            three(tilt)
        ),
    });
    strategy_reason(caught) + &strikes.unwrap_or_default()
}

/// Strikes of a plan.
fn strikes_of(approach: &Approach) -> Option<u32> {
    match *approach {
        Approach::Plan { strikes, .. } => Some(strikes),
        Approach::BounceDown { .. } | Approach::Brake { .. } => None,
    }
}

/// The reason for the strategy.
fn strategy_reason(caught: &Catch) -> String {
    if caught.settings.strategy.is_some() {
        return "as asked for".to_owned();
    }
    let before: Vec<&Candidate> = caught.candidates.iter().take_while(|candidate| !candidate.taken).collect();
    if !caught.outcome.is_caught() {
        return "no strategy catches the body; this is the first that was tried".to_owned();
    }
    let order = "the first that catches the body, in an order from strategies that ask little of the table to those that ask much";
    if before.is_empty() {
        return order.to_owned();
    }
    let ruled_out: Vec<String> = before
        .iter()
        .map(|candidate| format!("{} ends as {}", described(&candidate.approach), candidate.outcome.kind().name()))
        .collect();
    format!("{order}; before it, {}", ruled_out.join(", "))
}

/// A strategy with its numbers, in words.
fn described(approach: &Approach) -> String {
    let three = |value: f64| significant(value, 3);
    let name = approach.strategy().name();
    match *approach {
        Approach::BounceDown { ratio } => format!("{name} with ratio {}", three(ratio)),
        Approach::Plan { strikes, ratio } => format!("{name} of {strikes} strikes with ratio {}", three(ratio)),
        Approach::Brake { deceleration } => format!("{name} at {} m/s²", three(deceleration)),
    }
}

impl Tabular for CatchAnswer {
    /// Strikes, then the hold.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(stacked(&[("strike", &self.strikes), ("hold", &self.hold)]))
    }

    fn about(&self, name: &str) -> &'static str {
        let of_strikes = of_strikes().map(|column| (column.name, column.about));
        let of_hold = OF_HOLD.iter().map(|column| (column.name, column.about));
        of_strikes.chain(of_hold).find(|(own, _)| *own == name).map_or("", |(_, about)| about)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["strikes", "hold"]
    }

    fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End<'a> {
            outcome: &'a CatchOutcomeAnswer,
            settings: SettingsAnswer,
            strategy: &'a StrategyAnswer,
            error_bound: Option<f64>,
            contact_from: Option<f64>,
            upright_within: UprightAnswer,
            demand: DemandAnswer,
            reach: Option<ReachAnswer>,
            notes: &'a [String],
        }
        let Self { outcome, strategy, notes, .. } = self;
        let Self { settings, error_bound, contact_from, upright_within, demand, reach, .. } = *self;
        End { outcome, settings, strategy, error_bound, contact_from, upright_within, demand, reach, notes }
    }
}
