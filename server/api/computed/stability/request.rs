//! The request for `stability`: a scene, and the evidence that is asked for.

use equipoise_physics::analysis::evidence::{NOISY_IMPACTS, NOISY_RUNS, SMALL_RUN};
use equipoise_physics::analysis::fixed_point::is_plain;
use equipoise_physics::analysis::margins::{MOST_BODIES, MOST_EXTRA, MOST_SEARCHED, OF_BODY, Tolerance, refusal};
use equipoise_physics::analysis::regularity::WATCHED;
use equipoise_physics::analysis::{basin, losses};
use equipoise_physics::scene::{FieldKind, Scene, field};
use serde_json::{Value, json};

use crate::api::computed::stability::budget::{budget_price, release_margins_price};
use crate::api::prelude::*;
use crate::http::problem::shortened;

request_fields! {
    /// A request for a verdict.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct StabilityRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Largest number of impacts of the nonlinear run.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(DEFAULT_BOUNCES),
        /// Computes the basin of release angles too, by 448 more runs in parallel, each at a quarter of the price of a run. With a program of
        /// heights or `table.limits` each is a whole run, and for a polygon two.
        pub basin: bool = Flag,
        /// Computes the budget of the errors of the rig too: for each the largest value that keeps the verdict, alone and together, by up to some
        /// 2,000 more runs of `bounces` contacts.
        pub budget: bool = Flag,
        /// Adds margins of the gain `of` `release` to `margins`: the values of the tilt gain (with state feedback a factor on its gains) nearest to
        /// its own at which the run of this release ends otherwise, by up to some 120 more runs of `bounces` contacts.
        pub release_margins: bool = Flag,
        /// Tolerances of fields, each field once: largest deviations from the scene, either way.
        #[serde(serialize_with = "by_path")]
        pub tolerances: Option<Tolerated> = ToleratedSpec,
    }
}

/// Most fields with a tolerance: the three of the body, and further ones.
const MOST: usize = OF_BODY.len() + MOST_EXTRA;

/// Tolerances of fields in the order of the request.
pub type Tolerated = [Option<Tolerance>; MOST];

fn by_path<S: Serializer>(tolerated: &Option<Tolerated>, serializer: S) -> Result<S::Ok, S::Error> {
    let pairs = |tolerated: &Tolerated| -> Vec<_> {
        tolerated.iter().flatten().map(|field| (field.name.row().path, field.off)).collect()
    };
    tolerated.as_ref().map(pairs).serialize(serializer)
}

/// Contacts that the run is watched for, if a request does not say.
pub const DEFAULT_BOUNCES: u64 = 2000;

/// Price of a body of the margins, in bounces, by closed forms, and by a search on the return map.
const BODY_PRICE: u64 = 25;
const SEARCHED_PRICE: u64 = 8_000;

/// Price of a value of a gain that a search of its ends tries, in bounces: some ten maps with their derivatives.
const VALUE_PRICE: u64 = 150;

/// Price of a run of the basin without its bounces, in bounces.
const BASIN_RUN_PRICE: u64 = 10;

impl ResourceRequest for StabilityRequest {
    /// Price of the run, the watch with its derivatives, the ends of the gains, the budget, and the basin, whose
    /// runs cost a quarter in lanes, and those of a scene without mirror symmetry twice, once for each side.
    fn work(&self) -> u64 {
        let Self { ref scene, bounces, basin, budget, tolerances, release_margins } = *self;
        let judged = scene.with_tilt_law();
        let basin_run = basin::sides(&judged)
            * if basin::runs_in_lanes(&judged) { bounces / 4 } else { bounces * bounce_price(scene) };
        let basin = if basin { basin::RUNS * (BASIN_RUN_PRICE + basin_run) } else { 0 };
        let judged_law = judged;
        let judged = if scene.has_noise() { NOISY_RUNS * NOISY_IMPACTS } else { SMALL_RUN };
        let run = (bounces + judged) * bounce_price(scene) + 4 * bounces.min(WATCHED);
        let budget = if budget { budget_price(scene, bounces) } else { 0 };
        let gains = if release_margins { release_margins_price(scene, bounces) } else { 0 };
        let margins = tolerances.map_or(0, |off| {
            let is_closed = is_plain(&judged_law) && off.iter().flatten().all(|field| OF_BODY.contains(&field.name));
            if is_closed { MOST_BODIES * BODY_PRICE } else { MOST_SEARCHED * SEARCHED_PRICE }
        });
        let ends = losses::searched_gains(scene) * losses::MOST_VALUES * VALUE_PRICE * bounce_price(scene);
        limits::ANSWER_PRICE + run + ends + basin + budget + gains + margins
    }
}

