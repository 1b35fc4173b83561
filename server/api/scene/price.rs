//! Prices of scenes.

use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene};

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
