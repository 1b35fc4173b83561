//! The outcome of a run in words and numbers. The physics decides when a run ends.

use equipoise_physics::body::Touch;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::rules::SPEED_LIMIT;
use equipoise_physics::table::actuator_load::LimitViolation;
use serde::Serialize;

/// The outcome of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Name of the ending.
    pub kind: &'static str,
    /// Number of contacts, with the last.
    pub impacts: u64,
    /// Time of the last contact, s, or of the touch of another vertex after it.
    pub t: f64,
    /// A sentence with the numbers.
    pub detail: String,
    /// Quantity that passed a limit, if one did.
    pub quantity: Option<&'static str>,
    /// Value of the quantity.
    pub value: Option<f64>,
    /// Limit of the quantity.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: Option<&'static str>,
    /// Time at which a settling run comes to rest, s.
    pub settle_time: Option<f64>,
}

impl Outcome {
    /// The outcome of a run that ended at contact `impacts`, at time `t`, s.
    pub fn new(ending: Ending, impacts: u64, t: f64) -> Self {
        let at = format!("at contact {impacts}, t = {t} s");
        let t = if let Ending::OtherVertex(touch) = ending { t + touch.t } else { t };
        let (detail, decided) = match ending {
            Ending::OtherVertex(Touch { vertex, t: 0.0 }) => (
                format!("{at}, vertex {vertex} of the body was below the table's line: another one would have struck"),
                None,
            ),
            Ending::OtherVertex(Touch { vertex, t: since }) => (
                format!(
                    "{since} s after {}, vertex {vertex} of the body came down to y = 0 before the one that bounces",
                    if impacts == 0 { "the release".to_owned() } else { format!("contact {impacts}") }
                ),
                None,
            ),
            Ending::BeyondLimits(LimitViolation { quantity, value, limit, unit }) => (
                format!(
                    "{at}, the strike asks for a {quantity} of {value} {unit}; table.limits.{quantity} is {limit} {unit}"
                ),
                Some((quantity, value, limit, unit)),
            ),
            Ending::Missed => {
                (format!("after contact {impacts}, the body never meets the table as it was planned"), None)
            }
            Ending::Completed => (format!("all {impacts} contacts were computed, up to t = {t} s"), None),
            Ending::Toppled { theta, limit } => (
                format!("{at}, the angle {theta} rad had reached topple_angle {limit} rad"),
                Some(("theta", theta, limit, "rad")),
            ),
            Ending::Separating { approach } => (
                format!(
                    "{at}, the contact point left the table at {approach} m/s along its normal: it could only pull"
                ),
                Some(("approach", approach, 0.0, "m/s")),
            ),
            Ending::Sinking { contact_rise } if contact_rise > 0.0 => (
                format!(
                    "{at}, below y = 0, the contact point left at {contact_rise} m/s: it does not rise up to y = 0 again"
                ),
                Some(("contact_rise", contact_rise, 0.0, "m/s")),
            ),
            Ending::Sinking { contact_rise } => (
                format!(
                    "{at}, the strike left the contact point at {contact_rise} m/s vertically: it does not rise again"
                ),
                Some(("contact_rise", contact_rise, 0.0, "m/s")),
            ),
            Ending::Settled { flight_time: 0.0, .. } => (
                format!("{at}, the strike left the contact point at rest: the bounces end there"),
                Some(("flight_time", 0.0, 0.0, "s")),
            ),
            Ending::Settled { flight_time, settle_time } => (
                format!("{at}, the next flight would take {flight_time} s; the bounces end at t = {settle_time} s"),
                Some(("flight_time", flight_time, 0.0, "s")),
            ),
            Ending::Diverged { speed } if speed <= SPEED_LIMIT => (
                format!(
                    "after contact {impacts}, t = {t} s, the body turns so often that doubles do not resolve its next contact"
                ),
                None,
            ),
            Ending::Diverged { speed } => (
                format!("{at}, the strike gave a speed of {speed} m/s, beyond what doubles resolve"),
                Some(("speed", speed, SPEED_LIMIT, "m/s")),
            ),
        };
        let settle_time = if let Ending::Settled { settle_time, .. } = ending { Some(settle_time) } else { None };
        Self {
            kind: ending.name(),
            impacts,
            t,
            detail,
            quantity: decided.map(|(quantity, ..)| quantity),
            value: decided.map(|(_, value, ..)| value).filter(|value| value.is_finite()),
            limit: decided.map(|(_, _, limit, _)| limit),
            unit: decided.map(|(.., unit)| unit),
            settle_time,
        }
    }
}

#[cfg(test)]
mod tests {
    use equipoise_physics::run::ending::EndingKind;
    use serde_json::Value;

    #[test]
    fn the_contract_names_and_explains_every_ending() {
        let document: Value =
            serde_json::from_slice(include_bytes!(concat!(env!("OUT_DIR"), "/openapi.json"))).unwrap();
        let schemas = &document["components"]["schemas"];
        let names: Vec<&str> = EndingKind::ALL.into_iter().map(EndingKind::name).collect();
        assert_eq!(schemas["OutcomeKind"]["enum"], Value::from(names.clone()));
        assert_eq!(schemas["EnsembleCounts"]["required"], Value::from(names.clone()));
        let with_no_run: Vec<&str> = names.iter().copied().chain(["none"]).collect();
        assert_eq!(schemas["RegionCounts"]["required"], Value::from(with_no_run));
        let prose = schemas["OutcomeKind"]["description"].as_str().unwrap();
        for name in names {
            assert!(prose.contains(&format!("`{name}`:")), "{name} is not explained");
        }
    }
}
