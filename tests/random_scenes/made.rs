//! Random scenes and the requests for them.

use equipoise_physics::scene::{FIELDS, FieldKind, Name, VERTICES};
use proptest::prelude::*;
use serde_json::{Map, Value, json};

/// Typical values of a lab. Other fields are drawn from their whole range.
pub(super) const USUAL: [(Name, f64, f64); 30] = [
    (Name::ContactDistance, 0.05, 0.5),
    (Name::RadiusOfGyration, 0.03, 0.5),
    (Name::Gravity, 1.0, 10.0),
    (Name::Incline, 0.1, 1.57),
    (Name::Restitution, 0.3, 1.0),
    (Name::Friction, 0.0, 0.6),
    (Name::TiltGain, 0.5, 3.0),
    (Name::EnergyGain, -0.1, 0.3),
    (Name::TargetHeight, 0.2, 0.8),
    (Name::Theta, -0.3, 0.3),
    (Name::ThetaDot, -2.0, 2.0),
    (Name::XDot, -0.5, 0.5),
    (Name::TimingSd, 0.0, 0.002),
    (Name::AngleSd, 0.0, 0.01),
    (Name::XSd, 0.0, 0.005),
    (Name::XDotSd, 0.0, 0.02),
    (Name::YDotSd, 0.0, 0.02),
    (Name::ThetaDotSd, 0.0, 0.05),
    (Name::RestitutionSd, 0.0, 0.05),
    (Name::Offset, -0.01, 0.01),
    (Name::AngleBias, -0.01, 0.01),
    (Name::TiltOffset, -0.01, 0.01),
    (Name::TiltGainError, -0.1, 0.1),
    (Name::SpeedError, -0.1, 0.1),
    (Name::TableLength, 0.2, 5.0),
    (Name::PivotX, -0.5, 0.5),
    (Name::PivotDepth, -0.1, 0.1),
    (Name::Delay, 0.0, 0.05),
    (Name::Drag, 0.0, 0.5),
    (Name::RotationDrag, 0.0, 0.5),
];

/// Number of fields at the beginning of [`USUAL`] that are of the body, the contact and the law of the table.
pub(super) const USUAL_BODY_AND_LAW: usize = 9;

/// Ingredients of a random scene: for each field, its place in its range, if it is set; and the body.
#[derive(Clone, Debug)]
pub(super) struct Made {
    fields: Vec<Option<(f64, bool)>>,
    above: f64,
    body: Body,
    tilts: Tilts,
    noisy: bool,
}

#[derive(Clone, Debug)]
enum Body {
    Preset(usize),
    Rod,
    Point,
    /// Radii of the corners, in order.
    Polygon(Vec<f64>),
}

/// Control law of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tilts {
    Gain,
    Feedback,
}

prop_compose! {
    pub(super) fn made()(
        fields in prop::collection::vec(prop::option::weighted(0.35, (0.0..=1.0, prop::bool::weighted(0.15))), FIELDS.len()),
        above in 0.0..1.0,
        body in prop_oneof![
            2 => (0..64_usize).prop_map(Body::Preset),
            5 => Just(Body::Rod),
            1 => Just(Body::Point),
            2 => prop::collection::vec(0.05..0.2, 3..9).prop_map(Body::Polygon),
        ],
        tilts in prop_oneof![6 => Just(Tilts::Gain), 1 => Just(Tilts::Feedback)],
        // Rarely, because half of the resources refuse it.
        noisy in prop::bool::weighted(0.3),
    ) -> Made {
        Made { fields, above, body, tilts, noisy }
    }
}

