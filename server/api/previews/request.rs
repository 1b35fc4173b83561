//! The request for `previews`: a run.

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;
use crate::runs::interventions::{intervention_parameters, read_run};
use crate::runs::run::Run;

/// Price of an impact besides its bounce, in bounces: its dot.
const DOT_PRICE: u64 = 4;

/// A request for a preview.
#[derive(Debug, Clone)]
pub struct PreviewRequest {
    /// The run: a scene and its interventions.
    pub run: Run,
    /// Highest number of contacts.
    pub impacts: u64,
}

impl ResourceRequest for PreviewRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let run = read_run(reader);
        let impacts = reader.integer("impacts", 1..=limits::PREVIEW_IMPACTS).unwrap_or(1000);
        Some(Self { run: run?, impacts })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        let picture = limits::PREVIEW_ANSWER_PRICE + DOT_PRICE * self.impacts;
        Price::bounces(self.bounces().saturating_add(picture)).within(&limits.of_work())
    }
}

impl CanonicalRequest for PreviewRequest {
    fn canonical(&self) -> Vec<u8> {
        write::canonical(self.run.scene(), &(self.impacts, intervention_parameters(&self.run)))
    }
}

impl PreviewRequest {
    /// Price of the run alone, with its catches and throws, in bounces.
    pub fn bounces(&self) -> u64 {
        (self.impacts * bounce_price(self.run.scene())).saturating_add(self.run.guidance_price())
    }
}
