//! The air of a scene: reads its drag, and says what it does.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::Name;
use super::{BodyShape, Scene};
use crate::map::flight::AirDrag;

/// Fields of the air.
pub(crate) const AIR: [Name; 2] = [Name::Drag, Name::RotationDrag];

impl Draft {
    /// The drag of the air; `None` without any.
    pub(super) fn air(&self, body: BodyShape, errors: &mut Vec<FieldError>) -> Option<AirDrag> {
        let [linear, rotational] = AIR.map(|name| self.number(name).unwrap_or(0.0));
        if rotational != 0.0 && body == BodyShape::Point {
            let detail = "air.rotation_drag is for a body that turns; a point mass has no angle of its own";
            errors.push(FieldError::new(Name::RotationDrag, detail.to_owned()));
        }
        AirDrag::new(linear, rotational)
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
