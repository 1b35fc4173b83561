//! The answer of `throws`: the strike, its apex, a scene that begins with the flight, and the catch after it.

use std::borrow::Cow;

use equipoise_physics::catching::throw::{Apex, Throw, ThrowFailure, throw};
use equipoise_physics::map::body::{NoContact, PreImpact, Release};
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::{Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::catches::answer::CatchAnswer;
use crate::api::formats::Tabular;
use crate::api::scene::{Derived, Resolved, explain, scene_to_json};
use crate::api::shared::actuator_load::LoadAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::Refusal;
use crate::api::shared::state::run_to_impact;
use crate::api::shared::table::Table;
use crate::api::shared::table::columns::{RowColumn, table_of};
use crate::api::shared::table::gather::Read;
use crate::api::throws::request::{Placed, ThrowRequest};
use crate::api::vocabulary::ContactMode;
use crate::charts::significant;

/// The next contact.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "ThrowLanding")]
struct Landing {
    /// Time since the throw, s.
    t: f64,
    #[serde(flatten)]
    state: Placed,
}

/// The top of the flight.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "ReachedApex")]
pub(super) struct ApexAnswer {
    /// Time since the throw, s.
    pub(super) t: f64,
    /// Horizontal position of the centre of gravity, m. It follows from the throw.
    pub(super) x: f64,
    /// Height of the centre of gravity, m.
    pub(super) y: f64,
    /// Angle, rad.
    pub(super) theta: f64,
}

/// Answer of `/v1/throws`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Throw")]
pub struct ThrowAnswer {
    /// The scene with the body just after the throw as its release, ready to run.
    #[schemars(with = "Resolved<'static>")]
    scene: Json,
    derived: Derived,
    model: ModelChoice,
    /// Time of the throw in the run of the scene, s. 0 without `impact`. All other times count from the throw.
    t: f64,
    /// Just before the throw.
    before: Placed,
    /// Angle of the table, rad.
    pub(super) alpha: f64,
    /// Velocity of the table along its normal, m/s. Upwards is positive.
    pub(super) table_velocity: f64,
    /// Velocity of the table along itself, m/s. 0 unless `table.slide` is `matched`.
    table_velocity_tangential: f64,
    /// Impulse along the normal of the table per unit mass, m/s.
    impulse_normal: f64,
    /// Impulse along the table per unit mass, m/s.
    impulse_tangential: f64,
    #[schemars(with = "ContactMode")]
    contact_mode: &'static str,
    /// Just after the throw.
    after: Placed,
    pub(super) apex: ApexAnswer,
    /// The next contact. Null if there is none; `notes` gives the reason.
    landing: Option<Landing>,
    /// Distance of the apex from the target, the larger of height and ρ times angle, m. It is rounding unless `table.assumed_restitution` is wrong.
    residual: f64,
    /// Steps of the solver; 0 in closed form.
    iterations: u32,
    demand: LoadAnswer,
    /// The catch of the thrown body, as of `scene` by `/v1/catches`. Null if none was asked for.
    pub catch: Option<CatchAnswer>,
    notes: Vec<String>,
    /// Contacts that were computed.
    #[serde(skip)]
    pub bounces: u64,
    #[serde(skip)]
    pub(super) flight: ThrownFlight,
}

/// The flight after a throw, for its picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct ThrownFlight {
    pub(super) release: Release,
    pub(super) gravity: f64,
    /// Time to the next contact or, without one, to twice the time of the apex, s.
    pub(super) length: f64,
}

