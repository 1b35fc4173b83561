//! The air of a scene: reads its drag, refuses what is not derived with it, and says what it does.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::Name;
use super::{BodyShape, Scene};
use crate::map::flight::AirDrag;
use crate::map::table::noise::{Noise, NoiseModel};

/// Fields of the air.
pub(crate) const AIR: [Name; 2] = [Name::Drag, Name::RotationDrag];

impl Draft {
    /// The drag of the air; `None` without any.
    pub(super) fn air(
        &self,
        (body, is_polygon): (BodyShape, bool),
        turns: bool,
        noise: Option<Noise>,
        delay: f64,
        errors: &mut Vec<FieldError>,
    ) -> Option<AirDrag> {
        let [linear, rotational] = AIR.map(|name| self.number(name).unwrap_or(0.0));
        let drag = AirDrag::new(linear, rotational)?;
        let name = if linear != 0.0 { Name::Drag } else { Name::RotationDrag };
        let (path, rate) = (name.row().path, f64::max(linear, rotational));
        let plans = noise.is_some_and(|noise| noise.model == NoiseModel::Plan);
        for (excluded, what) in [
            (body == BodyShape::Point, "a point mass"),
            (is_polygon, "a polygon (body.vertices)"),
            (plans, "a table that plans its motion (noise.model `plan`)"),
            (delay != 0.0, "a table that senses before the strike (table.delay)"),
            (turns, "a table that turns as it strikes (table.tilt_rate)"),
        ] {
            if excluded {
                let detail = format!(
                    "{path} is {rate} 1/s, and flights through air are not derived for {what}; leave one of them out"
                );
                errors.push(FieldError::new(name, detail));
            }
        }
        Some(drag)
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
