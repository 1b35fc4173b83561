//! The request for `ensembles`: a scene, the number of its runs, and the tile of runs to compute.

use std::ops::Range;

use equipoise_physics::scene::{FieldKind, Name, Value};
use equipoise_physics::surveys::ensemble::Ensemble;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::{bounce_price, build_scene, read_draft};
use crate::api::shared::tile::Tile;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

/// A request for an ensemble.
#[derive(Debug, Clone, Copy)]
pub struct EnsembleRequest {
    /// All runs.
    pub ensemble: Ensemble,
    /// The tile of runs to compute.
    pub tile: Tile,
    /// True if the answer lists the angles.
    pub angles: bool,
}

impl ResourceRequest for EnsembleRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let draft = read_draft(reader);
        let said = reader.integer("runs", 1..=limits::ENSEMBLE_RUNS_IN_TILES);
        let is_known = said.is_some() || !reader.has("runs");
        let runs = said.unwrap_or(200);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(400);
        let FieldKind::Integer { maximum } = Name::Seed.row().kind else { return None };
        let seed = reader.integer("seed", 0..=maximum);
        let angles = reader.boolean("angles").unwrap_or(false);
        let is_tiled = reader.has("tile");
        let tile = Tile::read(reader, limits::ENSEMBLE_RUNS_IN_TILES);
        if let Some(tile) = tile.filter(|_| is_known) {
            check_tile(reader, tile, is_tiled, runs);
        }
        let mut draft = draft?;
        if let Some(seed) = seed
            && let Err(error) = draft.set(Name::Seed, Some(Value::Integer(seed)))
        {
            reader.refuse("seed", error.detail);
            return None;
        }
        let pointer = reader.pointer_to("scene");
        let scene = build_scene(draft, &pointer, reader.errors())?;
        let ensemble = Ensemble { scene, runs, impacts, angle_contacts: limits::ENSEMBLE_ANGLE_CONTACTS };
        Some(Self { ensemble, tile: tile?, angles })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        limits.of_answer().admit(self.angles())?;
        Price::bounces(self.work()).taking(self.bytes()).within(&limits.of_ensemble_work())
    }
}

impl CanonicalRequest for EnsembleRequest {
    fn canonical(&self) -> Vec<u8> {
        let Ensemble { scene, runs, impacts, .. } = &self.ensemble;
        write::canonical(scene, &(runs, impacts, self.tile, self.angles))
    }
}

impl EnsembleRequest {
    /// Range of run numbers in the tile.
    pub fn numbers(&self) -> Range<u64> {
        self.tile.share(self.ensemble.runs)
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
        let fewest = if self.ensemble.fits_lanes() { (self.runs() / 100).clamp(least, most) } else { 1 };
        runs.max(fewest)
    }

    /// Price of the bounces of a run, in bounces of the plain rod.
    fn run_price(&self) -> u64 {
        let Ensemble { scene, impacts, .. } = &self.ensemble;
        if self.ensemble.fits_lanes() && !self.ensemble.is_uniform() {
            impacts.div_ceil(limits::ENSEMBLE_LANE_BOUNCES)
        } else {
            impacts.saturating_mul(bounce_price(scene))
        }
    }

    /// Price, in bounces of the plain rod.
    fn work(&self) -> u64 {
        let Ensemble { impacts, angle_contacts, .. } = &self.ensemble;
        // One run stands for all of a uniform ensemble.
        let computed = if self.ensemble.is_uniform() { 1 } else { self.runs() };
        let angles = limits::ENSEMBLE_ANGLE_PRICE * angle_contacts.min(impacts);
        let runs = self.runs().saturating_mul(limits::ENSEMBLE_RUN_PRICE + angles);
        computed
            .saturating_mul(self.run_price())
            .saturating_add(runs)
            .saturating_add(impacts * limits::ENSEMBLE_CONTACT_PRICE + limits::ENSEMBLE_ANSWER_PRICE)
    }

    /// Maximum number of angles in the answer.
    pub fn angles(&self) -> u64 {
        if self.angles { self.stored_angles() } else { 0 }
    }

    /// Maximum number of angles that are stored for quantiles.
    fn stored_angles(&self) -> u64 {
        self.runs() * self.ensemble.angle_contacts.min(self.ensemble.impacts)
    }

    /// Most memory, bytes: the angles, and the curve of survival.
    fn bytes(&self) -> u64 {
        const CURVE_COLUMNS: u64 = 5;
        let angle = if self.angles { limits::ENSEMBLE_LISTED_ANGLE_BYTES } else { limits::ENSEMBLE_ANGLE_BYTES };
        self.stored_angles() * angle + self.ensemble.impacts * CURVE_COLUMNS * limits::NUMBER_BYTES
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
