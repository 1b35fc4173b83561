//! `/v1/catches`: bring a falling body to rest on the table, and hold it.

pub mod outcome;
pub mod request;

use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Candidate, Catch, CatchDemand, CatchFailure, CatchStrike, Reach};
use equipoise_physics::catching::plan::{FEWEST_STRIKES, MOST_TRIED, StrikesReason};
use equipoise_physics::catching::settings::{Approach, Strategy};
use equipoise_physics::control::lqr::DesignFailure;
use equipoise_physics::map::body::Release;
use equipoise_physics::map::table::actuator_load::{ActuatorLoad, height_between};
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::scene::{Name, Scene};

use crate::api::computed::catches::outcome::{CatchOutcomeAnswer, note_text};
use crate::api::computed::catches::request::{CatchOptions, CatchRequest};
use crate::api::computed::trajectories::columns::{
    HoldSamples, OF_HOLD, Strikes, UprightWithin, catch_words, of_strikes,
};
use crate::api::prelude::*;
use crate::api::shared::request_parts::Weights;
use crate::api::shared::stacked::stacked;
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, PanelNames, Plot, readable_chart};

impl ComputedResource for CatchRequest {
    const NAME: &'static str = "catches";
    const SINGULAR: &'static str = "Catch";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let answer = CatchAnswer::compute(&request.scene, &request.options, &mut || slice.should_continue())?;
            bounces.inc_by(answer.strike_count());
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<CatchAnswer>()
            .table(
                "One row for each strike (`phase` strike), then one for each moment of the hold (`phase` hold).",
                catch_words(),
            )
            .end::<CatchEnd<'static>>()
            .refuses(Analysis::Catch);
    }
}

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
            Approach::BounceDown(ratio) => Self { ratio: Some(ratio), ..none },
            Approach::Plan { strikes, ratio } => Self { ratio: Some(ratio), strikes: Some(strikes), ..none },
            Approach::Brake(deceleration) => Self { brake: Some(deceleration), ..none },
        }
    }
}

