//! The request for `periodic-orbits`: an orbit, or a branch of orbits along a field of the scene.

use equipoise_physics::analysis::periodic_orbits::branch::BranchStart;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Field, FieldKind, Name, Scene, Value, field};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::has_angle;
use crate::api::scene::spec::SceneSpec;
use crate::api::shared::refusal::lacking;
use crate::api::shared::write;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Fields, Object, choice, number, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

/// The range that a field is swept over.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct SweptRange {
    /// The field.
    #[serde(serialize_with = "path")]
    #[schemars(with = "String")]
    pub field: Name,
    /// Value at the start.
    pub from: f64,
    /// Value at the end.
    pub to: f64,
    /// Largest number of orbits along the sweep.
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

request_fields! {
    /// A request for an orbit as it is read. It has `guess`, or `family` with `theta`, unless the period is 1.
    pub(super) struct AskedOrbit {
        /// The scene.
        scene: Scene = SceneSpec,
        /// Number of impacts after which the orbit recurs. By default 2; without any start, 1, the upright bounce.
        period: Option<u64> = whole(1..=limits::ORBIT_PERIOD).optional(),
        /// A state just before an impact, near that of the orbit. All parts except `y_dot` are 0 by default.
        guess: Option<State> = Object.optional(),
        /// Start at the exact mirror-symmetric orbit of period 2. Needs `theta`.
        family: Option<()> = choice(&[("symmetric", ())]).optional(),
        /// Angle of that orbit; not 0. Needs `family`.
        theta: Option<f64> = number(-1.5..=1.5, "rad").optional(),
        /// The field along which to follow the orbit.
        sweep: Option<SweptRange> = Object.optional(),
    }
}

request_fields! {
    /// A range that a field is swept over, as it is read.
    struct AskedRange {
        /// Dotted path of a numeric field, such as table.tilt_gain; not contact.friction.
        field: &'static Field = SweptField.required(),
        /// First value, in the unit of the field.
        from: f64 = number(-1e4..=1e4, "").required(),
        /// Last value, in the unit of the field; differs from `from`.
        to: f64 = number(-1e4..=1e4, "").required(),
        /// Largest number of points, besides those located.
        points: u64 = whole(2..=limits::BRANCH_POINTS).or(200),
    }
}

/// The path of a field that can be swept.
struct SweptField;

impl Absence for SweptField {}

impl FieldSpec<&'static Field> for SweptField {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<&'static Field> {
        let sweeps = |row: &&Field| matches!(row.kind, FieldKind::Number { .. }) && row.name != Name::Friction;
        let row = reader.text(name).and_then(field).filter(sweeps);
        if row.is_none() && reader.has(name) {
            reader.refuse(
                name,
                "field must be the dotted name of a number of the scene, as table.tilt_gain, and not contact.friction",
            );
        }
        row
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        list.leaf(name, about, json!({"type": "string"}), None);
    }
}

impl ResourceRequest for PeriodicOrbitRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let before = reader.errors().len();
        let AskedOrbit { scene, period, guess, family, theta, sweep } = AskedOrbit::read_fields(reader)?;
        let cycle = scene.program().map_or(1, |program| program.heights().len() as u64);
        if let Some(period) = period.filter(|period| !period.is_multiple_of(cycle)) {
            let detail =
                format!("period is {period}; with a program of {cycle} heights it must be a multiple of {cycle}");
            reader.refuse("period", detail);
        }
        if !has_angle(&scene) && guess.is_some_and(|guess| guess.theta != 0.0 || guess.theta_dot != 0.0) {
            reader.refuse("guess", "a point mass has no theta and no theta_dot; leave them out");
        }
        if let Some(detail) = family.and_then(|()| lacking(&scene, Analysis::SymmetricOrbit)) {
            reader.refuse("family", detail);
        }
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
        Some(Self { scene, period: period.unwrap_or(default), start, sweep })
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

impl Fields for SweptRange {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let AskedRange { field: row, from, to, points } = AskedRange::read_fields(reader)?;
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
        Some(Self { field: row.name, from, to, points })
    }

    fn describe_fields(list: &mut FieldList) {
        AskedRange::describe_fields(list);
    }
}
