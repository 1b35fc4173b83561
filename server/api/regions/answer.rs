//! The answer of `regions`: a quantity and an outcome for each pair of values of two fields.

use equipoise_physics::catching::outcome::CatchOutcomeKind;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::surveys::stability_map;
use equipoise_physics::surveys::stability_map::{MapAxis, MapCell, MapOutcome, MapQuantity};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use std::sync::LazyLock;

use crate::api::regions::request::{RegionQuantity, RegionRequest, quantity_name};
use crate::api::scene::Resolved;
use crate::api::shared::tile::Tile;
use crate::api::vocabulary::counts;
use crate::{limits, schemas};

/// Outcome of a cell without a run.
const NO_RUN: &str = "none";

/// Answer of `/v1/regions`: the cells of a tile.
#[derive(Debug)]
pub struct RegionAnswer {
    pub(super) request: RegionRequest,
    pub(super) cells: Vec<MapCell>,
    pub(super) limit_curves: Vec<stability_map::BoundarySegment>,
}

impl RegionAnswer {
    /// The answer for the cells of a tile, row by row. Computes the limit curves; `None` if `go_on` returned false meanwhile.
    pub fn new(request: RegionRequest, cells: Vec<MapCell>, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        // The limit curves are those of the scene's own law, which a catch does not follow.
        let limit_curves = if request.map.quantity.is_of_catches() {
            Vec::new()
        } else {
            request.map.boundary(limits::REGION_BOUNDARY_NODES, &mut go_on)?
        };
        Some(Self { request, cells, limit_curves })
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &[MapCell])> {
        self.request.rows().zip(self.cells.chunks(self.request.map.x.count))
    }

    fn counts(&self) -> Counts {
        let mut counts = Counts::new(self.request.map.quantity);
        counts.add(&self.cells);
        counts
    }
}

pub(crate) fn written(value: f64) -> String {
    serde_json::to_string(&value).unwrap_or_default()
}

/// Number of a cell's outcome among those of the quantity. The number after the last outcome stands for a cell without a run.
pub(super) fn code(cell: &MapCell, quantity: MapQuantity) -> usize {
    cell.outcome.map_or_else(|| outcome_names(quantity).len() - 1, MapOutcome::code)
}

pub(crate) fn outcome_name(cell: &MapCell) -> &'static str {
    cell.outcome.map_or(NO_RUN, MapOutcome::name)
}

/// Names of the outcomes of a quantity, each at the place of its code.
pub(super) fn outcome_names(quantity: MapQuantity) -> &'static [&'static str] {
    if quantity.is_of_catches() { &OF_CATCHES } else { &OF_RUNS }
}

/// Names of the endings of runs, and of a cell without a run.
static OF_RUNS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| EndingKind::ALL.into_iter().map(EndingKind::name).chain([NO_RUN]).collect());

/// Names of the outcomes of catches, and of a cell without one.
static OF_CATCHES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| CatchOutcomeKind::ALL.into_iter().map(CatchOutcomeKind::name).chain([NO_RUN]).collect());

/// A row of values. Numbers of contacts are written as whole numbers.
pub(crate) struct RowValues<'a> {
    pub(crate) cells: &'a [MapCell],
    pub(crate) whole: bool,
}

impl Serialize for RowValues<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.cells.iter().map(|cell| cell.value);
        if self.whole {
            serializer.collect_seq(values.map(|value| value.map(|value| value as u64)))
        } else {
            serializer.collect_seq(values)
        }
    }
}

pub(crate) struct Outcomes<'a>(pub(crate) &'a [MapCell], pub(crate) MapQuantity);

impl Serialize for Outcomes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|cell| code(cell, self.1)))
    }
}

schemas! {
    /// Number of cells by outcome of their runs; `none` counts cells without one.
    RegionCounts = counts(OF_RUNS.iter().copied());
    /// Number of cells by outcome of their catches; `none` counts cells without one.
    CatchCounts = counts(OF_CATCHES.iter().copied());
}

/// Number of cells by outcome, of runs or of catches.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "a schema alone: the counts are a list")]
enum CellCounts {
    Runs(RegionCounts),
    Catches(CatchCounts),
}

/// Number of cells of each outcome.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "RegionEnd")]
pub(crate) struct Counts {
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "CellCounts")]
    counts: (MapQuantity, Vec<u64>),
}

