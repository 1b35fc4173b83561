//! Reasons for the model of a scene, in sentences.

use equipoise_physics::map::body::Body;
use equipoise_physics::map::flight::AirDrag;
use equipoise_physics::map::friction::Friction;
use equipoise_physics::map::strike::EnergyFeedback;
use equipoise_physics::map::table::errors::TableErrors;
use equipoise_physics::map::table::noise::Noise;
use equipoise_physics::map::table::pivot::TurningTable;
use equipoise_physics::map::table::sensing::Prediction;
use equipoise_physics::numbers::rounded::rounded;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};

/// The reason for the model of a scene.
pub fn model_reason(scene: &Scene) -> String {
    let Body { rod, is_point, .. } = scene.running_model();
    if let Some(requirement) = scene.requirements().last() {
        return level_reason(scene, requirement.level).unwrap_or_default();
    }
    if is_point {
        return "the body is a point: its table follows the angle of its velocity (eq. 3)".to_owned();
    }
    if scene.steers_energy() {
        return energy_reason(scene, rod.energy_feedback);
    }
    let (assumed, e) = (scene.assumed_restitution(), rod.restitution);
    if scene.value(Name::Strike) == Some(Value::Choice("still")) && e < 1.0 {
        format!("the table stands still and restitution is {e}, so every bounce loses energy (eq. 24)")
    } else if assumed != e {
        let way = if assumed > e { "loses" } else { "gains" };
        format!("{}, so every bounce {way} energy", belief(scene))
    } else if e == 1.0 {
        "nothing is lost at a bounce (eq. 1), and nothing else was asked for".to_owned()
    } else {
        format!("the table makes up all that restitution {e} loses (eq. 25), so the run is that of restitution 1")
    }
}

/// The restitution by which the table of a scene acts and the one that it meets.
pub fn belief(scene: &Scene) -> String {
    let Body { rod, lag, .. } = scene.running_model();
    let (effective, met, factor) = (scene.assumed_restitution(), rod.restitution, scene.speed_factor());
    if scene.moves_late() {
        format!(
            "the table moves by the speed {lag} s before the strike, as if it believed restitution {effective}, and it meets {met}"
        )
    } else if scene.table_errors().speed == 0.0 {
        format!("the table believes restitution {effective} and meets {met}")
    } else {
        format!(
            "the table's speed is {factor} times its law, as if it believed restitution {effective}, and it meets {met}"
        )
    }
}

/// The reason for which a scene asks for a level beyond the plain rod or the point mass; `None` if it does not.
pub fn level_reason(scene: &Scene, level: ModelLevel) -> Option<String> {
    let Body { turning, friction, noise, lag, drag, .. } = scene.running_model();
    let feedback = |seen| format!("feedback tilts the table by {seen} (α = −K·state), in place of α = κθ");
    Some(match level {
        ModelLevel::Point | ModelLevel::Linear => return None,
        ModelLevel::Rod => feedback("angle and velocities"),
        ModelLevel::RodWithX => feedback("place, angle and velocities"),
        ModelLevel::RigErrors => errors_reason(scene),
        ModelLevel::Turning => turning_reason(&turning?, friction.as_ref()),
        ModelLevel::Delay => format!(
            "the table takes the state {lag} s before the strike for that at the strike (table.prediction `{}`)",
            Prediction::None.name()
        ),
        ModelLevel::Drag => drag_reason(&drag?),
        ModelLevel::Friction => friction_reason(&friction?),
        ModelLevel::Noise => noise_reason(scene, &noise?),
        ModelLevel::Polygon => format!(
            "the body is a polygon of {} vertices, and each of them is looked at in every flight and at every contact",
            scene.vertices()?.places().len()
        ),
    })
}

