//! The request for `periodic-orbits`: an orbit, or a branch of orbits along a field of the scene.

use equipoise_physics::analysis::periodic_orbits::branch::BranchStart;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Field, FieldKind, Name, Scene, Value, field};
use serde::{Serialize, Serializer};

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::{has_angle, read_scene};
use crate::api::shared::refusal::lacking;
use crate::api::shared::state::read_state;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

/// The range that a field is swept over.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SweptRange {
    /// The field.
    #[serde(serialize_with = "path")]
    pub parameter: Name,
    /// Value at the start.
    pub from: f64,
    /// Value at the end.
    pub to: f64,
    /// Maximum number of orbits along the sweep.
    pub points: u64,
}

fn path<S: Serializer>(name: &Name, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name.row().path)
}

/// A request for an orbit, or for a branch of orbits.
#[derive(Debug, Clone, Copy)]
pub struct PeriodicOrbitRequest {
    /// The scene.
    pub scene: Scene,
    /// Number of contacts after which the orbit repeats.
    pub period: u64,
    /// Start of the search.
    pub start: BranchStart,
    /// The field that is swept, for a branch.
    pub sweep: Option<SweptRange>,
}

impl ResourceRequest for PeriodicOrbitRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let scene = read_scene(reader);
        let before = reader.errors().len();
        let cycle = scene.as_ref().and_then(Scene::program).map_or(1, |program| program.heights().len() as u64);
        let period = reader.integer("period", 1..=limits::ORBIT_PERIOD);
        if let Some(period) = period.filter(|period| !period.is_multiple_of(cycle)) {
            let detail =
                format!("period is {period}; with a program of {cycle} heights it must be a multiple of {cycle}");
            reader.refuse("period", detail);
        }
        let guess = reader.within("guess", read_state);
        let family = reader.choice("family", &[("symmetric", ())]);
        let theta = reader.number("theta", -1.5..=1.5, "rad");
        let is_point = scene.as_ref().is_some_and(|scene| !has_angle(scene));
        if is_point && guess.is_some_and(|guess| guess.theta != 0.0 || guess.theta_dot != 0.0) {
            reader.refuse("guess", "a point mass has no theta and no theta_dot; leave them out");
        }
        if let Some(detail) =
            scene.as_ref().filter(|_| family.is_some()).and_then(|scene| lacking(scene, Analysis::SymmetricOrbit))
        {
            reader.refuse("family", detail);
        }
        let sweep = if reader.has("sweep") { reader.within("sweep", SweptRange::read).flatten() } else { None };
        let start = match (guess, family, theta) {
            (Some(_), Some(()), _) => {
                reader.refuse("family", "family and guess both say where to start; leave one of them out");
                None
            }
            (None, Some(()), Some(theta)) if theta != 0.0 && period.unwrap_or(2) == 2 => {
                Some(BranchStart::Symmetric(theta))
            }
            (None, Some(()), Some(_)) if period.unwrap_or(2) != 2 => {
                reader.refuse("period", "period must be 2 for the symmetric family");
                None
            }
            (None, Some(()), Some(_)) => {
                reader.refuse("theta", "theta is 0; the symmetric family needs another angle, rad");
                None
            }
            (None, Some(()), None) => {
                reader.require(&["theta"]);
                None
            }
            (_, None, Some(_)) => {
                reader.refuse("theta", "theta goes with family; leave it out or add family \"symmetric\"");
                None
            }
            (Some(state), None, None) => Some(BranchStart::Near(state)),
            (None, None, None) if period.unwrap_or(cycle) == cycle => Some(BranchStart::Upright),
            (None, None, None) if reader.errors().len() > before => None,
            (None, None, None) => {
                reader.refuse_whole(format!(
                    "give a guess, or family \"symmetric\" with theta; only period {cycle} needs neither"
                ));
                None
            }
        };
        if cycle > 1 && matches!(start, Some(BranchStart::Symmetric(_))) {
            reader.refuse(
                "family",
                "family \"symmetric\" has bounces of one height, and scene.table.program has several",
            );
        }
        if reader.errors().len() > before {
            return None;
        }
        let start = start?;
        let default = if start == BranchStart::Upright || cycle > 1 { cycle } else { 2 };
        Some(Self { scene: scene?, period: period.unwrap_or(default), start, sweep })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for PeriodicOrbitRequest {
    fn canonical(&self) -> Vec<u8> {
        let start = match self.start {
            BranchStart::Upright => ("upright", [0.0; 4]),
            BranchStart::Near(state) => ("guess", [state.theta, state.x_dot, state.y_dot, state.theta_dot]),
            BranchStart::Symmetric(theta) => ("symmetric", [theta, 0.0, 0.0, 0.0]),
        };
        write::canonical(&self.scene, &(self.period, start, self.sweep))
    }
}

impl PeriodicOrbitRequest {
    /// Price of the work, in bounces of the plain rod. A bounce with derivatives costs as much as about twelve.
    fn work(&self) -> u64 {
        limits::ANSWER_PRICE + 12 * self.period * self.sweep.map_or(60, |sweep| 10 * sweep.points + 2000)
    }

    /// JSON pointer to the field that caused an error of the start.
    pub(super) fn pointer(&self) -> &'static str {
        match (self.start, self.sweep) {
            (BranchStart::Symmetric(_), _) => "/theta",
            (BranchStart::Near(_), _) => "/guess",
            (BranchStart::Upright, Some(_)) => "/sweep/from",
            (BranchStart::Upright, None) => "/period",
        }
    }
}

impl SweptRange {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let sweeps = |row: &&Field| matches!(row.kind, FieldKind::Number { .. }) && row.name != Name::Friction;
        let row = reader.text("parameter").and_then(field).filter(sweeps);
        if row.is_none() && reader.has("parameter") {
            reader
                .refuse("parameter", "parameter must be the dotted name of a number of the scene, as table.tilt_gain, and not contact.friction");
        }
        let (from, to) = (reader.number("from", -1e4..=1e4, ""), reader.number("to", -1e4..=1e4, ""));
        let points = reader.integer("points", 2..=limits::BRANCH_POINTS).unwrap_or(200);
        reader.require(&["parameter", "from", "to"]);
        let (row, from, to) = (row?, from?, to?);
        for (name, value) in [("from", from), ("to", to)] {
            if !row.admits(Value::Number(value)) {
                reader.refuse(name, format!("{name} is {value}; {} must be {}", row.path, row.limits()));
            }
        }
        if from == to {
            reader.refuse("to", format!("to is {to}, as from; a sweep needs a range"));
        }
        if row.name == Name::EnergyGain && from.min(to) <= 0.0 && from.max(to) >= 0.0 {
            reader.refuse("from", "at energy_gain 0 nothing sets the energy; sweep on one side of it");
        }
        Some(Self { parameter: row.name, from, to, points })
    }
}
