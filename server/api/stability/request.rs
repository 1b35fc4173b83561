//! The request for `stability`: a scene, and the evidence that is asked for.

use equipoise_physics::analysis::evidence::{NOISY_IMPACTS, NOISY_RUNS, SMALL_RUN};
use equipoise_physics::analysis::fixed_point::is_plain;
use equipoise_physics::analysis::margins::extra::{ExtraTolerance, MOST_EXTRA, refusal};
use equipoise_physics::analysis::margins::{MOST_BODIES, MOST_SEARCHED, Tolerances};
use equipoise_physics::analysis::regularity::WATCHED;
use equipoise_physics::analysis::{basin, losses};
use equipoise_physics::scene::{FieldKind, Scene, field};
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::bounce_price;
use crate::api::scene::spec::SceneSpec;
use crate::api::scene::write::resolved;
use crate::api::shared::write::canonical_of;
use crate::api::stability::budget::budget_price;
use crate::api::stability::gain_margins::gain_margins_price;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::problem::shortened;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Fields, Flag, Object, number, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

request_fields! {
    /// A request for a verdict.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct StabilityRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Largest number of impacts of the nonlinear run.
        pub impacts: u64 = whole(1..=limits::IMPACTS).or(DEFAULT_IMPACTS),
        /// Computes the basin of release angles too, by 448 more runs in parallel, each at a quarter of the price of a run. With a program of
        /// heights or `table.limits` each is a whole run, and for a polygon two.
        pub basin: bool = Flag,
        /// Computes the budget of the errors of the rig too: for each the largest value that keeps the verdict, alone and together, by up to some
        /// 2,000 more runs of `impacts` contacts.
        pub budget: bool = Flag,
        /// Adds the eigenvalues on the unit circle as a small picture without words, for a page that follows a slider.
        pub dial: bool = Flag,
        /// Computes the margins of the gain too: the values of the tilt gain (with state feedback a factor on its gains) nearest to its own at
        /// which small deviations do otherwise, and at which the run of this release ends otherwise, by up to some 120 more runs of `impacts`
        /// contacts.
        pub gain_margins: bool = Flag,
        /// Largest deviations of the body, and of further numbers, from the scene.
        pub tolerances: Option<ToleranceFields> = Object.optional(),
    }
}

request_fields! {
    /// Tolerances, either way.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct ToleranceFields {
        /// Tolerance of the contact distance.
        pub contact_distance: f64 = number(0.0..=1.0, "m").or(0.0),
        /// Tolerance of the radius of gyration.
        pub radius_of_gyration: f64 = number(0.0..=1.0, "m").or(0.0),
        /// Tolerance of the restitution. The restitution that the table assumes stays.
        pub restitution: f64 = number(0.0..=1.0, "").or(0.0),
        /// Tolerances of further fields of the scene, each field once. An error that the scene leaves out is 0 in the middle.
        #[serde(serialize_with = "by_path")]
        pub parameters: Further = FurtherSpec,
    }
}

/// Tolerances of further fields.
type Further = [Option<ExtraTolerance>; MOST_EXTRA];

fn by_path<S: Serializer>(further: &Further, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(further.iter().flatten().map(|field| (field.name.row().path, field.off)))
}

impl From<ToleranceFields> for Tolerances {
    fn from(fields: ToleranceFields) -> Self {
        let ToleranceFields { contact_distance, radius_of_gyration, restitution, parameters: further } = fields;
        Self { contact_distance, radius_of_gyration, restitution, further }
    }
}

/// Contacts that the run is watched for, if a request does not say.
pub const DEFAULT_IMPACTS: u64 = 2000;

/// Price of a body of the margins, in bounces, by closed forms, and by a search on the return map.
const BODY_PRICE: u64 = 25;
const SEARCHED_PRICE: u64 = 8_000;

/// Price of a value of a gain that a search of its ends tries, in bounces: some ten maps with their derivatives.
const VALUE_PRICE: u64 = 150;

/// Price of a run of the basin without its bounces, in bounces.
const BASIN_RUN_PRICE: u64 = 10;

