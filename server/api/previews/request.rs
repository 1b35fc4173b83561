//! The request for `previews`: a run.

use serde::Serialize;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::shared::write::canonical_of;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;
use crate::runs::interventions::RunSpec;
use crate::runs::run::Run;

/// Price of an impact besides its bounce, in bounces: its dot.
const DOT_PRICE: u64 = 4;

request_fields! {
    /// A request for a preview.
    #[derive(Debug, Clone, Serialize)]
    pub struct PreviewRequest {
        /// The run.
        pub run: Run = RunSpec,
        /// Largest number of impacts to follow.
        pub bounces: u64 = whole(1..=limits::PREVIEW_BOUNCES).or(1000),
    }
}

impl ResourceRequest for PreviewRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        Self::read_fields(reader)
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        let picture = limits::PREVIEW_ANSWER_PRICE + DOT_PRICE * self.bounces;
        Price::bounces(self.bounces().saturating_add(picture)).within(&limits.of_work())
    }
}

impl CanonicalRequest for PreviewRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}

impl PreviewRequest {
    /// Price of the run alone, with its catches and throws, in bounces.
    pub fn bounces(&self) -> u64 {
        (self.bounces * bounce_price(self.run.scene())).saturating_add(self.run.guidance_price())
    }
}