impl Made {
    /// The scene of a request, and its preset if it has one. Most scenes are free of contradictions.
    pub(super) fn put_into(&self, request: &mut Value, presets: &[String], plain: bool) {
        let mut scene = json!({});
        let tilts = if plain { Tilts::Gain } else { self.tilts };
        let is_point = matches!(self.body, Body::Point);
        match &self.body {
            Body::Preset(index) => request["preset"] = json!(presets[index % presets.len()]),
            Body::Rod => {}
            Body::Point => put(&mut scene, Name::PointMass.row().path, json!(true)),
            Body::Polygon(radii) => {
                let corner = |(index, radius): (usize, &f64)| {
                    let angle = std::f64::consts::TAU * (index as f64 / radii.len() as f64 - 0.25);
                    json!([radius * angle.cos(), radius * angle.sin()])
                };
                put(&mut scene, VERTICES, radii.iter().enumerate().map(corner).collect());
            }
        }
        let said = |name: Name| self.fields[name as usize].is_some();
        let second = |name: Name| self.fields[name as usize].is_some_and(|(share, _)| share >= 0.5);
        let still = second(Name::Strike);
        let one_strike = second(Name::EnergyLaw) && !still;
        for row in &FIELDS {
            let group = row.group();
            let fits = match row.name {
                Name::Friction | Name::Slide if plain => false,
                _ if plain && ["table.feedback.", "noise."].iter().any(|group| row.path.starts_with(group)) => false,
                Name::PointMass => false,
                Name::ContactDistance | Name::RadiusOfGyration => matches!(self.body, Body::Rod),
                Name::ContactVertex => false,
                Name::Theta | Name::ThetaDot | Name::Friction | Name::Slide | Name::Law if is_point => false,
                Name::EnergyGain | Name::AssumedRestitution | Name::EnergyLaw if still => false,
                Name::EnergyGain | Name::EnergyMeasure | Name::Friction if one_strike => false,
                Name::TargetHeight if said(Name::Program) => false,
                Name::TiltGain => tilts == Tilts::Gain,
                _ if row.path.starts_with("table.feedback.") => tilts == Tilts::Feedback,
                // Many resources refuse rigs that are not ideal, so few scenes have one.
                Name::Offset => self.above > 0.85 && !plain && matches!(self.body, Body::Rod),
                Name::SpeedError if still || one_strike => false,
                Name::TableLength => self.above > 0.85 && !plain,
                // A table does not turn and plan, and nothing is a limit of its motion then.
                Name::TiltRate | Name::PivotX | Name::PivotDepth => self.above > 0.8 && !plain && !is_point,
                Name::NoiseModel if self.above > 0.8 => false,
                Name::Drag | Name::RotationDrag => {
                    (0.2..0.35).contains(&self.above) && !plain && matches!(self.body, Body::Rod)
                }
                Name::Delay | Name::Prediction => (0.5..0.7).contains(&self.above) && !plain && !is_point,
                _ if row.path.starts_with("table.errors.") => self.above > 0.85 && !plain && !is_point,
                // Limits of the table end a run soon, so few scenes have them.
                _ if row.path.starts_with("table.limits.") => self.above < 0.2,
                _ => group != "noise" || (self.noisy && !is_point),
            };
            let needed = match row.name {
                Name::TargetHeight => one_strike || (said(Name::EnergyGain) && !still),
                _ => row.required && !matches!(self.body, Body::Preset(_)),
            };
            if fits && (said(row.name) || needed) {
                put(&mut scene, row.path, self.value(row.name));
            }
        }
        let takes_back = [
            (Name::TiltGain, tilts == Tilts::Feedback),
            (Name::TargetHeight, said(Name::Program)),
            (Name::EnergyGain, one_strike),
        ];
        for (name, _) in takes_back.into_iter().filter(|(_, back)| *back && matches!(self.body, Body::Preset(_))) {
            put(&mut scene, name.row().path, Value::Null);
        }
        if !matches!(self.body, Body::Preset(_)) {
            let length = scene.pointer("/body/contact_distance").and_then(Value::as_f64).unwrap_or(0.3);
            put(&mut scene, Name::Height.row().path, json!(length * (1.0 + self.above)));
        }
        if scene != json!({}) {
            request["scene"] = scene;
        }
    }

    fn value(&self, name: Name) -> Value {
        let (share, anything) = self.fields[name as usize].unwrap_or((0.5, false));
        match name.row().kind {
            FieldKind::Number { minimum, maximum } => {
                let usual = USUAL.iter().find(|(usual, ..)| *usual == name && !anything);
                let (low, high) = usual.map_or((minimum, maximum), |(_, low, high)| (*low, *high));
                json!((low + share * (high - low)).clamp(minimum, maximum))
            }
            FieldKind::Integer { maximum } => json!((share * maximum as f64) as u64),
            FieldKind::Choice(words) => json!(words[((share * words.len() as f64) as usize).min(words.len() - 1)]),
            FieldKind::Flag => json!(true),
            FieldKind::Numbers { minimum, maximum, most } => {
                let (_, low, high) =
                    USUAL.iter().find(|(usual, ..)| *usual == Name::TargetHeight).expect("it is there");
                let (low, high) = if anything { (minimum, maximum) } else { (*low, *high) };
                let count = 1 + (share * most as f64) as usize % most;
                (0..count)
                    .map(|n| json!((low + (high - low) * (share + 0.618 * n as f64).fract()).clamp(minimum, maximum)))
                    .collect()
            }
        }
    }
}

fn put(scene: &mut Value, path: &str, value: Value) {
    let mut at = scene;
    for part in path.split('.') {
        at = at.as_object_mut().expect("a group").entry(part).or_insert_with(|| Value::Object(Map::new()));
    }
    *at = value;
}

/// The query equivalent of a body. A null becomes the word `null`.
pub(super) fn query(body: &Value) -> String {
    fn below(path: &str, value: &Value, into: &mut Vec<(String, String)>) {
        let inner = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match value {
            Value::Object(fields) => fields.iter().for_each(|(name, value)| below(&inner(name), value, into)),
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(index, item)| below(&inner(&index.to_string()), item, into));
            }
            Value::String(text) => into.push((path.to_owned(), text.clone())),
            other => into.push((path.to_owned(), other.to_string())),
        }
    }
    let mut parameters = Vec::new();
    below("", body, &mut parameters);
    form_urlencoded::Serializer::new(String::new()).extend_pairs(parameters).finish()
}
