//! Says in sentences why a scene needs its model.

use super::fields::Name;
use super::model::{ModelLevel, ModelRequirement, first_error, further_errors};
use super::{Scene, Striking, VERTICES};
use crate::map::body::Body;
use crate::map::flight::AirDrag;
use crate::map::friction::Friction;
use crate::map::strike::EnergyFeedback;
use crate::map::table::control_law::Steering;
use crate::map::table::errors::TableErrors;
use crate::map::table::noise::Noise;
use crate::map::table::pivot::TurningTable;
use crate::map::table::sensing::Prediction;
use crate::numbers::rounded::rounded;

impl Scene {
    /// The requirements of the scene beyond the plain rod or the point mass, from the lowest level.
    pub fn requirements(&self) -> Vec<ModelRequirement> {
        let mut steps = Vec::new();
        let mut step =
            |level, name: Name, detail| steps.push(ModelRequirement { level, path: name.row().path, detail });
        let Body { steering, is_point, friction, lag, .. } = self.running_model;
        if let Steering::Feedback(gains) = steering
            && !is_point
        {
            let (level, name, seen) = if gains.x == 0.0 {
                (ModelLevel::Rod, Name::FeedbackTheta, "angle and velocities")
            } else {
                (ModelLevel::RodWithX, Name::FeedbackX, "place, angle and velocities")
            };
            step(level, name, format!("feedback tilts the table by {seen} (α = −K·state), in place of α = κθ"));
        }
        if let Some((name, detail)) = self.error_requirement() {
            step(ModelLevel::RigErrors, name, detail);
        }
        if let Some(detail) = self.turning_detail() {
            step(ModelLevel::Turning, Name::TiltRate, detail);
        }
        if lag != 0.0 {
            let detail = format!(
                "the table takes the state {lag} s before the strike for that at the strike (table.prediction `{}`)",
                Prediction::None.name()
            );
            step(ModelLevel::Delay, Name::Delay, detail);
        }
        if let Some((name, detail)) = self.drag_field().zip(self.drag_detail()) {
            step(ModelLevel::Drag, name, detail);
        }
        if let Some(Friction { coefficient, law, slide }) = friction {
            let (law, slide) = (law.name(), slide.name());
            let (name, detail) = if coefficient != 0.0 {
                let detail = format!(
                    "friction is {coefficient}, so the impulse has a part along the table (law `{law}`, slide `{slide}`)"
                );
                (Name::Friction, detail)
            } else {
                (Name::Slide, format!("slide is `{slide}`, so the table moves along itself, and friction is 0"))
            };
            step(ModelLevel::Friction, name, detail);
        }
        if let Some((name, detail)) = self.noise_requirement() {
            step(ModelLevel::Noise, name, detail);
        }
        if let Some(vertices) = self.vertices() {
            let detail = format!(
                "the body is a polygon of {} vertices, and each of them is looked at in every flight and at every contact",
                vertices.places().len()
            );
            steps.push(ModelRequirement { level: ModelLevel::Polygon, path: VERTICES, detail });
        }
        steps
    }

    /// A sentence that says why the scene needs its level.
    pub fn level_reason(&self) -> String {
        let e = self.running_model.rod.restitution;
        if let Some(requirement) = self.requirements().pop() {
            return requirement.detail;
        }
        if self.is_point() {
            return "the body is a point: its table follows the angle of its velocity (eq. 3)".to_owned();
        }
        if self.steers_energy() {
            return energy_reason(self);
        }
        let assumed = self.assumed_restitution();
        if self.strike() == Striking::Still && e < 1.0 {
            format!("the table stands still and restitution is {e}, so every bounce loses energy (eq. 24)")
        } else if assumed != e {
            let way = if assumed > e { "loses" } else { "gains" };
            format!("{}, so every bounce {way} energy", self.belief())
        } else if e == 1.0 {
            "nothing is lost at a bounce (eq. 1), and nothing else was asked for".to_owned()
        } else {
            format!("the table makes up all that restitution {e} loses (eq. 25), so the run is that of restitution 1")
        }
    }