impl Counts {
    /// No cells of a map of this quantity.
    pub(crate) fn new(quantity: MapQuantity) -> Self {
        Self { counts: (quantity, vec![0; outcome_names(quantity).len()]) }
    }

    pub(crate) fn add(&mut self, cells: &[MapCell]) {
        let (quantity, counts) = &mut self.counts;
        for cell in cells {
            if let Some(count) = counts.get_mut(code(cell, *quantity)) {
                *count += 1;
            }
        }
    }
}

fn by_name<S: Serializer>((quantity, counts): &(MapQuantity, Vec<u64>), serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(outcome_names(*quantity).iter().zip(counts))
}

/// A segment of a curve over the whole map on which the residue is 0 or 1, an end of the linear verdict.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "LimitSegment")]
struct SegmentAnswer {
    /// 0 or 1.
    residue: f64,
    x: [f64; 2],
    y: [f64; 2],
}

/// A side of the whole map.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "RegionAxis")]
struct AxisAnswer {
    field: &'static str,
    unit: &'static str,
    from: f64,
    to: f64,
    count: usize,
}

/// A tile of a map.
#[derive(Serialize, JsonSchema)]
pub(super) struct Region<'a> {
    scene: Resolved<'a>,
    /// Largest number of contacts of each run.
    bounces: u64,
    #[schemars(with = "RegionQuantity")]
    quantity: &'static str,
    /// The two sides of the whole map, x first.
    axes: [AxisAnswer; 2],
    /// The tile: a band of whole rows.
    tile: Tile,
    /// The values along a row.
    x: Vec<f64>,
    /// The value of each row of the tile.
    y: Vec<f64>,
    /// A row for each y. Null if the scene is not valid. `rest_time` is also null if the body does not come to rest in the time that is followed.
    /// `residue` and `spectral_radius` are also null without a fixed point; `residue` also for a point mass, with state feedback, and if friction
    /// couples the angle with the other components.
    #[schemars(with = "Vec<Vec<Option<f64>>>")]
    values: Vec<RowValues<'a>>,
    /// For each cell, the index of its outcome in `outcome_names`.
    #[schemars(with = "Vec<Vec<u64>>")]
    outcomes: Vec<Outcomes<'a>>,
    outcome_names: Vec<&'static str>,
    limit_curves: Vec<SegmentAnswer>,
    #[serde(flatten)]
    counts: Counts,
    notes: Vec<String>,
}

impl Serialize for RegionAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let RegionRequest { map, scene, tile } = &self.request;
        let side = |axis: MapAxis| {
            let row = axis.name.row();
            AxisAnswer { field: row.path, unit: row.unit, from: axis.from, to: axis.to, count: axis.count }
        };
        let mut notes = vec!["scene is one of the region; x and y replace its two fields".to_owned()];
        if self.cells.iter().any(|cell| cell.value.is_none()) {
            let beside = match map.quantity {
                MapQuantity::Survival | MapQuantity::MaxTheta | MapQuantity::Caught => "",
                MapQuantity::RestTime => ", or the body does not come to rest in the time that is followed",
                MapQuantity::SpectralRadius => ", has no fixed point or has noise",
                MapQuantity::Residue => {
                    ", has no fixed point or has noise; and where the angle has no block of its own: of a point mass, with \
                     state feedback, and where friction holds the contact"
                }
            };
            notes.push(format!("a value is null where the scene cannot be{beside}"));
        }
        Region {
            scene: Resolved(scene),
            bounces: map.impacts,
            quantity: quantity_name(map.quantity),
            axes: [side(map.x), side(map.y)],
            tile: *tile,
            x: (0..map.x.count).map(|column| map.x.value(column)).collect(),
            y: self.request.rows().map(|row| map.y.value(row)).collect(),
            values: self.rows().map(|(_, cells)| RowValues { cells, whole: self.request.is_whole() }).collect(),
            outcomes: self.rows().map(|(_, cells)| Outcomes(cells, map.quantity)).collect(),
            outcome_names: outcome_names(map.quantity).to_vec(),
            limit_curves: self
                .limit_curves
                .iter()
                .map(|&(residue, a, b)| SegmentAnswer { residue, x: [a[0], b[0]], y: [a[1], b[1]] })
                .collect(),
            counts: self.counts(),
            notes,
        }
        .serialize(serializer)
    }
}
