//! Parts of several requests: the state just before a contact, the weights of a state feedback, and a tile: an even share of work that is too
//! much for one request.

use std::ops::Range;

use equipoise_physics::control::lqr::{DEFAULT_INPUT_WEIGHT, DEFAULT_STATE_WEIGHTS};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::actuator_load::Pose;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::orbit::{ComingContact, run};
use equipoise_physics::scene::Scene;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::api::shared::refusal::Refusal;
use crate::http::Reader;
use crate::http::request::fields::{
    Absence, FieldList, FieldSpec, NamedNumbers, Number, Required, Whole, number, whole,
};
use crate::request_fields;

/// Runs a scene up to contact `impact`, which a request names at `pointer`.
pub(crate) fn run_to_impact(
    scene: &Scene,
    impact: u64,
    pointer: &'static str,
    mut go_on: impl FnMut() -> bool,
) -> Result<ComingContact, Refusal> {
    let mut orbit = scene.orbit().map_err(|_| (pointer, "the run has no contact".to_owned()))?;
    let mut last = ComingContact { t: 0.0, coming: PreImpact::at(0, orbit.x(), *orbit.state()), before: None };
    let mut before = None;
    let ending = run(&mut orbit, impact, |contact| {
        let coming = PreImpact { clearance: contact.clearance, ..PreImpact::at(contact.n, contact.x, contact.state) };
        last = ComingContact { t: contact.t, coming, before };
        before = contact.strike.as_ref().map(Pose::of).zip(contact.flight_time);
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    });
    let ending = ending.ok_or(Refusal::Cancelled)?;
    if orbit.contacts() < impact {
        let why = ending.name();
        return Err(Refusal::At(
            pointer,
            format!("impact is {impact}, but the run ends as `{why}` at contact {}", orbit.contacts()),
        ));
    }
    Ok(last)
}

request_fields! {
    impl State {
        /// Angle of the body.
        theta: f64 = ANGLE.or(0.0),
        /// Horizontal velocity.
        x_dot: f64 = SPEED.or(0.0),
        /// Vertical velocity.
        y_dot: f64 = SPEED.required(),
        /// Angular velocity.
        theta_dot: f64 = SPIN.or(0.0),
    }
}

/// Components of a state, as wide as the states that a valid scene can reach.
pub(crate) const PLACE: Number = number(-1000.0..=1000.0, "m");
pub(crate) const ANGLE: Number = number(-std::f64::consts::PI..=std::f64::consts::PI, "rad");
pub(crate) const SPEED: Number = number(-1000.0..=1000.0, "m/s");
pub(crate) const SPIN: Number = number(-1000.0..=1000.0, "rad/s");

request_fields! {
    /// Costs of a deviation and of a tilt. The law minimizes the sum of the weighted squares over all bounces, in SI units.
    #[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
    pub struct Weights {
        /// Weights of the state just before an impact. With weight 0 for x, the position is free: x is left out, and the body comes to rest anywhere.
        /// An array has all four: x, theta, x_dot, theta_dot.
        #[serde(serialize_with = "by_state")]
        #[schemars(with = "ByState")]
        pub state: [f64; 4] = STATE_WEIGHTS,
        /// Weight of the squared tilt of the table.
        pub input: f64 = number(1e-6..=1e6, "").or(DEFAULT_INPUT_WEIGHT),
    }
}

const STATE_WEIGHTS: NamedNumbers<4> = NamedNumbers {
    names: [
        ("x", "Weight of the squared horizontal position."),
        ("theta", "Weight of the squared angle."),
        ("x_dot", "Weight of the squared horizontal velocity."),
        ("theta_dot", "Weight of the squared angular velocity."),
    ],
    range: 0.0..=1e6,
    defaults: DEFAULT_STATE_WEIGHTS,
};

/// A number for each component of the state.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct ByState {
    x: f64,
    theta: f64,
    x_dot: f64,
    theta_dot: f64,
}

fn by_state<S: Serializer>(&[x, theta, x_dot, theta_dot]: &[f64; 4], serializer: S) -> Result<S::Ok, S::Error> {
    ByState { x, theta, x_dot, theta_dot }.serialize(serializer)
}

/// Share number `index`, from 0, of `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Tile {
    /// Number of the share, from 0.
    pub index: u64,
    /// Number of shares.
    pub of: u64,
}

impl Tile {
    /// All of the work.
    const WHOLE: Self = Self { index: 0, of: 1 };

    /// The share's part of `count` rows or runs.
    pub fn share(&self, count: u64) -> Range<u64> {
        count * self.index / self.of..count * (self.index + 1) / self.of
    }
}

/// A tile, one of at most so many. Without it the tile is all of the work.
#[derive(Debug, Clone, Copy)]
pub struct TileOf(pub u64);

impl TileOf {
    fn index(self) -> Required<Whole> {
        whole(0..=self.0).required()
    }

    fn of(self) -> Required<Whole> {
        whole(1..=self.0).required()
    }
}

impl FieldSpec<Tile> for TileOf {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Tile> {
        if !reader.has(name) {
            return Some(Tile::WHOLE);
        }
        reader.within(name, |tile| {
            let (index, of) = (self.index().read(tile, "index"), self.of().read(tile, "of"));
            let (index, of) = (index?, of?);
            if index >= of {
                tile.refuse("index", format!("index is {index}; it must be from 0 to {}, below `of`", of - 1));
                return None;
            }
            Some(Tile { index, of })
        })?
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, |tile| {
            self.index().describe("index", "Number of the share, from 0.", tile);
            self.of().describe("of", "Number of shares.", tile);
        });
        list.may_be_absent(name);
        list.property(name, about, &schema);
    }
}
