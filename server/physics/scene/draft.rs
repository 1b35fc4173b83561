//! Collects the values of a scene one by one, each checked against its row.

use super::error::FieldError;
use super::fields::{FIELDS, Name, Value};
use crate::map::polygon::Vertices;
use crate::map::table::program::HeightProgram;

/// Path of the vertices of a polygon.
pub const VERTICES: &str = "body.vertices";

/// A value as a draft keeps it: short, because scenes are copied often.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slot {
    Number(f64),
    Integer(u64),
    Choice(&'static str),
    Flag(bool),
    /// The list of the draft.
    List,
}

/// Values of fields, one slot for each row of [`FIELDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draft {
    slots: [Option<Slot>; FIELDS.len()],
    /// Value of the only field that is a list.
    list: Option<HeightProgram>,
    pub(super) vertices: Option<Vertices>,
}

impl Default for Draft {
    fn default() -> Self {
        Self { slots: [None; FIELDS.len()], list: None, vertices: None }
    }
}

impl Draft {
    /// Sets a value, or clears it with None.
    ///
    /// # Errors
    /// The value is not of the field's kind, or is out of its range.
    pub fn set(&mut self, name: Name, value: Option<Value>) -> Result<(), FieldError> {
        let row = name.row();
        if let Some(value) = value.filter(|&value| !row.admits(value)) {
            return Err(FieldError::new(name, format!("{} is {value}; it must be {}", row.key(), row.limits())));
        }
        self.put(name, value);
        Ok(())
    }

    /// [`Draft::set`] in a run: the field takes the place of [`Name::other_way`].
    ///
    /// # Errors
    /// Same as [`Draft::set`].
    pub fn replace(&mut self, name: Name, value: Value) -> Result<(), FieldError> {
        self.set(name, Some(value))?;
        if let Some(other) = name.other_way() {
            self.put(other, None);
        }
        Ok(())
    }

    /// Sets a value that the row admits, or clears it.
    pub(super) fn put(&mut self, name: Name, value: Option<Value>) {
        let slot = value.map(|value| match value {
            Value::Number(number) => Slot::Number(number),
            Value::Integer(number) => Slot::Integer(number),
            Value::Choice(word) => Slot::Choice(word),
            Value::Flag(flag) => Slot::Flag(flag),
            Value::Numbers(list) => {
                self.list = Some(list);
                Slot::List
            }
        });
        if self.slots[name as usize] == Some(Slot::List) && slot.is_none() {
            self.list = None;
        }
        self.slots[name as usize] = slot;
    }

    /// Gives a field without a value this one.
    pub(super) fn fill(&mut self, name: Name, value: Value) {
        if self.slots[name as usize].is_none() {
            self.put(name, Some(value));
        }
    }

    /// Value of a field; after [`Draft::build`], with defaults.
    pub fn get(&self, name: Name) -> Option<Value> {
        self.slots[name as usize].and_then(|slot| match slot {
            Slot::Number(number) => Some(Value::Number(number)),
            Slot::Integer(number) => Some(Value::Integer(number)),
            Slot::Choice(word) => Some(Value::Choice(word)),
            Slot::Flag(flag) => Some(Value::Flag(flag)),
            Slot::List => self.list.map(Value::Numbers),
        })
    }

    /// Sets the vertices of a polygon, or clears them with None.
    pub fn set_vertices(&mut self, vertices: Option<Vertices>) {
        self.vertices = vertices;
    }

    /// Vertices, if the body is a polygon.
    pub fn vertices(&self) -> Option<&Vertices> {
        self.vertices.as_ref()
    }

    /// Tells whether the body is a point mass.
    pub fn is_point(&self) -> bool {
        self.get(Name::PointMass) == Some(Value::Flag(true))
    }

    /// Value of a field that is a number.
    pub(super) fn number(&self, name: Name) -> Option<f64> {
        match self.get(name) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::trig;

    pub(crate) fn draft(values: &[(Name, f64)]) -> Draft {
        let mut draft = Draft::default();
        for &(name, number) in values {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        draft
    }

    const ROD: [(Name, f64); 4] = [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 0.094),
        (Name::TiltGain, 1.1),
        (Name::Height, 0.2),
    ];

    fn paths(draft: Draft) -> Vec<&'static str> {
        draft.build().unwrap_err().iter().map(|error| error.path).collect()
    }

    #[test]
    fn defaults_are_filled_in() {
        let scene = draft(&ROD).build().unwrap();
        assert_eq!(scene.value(Name::Gravity), Some(Value::Number(9.81)));
        assert_eq!(scene.gravity(), 9.81);
        assert_eq!(scene.value(Name::TargetHeight), None);
    }

    #[test]
    fn everything_missing_is_named_at_once() {
        assert_eq!(paths(Draft::default()), ["body", "table.tilt_gain", "release.height"]);
        assert_eq!(paths(draft(&ROD[1..])), ["body.contact_distance"]);
    }

    #[test]
    fn contradictions_are_errors() {
        let mut point = draft(&ROD);
        point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
        assert_eq!(paths(point), ["body.contact_distance", "body.radius_of_gyration"]);
        let mut still = draft(&ROD);
        still.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        still.set(Name::EnergyGain, Some(Value::Number(0.1))).unwrap();
        assert_eq!(paths(still), ["table.energy_gain", "table.target_height"]);
    }

    #[test]
    fn a_release_below_the_table_is_refused_and_one_on_it_is_not() {
        let mut low = draft(&ROD);
        low.set(Name::Height, Some(Value::Number(0.13))).unwrap();
        assert_eq!(paths(low), ["release.height"]);
        low.set(Name::Theta, Some(Value::Number(0.3))).unwrap();
        low.set(Name::Height, Some(Value::Number(0.4 / 3.0 * trig::sin_cos(0.3).1))).unwrap();
        low.build().unwrap();
    }

    #[test]
    fn feedback_takes_the_place_of_the_tilt_gain() {
        let mut both = draft(&ROD);
        both.set(Name::FeedbackX, Some(Value::Number(1.0))).unwrap();
        assert_eq!(paths(both), ["table.tilt_gain"]);
        both.set(Name::TiltGain, None).unwrap();
        let scene = both.build().unwrap();
        assert_eq!(scene.value(Name::FeedbackThetaDot), Some(Value::Number(0.0)));
    }

    #[test]
    fn noise_has_a_model_and_a_seed_where_there_is_any() {
        let quiet = draft(&[&ROD[..], &[(Name::TimingSd, 0.0)]].concat()).build().unwrap();
        assert_eq!(quiet.value(Name::Seed), None);
        let noisy = draft(&[&ROD[..], &[(Name::AngleSd, 0.01)]].concat()).build().unwrap();
        assert_eq!(noisy.value(Name::Seed), Some(Value::Integer(0)));
        assert_eq!(noisy.value(Name::NoiseModel), Some(Value::Choice("strike")));
    }
}
