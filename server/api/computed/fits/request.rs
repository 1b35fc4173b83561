//! The request for `fits`: a scene with first values, the measured impacts, the unknown fields, and standard deviations.
//! Reasons for which there is no fit are told at its fields.

use std::f64::consts::PI;
use std::sync::Arc;

use equipoise_physics::analysis::regularity::WATCHED;
use equipoise_physics::fitting::{COLUMNS, DataError, FitFailure, FitRequest, MOST_UNKNOWNS, Measured, check};
use equipoise_physics::scene::{Name, Scene, field};
use serde_json::{Value, json};

use crate::api::computed::stability::request::DEFAULT_BOUNCES;
use crate::api::computed::trajectories::columns::trajectory_words;
use crate::api::prelude::*;
use crate::api::scene::explain;
use crate::api::shared::table::with_unit;
use crate::api::shared::write;
use crate::http::request::reader;
use crate::http::request::tree::TableBody;

/// A request for a fit.
#[derive(Debug, Clone)]
pub struct FitsRequest {
    /// The request as the physics takes it.
    pub fit: Arc<FitRequest>,
}

/// Standard deviations, in the unit of the column.
const DEVIATIONS: std::ops::RangeInclusive<f64> = 1e-9..=1e3;

/// Measured values, in the unit of the column.
const VALUES: std::ops::RangeInclusive<f64> = -1e12..=1e12;

request_fields! {
    /// The fields of a request for a fit.
    pub struct FitFields {
        /// The scene with first values of the unknown fields. Its release takes part only if a field of `release` is unknown.
        scene: Scene = SceneSpec,
        /// Measured impacts in columns of one length, null where a value is missing. States are those just before an impact. `t` is needed, on any
        /// clock, and rises from row to row. Without `n` the rows are the impacts from 1 on; missed and doubled ones are found.
        measured: Measured = MeasuredSpec,
        /// Paths of the unknown fields, such as `table.tilt_gain`. `/v1/fields` lists all fields; those of kind `number` can be unknown.
        unknown: Vec<Name> = UnknownSpec,
        /// Standard deviations of the measurements by column. Those that are missing are estimated from the residuals. Only if all are given can
        /// χ² say that the model is wrong.
        sd: [Option<f64>; COLUMNS.len()] = DeviationsSpec,
    }
}

/// The measured impacts as a table: with the columns that trajectories write, with units or without. Angles may be in degrees.
pub static MEASURED: TableBody = TableBody {
    field: "measured",
    columns: || {
        let named = COLUMNS.into_iter().flat_map(|(name, unit)| {
            let degrees =
                unit.starts_with("rad").then(|| (with_unit(name, &unit.replace("rad", "deg")), name, PI / 180.0));
            [(name.to_owned(), name, 1.0), (with_unit(name, unit), name, 1.0)].into_iter().chain(degrees)
        });
        std::iter::once(("n".to_owned(), "n", 1.0)).chain(named).collect()
    },
    others: || {
        let words = trajectory_words();
        words.iter().flat_map(|word| [word.name.to_owned(), word.csv_name()]).collect()
    },
    rows: limits::FIT_IMPACTS,
};

/// Measured columns.
struct MeasuredSpec;

impl FieldSpec<Measured> for MeasuredSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Measured> {
        reader.require(&[name]);
        reader.within(name, read_measured)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, |list| {
            let numbers = column(json!({"type": "integer", "minimum": 1, "maximum": limits::BOUNCES}));
            list.property("n", "Numbers of the impacts, rising.", &numbers);
            for (name, unit) in COLUMNS {
                list.property(name, "", &json!({"$ref": "#/components/schemas/MeasuredValues", "x-unit": unit}));
            }
            list.require("t");
        });
        list.property(name, about, &schema);
        list.require(name);
    }
}

fn column(items: Value) -> Value {
    json!({"type": "array", "maxItems": limits::FIT_IMPACTS, "items": items})
}

/// Schema of a measured column, by a name, as other lists with gaps.
pub fn measured_values() -> Value {
    let mut values = column(json!({"type": ["number", "null"], "minimum": VALUES.start(), "maximum": VALUES.end()}));
    values["description"] = json!("Measurements, null where one is missing.");
    values
}

/// Paths of fields.
struct UnknownSpec;

impl FieldSpec<Vec<Name>> for UnknownSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Vec<Name>> {
        reader.require(&[name]);
        read_unknown(reader)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = json!({
            "type": "array", "minItems": 1, "maxItems": MOST_UNKNOWNS, "uniqueItems": true, "items": {"type": "string"},
        });
        list.property(name, about, &schema);
        list.require(name);
    }
}

/// A number for each measured column, or none.
struct DeviationsSpec;

impl FieldSpec<[Option<f64>; COLUMNS.len()]> for DeviationsSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<[Option<f64>; COLUMNS.len()]> {
        let read = |sd: &mut Reader<'_, '_>| COLUMNS.map(|(name, unit)| sd.number(name, DEVIATIONS, unit));
        Some(reader.within(name, read).unwrap_or_default())
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, |list| {
            for (name, unit) in COLUMNS {
                FieldSpec::<f64>::describe(&number(DEVIATIONS, unit), name, "", list);
            }
        });
        list.property(name, about, &schema);
    }
}

impl Fields for FitsRequest {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let FitFields { scene, measured, unknown, sd } = FitFields::read_fields(reader)?;
        let fit = FitRequest { scene, measured, unknown, sd };
        if reader.errors().is_empty() {
            for (pointer, detail) in check(&fit).into_iter().filter_map(|why| place(&fit, why)) {
                let pointer = format!("{}{pointer}", reader.pointer());
                reader.errors().push(pointer, detail);
            }
        }
        Some(Self { fit: Arc::new(fit) })
    }

    fn describe_fields(list: &mut FieldList) {
        FitFields::describe_fields(list);
    }
}

