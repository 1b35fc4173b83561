//! `/v1/throws`: the strike that sends the body to an apex of given height and angle.

use equipoise_physics::catching::throw::{Apex, Throw, ThrowFailure, ThrowTarget, throw};
use equipoise_physics::map::body::{NoContact, PreImpact, Release};
use equipoise_physics::map::strike::State;
use equipoise_physics::run::orbit::ComingContact;
use equipoise_physics::scene::{Name, Scene, Value};

use crate::api::computed::catches::request::CatchOptions;
use crate::api::computed::catches::{CatchAnswer, Flight};
use crate::api::prelude::*;
use crate::api::scene::explain;
use crate::api::shared::request_parts::{ANGLE, PLACE, SPEED, SPIN, run_to_impact};
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot, chart};
use crate::runs::run::THROW_PRICE;

impl ComputedResource for ThrowRequest {
    const NAME: &'static str = "throws";
    const SINGULAR: &'static str = "Throw";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let answer = ThrowAnswer::compute(request, &mut || slice.should_continue())?;
            bounces.inc_by(answer.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<ThrowAnswer>()
            .table(
                "One row. For the rows of a catch, ask `/v1/catches` with the `scene` of the answer.",
                COLUMNS.iter().map(RowColumn::word),
            )
            .end_of::<ThrowAnswer>(ThrowAnswer::END)
            .refuses(Analysis::Throw);
    }
}

/// Heights of the apex, m.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.0..=100.0;

/// Angles at the apex, rad: about sixteen turns either way.
const ANGLES: std::ops::RangeInclusive<f64> = -100.0..=100.0;

request_fields! {
    /// A request for a throw. The scene need not have a law.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct ThrowRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = LawlessSceneSpec,
        /// The top of the flight after the throw.
        #[serde(serialize_with = "height_and_angle")]
        pub apex: ThrowTarget = Object.required(),
        /// Throws at this impact of the run of the scene, counted from 1. Not with `state`.
        pub impact: Option<u64> = whole(1..=limits::BOUNCES).optional(),
        /// State just before the throw, with the contact point on the table. What is left out is 0.
        pub state: Placed = ObjectOfDefaults,
        /// Settings with which the thrown body is caught. `{}` takes all defaults. Without it the body is not caught.
        pub catch: Option<CatchOptions> = Object.optional(),
    }
}

request_fields! {
    impl ThrowTarget {
        /// Height of the centre of gravity at the apex; above its height before the throw.
        height: f64 = number(HEIGHTS, "m").required(),
        /// Angle at the apex. A half turn is 3.14 more than the angle before the throw.
        theta: f64 = number(ANGLES, "rad").or(0.0),
    }
}

fn height_and_angle<S: Serializer>(target: &ThrowTarget, serializer: S) -> Result<S::Ok, S::Error> {
    (target.height, target.theta).serialize(serializer)
}

request_fields! {
    /// The body on the table.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
    #[schemars(rename = "ThrownState")]
    pub struct Placed {
        /// Horizontal position of the centre of gravity, m.
        pub x: f64 = PLACE.or(0.0),
        /// Angle, rad.
        pub theta: f64 = ANGLE.or(0.0),
        /// Horizontal velocity, m/s.
        pub x_dot: f64 = SPEED.or(0.0),
        /// Vertical velocity, m/s.
        pub y_dot: f64 = SPEED.or(0.0),
        /// Angular velocity, rad/s.
        pub theta_dot: f64 = SPIN.or(0.0),
    }
}

impl Placed {
    /// A state at a place, m.
    fn new(x: f64, State { theta, x_dot, y_dot, theta_dot }: State) -> Self {
        Self { x, theta, x_dot, y_dot, theta_dot }
    }

    /// The state without its place.
    fn state(self) -> State {
        let Self { theta, x_dot, y_dot, theta_dot, .. } = self;
        State { theta, x_dot, y_dot, theta_dot }
    }
}

impl ResourceRequest for ThrowRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let request = Self::read_fields(reader)?;
        if request.impact.is_some() && reader.has("state") {
            reader.refuse("impact", "impact and state both say what is thrown; leave one of them out");
        }
        (!refuse_lacking(reader, &request.scene, Analysis::Throw)).then_some(request)
    }

    fn work(&self) -> u64 {
        let before = self.impact.map_or(0, |impact| impact * bounce_price(&self.scene));
        let catch = self.catch.map_or(0, |catch| catch.price(&self.scene));
        limits::ANSWER_PRICE + THROW_PRICE + before + catch
    }
}

/// The next contact.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct ThrowLanding {
    /// Time since the throw, s.
    t: f64,
    #[serde(flatten)]
    state: Placed,
}

/// The top of the flight.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct ReachedApex {
    /// Time since the throw, s.
    t: f64,
    /// Horizontal position of the centre of gravity, m. It follows from the throw.
    x: f64,
    /// Height of the centre of gravity, m.
    y: f64,
    /// Angle, rad.
    theta: f64,
}

/// Answer of `/v1/throws`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Throw")]
pub struct ThrowAnswer {
    /// The scene with the body just after the throw as its release, ready to run.
    scene: Resolved,
    derived: Derived,
    model: ModelChoice,
    /// Time of the throw in the run of the scene, s. 0 without `impact`. All other times count from the throw.
    t: f64,
    /// Just before the throw.
    before: Placed,
    /// Angle of the table, rad.
    alpha: f64,
    /// Velocity of the table along its normal, m/s. Upwards is positive.
    table_velocity: f64,
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
    apex: ReachedApex,
    /// The next contact. Null if there is none; `notes` gives the reason.
    landing: Option<ThrowLanding>,
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
    /// The flight to the next contact or, without one, to twice the time of the apex.
    #[serde(skip)]
    flight: Flight,
}