    /// The restitution by which the table acts and the one that it meets, in words.
    pub fn belief(&self) -> String {
        let Body { rod, lag, .. } = self.running_model;
        let (effective, met, factor) = (self.assumed_restitution(), rod.restitution, self.speed_factor());
        if self.moves_late() {
            format!(
                "the table moves by the speed {lag} s before the strike, as if it believed restitution {effective}, and it meets {met}"
            )
        } else if self.table_errors().speed == 0.0 {
            format!("the table believes restitution {effective} and meets {met}")
        } else {
            format!(
                "the table's speed is {factor} times its law, as if it believed restitution {effective}, and it meets {met}"
            )
        }
    }

    /// The field of a constant error that asks for more than an ideal rig, with a sentence.
    fn error_requirement(&self) -> Option<(Name, String)> {
        let name = self.first_error()?;
        let TableErrors { angle_bias, tilt_offset, tilt_gain, speed, offset } = self.table_errors();
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
        let effect = match self.running_model.constant_tilt {
            0.0 => "all of it other gains of the table".to_owned(),
            tilt => format!("the table tilts by {} rad beside its law", rounded(tilt)),
        };
        Some((name, format!("{}: {effect}", said.join(", "))))
    }

    /// A sentence on a table that turns as it strikes.
    fn turning_detail(&self) -> Option<String> {
        let Body { turning, friction, .. } = self.running_model;
        let turning = turning?;
        let TurningTable { place, depth, is_corrected } = turning;
        let about = match place {
            Some(place) => format!("at x = {place} m and {depth} m below its surface"),
            None => format!("{depth} m below the contact"),
        };
        let law = if is_corrected { ", which its law corrects its speed for" } else { "" };
        let effect = match (turning.strikes(), turning.drags(friction.as_ref())) {
            (true, true) => "its surface strikes and drags the contact point besides",
            (true, false) => "its surface strikes the contact point besides",
            (false, true) => "its surface drags the contact point along",
            (false, false) => "its surface moves along itself at most, which changes no bounce here",
        };
        Some(format!("the table turns as it strikes, about a pivot {about}{law}: {effect}"))
    }

    /// A sentence on the air.
    fn drag_detail(&self) -> Option<String> {
        let AirDrag { linear, rotational, wind } = self.running_model.drag?;
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

    /// The field of noise that asks for more than an exact table, with a sentence.
    fn noise_requirement(&self) -> Option<(Name, String)> {
        let noise = self.running_model.noise?;
        let Noise { timing_sd, angle_sd, seed, model, .. } = noise;
        let name = first_error(&noise);
        let further: String = further_errors(&noise).map(|(_, sd, unit, of)| format!(", {sd}{unit} in {of}")).collect();
        let ahead = match noise.horizon {
            0.0 => String::new(),
            horizon => format!(", sensed {horizon} s before the strike and carried on"),
        };
        let detail = format!(
            "the table errs by {timing_sd} s in time and {angle_sd} rad in angle{further}{ahead} (standard deviations; seed {seed}, model `{}`)",
            model.name()
        );
        Some((name, detail))
    }
}

/// A sentence that says why the strikes of a scene depend on the energy.
fn energy_reason(scene: &Scene) -> String {
    let gain = scene.energy_gain();
    match scene.running_model.rod.energy_feedback {
        EnergyFeedback::Vertical => {
            format!("energy_gain is {gain} s²/m², so the table's speed depends on the energy (eq. 28)")
        }
        EnergyFeedback::Total => format!(
            "energy_gain is {gain} s²/m² and energy_measure `total`, so the table's speed depends on the energy, sideways motion and \
             spin included"
        ),
        EnergyFeedback::OneStrike => {
            "energy_law is `one_strike`, so the table's speed depends on the energy, and each strike brings it to the target".to_owned()
        }
    }
}