/// Tolerances of fields, each field once, in the order of the request.
#[derive(Debug, Clone, Copy)]
struct ToleratedSpec;

impl FieldSpec<Option<Tolerated>> for ToleratedSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Option<Tolerated>> {
        match reader.peek(name) {
            None => Some(reader.value(name).and(None)),
            Some(Value::Object(_)) => {
                reader.value(name);
                reader.refuse(name, format!("{name} is an object; since 0.3 it is a list of {{field, tolerance}}"));
                None
            }
            Some(_) => Some(Some(read_tolerated(reader, name))),
        }
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(&format!("{name}.0"), |item| {
            let about = "Dotted path of a numeric field. Not `table.tilt_gain`, whose margin it is, `table.feedback`, noise, and fields that only end \
                         runs. An error that the scene leaves out is 0 in the middle. The restitution that the table assumes stays.";
            item.leaf("field", about, json!({"type": "string"}), Some(json!("table.errors.speed")));
            let about = "Its tolerance in the field's unit, up to the width of its range; of a length of the body up to 1 m. Values are cut to the range.";
            item.leaf("tolerance", about, json!({"type": "number", "minimum": 0}), None);
            item.require("field");
            item.require("tolerance");
        });
        let about = format!("{about} At most {MOST_EXTRA} besides those of the body and of the restitution.");
        list.property(name, &about, &json!({"type": "array", "maxItems": MOST, "items": schema}));
        list.may_be_absent(name);
    }
}

fn read_tolerated(reader: &mut Reader<'_, '_>, name: &'static str) -> Tolerated {
    let mut tolerated: Tolerated = [None; MOST];
    reader.objects(name, MOST, |place, item| {
        item.require(&["field", "tolerance"]);
        let path = item.text("field");
        let row = path.and_then(field);
        let (most, unit) = match row.map(|row| (row.kind, row)) {
            Some((_, row)) if OF_BODY.contains(&row.name) => (1.0, row.unit),
            Some((FieldKind::Number { minimum, maximum }, row)) => (maximum - minimum, row.unit),
            _ => (f64::MAX, ""),
        };
        let off = item.number("tolerance", 0.0..=most, unit);
        let further = tolerated.iter().flatten().filter(|known| !OF_BODY.contains(&known.name)).count();
        let refused = match (path, row) {
            (None, _) => None,
            (Some(path), None) => Some(format!(
                "field is {:?}; it must be a field of a scene whose values are numbers, such as table.errors.speed",
                shortened(path)
            )),
            (Some(_), Some(row)) if tolerated.iter().flatten().any(|known| known.name == row.name) => {
                Some(format!("field is {} for the second time; give it one tolerance", row.path))
            }
            (Some(_), Some(row)) if further == MOST_EXTRA && !OF_BODY.contains(&row.name) => Some(format!(
                "{} is one field too many: besides those of the body and of the restitution there are at most {MOST_EXTRA} tolerances",
                row.path
            )),
            (Some(_), Some(row)) => refusal(row),
        };
        if let Some(detail) = refused {
            item.refuse("field", detail);
        } else if let (Some(row), Some(off)) = (row, off) {
            tolerated[place] = Some(Tolerance { name: row.name, off });
        }
    });
    tolerated
}