impl ThrowAnswer {
    /// Throws the body of a scene.
    ///
    /// # Errors
    /// The reason for which it cannot be thrown there, or cancelled work.
    pub fn compute(request: &ThrowRequest, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let ThrowRequest { ref scene, apex, impact, state, ref catch } = *request;
        let ComingContact { t, coming, before } = match impact {
            None => ComingContact { t: 0.0, coming: PreImpact::at(1, state.x, state.state()), before: None },
            Some(impact) => run_to_impact(scene, impact, "/impact", &mut *go_on)?,
        };
        let thrown = throw(scene, &coming, before, &apex).map_err(|why| refusal(why, impact))?;
        let released = released(scene, &thrown, &coming)?;
        let catch = catch.as_ref().map(|options| CatchAnswer::compute(&released, options, go_on)).transpose()?;
        let Throw { motion, strike, apex, residual, iterations, load, release, landing } = thrown;
        let Apex { t: rise, x, y, theta } = apex;
        Ok(Self {
            scene: Resolved(released),
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
            apex: ReachedApex { t: rise, x, y, theta },
            landing: landing.ok().map(|arrival| {
                let x = coming.x + arrival.way;
                ThrowLanding { t: arrival.t, state: Placed::new(x, arrival.state) }
            }),
            residual,
            iterations,
            demand: load.into(),
            bounces: impact.unwrap_or(0) + catch.as_ref().map_or(1, |catch| 1 + catch.strike_count()),
            notes: notes(scene, &thrown),
            catch,
            flight: Flight {
                t: 0.0,
                release,
                gravity: scene.gravity(),
                length: landing.map_or(2.0 * rise, |arrival| arrival.t),
            },
        })
    }
}

/// The scene with the flight of the throw as its release.
fn released(scene: &Scene, thrown: &Throw, from: &PreImpact) -> Result<Scene, Refusal> {
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
        if from.clearance < 0.0 {
            let (n, below) = (from.n, -from.clearance);
            let detail = format!(
                "at impact {n} the table strikes late, with the contact point {below} m below y = 0, and no scene is released there; throw at \
                 another impact, or leave noise.timing_sd out"
            );
            return Refusal::At("/impact", detail);
        }
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
#[rustfmt::skip]
const COLUMNS: [RowColumn<ThrowAnswer>; 24] = [
    RowColumn::new("t", "s", "Time of the throw in the run of the scene.", Read::Number(|throw| throw.t)),
    RowColumn::new("x", "m", "Place just before the throw.", Read::Number(|throw| throw.before.x)),
    RowColumn::new("theta", "rad", "Angle just before.", Read::Number(|throw| throw.before.theta)),
    RowColumn::new("x_dot", "m/s", "Horizontal velocity just before.", Read::Number(|throw| throw.before.x_dot)),
    RowColumn::new("y_dot", "m/s", "Vertical velocity just before.", Read::Number(|throw| throw.before.y_dot)),
    RowColumn::new("theta_dot", "rad/s", "Angular velocity just before.", Read::Number(|throw| throw.before.theta_dot)),
    RowColumn::new("alpha", "rad", "Angle of the table.", Read::Number(|throw| throw.alpha)),
    RowColumn::new("table_velocity", "m/s", "Along the normal.", Read::Number(|throw| throw.table_velocity)),
    RowColumn::new("table_velocity_tangential", "m/s", "Along the table.", Read::Number(|throw| throw.table_velocity_tangential)),
    RowColumn::new("impulse_normal", "m/s", "Per unit mass.", Read::Number(|throw| throw.impulse_normal)),
    RowColumn::new("impulse_tangential", "m/s", "Per unit mass.", Read::Number(|throw| throw.impulse_tangential)),
    RowColumn::new("contact_mode", "", "", Read::Word(|throw: &ThrowAnswer| Some(throw.contact_mode))).among("ContactMode"),
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
    RowColumn::new("caught", "", "Outcome of the catch, if one was asked for.", Read::Word(|throw: &ThrowAnswer| throw.catch.as_ref().map(|catch| catch.outcome.kind)))
        .among("CatchOutcomeKind"),
];

impl Tabular for ThrowAnswer {
    const END: &'static [&'static str] = &["scene", "demand", "notes"];

    /// The throw in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&COLUMNS, std::slice::from_ref(self)))
    }
}

/// Points of a curve.
const POINTS: usize = 129;

impl Pictured for ThrowAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let apex = &self.apex;
        let four = |value: f64| significant(value, 4);
        let rise = apex.t;
        let time = ChartAxis::new("time after the throw", "t", "s");
        let plot = |y, [flight, at_apex]: [&'static str; 2], index: usize, reached| {
            let over_time = self.flight.points(POINTS).map(|(t, at)| (t, at[index])).collect();
            let flight = Curve::new(flight, CurveStyle::Truth, over_time);
            Plot::new(time, y).with(vec![flight, Curve::new(at_apex, CurveStyle::BesideDots, vec![(rise, reached)])])
        };
        let height = plot(ChartAxis::new("height of the centre of gravity", "y", "m"), ["flight", "apex"], 1, apex.y);
        let angle = plot(ChartAxis::new("angle", "θ", "rad"), ["", ""], 2, apex.theta);
        Ok(chart(&Chart {
            title: "A throw to an apex of chosen height and angle",
            subtitle: format!(
                "the table strikes at α = {} rad and {} m/s along its normal",
                four(self.alpha),
                four(self.table_velocity)
            ),
            caption: format!(
                "The apex is {} s after the throw, at {} m and {} rad, {} m to the side.",
                four(rise),
                four(apex.y),
                four(apex.theta),
                four(apex.x - self.flight.release.x)
            ),
            plots: vec![height, angle],
        }))
    }
}