impl ResourceRequest for FitsRequest {
    fn work(&self) -> u64 {
        let FitRequest { scene, measured, unknown, .. } = &*self.fit;
        let first = measured.n.first().copied().unwrap_or(1);
        let last = measured.n.last().copied().unwrap_or(measured.rows() as u64);
        let impacts = last.saturating_sub(first).max(measured.rows() as u64);
        // Friction, and an error of the rig that the scene leaves out, take a dearer model than the scene has by itself.
        let is_dearer = unknown.iter().any(|&name| name == Name::Friction || scene.number(name).is_none());
        let bounce = bounce_price(scene) + u64::from(is_dearer);
        // A derivative steps each component of a state and each field to both sides.
        let derivative = 2 * (COLUMNS.len() + unknown.len()) as u64 * bounce;
        let margins = (8 + 4 * unknown.len() as u64) * limits::ANSWER_PRICE;
        let stability = margins + (DEFAULT_BOUNCES + 4 * WATCHED) * bounce;
        let further = limits::FIT_FURTHER_ITERATIONS * (impacts.min(limits::FIT_FEW_IMPACTS) + limits::FIT_OVERHEAD);
        let iterations = limits::FIT_ITERATIONS * (impacts + limits::FIT_OVERHEAD) + further;
        stability + iterations * derivative
    }
}

fn read_measured(reader: &mut Reader<'_, '_>) -> Measured {
    reader.require(&["t"]);
    let mut measured = Measured::default();
    for (column, (name, unit)) in measured.columns.iter_mut().zip(COLUMNS) {
        let items = reader.array(name, limits::FIT_IMPACTS).unwrap_or_default();
        let (source, pointer) = (reader.source(), reader.pointer_to(name));
        for (row, item) in items.iter().enumerate() {
            let read = match item {
                Value::Null => Ok(None),
                item => reader::number_within(item, source, &VALUES, unit).map(Some),
            };
            column.push(read.unwrap_or_else(|error| {
                reader.errors().push(format!("{pointer}/{row}"), format!("{name} {error}"));
                None
            }));
        }
    }
    let items = reader.array("n", limits::FIT_IMPACTS).unwrap_or_default();
    let (source, pointer) = (reader.source(), reader.pointer_to("n"));
    for (row, item) in items.iter().enumerate() {
        match reader::integer(item, source, &(1..=limits::BOUNCES)) {
            Ok(n) => measured.n.push(n),
            Err(error) => reader.errors().push(format!("{pointer}/{row}"), format!("n {error}")),
        }
    }
    measured
}

fn read_unknown(reader: &mut Reader<'_, '_>) -> Option<Vec<Name>> {
    let items = reader.array("unknown", MOST_UNKNOWNS)?;
    if items.is_empty() {
        reader.refuse(
            "unknown",
            format!("unknown is empty; name 1 to {MOST_UNKNOWNS} fields of the scene by their paths"),
        );
        return None;
    }
    let pointer = reader.pointer_to("unknown");
    let mut names = Vec::new();
    for (index, item) in items.iter().enumerate() {
        match reader::text(item).map(|path| (path, field(path))) {
            Ok((_, Some(row))) => names.push(row.name),
            Ok((path, None)) => {
                let detail = format!(
                    "unknown {index} is `{}`, which is no field of a scene; /v1/fields lists them",
                    crate::http::problem::shortened(path)
                );
                reader.errors().push(format!("{pointer}/{index}"), detail);
            }
            Err(error) => reader.errors().push(format!("{pointer}/{index}"), format!("unknown {index} {error}")),
        }
    }
    Some(names)
}

impl FitsRequest {
    /// Canonical form.
    pub(super) fn canonical(&self) -> Vec<u8> {
        let FitRequest { scene, measured, unknown, sd } = &*self.fit;
        let unknown: Vec<&str> = unknown.iter().map(|name| name.row().path).collect();
        write::canonical(scene, &(&measured.n, &measured.columns, unknown, sd))
    }
}

/// The JSON pointer to the field for which there is no fit, and a sentence on it; `None` of cancelled work.
pub(super) fn place(request: &FitRequest, why: FitFailure) -> Option<(String, String)> {
    let scene = |detail: String| ("/scene".to_owned(), detail);
    Some(match why {
        FitFailure::Cancelled => return None,
        FitFailure::Data(DataError { column, row, detail }) => {
            let pointer = match (column, row) {
                ("", _) => "/measured".to_owned(),
                (column, None) => format!("/measured/{column}"),
                (column, Some(row)) => format!("/measured/{column}/{row}"),
            };
            (pointer, detail)
        }
        FitFailure::Unknown(index, detail) => (format!("/unknown/{index}"), detail),
        FitFailure::Scene(errors) => {
            let details: Vec<String> = explain(errors).into_iter().map(|error| error.detail).collect();
            scene(format!("on the way the fit came to a scene that cannot be: {}", details.join("; ")))
        }
        FitFailure::TooFew { values, unknowns } => {
            let detail = format!(
                "there are {values} values for {unknowns} unknowns, the {} fields and the initial states of the windows; at least {} are \
                 needed",
                request.unknown.len(),
                unknowns + 3
            );
            ("/measured".to_owned(), detail)
        }
        FitFailure::RunEnds => scene(
            "the run of the scene ends among the measured impacts, whatever the start; give first values closer to the rig, and check the units \
             of the data"
                .to_owned(),
        ),
    })
}
