//! The request for `ladder`: a scene, the contacts on each level and the difference that counts.

use equipoise_physics::scene::Scene;
use serde::Serialize;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::spec::SceneSpec;
use crate::api::scene::write::resolved;
use crate::api::shared::write::canonical_of;
use crate::api::trajectories::request::LINEAR_PRICE;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, number, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

request_fields! {
    /// A request for the ladder.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct LadderRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Largest number of impacts to follow on each rung.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(100),
        /// Largest difference of states for which a rung counts as not needed, m/s.
        pub tolerance: f64 = number(TOLERANCES, "m/s").or(1e-3),
    }
}

/// Tolerances, m/s.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-15..=10.0;

/// Number of levels of the tallest hierarchy, and the price of one impact on a level other than the linear one, in bounces.
const LEVELS: u64 = 8;
const LEVEL_PRICE: u64 = 20;

/// Price of the rest of the work, in bounces: the setup of the linear solution, and the answer.
const ONCE_PRICE: u64 = 2500;

impl ResourceRequest for LadderRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        Self::read_fields(reader)
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for LadderRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}

impl LadderRequest {
    /// Price of the work, in bounces.
    fn work(&self) -> u64 {
        ONCE_PRICE + self.bounces * (LEVELS * LEVEL_PRICE + LINEAR_PRICE)
    }
}