impl ThrowAnswer {
    /// Throws the body of a scene.
    ///
    /// # Errors
    /// The reason for which it cannot be thrown there, or cancelled work.
    pub fn compute(request: &ThrowRequest, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let ThrowRequest { ref scene, apex, impact, state, ref catch } = *request;
        let (t, coming) = match impact {
            None => (0.0, PreImpact::at(1, state.x, state.state())),
            Some(impact) => run_to_impact(scene, impact, "/impact", &mut *go_on)?,
        };
        let thrown = throw(scene, &coming, &apex).map_err(|why| refusal(why, impact))?;
        let released = released(scene, &thrown)?;
        let catch = catch.as_ref().map(|options| CatchAnswer::compute(&released, options, go_on)).transpose()?;
        let Throw { motion, strike, apex, residual, iterations, load, release, landing } = thrown;
        let Apex { t: rise, x, y, theta } = apex;
        Ok(Self {
            scene: scene_to_json(&released),
            derived: Derived::of(&released),
            model: ModelChoice::of(&released),
            t,
            before: Placed::new(coming.x, coming.state),
            alpha: motion.alpha,
            table_velocity: motion.normal_velocity,
            table_velocity_tangential: motion.tangential_velocity + 0.0,
            impulse_normal: strike.impulse_normal,
            impulse_tangential: strike.impulse_tangential + 0.0,
            contact_mode: strike.mode.name(),
            after: Placed::new(coming.x, strike.after),
            apex: ApexAnswer { t: rise, x, y, theta },
            landing: landing.ok().map(|arrival| {
                let x = coming.x + arrival.way;
                Landing { t: arrival.t, state: Placed::new(x, arrival.state) }
            }),
            residual,
            iterations,
            demand: load.into(),
            bounces: impact.unwrap_or(0) + catch.as_ref().map_or(1, |catch| 1 + catch.strike_count()),
            notes: notes(scene, &thrown),
            catch,
            flight: ThrownFlight {
                release,
                gravity: scene.gravity(),
                length: landing.map_or(2.0 * rise, |arrival| arrival.t),
            },
        })
    }
}

/// The scene with the flight of the throw as its release.
fn released(scene: &Scene, thrown: &Throw) -> Result<Scene, Refusal> {
    let Release { x, height, state: State { theta, x_dot, y_dot, theta_dot } } = thrown.release;
    let mut draft = scene.draft();
    for (name, value) in [
        (Name::Height, height),
        (Name::Theta, theta),
        (Name::X, x),
        (Name::XDot, x_dot),
        (Name::YDot, y_dot),
        (Name::ThetaDot, theta_dot),
    ] {
        if draft.set(name, Some(Value::Number(value))).is_err() {
            let row = name.row();
            let detail = format!("the throw would need {} = {value}, which must be {}", row.path, row.limits());
            return Err(Refusal::At("/apex", detail));
        }
    }
    draft.build().map_err(|errors| {
        let details: Vec<String> = explain(errors).into_iter().map(|error| error.detail).collect();
        Refusal::At("/apex", details.join("; "))
    })
}

/// The field that a failure is about.
fn refusal(why: ThrowFailure, impact: Option<u64>) -> Refusal {
    let pointer = match why {
        ThrowFailure::PointMass => "/scene/body/point",
        ThrowFailure::OffTable { .. } => "/scene/table/length",
        ThrowFailure::TooLow { .. } => "/apex/height",
        ThrowFailure::BeyondLimits(violation) => match violation.quantity {
            "tilt" => "/scene/table/limits/tilt",
            "tilt_rate" => "/scene/table/limits/tilt_rate",
            "stroke" => "/scene/table/limits/stroke",
            _ => "/scene/table/limits/speed",
        },
        ThrowFailure::Lying { .. } => match impact {
            None => "/state",
            Some(_) => "/impact",
        },
        ThrowFailure::CannotPush { .. }
        | ThrowFailure::TooSteep { .. }
        | ThrowFailure::AngleOutOfReach { .. }
        | ThrowFailure::OtherVertex(_)
        | ThrowFailure::ContactSinks { .. }
        | ThrowFailure::ContactReturns { .. }
        | ThrowFailure::OutrunsTable { .. }
        | ThrowFailure::TooFast { .. } => "/apex",
    };
    Refusal::At(pointer, why.to_string())
}

/// Facts beside a throw.
fn notes(scene: &Scene, thrown: &Throw) -> Vec<String> {
    let mut notes = Vec::new();
    if scene.number(Name::AssumedRestitution).is_some_and(|assumed| Some(assumed) != scene.number(Name::Restitution)) {
        notes.push(format!(
            "the table assumes a restitution that is not the contact's, so the apex misses the target: by {} m in height or in ρ times angle",
            significant(thrown.residual, 3)
        ));
    }
    match &thrown.landing {
        Ok(arrival) => {
            let limit = scene.number(Name::ToppleAngle).unwrap_or(f64::INFINITY);
            if arrival.state.theta.abs() >= limit {
                notes.push(format!(
                    "the body comes down at {} rad, at or beyond topple_angle {} rad, where no strike follows",
                    significant(arrival.state.theta, 4),
                    significant(limit, 4)
                ));
            }
        }
        Err(why) => {
            let why = match why {
                NoContact::TooManyPieces => "it turns so often that doubles do not resolve its next contact",
                NoContact::Sinking => "the contact point does not come up to y = 0 again",
                NoContact::Missed => "it never meets the table as it was planned",
                NoContact::OtherVertex(_) => "another vertex comes down first",
            };
            notes.push(format!("landing is null: {why}"));
        }
    }
    notes
}