/// The settings that were used, defaults included. Null where a strategy has no such number.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct CatchUsed {
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
struct CatchReason {
    #[schemars(with = "CatchStrategy")]
    name: &'static str,
    /// One sentence, with the reason for the number of strikes of a plan that chose it.
    reason: String,
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
struct CatchCandidate {
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
struct CatchReach {
    /// The part of the motion that grows by itself, |θ + θ̇ρ/√(Gl)|, rad. A table that tilts to α turns it back if it is below α. A contact that
    /// sticks has √(ρ² + l²) in place of ρ and the friction in place of the tilt.
    theta: f64,
    /// Largest `theta` that can be turned back, rad. Null if nothing limits the tilt.
    limit: Option<f64>,
}

/// Facts about a catch, which end its answers in JSON and NDJSON.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct CatchFacts {
    /// Estimated bound on the largest of |δx|, |ρδθ|, |δẋ| and |ρδθ̇| over the hold, m. Null without a hold, and if none is known.
    error_bound: Option<f64>,
    /// Time since the release at which the lasting contact begins, s. Null if it does not.
    contact_from: Option<f64>,
    upright_within: UprightWithin,
    demand: DemandAnswer,
    reach: Option<CatchReach>,
    notes: Vec<String>,
}

/// Answer of `/v1/catches`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Catch")]
pub struct CatchAnswer {
    scene: Resolved,
    derived: Derived,
    model: ModelChoice,
    settings: CatchUsed,
    strategy: CatchReason,
    /// The strategies that `auto` compared; empty if one was asked for.
    candidates: Vec<CatchCandidate>,
    /// The outcome.
    pub outcome: CatchOutcomeAnswer,
    #[schemars(with = "Strikes")]
    strikes: Table,
    #[schemars(with = "HoldSamples")]
    hold: Table,
    #[serde(flatten)]
    facts: CatchFacts,
    /// The catch and its scene, for the picture.
    #[serde(skip)]
    drawn: (Scene, Catch),
}

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
struct CatchEnd<'a> {
    outcome: &'a CatchOutcomeAnswer,
    settings: CatchUsed,
    strategy: &'a CatchReason,
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
        let candidate = |candidate: &Candidate| CatchCandidate {
            approach: candidate.approach.into(),
            taken: candidate.taken,
            outcome: CatchOutcomeAnswer::new(&candidate.outcome, candidate.contact_from, candidate.end, friction),
            contact_from: candidate.contact_from,
            demand: candidate.demand.into(),
        };
        let (theta_1mrad, x_1mm) = caught.hold.as_ref().map_or((None, None), |hold| (hold.theta_within, hold.x_within));
        Ok(Self {
            scene: Resolved(*scene),
            derived: Derived::of(scene),
            model: ModelChoice::of(scene),
            settings: CatchUsed {
                approach: caught.approach.into(),
                weights: Weights { state: options.settings.state_weights, input: options.settings.input_weight },
                hold_speed: options.settings.hold_speed,
                hold: options.settings.hold,
                hold_samples: options.hold_samples,
            },
            strategy: CatchReason { name: caught.approach.strategy().name(), reason: reason(&caught) },
            candidates: caught.candidates.iter().map(candidate).collect(),
            outcome: CatchOutcomeAnswer::new(&caught.outcome, caught.contact_from, caught.end(), friction),
            strikes: table_of(&of_strikes(), &caught.strikes),
            hold: table_of(&OF_HOLD, &thinned(samples, options.hold_samples)),
            facts: CatchFacts {
                error_bound: caught.hold.as_ref().map(|hold| hold.error_bound).filter(|bound| bound.is_finite()),
                contact_from: caught.contact_from,
                upright_within: UprightWithin { theta_1mrad, x_1mm },
                demand: caught.demand.into(),
                reach: caught
                    .reach
                    .map(|Reach { theta, limit }| CatchReach { theta, limit: Some(limit).filter(|it| it.is_finite()) }),
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
        Approach::BounceDown(_) | Approach::Brake(_) => None,
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
        Approach::BounceDown(ratio) => format!("{name} with ratio {}", three(ratio)),
        Approach::Plan { strikes, ratio } => format!("{name} of {strikes} strikes with ratio {}", three(ratio)),
        Approach::Brake(deceleration) => format!("{name} at {} m/s²", three(deceleration)),
    }
}

impl Tabular for CatchAnswer {
    /// Strikes, then the hold.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(stacked(&[("strike", &self.strikes), ("hold", &self.hold)]))
    }

    fn about(&self, name: &str) -> &'static str {
        catch_words().iter().find(|column| column.name == name).map_or("", |column| column.about)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["strikes", "hold"]
    }

    fn end(&self) -> impl Serialize {
        let Self { outcome, settings, strategy, facts, .. } = self;
        CatchEnd { outcome, settings: *settings, strategy, facts }
    }
}

/// Points of a flight.
const POINTS: usize = 17;

/// Flights that are drawn with points of their own; the later ones are shorter than a pixel.
const FLIGHTS: usize = 128;

/// A flight from its start.
#[derive(Debug, Clone, Copy)]
pub struct Flight {
    /// Time at its start, s.
    pub t: f64,
    /// State from which it starts.
    pub release: Release,
    /// Gravity, m/s².
    pub gravity: f64,
    /// Time to its end, s.
    pub length: f64,
}

impl Flight {
    /// Times, s, and x, y and θ then, evenly over the flight.
    pub fn points(self, count: usize) -> impl Iterator<Item = (f64, [f64; 3])> {
        let Self { t, release: Release { x, height, state }, gravity, length } = self;
        (0..count).map(move |n| {
            let since = length * n as f64 / (count - 1) as f64;
            let y = height + since * (state.y_dot - 0.5 * gravity * since);
            (t + since, [x + state.x_dot * since, y, state.theta + state.theta_dot * since])
        })
    }
}

