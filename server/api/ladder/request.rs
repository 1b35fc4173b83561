//! The request for `ladder`: a scene, the contacts on each level and the difference that counts.

use equipoise_physics::scene::Scene;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::read_scene;
use crate::api::shared::write;
use crate::api::trajectories::request::LINEAR_PRICE;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

/// A request for the ladder.
#[derive(Debug, Clone, Copy)]
pub struct LadderRequest {
    /// The scene.
    pub scene: Scene,
    /// Highest number of contacts on each level.
    pub impacts: u64,
    /// Largest difference of the states, m/s, at which a level counts as not needed.
    pub tolerance: f64,
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
        let scene = read_scene(reader);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(100);
        let tolerance = reader.number("tolerance", TOLERANCES, "m/s").unwrap_or(1e-3);
        Some(Self { scene: scene?, impacts, tolerance })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for LadderRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(&self.scene, &(self.impacts, self.tolerance))
    }
}

impl LadderRequest {
    /// Price of the work, in bounces.
    fn work(&self) -> u64 {
        ONCE_PRICE + self.impacts * (LEVELS * LEVEL_PRICE + LINEAR_PRICE)
    }
}