/// Columns of a throw.
pub(super) const COLUMNS: [RowColumn<ThrowAnswer>; 24] = [
    RowColumn::new("t", "s", "Time of the throw in the run of the scene.", Read::Number(|throw| throw.t)),
    RowColumn::new("x", "m", "Place just before the throw.", Read::Number(|throw| throw.before.x)),
    RowColumn::new("theta", "rad", "Angle just before.", Read::Number(|throw| throw.before.theta)),
    RowColumn::new("x_dot", "m/s", "Horizontal velocity just before.", Read::Number(|throw| throw.before.x_dot)),
    RowColumn::new("y_dot", "m/s", "Vertical velocity just before.", Read::Number(|throw| throw.before.y_dot)),
    RowColumn::new("theta_dot", "rad/s", "Angular velocity just before.", Read::Number(|throw| throw.before.theta_dot)),
    RowColumn::new("alpha", "rad", "Angle of the table.", Read::Number(|throw| throw.alpha)),
    RowColumn::new("table_velocity", "m/s", "Along the normal.", Read::Number(|throw| throw.table_velocity)),
    RowColumn::new(
        "table_velocity_tangential",
        "m/s",
        "Along the table.",
        Read::Number(|throw| throw.table_velocity_tangential),
    ),
    RowColumn::new("impulse_normal", "m/s", "Per unit mass.", Read::Number(|throw| throw.impulse_normal)),
    RowColumn::new("impulse_tangential", "m/s", "Per unit mass.", Read::Number(|throw| throw.impulse_tangential)),
    RowColumn::new("contact_mode", "", "", Read::Word(|throw: &ThrowAnswer| Some(throw.contact_mode)))
        .among("ContactMode"),
    RowColumn::new("x_dot_after", "m/s", "", Read::Number(|throw| throw.after.x_dot)),
    RowColumn::new("y_dot_after", "m/s", "", Read::Number(|throw| throw.after.y_dot)),
    RowColumn::new("theta_dot_after", "rad/s", "", Read::Number(|throw| throw.after.theta_dot)),
    RowColumn::new("apex_t", "s", "Time since the throw.", Read::Number(|throw| throw.apex.t)),
    RowColumn::new("apex_x", "m", "", Read::Number(|throw| throw.apex.x)),
    RowColumn::new("apex_y", "m", "Height of the centre of gravity.", Read::Number(|throw| throw.apex.y)),
    RowColumn::new("apex_theta", "rad", "", Read::Number(|throw| throw.apex.theta)),
    RowColumn::new("landing_t", "s", "Time since the throw.", Read::Sparse(|throw| Some(throw.landing?.t))),
    RowColumn::new("landing_x", "m", "", Read::Sparse(|throw| Some(throw.landing?.state.x))),
    RowColumn::new("landing_theta", "rad", "", Read::Sparse(|throw| Some(throw.landing?.state.theta))),
    RowColumn::new("residual", "m", "Distance of the apex from the target.", Read::Number(|throw| throw.residual)),
    RowColumn::new(
        "caught",
        "",
        "Outcome of the catch, if one was asked for.",
        Read::Word(|throw: &ThrowAnswer| throw.catch.as_ref().map(|catch| catch.outcome.kind)),
    )
    .among("CatchOutcomeKind"),
];

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "ThrowEnd")]
pub(super) struct End<'a> {
    #[schemars(with = "Resolved<'static>")]
    scene: &'a Json,
    demand: LoadAnswer,
    notes: &'a Vec<String>,
}

impl Tabular for ThrowAnswer {
    /// The throw in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&COLUMNS, std::slice::from_ref(self)))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    fn end(&self) -> impl Serialize {
        End { scene: &self.scene, demand: self.demand, notes: &self.notes }
    }
}
