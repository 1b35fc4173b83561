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
    Endpoint::of::<catches::Catches>(),
    Endpoint::of::<controllers::Controllers>(),
    Endpoint::of::<ensembles::Ensembles>(),
    Endpoint::of::<fits::Fits>(),
    Endpoint::of::<jacobians::Jacobians>(),
    Endpoint::of::<ladder::Ladder>(),
    Endpoint::of::<periodic_orbits::PeriodicOrbits>(),
    Endpoint::of::<precision::Precision>(),
    Endpoint::of::<previews::Previews>(),
    Endpoint::of::<regions::Regions>(),
    Endpoint::of::<stability::Stability>(),
    Endpoint::of::<throws::Throws>(),
    Endpoint::of::<trajectories::Trajectories>(),
];
