//! The request for `jacobians`: the place of differentiation.

use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;
use serde::{Serialize, Serializer};

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::{bounce_price, read_scene};
use crate::api::shared::state::read_state;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

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

impl At {
    /// Reads `at`.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let Some(value) = reader.value("at") else { return Some(Self::FixedPoint) };
        if value.is_string() {
            return reader.choice("at", &[("fixed_point", Self::FixedPoint)]);
        }
        let (mut found, mut kinds) = (None, 0);
        reader.within("at", |at| {
            if at.has("state") {
                kinds += 1;
                let state = at.within("state", |state| {
                    (state.number("x", -1000.0..=1000.0, "m").unwrap_or(0.0), read_state(state))
                });
                found = state.map(|(x, state)| Self::State(x, state));
            }
            if at.has("impact") {
                kinds += 1;
                found = at.integer("impact", 1..=limits::IMPACTS).map(Self::Impact);
            }
            if kinds != 1 {
                at.refuse_whole("at must be \"fixed_point\", or have either `state` or `impact`");
            }
        });
        found
    }
}

fn components<S: Serializer>(state: &State, serializer: S) -> Result<S::Ok, S::Error> {
    (state.theta, state.x_dot, state.y_dot, state.theta_dot).serialize(serializer)
}

/// A request for a derivative.
#[derive(Debug, Clone, Copy)]
pub struct JacobianRequest {
    /// The scene.
    pub scene: Scene,
    /// The place.
    pub at: At,
    /// Number of contacts over which the map is taken.
    pub period: u64,
}

impl ResourceRequest for JacobianRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let scene = read_scene(reader);
        let at = At::read(reader);
        let period = reader.integer("period", 1..=limits::PERIOD).unwrap_or(1);
        if reader.has("method") {
            reader.refuse("method", "unknown field `method`: derivatives are exact; leave it out");
        }
        Some(Self { scene: scene?, at: at?, period })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for JacobianRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(&self.scene, &(self.at, self.period))
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
