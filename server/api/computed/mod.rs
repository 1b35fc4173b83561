//! The resources that compute an answer, a file or a folder each: the request that is read, the answer that is computed, the picture that is drawn.

pub mod catches;
pub mod controllers;
pub mod ensembles;
pub mod fits;
pub mod jacobians;
pub mod ladder;
pub mod periodic_orbits;
pub mod precision;
pub mod previews;
pub mod regions;
pub mod stability;
pub mod throws;
pub mod trajectories;

use crate::api::resource::Endpoint;

/// Resources that compute an answer: each at `/v1/<name>`, and for many requests at once at `/v1/batches/<name>`.
pub(crate) const COMPUTED: [Endpoint; 13] = [
    Endpoint::of::<catches::request::CatchRequest>(),
    Endpoint::of::<controllers::ControllerRequest>(),
    Endpoint::of::<ensembles::EnsembleRequest>(),
    Endpoint::of::<fits::request::FitsRequest>(),
    Endpoint::of::<jacobians::JacobianRequest>(),
    Endpoint::of::<ladder::LadderRequest>(),
    Endpoint::of::<periodic_orbits::PeriodicOrbitRequest>(),
    Endpoint::of::<precision::PrecisionRequest>(),
    Endpoint::of::<previews::PreviewRequest>(),
    Endpoint::of::<regions::request::RegionRequest>(),
    Endpoint::of::<stability::request::StabilityRequest>(),
    Endpoint::of::<throws::ThrowRequest>(),
    Endpoint::of::<trajectories::TrajectoryRequest>(),
];
