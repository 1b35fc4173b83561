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
    /// Sets a value, or clears it with None. Fails if it is not of the field's kind, or out of its range.
    pub fn set(&mut self, name: Name, value: Option<Value>) -> Result<(), FieldError> {
        let row = name.row();
        if let Some(value) = value.filter(|&value| !row.admits(value)) {
            return Err(FieldError::new(name, format!("{} is {value}; it must be {}", row.key(), row.limits())));
        }
        self.put(name, value);
        Ok(())
    }

    /// [`Draft::set`] in a run: the field takes the place of [`Name::other_way`].
    pub fn replace(&mut self, name: Name, value: Value) -> Result<(), FieldError> {
        self.set(name, Some(value))?;
        if let Some(other) = name.other_way() {
            self.put(other, None);
        }
        Ok(())
    }

    /// The same draft with other numbers in fields, or without a value. Fails as [`Draft::set`] does.
    pub(crate) fn with(mut self, values: impl IntoIterator<Item = (Name, Option<f64>)>) -> Result<Self, FieldError> {
        for (name, value) in values {
            self.set(name, value.map(Value::Number))?;
        }
        Ok(self)
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
