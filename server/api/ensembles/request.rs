//! The request for `ensembles`: a scene, the number of its runs, and the tile of runs to compute.

use std::ops::Range;

use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::surveys::ensemble::Ensemble;
use serde::Serialize;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::scene::spec::SceneSpec;
use crate::api::scene::write::resolved;
use crate::api::shared::tile::{Tile, TileOf};
use crate::api::shared::write::canonical_of;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, Flag, exact_whole, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

request_fields! {
    /// A request for an ensemble.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct EnsembleRequest {
        /// The scene, with the seed of the request.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Number of runs, those of other tiles included. More than 20 000 have to be requested in tiles.
        pub runs: u64 = whole(1..=limits::ENSEMBLE_RUNS_IN_TILES).or(200),
        /// Largest number of contacts of each run.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(400),
        /// Seed of the noise, in place of the scene's own `noise.seed`.
        #[serde(skip)]
        pub seed: Option<u64> = exact_whole().optional(),
        /// Adds the angles themselves to JSON and Arrow.
        pub angles: bool = Flag,
        /// A share of the runs, at most 20 000: from number ⌊runs·index/of⌋ to below ⌊runs·(index + 1)/of⌋.
        pub tile: Tile = TileOf(limits::ENSEMBLE_RUNS_IN_TILES),
    }
}

impl ResourceRequest for EnsembleRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let mut request = Self::read_fields(reader)?;
        if !reader.is_wrong("runs") {
            let is_tiled = reader.has("tile");
            check_tile(reader, request.tile, is_tiled, request.runs);
        }
        if let Some(seed) = request.seed {
            let mut draft = request.scene.draft();
            if let Err(error) = draft.set(Name::Seed, Some(Value::Integer(seed))) {
                reader.refuse("seed", error.detail);
            }
            request.scene = draft.build().ok()?;
        }
        Some(request)
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        limits.of_answer().admit(self.angles())?;
        Price::bounces(self.work()).taking(self.bytes()).within(&limits.of_ensemble_work())
    }
}

impl CanonicalRequest for EnsembleRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}

impl EnsembleRequest {
    /// All runs.
    pub fn ensemble(&self) -> Ensemble {
        let Self { scene, runs, bounces, .. } = *self;
        Ensemble { scene, runs, impacts: bounces, angle_contacts: limits::ENSEMBLE_ANGLE_CONTACTS }
    }

    /// Range of run numbers in the tile.
    pub fn numbers(&self) -> Range<u64> {
        self.tile.share(self.runs)
    }

    /// Number of runs in the tile.
    pub fn runs(&self) -> u64 {
        let numbers = self.numbers();
        numbers.end - numbers.start
    }

    /// Number of runs in a block, which depends on the request alone.
    pub fn block_runs(&self) -> u64 {
        let runs = limits::ENSEMBLE_BLOCK_WORK / self.run_price().max(1);
        let (least, most) = limits::ENSEMBLE_BLOCK_RUNS.into_inner();
        let fewest = if self.ensemble().fits_lanes() { (self.runs() / 100).clamp(least, most) } else { 1 };
        runs.max(fewest)
    }

    /// Price of the bounces of a run, in bounces of the plain rod.
    fn run_price(&self) -> u64 {
        let ensemble = self.ensemble();
        if ensemble.fits_lanes() && !ensemble.is_uniform() {
            self.bounces.div_ceil(limits::ENSEMBLE_LANE_BOUNCES)
        } else {
            self.bounces.saturating_mul(bounce_price(&self.scene))
        }
    }

    /// Price, in bounces of the plain rod.
    fn work(&self) -> u64 {
        // One run stands for all of a uniform ensemble.
        let computed = if self.ensemble().is_uniform() { 1 } else { self.runs() };
        let angles = limits::ENSEMBLE_ANGLE_PRICE * limits::ENSEMBLE_ANGLE_CONTACTS.min(self.bounces);
        let runs = self.runs().saturating_mul(limits::ENSEMBLE_RUN_PRICE + angles);
        computed
            .saturating_mul(self.run_price())
            .saturating_add(runs)
            .saturating_add(self.bounces * limits::ENSEMBLE_CONTACT_PRICE + limits::ENSEMBLE_ANSWER_PRICE)
    }

    /// Maximum number of angles in the answer.
    pub fn angles(&self) -> u64 {
        if self.angles { self.stored_angles() } else { 0 }
    }

    /// Maximum number of angles that are stored for quantiles.
    fn stored_angles(&self) -> u64 {
        self.runs() * limits::ENSEMBLE_ANGLE_CONTACTS.min(self.bounces)
    }

    /// Most memory, bytes: the angles, and the curve of survival.
    fn bytes(&self) -> u64 {
        const CURVE_COLUMNS: u64 = 5;
        let angle = if self.angles { limits::ENSEMBLE_LISTED_ANGLE_BYTES } else { limits::ENSEMBLE_ANGLE_BYTES };
        self.stored_angles() * angle + self.bounces * CURVE_COLUMNS * limits::NUMBER_BYTES
    }
}

/// Checks that a tile has at least one run, and at most as many as one answer may have.
fn check_tile(reader: &mut Reader<'_, '_>, tile: Tile, is_tiled: bool, runs: u64) {
    const MOST: u64 = limits::ENSEMBLE_RUNS;
    if tile.of > runs {
        reader.refuse("tile", format!("tile is one of {}, but there are only {runs} runs", tile.of));
    } else if runs.div_ceil(tile.of) > MOST {
        let least = runs.div_ceil(MOST);
        let (name, what) = match is_tiled {
            true => ("tile", format!("one tile of {} has {} runs", tile.of, runs.div_ceil(tile.of))),
            false => ("runs", format!("runs is {runs}")),
        };
        reader.refuse(
            name,
            format!("{what}; at most {MOST} are answered at once, so ask for one tile of {least} or more"),
        );
    }
}
