//! A scene as text: `path=value` of each field, between spaces or lines. Not here: JSON and query strings, which are the server's.

use std::str::FromStr;

use super::build::Scene;
use super::draft::Draft;
use super::error::FieldError;
use super::fields::{Field, FieldKind, Value, field};
use crate::map::table::program::HeightProgram;

impl FromStr for Scene {
    type Err = Vec<FieldError>;

    /// Reads a scene; numbers in SI units, lists of numbers between commas. Vertices of a polygon are set by [`Draft::set_vertices`] alone.
    /// Fails with every field that is unknown, missing, out of its range, or contradicts another one.
    fn from_str(text: &str) -> Result<Self, Vec<FieldError>> {
        let (mut draft, mut errors) = (Draft::default(), Vec::new());
        for entry in text.split_whitespace() {
            let (path, value) = entry.split_once('=').unwrap_or((entry, ""));
            let set = match field(path) {
                None => Err(FieldError::at("", format!("{path} is no field"))),
                Some(row) => match row.read(value) {
                    None => {
                        Err(FieldError::at(row.path, format!("{} is {value}; it must be {}", row.key(), row.limits())))
                    }
                    read => draft.set(row.name, read),
                },
            };
            errors.extend(set.err());
        }
        if errors.is_empty() { draft.build() } else { Err(errors) }
    }
}

impl Field {
    /// Reads a value of the field's kind, in any range.
    fn read(&self, text: &str) -> Option<Value> {
        match self.kind {
            FieldKind::Number { .. } => text.parse().ok().map(Value::Number),
            FieldKind::Integer { .. } => text.parse().ok().map(Value::Integer),
            FieldKind::Choice(words) => words.iter().find(|word| **word == text).copied().map(Value::Choice),
            FieldKind::Flag => (text == "true").then_some(Value::Flag(true)),
            FieldKind::Numbers { .. } => {
                let numbers = text.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?;
                HeightProgram::new(&numbers).map(Value::Numbers)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Name;

    const RIG: &str =
        "body.contact_distance=0.133 body.radius_of_gyration=0.094 table.tilt_gain=1.1 release.height=0.3";

    #[test]
    fn every_kind_of_value_is_read() {
        let text = format!("{RIG}\ntable.program=0.2,0.3 contact.law=newton noise.seed=7 noise.timing_sd=1e-3");
        let scene: Scene = text.parse().unwrap();
        assert_eq!(scene.number(Name::TiltGain), Some(1.1));
        assert_eq!(scene.value(Name::Seed), Some(Value::Integer(7)));
        assert_eq!(scene.value(Name::Law), Some(Value::Choice("newton")));
        assert_eq!(scene.value(Name::Program), Some(Value::Numbers(HeightProgram::new(&[0.2, 0.3]).unwrap())));
    }

    #[test]
    fn every_error_names_its_field() {
        let told = |text: &str| -> Vec<String> {
            let errors = format!("{RIG} {text}").parse::<Scene>().unwrap_err();
            errors.iter().map(|error| format!("{}: {}", error.path, error.detail)).collect()
        };
        assert_eq!(
            told("gravity=heavy contact.law=poison air.drags=1 table.delay=2"),
            [
                "gravity: gravity is heavy; it must be from 0.1 to 100 m/s²",
                "contact.law: law is poison; it must be one of poisson, newton, stronge",
                ": air.drags is no field",
                "table.delay: delay is 2; it must be from 0 to 1 s",
            ]
        );
        assert!("".parse::<Scene>().unwrap_err().iter().any(|error| error.path == "body"));
    }
}
