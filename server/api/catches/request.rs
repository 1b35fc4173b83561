//! The request for `catches`: a scene, and the settings of the catch.

use equipoise_physics::catching::contact_work;
use equipoise_physics::catching::plan::{FEWEST_STRIKES, MOST_STRIKES};
use equipoise_physics::catching::settings::{
    BRAKES, CatchSettings, DEFAULT_HOLD, HOLD_SPEED, PLAN_RATIOS, RATIOS, Strategy,
};
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use serde::Serialize;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::read_scene_without_law;
use crate::api::shared::refusal::refuse_lacking;
use crate::api::shared::weights::read_weights;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

/// Contact speeds after a strike below which the lasting contact begins, m/s. At the lowest, the slowest ratio takes some 700 strikes.
const HOLD_SPEEDS: std::ops::RangeInclusive<f64> = 1e-4..=0.1;

/// Times in contact, s. A shorter one shows nothing.
const HOLDS: std::ops::RangeInclusive<f64> = 0.1..=limits::HOLD_TIME;

/// Default for the largest number of rows of the hold.
const HOLD_SAMPLES: u64 = 200;

// The limits are those of the physics.
const _: () = assert!(
    limits::HOLD_SAMPLES == equipoise_physics::run::lasting_contact::MOST_SAMPLES as u64
        && limits::HOLD_TIME == equipoise_physics::run::lasting_contact::LONGEST_HOLD
);

/// Price of a catch by bounces that die down, in bounces: about 1 ms.
const CATCH_BOUNCE_DOWN_PRICE: u64 = 20_000;

/// Price of a planned catch, in bounces: about 20 ms for random releases, with the choice of its strikes and a new plan at each of them, and
/// up to 180 ms with many strikes.
const CATCH_PLAN_PRICE: u64 = 800_000;

/// Price of a catch by a braking table, in bounces: about 1 ms.
const CATCH_BRAKE_PRICE: u64 = 20_000;

/// Attempts of a catch whose strategy is not named: two of `bounce_down`, two of `plan`, and one of `brake`.
const STRATEGIES_COMPARED: u64 = 5;

/// Strikes of a planned catch before its stop: four numbers are to vanish, and an error grows by up to 16 times a strike.
const PLAN_STRIKES: std::ops::RangeInclusive<u64> = FEWEST_STRIKES as u64..=MOST_STRIKES as u64;

/// Settings of a catch, with the size of its answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CatchOptions {
    /// Settings of the physics.
    pub settings: CatchSettings,
    /// Largest number of rows of the hold.
    pub hold_samples: u64,
}

/// A request for a catch.
#[derive(Debug, Clone, Copy)]
pub struct CatchRequest {
    /// The scene.
    pub scene: Scene,
    /// Settings of the catch.
    pub options: CatchOptions,
}

impl CatchOptions {
    /// Reads the settings and the size from the fields of an object.
    pub fn read(reader: &mut Reader<'_, '_>) -> Self {
        let settings = read_settings(reader);
        let hold_samples = reader.integer("hold_samples", 2..=limits::HOLD_SAMPLES).unwrap_or(HOLD_SAMPLES);
        Self { settings, hold_samples }
    }

    /// Everything that determines the answer.
    pub fn canonical(&self) -> impl Serialize {
        (canonical_settings(&self.settings), self.hold_samples)
    }

    /// Price of the catch of a scene, in bounces.
    pub fn price(&self, scene: &Scene) -> u64 {
        whole_catch_price(scene, &self.settings) + limits::HOLD_SAMPLE_PRICE * self.hold_samples
    }
}

/// Strategies by their names in requests; `auto` leaves the choice to the server.
const STRATEGIES: [(&str, Option<Strategy>); 4] = [
    ("auto", None),
    ("bounce_down", Some(Strategy::BounceDown)),
    ("plan", Some(Strategy::Plan)),
    ("brake", Some(Strategy::Brake)),
];

