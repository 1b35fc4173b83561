//! The rig as it is: reads the constant errors of a scene, and says what they do.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::Name;
use super::{BodyShape, Scene, Striking};
use crate::map::table::errors::TableErrors;
use crate::numbers::rounded::rounded;

/// Fields of the constant errors.
pub(crate) const ERRORS: [Name; 5] =
    [Name::AngleBias, Name::TiltOffset, Name::TiltGainError, Name::SpeedError, Name::Offset];

impl Draft {
    /// The constant errors; 0 where a field has no value.
    pub(crate) fn table_errors(&self) -> TableErrors {
        let [angle_bias, tilt_offset, tilt_gain, speed, offset] = ERRORS.map(|name| self.number(name).unwrap_or(0.0));
        TableErrors { angle_bias, tilt_offset, tilt_gain, speed, offset }
    }

    /// Refuses an error of the table's speed where the table has none.
    pub(super) fn refuse_speed_error(&self, strike: Striking, errors: &mut Vec<FieldError>) {
        if strike == Striking::Still && self.number(Name::SpeedError).is_some_and(|error| error != 0.0) {
            let detail = "errors.speed is of a table that moves and strike says `still`; leave one of them out";
            errors.push(FieldError::new(Name::SpeedError, detail.to_owned()));
        }
    }
}

impl Name {
    /// Tells whether a field is a constant error of the rig, which is 0 in a scene that leaves it out.
    pub(crate) fn is_rig_error(self) -> bool {
        ERRORS.contains(&self)
    }
}

impl Scene {
    /// The constant errors of the rig.
    pub fn table_errors(&self) -> &TableErrors {
        &self.errors
    }

    /// Tilt of the table beside its law of the true angle, rad: 0 on a rig without constant errors.
    pub fn constant_tilt(&self) -> f64 {
        self.constant_tilt
    }

    /// 1 + ε_α: the table tilts by so many times its law.
    pub fn tilt_factor(&self) -> f64 {
        1.0 + self.errors.tilt_gain
    }

    /// 1 + ε_w: the table moves at so many times its law.
    pub fn speed_factor(&self) -> f64 {
        1.0 + self.errors.speed
    }

    /// True if a constant error changes the tilt gain, the table's speed or the contact distance of a body with an angle. These are then products
    /// and roots that doubles round, once for all bounces.
    pub fn rounds_parameters(&self) -> bool {
        let TableErrors { tilt_gain, speed, offset, .. } = self.errors;
        self.body != BodyShape::Point && [tilt_gain, speed, offset].iter().any(|error| *error != 0.0)
    }

    /// Restitution that the table is told, whatever the error of its speed.
    pub(crate) fn specified_restitution(&self) -> f64 {
        self.number(Name::AssumedRestitution).unwrap_or(self.restitution)
    }

    /// The restitution by which the table acts and the one that it meets, in words.
    pub fn belief(&self) -> String {
        let (effective, met, error) = (self.assumed_restitution(), self.restitution, self.errors.speed);
        if self.moves_late() {
            return format!(
                "the table moves by the speed {} s before the strike, as if it believed restitution {effective}, and it meets {met}",
                self.lag
            );
        }
        if error == 0.0 {
            format!("the table believes restitution {effective} and meets {met}")
        } else {
            format!(
                "the table's speed is {} times its law, as if it believed restitution {effective}, and it meets {met}",
                1.0 + error
            )
        }
    }

    /// The first field of a constant error that is not 0.
    pub(crate) fn first_error(&self) -> Option<Name> {
        ERRORS.into_iter().find(|&name| self.number(name).is_some_and(|error| error != 0.0))
    }

    /// The field of a constant error that asks for more than an ideal rig, with a sentence.
    pub(super) fn error_requirement(&self) -> Option<(Name, String)> {
        let name = self.first_error()?;
        let TableErrors { angle_bias, tilt_offset, tilt_gain, speed, offset } = self.errors;
        let [angle_bias, tilt_offset, offset] = [angle_bias, tilt_offset, offset].map(rounded);
        let mut said = Vec::new();
        let mut say = |error: f64, words: String| {
            if error != 0.0 {
                said.push(words);
            }
        };
        say(angle_bias, format!("the angle is sensed {angle_bias} rad too large"));
        say(tilt_offset, format!("the table tilts {tilt_offset} rad too far"));
        say(tilt_gain, format!("the table tilts by {} times its law", rounded(1.0 + tilt_gain)));
        say(speed, format!("the table moves at {} times its law", rounded(1.0 + speed)));
        say(offset, format!("the centre of gravity is {offset} m off the axis"));
        let effect = match self.constant_tilt {
            0.0 => "all of it other gains of the table".to_owned(),
            tilt => format!("the table tilts by {} rad beside its law", rounded(tilt)),
        };
        Some((name, format!("{}: {effect}", said.join(", "))))
    }
}