fn errors_reason(scene: &Scene) -> String {
    let TableErrors { angle_bias, tilt_offset, tilt_gain, speed, offset } = scene.table_errors();
    let words = [
        (angle_bias, format!("the angle is sensed {} rad too large", rounded(angle_bias))),
        (tilt_offset, format!("the table tilts {} rad too far", rounded(tilt_offset))),
        (tilt_gain, format!("the table tilts by {} times its law", rounded(1.0 + tilt_gain))),
        (speed, format!("the table moves at {} times its law", rounded(1.0 + speed))),
        (offset, format!("the centre of gravity is {} m off the axis", rounded(offset))),
    ];
    let said = Vec::from_iter(words.into_iter().filter(|(error, _)| *error != 0.0).map(|(_, words)| words));
    let effect = match scene.running_model().constant_tilt {
        0.0 => "all of it other gains of the table".to_owned(),
        tilt => format!("the table tilts by {} rad beside its law", rounded(tilt)),
    };
    format!("{}: {effect}", said.join(", "))
}

fn turning_reason(turning: &TurningTable, friction: Option<&Friction>) -> String {
    let TurningTable { place, depth, is_corrected } = *turning;
    let about = match place {
        Some(place) => format!("at x = {place} m and {depth} m below its surface"),
        None => format!("{depth} m below the contact"),
    };
    let law = if is_corrected { ", which its law corrects its speed for" } else { "" };
    let effect = match (turning.strikes(), turning.drags(friction)) {
        (true, true) => "its surface strikes and drags the contact point besides",
        (true, false) => "its surface strikes the contact point besides",
        (false, true) => "its surface drags the contact point along",
        (false, false) => "its surface moves along itself at most, which changes no bounce here",
    };
    format!("the table turns as it strikes, about a pivot {about}{law}: {effect}")
}

fn drag_reason(&AirDrag { linear, rotational, wind }: &AirDrag) -> String {
    let of_place = match wind {
        0.0 => format!("{linear} 1/s of the velocity"),
        wind => format!("{linear} 1/s of the velocity relative to its own, {wind} m/s along x,"),
    };
    match (linear != 0.0, rotational != 0.0) {
        (true, true) => format!("the air takes {of_place} and {rotational} 1/s of the spin in flight"),
        (true, false) => format!("the air takes {of_place} in flight"),
        (false, _) => format!("the air takes {rotational} 1/s of the spin in flight"),
    }
}

fn friction_reason(&Friction { coefficient, law, slide }: &Friction) -> String {
    let (law, slide) = (law.name(), slide.name());
    if coefficient != 0.0 {
        format!("friction is {coefficient}, so the impulse has a part along the table (law `{law}`, slide `{slide}`)")
    } else {
        format!("slide is `{slide}`, so the table moves along itself, and friction is 0")
    }
}

fn noise_reason(scene: &Scene, noise: &Noise) -> String {
    let Noise { timing_sd, angle_sd, horizon, seed, model, .. } = noise;
    let further = [
        (Name::XSd, " m in place"),
        (Name::XDotSd, " m/s in horizontal velocity"),
        (Name::YDotSd, " m/s in vertical velocity"),
        (Name::ThetaDotSd, " rad/s in angular velocity"),
        (Name::RestitutionSd, " in restitution"),
    ];
    let sd = |name| scene.number(name).filter(|sd| *sd != 0.0);
    let further: String = further.iter().filter_map(|&(name, of)| Some(format!(", {}{of}", sd(name)?))).collect();
    let ahead = match horizon {
        0.0 => String::new(),
        horizon => format!(", sensed {horizon} s before the strike and carried on"),
    };
    format!(
        "the table errs by {timing_sd} s in time and {angle_sd} rad in angle{further}{ahead} (standard deviations; seed {seed}, model `{}`)",
        model.name()
    )
}

/// The reason for which the strikes of a scene depend on the energy.
fn energy_reason(scene: &Scene, feedback: EnergyFeedback) -> String {
    let gain = scene.energy_gain();
    match feedback {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_told_with_its_number() {
        let rig = "body.contact_distance=0.133 body.radius_of_gyration=0.094 table.tilt_gain=1.1 release.height=0.3";
        let scene: Scene = format!("{rig} table.errors.angle_bias=0.002 body.offset=0.001").parse().unwrap();
        let reason = level_reason(&scene, ModelLevel::RigErrors).unwrap();
        assert!(reason.contains("0.001 m off the axis"), "{reason}");
    }
}
