//! The orbit of one cycle of a program of heights, in place of a bounce that repeats.

use equipoise_physics::analysis::periodic_orbits::{OrbitFailure, OrbitProblem, find};
use equipoise_physics::scene::Scene;

/// A sentence on small deviations from the orbit of one cycle. None without a program.
pub(super) fn cycle_sentence(scene: &Scene) -> Option<String> {
    let period = scene.program()?.heights().len();
    let orbit = OrbitProblem::of(scene)
        .map_err(OrbitFailure::Scene)
        .and_then(|problem| find(&problem, period, &problem.upright()));
    Some(match orbit {
        Ok(orbit) => {
            let deviations = match orbit.multipliers.stable {
                Some(true) => "small deviations stay small",
                Some(false) => "small deviations grow",
                None => "the linear analysis is silent there",
            };
            let (radius, time) = (orbit.multipliers.spectral_radius(), orbit.flight_time);
            let evidence = match orbit.multipliers.residue {
                Some(residue) => format!("its residue is {residue}"),
                None => format!("its spectral radius is {radius}"),
            };
            format!("about the orbit of one cycle ({period} strikes, {time} s) {deviations}: {evidence}")
        }
        Err(failure) => format!("the orbit of one cycle is not found: {failure}"),
    })
}
