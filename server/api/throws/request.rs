//! The request for `throws`: a scene, the state before the throw, the apex, and the catch after it.

use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::api::catches::request::CatchOptions;
use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::scene::spec::LawlessSceneSpec;
use crate::api::scene::write::resolved;
use crate::api::shared::refusal::refuse_lacking;
use crate::api::shared::state::{ANGLE, PLACE, SPEED, SPIN};
use crate::api::shared::write::canonical_of;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, Object, ObjectOfDefaults, number, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;
use crate::runs::prices::THROW_PRICE;

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
    pub(super) fn new(x: f64, State { theta, x_dot, y_dot, theta_dot }: State) -> Self {
        Self { x, theta, x_dot, y_dot, theta_dot }
    }

    /// The state without its place.
    pub(super) fn state(self) -> State {
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

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        let before = self.impact.map_or(0, |impact| impact * bounce_price(&self.scene));
        let catch = self.catch.map_or(0, |catch| catch.price(&self.scene));
        Price::bounces(limits::ANSWER_PRICE + THROW_PRICE + before + catch).within(&limits.of_work())
    }
}

impl CanonicalRequest for ThrowRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}
