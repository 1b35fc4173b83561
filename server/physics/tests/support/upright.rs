//! The upright bounce of a rod in one regime of its contact.

use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::Rod;

/// A rod with a contact in this regime.
pub(crate) fn body_in(rod: &Rod, regime: ContactRegime) -> Body {
    let slide = if regime == ContactRegime::Sticking { Slide::None } else { Slide::Matched };
    let rough = Friction { coefficient: 1.0, law: RestitutionLaw::Poisson, slide };
    Body { friction: (regime != ContactRegime::Frictionless).then_some(rough), ..Body::plain(*rod) }
}

/// The model of a rod that bounces upright at `speed` V > 0 (m/s) on a table that makes up the loss.
pub(crate) fn upright_bounce(rod: &Rod, speed: f64, regime: ContactRegime) -> BounceModel {
    BounceModel::rising(&body_in(rod, regime), speed, 1.0)
}
