//! The request for `stability`: a scene, and the evidence that is asked for.

use equipoise_physics::analysis::evidence::{NOISY_IMPACTS, NOISY_RUNS, SMALL_RUN};
use equipoise_physics::analysis::fixed_point::is_plain;
use equipoise_physics::analysis::margins::extra::{ExtraTolerance, MOST_EXTRA, refusal};
use equipoise_physics::analysis::margins::{MOST_BODIES, MOST_SEARCHED, Tolerances};
use equipoise_physics::analysis::regularity::WATCHED;
use equipoise_physics::analysis::{basin, losses};
use equipoise_physics::scene::{FieldKind, Scene, field};

use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::scene::{bounce_price, read_scene};
use crate::api::shared::write;
use crate::api::stability::budget::budget_price;
use crate::api::stability::gain_margins::gain_margins_price;
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::problem::shortened;
use crate::limits;
use crate::limits::Limits;

/// A request for a verdict.
#[derive(Debug, Clone, Copy)]
pub struct StabilityRequest {
    /// The scene.
    pub scene: Scene,
    /// Number of contacts that the run is watched for.
    pub impacts: u64,
    /// True if the basin is asked for.
    pub basin: bool,
    /// True if the budget of the errors is asked for.
    pub budget: bool,
    /// True if the dial is asked for.
    pub dial: bool,
    /// True if the margins of the gain are asked for.
    pub gain_margins: bool,
    /// Tolerances of the body, if the margins are asked for.
    pub tolerances: Option<Tolerances>,
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
        let scene = read_scene(reader);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(DEFAULT_IMPACTS);
        let basin = reader.boolean("basin").unwrap_or(false);
        let budget = reader.boolean("budget").unwrap_or(false);
        let dial = reader.boolean("dial").unwrap_or(false);
        let gain_margins = reader.boolean("gain_margins").unwrap_or(false);
        let tolerances = read_tolerances(reader);
        Some(Self { scene: scene?, impacts, basin, budget, dial, gain_margins, tolerances })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(self.work()).within(&limits.of_work())
    }
}

impl CanonicalRequest for StabilityRequest {
    fn canonical(&self) -> Vec<u8> {
        let off = self.tolerances.map(|off| {
            let further =
                off.further.iter().flatten().map(|field| (field.name.row().path, field.off)).collect::<Vec<_>>();
            (off.contact_distance, off.radius_of_gyration, off.restitution, further)
        });
        write::canonical(&self.scene, &(self.impacts, self.basin, self.budget, self.dial, self.gain_margins, off))
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
            let is_closed = is_plain(&judged_law) && off.further.iter().all(Option::is_none);
            if is_closed { MOST_BODIES * BODY_PRICE } else { MOST_SEARCHED * SEARCHED_PRICE }
        });
        let ends = losses::searched_gains(scene) * losses::MOST_VALUES * VALUE_PRICE * bounce_price(scene);
        limits::ANSWER_PRICE + run + ends + basin + budget + gains + margins
    }
}

/// Reads `tolerances`, if they are asked for.
fn read_tolerances(reader: &mut Reader<'_, '_>) -> Option<Tolerances> {
    reader.within("tolerances", |reader| Tolerances {
        contact_distance: reader.number("contact_distance", 0.0..=1.0, "m").unwrap_or(0.0),
        radius_of_gyration: reader.number("radius_of_gyration", 0.0..=1.0, "m").unwrap_or(0.0),
        restitution: reader.number("restitution", 0.0..=1.0, "(no unit)").unwrap_or(0.0),
        further: read_further(reader),
    })
}

/// Reads the tolerances of further fields, each field once, in the order of the request.
fn read_further(reader: &mut Reader<'_, '_>) -> [Option<ExtraTolerance>; MOST_EXTRA] {
    let mut further: [Option<ExtraTolerance>; MOST_EXTRA] = [None; MOST_EXTRA];
    reader.objects("parameters", MOST_EXTRA, |place, item| {
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
