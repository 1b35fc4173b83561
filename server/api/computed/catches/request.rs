//! The request for `catches`: a scene, and the settings of the catch.

use equipoise_physics::catching::contact_work;
use equipoise_physics::catching::plan::{FEWEST_STRIKES, MOST_STRIKES};
use equipoise_physics::catching::settings::{
    BRAKES, CatchSettings, DEFAULT_HOLD, HOLD_SPEED, PLAN_RATIOS, RATIOS, Strategy,
};
use equipoise_physics::scene::Scene;

use crate::api::prelude::*;
use crate::api::shared::request_parts::Weights;

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

request_fields! {
    /// Settings of a catch, with the size of its answer.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    pub struct CatchOptions {
        /// Settings of the physics.
        #[serde(serialize_with = "serialized")]
        pub settings: CatchSettings = Part,
        /// Largest number of rows of `hold`: every so many of 600 steps evenly in time, and the last moment.
        pub hold_samples: u64 = whole(2..=limits::HOLD_SAMPLES).or(HOLD_SAMPLES),
    }
}

request_fields! {
    /// A request for a catch. The scene need not have a law.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct CatchRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = LawlessSceneSpec,
        /// Settings of the catch.
        pub options: CatchOptions = Part,
    }
}

request_fields! {
    /// Settings of a catch as they are asked for.
    struct AskedSettings {
        /// Strategy of the catch. `bounce_down`: each strike leaves the contact point `ratio` times as fast as it came, and tilts by state feedback
        /// that is scheduled on that speed. `plan`: `strikes` strikes of `ratio` and a stop, with the least tilts after which the body is at rest;
        /// planned again at each strike, with the restitution that the strikes so far have shown. `brake`: the table meets the contact point at its
        /// own speed, without a strike, and brakes. `auto` tries `bounce_down` quickly and slowly, plans quickly and slowly, and `brake`, and takes
        /// the first that catches the body within `table.limits`.
        strategy: Option<Strategy> = choice(&STRATEGIES).or(None),
        /// Ratio of the vertical speeds of the contact point just after and just before a strike. Only for `bounce_down` (at most 0.98, by default 0.5)
        /// and `plan` (by default 0.8).
        ratio: Option<f64> = number(PLAN_RATIOS, "").optional(),
        /// Number of strikes of a plan before its stop. Only for `plan`. By default the fewest from 4 to 12 with all tilts within 0.25 rad and
        /// `table.limits`, else those with the least tilt.
        strikes: Option<u64> = whole(PLAN_STRIKES).optional(),
        /// Acceleration of the braking table. Only for `brake`. By default the gravity in the plane.
        brake: Option<f64> = number(BRAKES, "m/s²").optional(),
        /// Costs of a deviation and of a tilt. The law minimizes the sum of the weighted squares over all bounces, in SI units.
        weights: Weights = ObjectOfDefaults,
        /// Vertical speed of the contact point after a strike below which the lasting contact begins.
        hold_speed: f64 = number(HOLD_SPEEDS, "m/s").or(HOLD_SPEED),
        /// Time in contact to compute.
        hold: f64 = number(HOLDS, "s").or(DEFAULT_HOLD),
    }
}

impl CatchOptions {
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

impl Fields for CatchSettings {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let AskedSettings { strategy, ratio, strikes, brake, weights, hold_speed, hold } = Fields::read_fields(reader)?;
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
            reader.refuse(
                "ratio",
                format!("ratio is {ratio}; for bounce_down it must be from {least} to {most} (no unit)"),
            );
        }
        let strikes = strikes.and_then(|strikes| u32::try_from(strikes).ok());
        let Weights { state: state_weights, input: input_weight } = weights;
        Some(Self { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold })
    }

    fn describe_fields(list: &mut FieldList) {
        AskedSettings::describe_fields(list);
    }
}

/// Everything of the settings that determines a catch.
pub fn canonical_settings(settings: &CatchSettings) -> impl Serialize + use<> {
    let CatchSettings { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold } = *settings;
    (strategy.map(Strategy::name), (ratio, strikes, brake, hold_speed, hold), state_weights, input_weight)
}

fn serialized<S: Serializer>(settings: &CatchSettings, serializer: S) -> Result<S::Ok, S::Error> {
    canonical_settings(settings).serialize(serializer)
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

impl ResourceRequest for CatchRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let request = Self::read_fields(reader)?;
        (!refuse_lacking(reader, &request.scene, Analysis::Catch)).then_some(request)
    }

    fn work(&self) -> u64 {
        limits::ANSWER_PRICE + self.options.price(&self.scene)
    }
}
