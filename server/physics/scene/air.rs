//! The air of a scene: reads its drag, and says what it does.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::Name;
use super::{BodyShape, Scene};
use crate::map::flight::AirDrag;
use crate::numbers::number::Arithmetic;

/// Fields of the air. They have lines in the budget of a scene that names one of them.
pub(crate) const AIR: [Name; 2] = [Name::Drag, Name::RotationDrag];

/// The drag of the air, by the values of its fields; `None` without any.
pub(super) fn air_of<N: Arithmetic>(of: impl Fn(Name) -> N) -> Option<AirDrag<N>> {
    let [linear, rotational] = AIR.map(of);
    AirDrag::new(linear, rotational)
}

impl Draft {
    /// The drag of the air; `None` without any.
    pub(super) fn air(&self, body: BodyShape, errors: &mut Vec<FieldError>) -> Option<AirDrag> {
        if body == BodyShape::Point && self.number(Name::RotationDrag).is_some_and(|rate| rate != 0.0) {
            let detail = "air.rotation_drag is for a body that turns; a point mass has no angle of its own";
            errors.push(FieldError::new(Name::RotationDrag, detail.to_owned()));
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
        let AirDrag { linear, rotational } = self.drag?;
        Some(match (linear != 0.0, rotational != 0.0) {
            (true, true) => {
                format!("the air takes {linear} 1/s of the velocity and {rotational} 1/s of the spin in flight")
            }
            (true, false) => format!("the air takes {linear} 1/s of the velocity in flight"),
            (false, _) => format!("the air takes {rotational} 1/s of the spin in flight"),
        })
    }
}