/// Name of a strategy in requests.
pub fn strategy_name(strategy: Option<Strategy>) -> &'static str {
    STRATEGIES.iter().find(|(_, known)| *known == strategy).map_or("auto", |(name, _)| name)
}

/// Reads the settings of a catch from the fields of an object.
pub fn read_settings(reader: &mut Reader<'_, '_>) -> CatchSettings {
    let strategy = reader.choice("strategy", &STRATEGIES).flatten();
    let ratio = reader.number("ratio", PLAN_RATIOS, "");
    let strikes = reader.integer("strikes", PLAN_STRIKES);
    let brake = reader.number("brake", BRAKES, "m/s²");
    let said = strategy_name(strategy);
    let mut only_for = |name: &'static str, known: &[Strategy], words: &str| {
        if reader.has(name) && !strategy.is_some_and(|strategy| known.contains(&strategy)) {
            reader.refuse(
                name,
                format!(
                    "{name} is for the strategy {words}, and strategy is {said}; leave {name} out or name that strategy"
                ),
            );
        }
    };
    only_for("ratio", &[Strategy::BounceDown, Strategy::Plan], "bounce_down or plan");
    only_for("strikes", &[Strategy::Plan], "plan");
    only_for("brake", &[Strategy::Brake], "brake");
    if let Some(ratio) = ratio.filter(|ratio| strategy == Some(Strategy::BounceDown) && !RATIOS.contains(ratio)) {
        let (least, most) = (RATIOS.start(), RATIOS.end());
        reader
            .refuse("ratio", format!("ratio is {ratio}; for bounce_down it must be from {least} to {most} (no unit)"));
    }
    let (state_weights, input_weight) = read_weights(reader);
    let hold_speed = reader.number("hold_speed", HOLD_SPEEDS, "m/s").unwrap_or(HOLD_SPEED);
    let hold = reader.number("hold", HOLDS, "s").unwrap_or(DEFAULT_HOLD);
    let strikes = strikes.and_then(|strikes| u32::try_from(strikes).ok());
    CatchSettings { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold }
}

/// Everything of the settings that determines a catch.
pub fn canonical_settings(settings: &CatchSettings) -> impl Serialize + use<> {
    let CatchSettings { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold } = *settings;
    (strategy.map(Strategy::name), (ratio, strikes, brake, hold_speed, hold), state_weights, input_weight)
}

/// Price of a catch with its lasting contact, in bounces. All strategies are compared if none is asked for.
pub fn whole_catch_price(scene: &Scene, settings: &CatchSettings) -> u64 {
    let attempts = if settings.strategy.is_some() { 1 } else { STRATEGIES_COMPARED };
    catch_price(settings) + attempts * limits::CONTACT_WORK_PRICE * contact_work(scene, settings)
}

/// Price of a catch besides the work of its lasting contact, in bounces.
pub fn catch_price(settings: &CatchSettings) -> u64 {
    match settings.strategy {
        Some(Strategy::BounceDown) => CATCH_BOUNCE_DOWN_PRICE,
        Some(Strategy::Plan) => CATCH_PLAN_PRICE,
        Some(Strategy::Brake) => CATCH_BRAKE_PRICE,
        None => 2 * (CATCH_BOUNCE_DOWN_PRICE + CATCH_PLAN_PRICE) + CATCH_BRAKE_PRICE,
    }
}

/// Reads the scene of a catch or a throw, in which the table follows no law of the scene.
pub fn read_guided_scene(reader: &mut Reader<'_, '_>, analysis: Analysis) -> Option<Scene> {
    let scene = read_scene_without_law(reader)?;
    (!refuse_lacking(reader, &scene, analysis)).then_some(scene)
}

impl ResourceRequest for CatchRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let scene = read_guided_scene(reader, Analysis::Catch);
        let options = CatchOptions::read(reader);
        Some(Self { scene: scene?, options })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(limits::ANSWER_PRICE + self.options.price(&self.scene)).within(&limits.of_work())
    }
}

impl CanonicalRequest for CatchRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(&self.scene, &self.options.canonical())
    }
}