impl ResourceRequest for StabilityRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        Self::read_fields(reader)
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for StabilityRequest {
    fn canonical(&self) -> Vec<u8> {
        canonical_of(self)
    }
}

impl StabilityRequest {
    /// Highest price of the work, in bounces of the plain rod: the run, the watch with its derivatives, the ends of the gains, the budget, and the basin, whose
    /// runs cost a quarter in lanes, and those of a scene without mirror symmetry twice, once for each side.
    fn work(&self) -> u64 {
        let Self { ref scene, impacts, basin, budget, tolerances, gain_margins, dial: _ } = *self;
        let judged = scene.with_tilt_law();
        let basin_run = basin::sides(&judged)
            * if basin::runs_in_lanes(&judged) { impacts / 4 } else { impacts * bounce_price(scene) };
        let basin = if basin { basin::RUNS * (BASIN_RUN_PRICE + basin_run) } else { 0 };
        let judged_law = judged;
        let judged = if scene.has_noise() { NOISY_RUNS * NOISY_IMPACTS } else { SMALL_RUN };
        let run = (impacts + judged) * bounce_price(scene) + 4 * impacts.min(WATCHED);
        let budget = if budget { budget_price(scene, impacts) } else { 0 };
        let gains = if gain_margins { gain_margins_price(scene, impacts) } else { 0 };
        let margins = tolerances.map_or(0, |off| {
            let is_closed = is_plain(&judged_law) && off.parameters.iter().all(Option::is_none);
            if is_closed { MOST_BODIES * BODY_PRICE } else { MOST_SEARCHED * SEARCHED_PRICE }
        });
        let ends = losses::searched_gains(scene) * losses::MOST_VALUES * VALUE_PRICE * bounce_price(scene);
        limits::ANSWER_PRICE + run + ends + basin + budget + gains + margins
    }
}

/// Tolerances of further fields, each field once, in the order of the request.
#[derive(Debug, Clone, Copy)]
struct FurtherSpec;

impl FieldSpec<Further> for FurtherSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Further> {
        Some(read_further(reader, name))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(&format!("{name}.0"), |item| {
            let about = "Dotted path of a numeric field. Not `table.tilt_gain`, whose margin it is, `table.feedback`, noise, and fields that only end runs.";
            item.leaf("parameter", about, json!({"type": "string"}), Some(json!("table.errors.speed")));
            let about = "Its tolerance in the field's unit, up to the width of its range. Values are cut to the range.";
            item.leaf("tolerance", about, json!({"type": "number", "minimum": 0}), None);
            item.require("parameter");
            item.require("tolerance");
        });
        list.property(name, about, &json!({"type": "array", "maxItems": MOST_EXTRA, "items": schema}));
    }
}

fn read_further(reader: &mut Reader<'_, '_>, name: &'static str) -> Further {
    let mut further: Further = [None; MOST_EXTRA];
    reader.objects(name, MOST_EXTRA, |place, item| {
        item.require(&["parameter", "tolerance"]);
        let path = item.text("parameter");
        let row = path.and_then(field);
        let (most, unit) = match row.map(|row| (row.kind, row.unit)) {
            Some((FieldKind::Number { minimum, maximum }, unit)) => (maximum - minimum, unit),
            _ => (f64::MAX, ""),
        };
        let off = item.number("tolerance", 0.0..=most, unit);
        let refused = match (path, row) {
            (None, _) => None,
            (Some(path), None) => Some(format!(
                "parameter is {:?}; it must be a field of a scene whose values are numbers, such as table.errors.speed",
                shortened(path)
            )),
            (Some(_), Some(row)) if further.iter().flatten().any(|known| known.name == row.name) => {
                Some(format!("parameter is {} for the second time; give it one tolerance", row.path))
            }
            (Some(_), Some(row)) => refusal(row),
        };
        if let Some(detail) = refused {
            item.refuse("parameter", detail);
        } else if let (Some(row), Some(off)) = (row, off) {
            further[place] = Some(ExtraTolerance { name: row.name, off });
        }
    });
    further
}
