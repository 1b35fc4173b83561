//! The request for `jacobians`: the place of differentiation.

use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::scene::spec::SceneSpec;
use crate::api::scene::write::resolved;
use crate::api::shared::state::PLACE;
use crate::api::shared::write::canonical_of;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Fields, Object, Part, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

/// The place at which to differentiate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum At {
    /// At the scene's fixed point.
    FixedPoint,
    /// At a place x, m, and a state just before a contact.
    State(f64, #[serde(serialize_with = "components")] State),
    /// At a contact of the scene's run.
    Impact(u64),
}

/// Price of a bounce with its derivatives, in bounces of the plain rod.
const BOUNCE_PRICE: u64 = 12;

/// A word, or an object with a state or the number of an impact.
#[derive(Debug, Clone, Copy)]
struct AtSpec;

request_fields! {
    /// A state just before an impact, with the position.
    struct PlacedState {
        /// Horizontal position of the centre of gravity. It matters only if the table feeds it back.
        x: f64 = PLACE.or(0.0),
        /// The state.
        state: State = Part,
    }
}

request_fields! {
    /// A given state.
    struct StateAt {
        /// A state just before an impact.
        state: PlacedState = Object.required(),
    }
}

request_fields! {
    /// The state at an impact of the run.
    struct ImpactAt {
        /// Number of an impact of the run, counted from 1.
        impact: u64 = whole(1..=limits::BOUNCES).required(),
    }
}

impl FieldSpec<At> for AtSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<At> {
        let Some(value) = reader.value(name) else { return Some(At::FixedPoint) };
        if value.is_string() {
            return reader.choice(name, &[("fixed_point", At::FixedPoint)]);
        }
        let read = |at: &mut Reader<'_, '_>| match (at.has("state"), at.has("impact")) {
            (true, false) => StateAt::read_fields(at).map(|at| At::State(at.state.x, at.state.state)),
            (false, true) => ImpactAt::read_fields(at).map(|at| At::Impact(at.impact)),
            _ => {
                at.refuse_whole("at must be \"fixed_point\", or have either `state` or `impact`");
                None
            }
        };
        reader.within(name, read).flatten()
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let word = json!({"type": "string", "enum": ["fixed_point"]});
        let others = "Or `at.impact`, or `at.state.y_dot` and what else of `at.state` is not 0.";
        list.parameter(name, &format!("{about} {others}"), word.clone(), Some(json!("fixed_point")));
        let (state, impact) =
            (list.nested(name, StateAt::describe_fields), list.nested(name, ImpactAt::describe_fields));
        list.may_be_absent(name);
        list.property(name, about, &json!({"oneOf": [word, state, impact], "default": "fixed_point"}));
    }
}

fn components<S: Serializer>(state: &State, serializer: S) -> Result<S::Ok, S::Error> {
    (state.theta, state.x_dot, state.y_dot, state.theta_dot).serialize(serializer)
}

request_fields! {
    /// A request for a derivative.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct JacobianRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// State at which to differentiate.
        pub at: At = AtSpec,
        /// Number of bounces to differentiate over.
        pub period: u64 = whole(1..=limits::PERIOD).or(1),
    }
}

impl ResourceRequest for JacobianRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let request = Self::read_fields(reader);
        if reader.has("method") {
            reader.refuse("method", "unknown field `method`: derivatives are exact; leave it out");
        }
        request
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for JacobianRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}

impl JacobianRequest {
    /// Price of the work, in bounces of the plain rod.
    fn work(&self) -> u64 {
        let Self { scene, at, period } = self;
        let before = match at {
            At::Impact(impact) => impact * bounce_price(scene),
            At::FixedPoint | At::State(..) => 0,
        };
        limits::ANSWER_PRICE + before + period * BOUNCE_PRICE
    }
}
