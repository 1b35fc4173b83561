//! Quantities that follow from a scene: what a client needs to draw the body and its flights, and the price of a bounce.

use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;

/// Quantities that follow from the scene, to draw the body and its flights.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Derived {
    /// Gravity in the plane of motion, G = gravity · sin(incline), m/s².
    gravity_in_plane: f64,
    /// Distance l from the centre of gravity to the contact point, m. 0 for a point mass.
    contact_distance: f64,
    /// Radius of gyration ρ about the centre of gravity, m. Null for a point mass.
    radius_of_gyration: Option<f64>,
    /// Vertices of a polygon as \[x, y\] about its centre of gravity at θ = 0, m. The contact vertex is at \[0, −contact_distance\]. Null for
    /// other bodies.
    outline: Option<Vec<[f64; 2]>>,
    /// Target of the first strike.
    target: Option<EnergyTarget>,
}

/// The bounce that energy feedback steers for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct EnergyTarget {
    /// Height y* of the centre of gravity at the top, m.
    height: f64,
    /// Energy per unit mass G y*, m²/s².
    energy: f64,
}

impl Derived {
    /// Derives the quantities of a scene.
    pub fn of(scene: &Scene) -> Self {
        let rod = scene.parameters::<f64>();
        Self {
            gravity_in_plane: rod.gravity,
            contact_distance: rod.contact_distance,
            radius_of_gyration: has_angle(scene).then_some(rod.radius_of_gyration),
            outline: scene.outline().map(|outline| outline.vertices().to_vec()),
            target: EnergyTarget::of(scene, 1),
        }
    }
}

impl EnergyTarget {
    /// The target of strike `n` of a scene, if its table steers the energy.
    pub fn of(scene: &Scene, n: u64) -> Option<Self> {
        let height = scene.target_height(n)?;
        Some(Self { height, energy: scene.gravity() * height })
    }
}

/// True if the body has an angle: every body except a point mass.
pub fn has_angle(scene: &Scene) -> bool {
    scene.value(Name::PointMass).is_none()
}

/// Largest price of a bounce of a scene, in bounces of the plain rod.
pub fn bounce_price(scene: &Scene) -> u64 {
    let vertices = scene.vertices().map_or(0, |vertices| vertices.places().len() as u64);
    let dearer =
        scene.requirements().into_iter().map(|requirement| if requirement.level == ModelLevel::Noise { 2 } else { 1 });
    1 + u64::from(!has_angle(scene)) + vertices / 8 + dearer.sum::<u64>()
}

#[cfg(test)]
mod tests {
    use equipoise_physics::scene::Name;

    use super::*;
    use crate::api::scene::presets;

    fn of(preset: &str) -> Derived {
        Derived::of(&presets::find(preset).unwrap().draft().build().unwrap())
    }

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs().max(1e-3), "{value} is not {expected}");
    }

    #[test]
    fn a_rod_has_no_outline() {
        let Derived { gravity_in_plane: gravity, contact_distance, radius_of_gyration, outline, target } = of("case-1");
        close(gravity, 9.81);
        close(contact_distance, 0.4 / 3.0);
        assert_eq!(radius_of_gyration, Some(0.09428090415820635));
        assert_eq!((outline, target), (None, None));
    }

    #[test]
    fn a_polygon_stands_on_its_contact_vertex() {
        let Derived { contact_distance, outline, .. } = of("triangle-polygon");
        let outline = outline.unwrap();
        close(contact_distance, 0.4 / 3.0);
        for (place, expected) in outline.iter().zip([[0.0, -0.4 / 3.0], [0.05, 0.2 / 3.0], [-0.05, 0.2 / 3.0]]) {
            close(place[0], expected[0]);
            close(place[1], expected[1]);
        }
    }

    #[test]
    fn a_point_mass_is_its_own_contact_point() {
        let Derived { contact_distance, radius_of_gyration, .. } = of("point-mass");
        assert_eq!((contact_distance, radius_of_gyration), (0.0, None));
    }

    #[test]
    fn an_inclined_plane_has_less_gravity_and_its_target_less_energy() {
        let mut draft = presets::find("case-4").unwrap().draft();
        draft.set(Name::Incline, Some(equipoise_physics::scene::Value::Number(std::f64::consts::FRAC_PI_6))).unwrap();
        let scene = draft.build().unwrap();
        let Derived { gravity_in_plane: gravity, target, .. } = Derived::of(&scene);
        close(gravity, 4.905);
        let EnergyTarget { height, energy } = target.unwrap();
        assert_eq!(Some(height), scene.number(Name::TargetHeight));
        close(energy, 4.905 * height);
    }
}