/// The motion of the body: the fall, the flights between strikes, and the hold. Times, s, and x, y and θ then.
fn motion(scene: &Scene, strikes: &[CatchStrike], hold: &[HoldSample]) -> Vec<(f64, [f64; 3])> {
    let gravity = scene.gravity();
    let length = scene.parameters::<f64>().contact_distance;
    let height = |theta: f64| length * sin_cos(theta).1;
    let first = strikes.first().map(|strike| strike.t).or(hold.first().map(|sample| sample.t));
    let fall = first.map(|length| Flight { t: 0.0, release: *scene.release(), gravity, length });
    let flights = strikes.iter().take(FLIGHTS).filter_map(|at| {
        let release = Release { x: at.x, height: height(at.state.theta) + at.clearance, state: at.strike.after };
        Some(Flight { t: at.t, release, gravity, length: at.flight_time? })
    });
    let held = hold.iter().map(|at| (at.t, [at.x, at.table_y + height(at.theta), at.theta]));
    fall.into_iter().chain(flights).flat_map(|flight| flight.points(POINTS)).chain(held).collect()
}

impl Pictured for CatchAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let (scene, caught) = &self.drawn;
        let hold = caught.hold.as_ref().map_or(&[][..], |hold| &hold.samples);
        let motion = motion(scene, &caught.strikes, hold);
        let moved = |index: usize| motion.iter().map(|(t, at)| (*t, at[index])).collect();
        let strikes = |read: fn(&CatchStrike) -> f64| caught.strikes.iter().map(|at| (at.t, read(at))).collect();
        let held = |read: fn(&HoldSample) -> f64| hold.iter().map(|sample| (sample.t, read(sample))).collect();
        let time = ChartAxis::new("time", "t", "s");
        let plot = |name, symbol, unit, curves| Plot::new(time, ChartAxis::new(name, symbol, unit)).with(curves);
        let body = |label, index| vec![Curve::new(label, CurveStyle::Truth, moved(index))];
        let dots = |label, points| Curve::new(label, CurveStyle::BesideDots, points);
        let line = |label, points| Curve::new(label, CurveStyle::Beside, points);
        let way = Curve::new("table between strikes", CurveStyle::Limit, way(&caught.strikes));
        let tilt = vec![
            dots("table at strikes", strikes(|at| at.strike.alpha)),
            line("table in contact", held(|sample| sample.alpha)),
        ];
        let height = vec![way, dots("", strikes(|_| 0.0)), line("", held(|sample| sample.table_y))];
        let speed = vec![dots("", strikes(|at| at.strike.table_speed())), line("", held(|sample| sample.table_y_dot))];
        let notes: String = self.facts.notes.iter().map(|note| format!("; {note}")).collect();
        let drawn = Chart {
            title: "A falling body, caught and held by a table",
            subtitle: format!("{}: {}", self.outcome.kind, self.outcome.detail),
            caption: format!("Strategy {}: {}{}", self.strategy.name, self.strategy.reason, notes),
            plots: vec![
                plot("angle of the body", "θ", "rad", body("body", 2)),
                plot("tilt of the table", "α", "rad", tilt),
                plot("height of the body", "y", "m", body("", 1)),
                plot("height of the table", "", "m", height),
                plot("place of the body", "x", "m", body("", 0)),
                plot("speed of the table", "w", "m/s", speed),
            ],
        };
        Ok(readable_chart(&drawn, &PANELS))
    }
}

/// Names of the panels and curves for a page. Those of the body are on the left, those of the table on the right.
static PANELS: [PanelNames; 6] = [
    PanelNames { panel: "theta", curves: &["body"] },
    PanelNames { panel: "alpha", curves: &["strikes", "contact"] },
    PanelNames { panel: "y", curves: &["body"] },
    PanelNames { panel: "table_y", curves: &["way", "strikes", "contact"] },
    PanelNames { panel: "x", curves: &["body"] },
    PanelNames { panel: "table_speed", curves: &["strikes", "contact"] },
];

/// Height of the table from strike to strike: the way whose range is the stroke of the demand.
fn way(strikes: &[CatchStrike]) -> Vec<(f64, f64)> {
    let vertical = |at: &CatchStrike| at.strike.table_velocity.1;
    let pairs = strikes.windows(2).take(FLIGHTS);
    let between = pairs.flat_map(|pair| {
        let (t, time) = (pair[0].t, pair[0].flight_time.unwrap_or(0.0));
        let velocities = (vertical(&pair[0]), vertical(&pair[1]));
        let share = |n: usize| n as f64 / (POINTS - 1) as f64;
        (0..POINTS).map(move |n| (t + time * share(n), height_between(velocities, time, share(n))))
    });
    between.collect()
}
