//! The request for `controllers`: a scene and the weights of its state feedback.

use equipoise_physics::analysis::contact_regime::{ContactRegime, contact_regime};
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::spec::SceneSpec;
use crate::api::scene::{build_scene, complete_law};
use crate::api::shared::refusal::refuse_lacking;
use crate::api::shared::weights::Weights;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, ObjectOfDefaults, choice};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

/// A request for a control law.
#[derive(Debug, Clone, Copy)]
pub struct ControllerRequest {
    /// The scene with its law; a tilt gain of 1 is added where it has none, since a scene needs one to be built.
    pub scene: Scene,
    /// κ, if the scene has one.
    pub tilt_gain: Option<f64>,
    /// Contact regime that the law is designed for.
    pub regime: ContactRegime,
    /// The weights.
    pub weights: Weights,
}

request_fields! {
    /// A request for a control law as it is read. The scene need not have a law.
    pub(super) struct AskedLaw {
        /// The scene.
        scene: Draft = SceneSpec,
        /// Behaviour of the contact for which the law is designed. By default that of the scene near its fixed point: with any friction it sticks.
        contact: Option<bool> = choice(&[("frictionless", false), ("stick", true)]).optional(),
        /// Costs of a deviation and of a tilt. The law minimizes the sum of the weighted squares over all bounces, in SI units.
        weights: Weights = ObjectOfDefaults,
    }
}

impl ResourceRequest for ControllerRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let AskedLaw { scene: mut draft, contact: sticks, weights } = AskedLaw::read_fields(reader)?;
        // The request is for a law, so the scene may have none.
        let tilt_gain = complete_law(&mut draft);
        let pointer = reader.pointer_to("scene");
        let scene = build_scene(draft, &pointer, reader.errors())?;
        if refuse_lacking(reader, &scene, Analysis::Controller) {
            return None;
        }
        let regime = match sticks {
            None => contact_regime(&scene.model()),
            Some(false) => ContactRegime::Frictionless,
            Some(true) if scene.value(Name::Slide) == Some(Value::Choice("matched")) => ContactRegime::VelocityMatched,
            Some(true) => ContactRegime::Sticking,
        };
        Some(Self { scene, tilt_gain, regime, weights })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(limits::CONTROLLER_PRICE).within(&limits.of_work())
    }
}

impl CanonicalRequest for ControllerRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(&self.scene, &(contact_name(self.regime), self.weights, self.tilt_gain))
    }
}

/// Name of a contact regime in requests and answers.
pub(super) fn contact_name(regime: ContactRegime) -> &'static str {
    if regime == ContactRegime::Frictionless { "frictionless" } else { "stick" }
}
