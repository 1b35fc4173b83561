//! The answer of `catches`: the strikes, the hold, what they ask of the table, and how the catch ends.

use std::borrow::Cow;

use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Candidate, Catch, CatchDemand, CatchFailure, Reach};
use equipoise_physics::catching::plan::{FEWEST_STRIKES, MOST_TRIED, StrikesReason};
use equipoise_physics::catching::settings::{Approach, Strategy};
use equipoise_physics::control::lqr::DesignFailure;
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::catches::columns::{HoldSamples, OF_HOLD, Strikes, of_strikes, words};
use crate::api::catches::outcome::{CatchOutcomeAnswer, note_text};
use crate::api::catches::request::CatchOptions;
use crate::api::formats::Tabular;
use crate::api::scene::{Derived, Resolved, scene_to_json};
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::{Refusal, lacking};
use crate::api::shared::table::Table;
use crate::api::shared::table::columns::table_of;
use crate::api::shared::table::stacked::stacked;
use crate::api::shared::weights::Weights;
use crate::api::trajectories::hold::UprightWithin;
use crate::charts::significant;
use crate::words;

words! {
    /// Strategy of a catch.
    pub CatchStrategy = Strategy::ALL.map(Strategy::name);
}

/// A strategy with its numbers; those that it does not have are null.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct ApproachAnswer {
    #[schemars(with = "CatchStrategy")]
    strategy: &'static str,
    ratio: Option<f64>,
    strikes: Option<u32>,
    /// Acceleration of the braking table, m/s².
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

/// The settings that were used, defaults included. Null where a strategy has no such number.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "CatchUsed")]
struct SettingsAnswer {
    #[serde(flatten)]
    approach: ApproachAnswer,
    weights: Weights,
    /// Contact speed after a strike below which the lasting contact begins, m/s.
    hold_speed: f64,
    /// Time in contact, s.
    hold: f64,
    hold_samples: u64,
}

/// The strategy that was used.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "CatchReason")]
pub(super) struct StrategyAnswer {
    #[schemars(with = "CatchStrategy")]
    pub(super) name: &'static str,
    /// One sentence, with the reason for the number of strikes of a plan that chose it.
    pub(super) reason: String,
}

/// Largest motions that the catch requires of the table, and what the contact needs.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "CatchDemand")]
struct DemandAnswer {
    /// Largest tilt, rad.
    tilt: f64,
    /// Largest tilt rate, rad/s. From one strike to the next its mean, in contact the largest. Null if the table did not get from one strike to
    /// another.
    tilt_rate: Option<f64>,
    /// Largest speed of the table, m/s.
    speed: f64,
    /// Longest vertical stroke, between two strikes as in Demand or of the braking table, m. Null if the table did not get from one strike to
    /// another.
    stroke: Option<f64>,
    /// Way of the table along x in contact, end to end, m.
    travel: f64,
    /// Largest force along the normal in contact per unit mass, m/s².
    normal_force: f64,
    /// Coefficient of friction that a contact without slip needs. 0 without friction. Null if no coefficient suffices.
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

/// A strategy that `auto` compared with the others. An outcome other than `held` and `rests_on_edge` rules it out.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "CatchCandidate")]
struct CandidateAnswer {
    #[serde(flatten)]
    approach: ApproachAnswer,
    /// True for the one that was taken.
    taken: bool,
    outcome: CatchOutcomeAnswer,
    /// Time at which its lasting contact begins, s.
    contact_from: Option<f64>,
    demand: DemandAnswer,
}

/// Reach of the table as the contact begins. Null without a lasting contact.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "CatchReach")]
struct ReachAnswer {
    /// The part of the motion that grows by itself, |θ + θ̇ρ/√(Gl)|, rad. A table that tilts to α turns it back if it is below α. A contact that
    /// sticks has √(ρ² + l²) in place of ρ and the friction in place of the tilt.
    theta: f64,
    /// Largest `theta` that can be turned back, rad. Null if nothing limits the tilt.
    limit: Option<f64>,
}

/// Facts about a catch, which end its answers in JSON and NDJSON.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct CatchFacts {
    /// Estimated bound on the largest of |δx|, |ρδθ|, |δẋ| and |ρδθ̇| over the hold, m. Null without a hold, and if none is known.
    error_bound: Option<f64>,
    /// Time since the release at which the lasting contact begins, s. Null if it does not.
    pub(super) contact_from: Option<f64>,
    upright_within: UprightWithin,
    demand: DemandAnswer,
    reach: Option<ReachAnswer>,
    pub(super) notes: Vec<String>,
}

/// Answer of `/v1/catches`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Catch")]
pub struct CatchAnswer {
    #[schemars(with = "Resolved<'static>")]
    scene: Json,
    derived: Derived,
    model: ModelChoice,
    settings: SettingsAnswer,
    pub(super) strategy: StrategyAnswer,
    /// The strategies that `auto` compared; empty if one was asked for.
    candidates: Vec<CandidateAnswer>,
    /// The outcome.
    pub outcome: CatchOutcomeAnswer,
    #[schemars(with = "Strikes")]
    pub(super) strikes: Table,
    #[schemars(with = "HoldSamples")]
    pub(super) hold: Table,
    #[serde(flatten)]
    pub(super) facts: CatchFacts,
    /// The catch and its scene, for the picture.
    #[serde(skip)]
    pub(super) drawn: (Scene, Catch),
}

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "CatchEnd")]
pub(super) struct End<'a> {
    outcome: &'a CatchOutcomeAnswer,
    settings: SettingsAnswer,
    strategy: &'a StrategyAnswer,
    #[serde(flatten)]
    facts: &'a CatchFacts,
}

impl CatchAnswer {
    /// Catches the body of a scene.
    ///
    /// # Errors
    /// The reason for which there is no catch, or cancelled work.
    pub fn compute(scene: &Scene, options: &CatchOptions, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let caught = catch(scene, &options.settings, None, go_on).map_err(|why| refusal(scene, why))?;
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
                weights: Weights { state: options.settings.state_weights, input: options.settings.input_weight },
                hold_speed: options.settings.hold_speed,
                hold: options.settings.hold,
                hold_samples: options.hold_samples,
            },
            strategy: StrategyAnswer { name: caught.approach.strategy().name(), reason: reason(&caught) },
            candidates: caught.candidates.iter().map(candidate).collect(),
            outcome: CatchOutcomeAnswer::new(&caught.outcome, caught.contact_from, end, friction),
            strikes: table_of(&of_strikes(), &caught.strikes),
            hold: table_of(&OF_HOLD, &thinned(samples, options.hold_samples)),
            facts: CatchFacts {
                error_bound: caught.hold.as_ref().map(|hold| hold.error_bound).filter(|bound| bound.is_finite()),
                contact_from: caught.contact_from,
                upright_within: UprightWithin { theta_1mrad, x_1mm },
                demand: caught.demand.into(),
                reach: caught.reach.map(|Reach { theta, limit }| ReachAnswer {
                    theta,
                    limit: Some(limit).filter(|it| it.is_finite()),
                }),
                notes: caught.notes.iter().map(note_text).collect(),
            },
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
        words().iter().find(|column| column.name == name).map_or("", |column| column.about)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["strikes", "hold"]
    }

    fn end(&self) -> impl Serialize {
        let Self { outcome, settings, strategy, facts, .. } = self;
        End { outcome, settings: *settings, strategy, facts }
    }
}
