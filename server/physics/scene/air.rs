//! The air of a scene: reads its drag, and says what it does.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::Name;
use super::{BodyShape, Scene};
use crate::map::flight::AirDrag;
use crate::numbers::number::Arithmetic;

/// Fields of the air. They have lines in the budget of a scene that names one of them.
pub(crate) const AIR: [Name; 3] = [Name::Drag, Name::RotationDrag, Name::Wind];

/// The drag of the air, by the values of its fields; `None` without any.
pub(super) fn air_of<N: Arithmetic>(of: impl Fn(Name) -> N) -> Option<AirDrag<N>> {
    let [linear, rotational, wind] = AIR.map(of);
    AirDrag::new(linear, rotational).map(|drag| AirDrag { wind, ..drag })
}

impl Draft {
    /// The drag of the air; `None` without any.
    pub(super) fn air(&self, body: BodyShape, errors: &mut Vec<FieldError>) -> Option<AirDrag> {
        if body == BodyShape::Point && self.number(Name::RotationDrag).is_some_and(|rate| rate != 0.0) {
            let detail = "air.rotation_drag is for a body that turns; a point mass has no angle of its own";
            errors.push(FieldError::new(Name::RotationDrag, detail.to_owned()));
        }
        if self.number(Name::Wind).is_some() && self.number(Name::Drag).is_none() {
            let detail = "air.wind acts by the drag of the air; give air.drag too, or leave the wind out";
            errors.push(FieldError::new(Name::Wind, detail.to_owned()));
        }
        air_of(|name| self.number(name).unwrap_or(0.0))
    }
}

impl Scene {
    /// Air that drags the body in flight, if it does.
    pub fn drag(&self) -> Option<AirDrag> {
        self.drag
    }

    /// The field by which the air drags the body, if it does.
    pub fn drag_field(&self) -> Option<Name> {
        self.drag.map(|drag| if drag.linear != 0.0 { Name::Drag } else { Name::RotationDrag })
    }

    /// A sentence on the air.
    pub(super) fn drag_detail(&self) -> Option<String> {
        let AirDrag { linear, rotational, wind } = self.drag?;
        let of_place = match wind {
            0.0 => format!("{linear} 1/s of the velocity"),
            wind => format!("{linear} 1/s of the velocity relative to its own, {wind} m/s along x,"),
        };
        Some(match (linear != 0.0, rotational != 0.0) {
            (true, true) => format!("the air takes {of_place} and {rotational} 1/s of the spin in flight"),
            (true, false) => format!("the air takes {of_place} in flight"),
            (false, _) => format!("the air takes {rotational} 1/s of the spin in flight"),
        })
    }
}
