//! The turning table of a scene: reads its pivot, refuses what contradicts it, and says what it does.

use super::Scene;
use super::draft::Draft;
use super::error::FieldError;
use super::fields::{Name, Value};
use super::words::Alternative;
use crate::map::table::noise::{Noise, NoiseModel};
use crate::map::table::pivot::{TiltRate, TurningTable};

/// Fields of the turning table.
pub(crate) const TURNING: [Name; 3] = [Name::TiltRate, Name::PivotX, Name::PivotDepth];

impl Draft {
    /// The turning table. `None` if it does not turn as it strikes, and if it turns about the contact.
    pub(super) fn turning(&self, noise: Option<Noise>, errors: &mut Vec<FieldError>) -> Option<TurningTable> {
        let word = match self.get(Name::TiltRate) {
            Some(Value::Choice(word)) => word,
            _ => return None,
        };
        let is_corrected = match TiltRate::from_word(word)? {
            TiltRate::None => return None,
            TiltRate::Follows => false,
            TiltRate::Corrected => true,
        };
        if noise.is_some_and(|noise| noise.model == NoiseModel::Plan) {
            let detail = format!(
                "tilt_rate `{word}` is of a table that follows the body, and noise.model `plan` of one that holds what it has planned; \
                 leave one of them out"
            );
            errors.push(FieldError::new(Name::TiltRate, detail));
        }
        let (place, depth) = (self.number(Name::PivotX), self.number(Name::PivotDepth).unwrap_or(0.0));
        (place.is_some() || depth != 0.0).then_some(TurningTable { place, depth, is_corrected })
    }
}

impl Scene {
    /// The turning table, if its turning changes the motion of the body.
    pub fn acting_turn(&self) -> Option<TurningTable> {
        self.turning.filter(|turning| turning.acts(self.contact_friction().as_ref()))
    }

    /// A sentence on a table that turns as it strikes.
    pub(super) fn turning_detail(&self) -> Option<String> {
        let turning = self.turning?;
        let TurningTable { place, depth, is_corrected } = turning;
        let about = match place {
            Some(place) => format!("at x = {place} m and {depth} m below its surface"),
            None => format!("{depth} m below the contact"),
        };
        let law = if is_corrected { ", which its law corrects its speed for" } else { "" };
        let friction = self.contact_friction();
        let effect = match (turning.strikes(), turning.drags(friction.as_ref())) {
            (true, true) => "its surface strikes and drags the contact point besides",
            (true, false) => "its surface strikes the contact point besides",
            (false, true) => "its surface drags the contact point along",
            (false, false) => "its surface moves along itself at most, which changes no bounce here",
        };
        Some(format!("the table turns as it strikes, about a pivot {about}{law}: {effect}"))
    }
}
