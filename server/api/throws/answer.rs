//! The answer of `throws`: the strike, its apex, a scene that begins with the flight, and the catch after it.

use std::borrow::Cow;

use equipoise_physics::catching::throw::{Apex, Throw, ThrowFailure, ThrowTarget, throw};
use equipoise_physics::map::body::{NoContact, PreImpact, Release};
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::{Name, Scene, Value};
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::catches::answer::CatchAnswer;
use crate::api::formats::Tabular;
use crate::api::scene::{Derived, explain, scene_to_json};
use crate::api::shared::actuator_load::LoadAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::Refusal;
use crate::api::shared::state::run_to_impact;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::throws::request::{Start, ThrowRequest};
use crate::charts::significant;

/// The body on the table.
#[derive(Debug, Clone, Copy, Serialize)]
struct Placed {
    x: f64,
    theta: f64,
    x_dot: f64,
    y_dot: f64,
    theta_dot: f64,
}

impl Placed {
    fn new(x: f64, State { theta, x_dot, y_dot, theta_dot }: State) -> Self {
        Self { x, theta, x_dot, y_dot, theta_dot }
    }
}

/// The next contact.
#[derive(Debug, Clone, Copy, Serialize)]
struct Landing {
    /// Time since the throw, s.
    t: f64,
    #[serde(flatten)]
    state: Placed,
}

/// The top of the flight; `t` is the time since the throw, s.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct ApexAnswer {
    pub(super) t: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) theta: f64,
}

/// Answer of `/v1/throws`.
#[derive(Debug, Serialize)]
pub struct ThrowAnswer {
    scene: Json,
    derived: Derived,
    model: ModelChoice,
    /// Time of the throw in the run, s.
    t: f64,
    before: Placed,
    pub(super) alpha: f64,
    pub(super) table_velocity: f64,
    table_velocity_tangential: f64,
    impulse_normal: f64,
    impulse_tangential: f64,
    contact_mode: &'static str,
    after: Placed,
    pub(super) apex: ApexAnswer,
    landing: Option<Landing>,
    residual: f64,
    iterations: u32,
    demand: LoadAnswer,
    /// The catch of the thrown body, if one is asked for.
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
        let ThrowRequest { ref scene, start, height, theta, ref catch } = *request;
        let (t, coming) = match start {
            Start::State(x, state) => (0.0, PreImpact::at(1, x, state)),
            Start::Impact(impact) => run_to_impact(scene, impact, "/impact", &mut *go_on)?,
        };
        let thrown = throw(scene, &coming, &ThrowTarget { height, theta }).map_err(|why| refusal(why, start))?;
        let released = released(scene, &thrown)?;
        let catch = catch.as_ref().map(|options| CatchAnswer::compute(&released, options, go_on)).transpose()?;
        let Throw { motion, strike, apex, residual, iterations, load, release, landing } = thrown;
        let Apex { t: rise, x, y, theta } = apex;
        let before_throw = match start {
            Start::State(..) => 0,
            Start::Impact(impact) => impact,
        };
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
            bounces: before_throw + catch.as_ref().map_or(1, |catch| 1 + catch.strike_count()),
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
fn refusal(why: ThrowFailure, start: Start) -> Refusal {
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
        ThrowFailure::Lying { .. } => match start {
            Start::State(..) => "/state",
            Start::Impact(_) => "/impact",
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

impl Tabular for ThrowAnswer {
    /// The throw in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        let number = |name, unit, value| Column { name, unit, cells: Cells::Numbers(vec![value]) };
        let sparse = |name, unit, value| Column { name, unit, cells: Cells::Sparse(vec![value]) };
        let (before, after, apex) = (&self.before, &self.after, &self.apex);
        let landing = |read: fn(&Landing) -> f64| self.landing.as_ref().map(read);
        Cow::Owned(Table(vec![
            number("t", "s", self.t),
            number("x", "m", before.x),
            number("theta", "rad", before.theta),
            number("x_dot", "m/s", before.x_dot),
            number("y_dot", "m/s", before.y_dot),
            number("theta_dot", "rad/s", before.theta_dot),
            number("alpha", "rad", self.alpha),
            number("table_velocity", "m/s", self.table_velocity),
            number("table_velocity_tangential", "m/s", self.table_velocity_tangential),
            number("impulse_normal", "m/s", self.impulse_normal),
            number("impulse_tangential", "m/s", self.impulse_tangential),
            Column { name: "contact_mode", unit: "", cells: Cells::Words(vec![Some(self.contact_mode)]) },
            number("x_dot_after", "m/s", after.x_dot),
            number("y_dot_after", "m/s", after.y_dot),
            number("theta_dot_after", "rad/s", after.theta_dot),
            number("apex_t", "s", apex.t),
            number("apex_x", "m", apex.x),
            number("apex_y", "m", apex.y),
            number("apex_theta", "rad", apex.theta),
            sparse("landing_t", "s", landing(|it| it.t)),
            sparse("landing_x", "m", landing(|it| it.state.x)),
            sparse("landing_theta", "rad", landing(|it| it.state.theta)),
            number("residual", "m", self.residual),
            Column {
                name: "caught",
                unit: "",
                cells: Cells::Words(vec![self.catch.as_ref().map(|catch| catch.outcome.kind)]),
            },
        ]))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            scene: Json,
            demand: LoadAnswer,
            notes: Vec<String>,
        }
        End { scene: self.scene.clone(), demand: self.demand, notes: self.notes.clone() }
    }
}
