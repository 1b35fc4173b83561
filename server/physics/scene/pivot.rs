//! The turning table of a scene: reads its pivot, refuses what is not derived with it, and says what it does.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::{Name, Value};
use super::words::Alternative;
use super::{BodyShape, Scene};
use crate::map::table::noise::{Noise, NoiseModel};
use crate::map::table::pivot::{TiltRate, TurningTable};

/// Fields of the turning table.
pub(crate) const TURNING: [Name; 3] = [Name::TiltRate, Name::PivotX, Name::PivotDepth];

/// Limits that are derived for a table that does not turn.
const MOTION_LIMITS: [Name; 3] = [Name::TiltRateLimit, Name::SpeedLimit, Name::StrokeLimit];

impl Draft {
    /// The turning table. `None` if it does not turn as it strikes, and if it turns about the contact.
    pub(super) fn turning(
        &self,
        body: BodyShape,
        noise: Option<Noise>,
        lag: f64,
        errors: &mut Vec<FieldError>,
    ) -> Option<TurningTable> {
        let word = match self.get(Name::TiltRate) {
            Some(Value::Choice(word)) => word,
            _ => return None,
        };
        let is_corrected = match TiltRate::from_word(word)? {
            TiltRate::None => return None,
            TiltRate::Follows => false,
            TiltRate::Corrected => true,
        };
        let mut refuse = |name, detail| errors.push(FieldError::new(name, detail));
        if body == BodyShape::Point {
            let detail = format!("tilt_rate `{word}` is for a body with an angle; a point mass has none here");
            refuse(Name::TiltRate, detail);
        }
        if noise.is_some_and(|noise| noise.model == NoiseModel::Plan) {
            let detail = format!(
                "tilt_rate `{word}` is of a table that follows the body, and noise.model `plan` of one that holds what it has planned; \
                 leave one of them out"
            );
            refuse(Name::TiltRate, detail);
        }
        let (place, depth) = (self.number(Name::PivotX), self.number(Name::PivotDepth).unwrap_or(0.0));
        let turning = (place.is_some() || depth != 0.0).then_some(TurningTable { place, depth, is_corrected })?;
        let sensed = noise.and_then(|noise| Self::first_sensing_error(&noise)).or((lag != 0.0).then_some(Name::Delay));
        if let Some(name) = sensed {
            let detail = format!(
                "{} is of a table that does not turn as it strikes, and tilt_rate is `{word}` with table.pivot; leave one of them out",
                name.row().path
            );
            refuse(name, detail);
        }
        for limit in MOTION_LIMITS.into_iter().filter(|limit| self.get(*limit).is_some()) {
            let detail = format!(
                "limits.{} is of a table that does not turn as it strikes, and tilt_rate is `{word}` with table.pivot; leave one of them \
                 out",
                limit.row().key()
            );
            refuse(limit, detail);
        }
        Some(turning)
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
