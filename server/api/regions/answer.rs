//! The answer of `regions`: a quantity and an outcome for each pair of values of two fields.

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::surveys::stability_map;
use equipoise_physics::surveys::stability_map::{MapAxis, MapCell, MapQuantity};
use serde::{Serialize, Serializer};

use crate::api::regions::request::RegionRequest;
use crate::api::scene::Resolved;
use crate::api::shared::tile::Tile;
use crate::limits;

/// Outcome of a cell without a run.
const NO_RUN: &str = "none";

/// Answer of `/v1/regions`: the cells of a tile.
#[derive(Debug)]
pub struct RegionAnswer {
    pub(super) request: RegionRequest,
    pub(super) cells: Vec<MapCell>,
    pub(super) boundary: Vec<stability_map::BoundarySegment>,
}

impl RegionAnswer {
    /// The answer for the cells of a tile, row by row. Computes the boundary; `None` if `go_on` returned false meanwhile.
    pub fn new(request: RegionRequest, cells: Vec<MapCell>, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        let boundary = request.map.boundary(limits::REGION_BOUNDARY_NODES, &mut go_on)?;
        Some(Self { request, cells, boundary })
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &[MapCell])> {
        self.request.rows().zip(self.cells.chunks(self.request.map.x.count))
    }

    fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        counts.add(&self.cells);
        counts
    }
}

pub(crate) fn written(value: f64) -> String {
    serde_json::to_string(&value).unwrap_or_default()
}

/// Number of a cell's outcome. The number after the last outcome stands for a cell without a run.
pub(super) fn code(cell: &MapCell) -> usize {
    cell.outcome.map_or(EndingKind::ALL.len(), |outcome| outcome as usize)
}

pub(crate) fn outcome_name(cell: &MapCell) -> &'static str {
    cell.outcome.map_or(NO_RUN, EndingKind::name)
}

pub(crate) fn quantity_name(quantity: MapQuantity) -> &'static str {
    match quantity {
        MapQuantity::Survival => "survival",
        MapQuantity::MaxTheta => "max_theta",
        MapQuantity::Residue => "residue",
        MapQuantity::SpectralRadius => "spectral_radius",
    }
}

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

pub(crate) struct Outcomes<'a>(pub(crate) &'a [MapCell]);

impl Serialize for Outcomes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(code))
    }
}

/// Number of cells of each outcome.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Counts {
    #[serde(serialize_with = "by_name")]
    counts: [u64; EndingKind::ALL.len() + 1],
}

impl Counts {
    pub(crate) fn add(&mut self, cells: &[MapCell]) {
        for cell in cells {
            self.counts[code(cell)] += 1;
        }
    }
}

fn by_name<S: Serializer>(counts: &[u64; EndingKind::ALL.len() + 1], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(outcome_names().zip(counts))
}

fn outcome_names() -> impl Iterator<Item = &'static str> {
    EndingKind::ALL.into_iter().map(EndingKind::name).chain([NO_RUN])
}

/// A segment of the linear boundary.
#[derive(Debug, Serialize)]
struct SegmentAnswer {
    residue: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Serialize for RegionAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct AxisAnswer {
            parameter: &'static str,
            unit: &'static str,
            from: f64,
            to: f64,
            count: usize,
        }
        #[derive(Serialize)]
        struct Json<'a> {
            scene: Resolved<'a>,
            impacts: u64,
            quantity: &'static str,
            axes: [AxisAnswer; 2],
            tile: Tile,
            x: Vec<f64>,
            y: Vec<f64>,
            values: Vec<RowValues<'a>>,
            outcomes: Vec<Outcomes<'a>>,
            outcome_names: Vec<&'static str>,
            boundary: Vec<SegmentAnswer>,
            #[serde(flatten)]
            counts: Counts,
            notes: Vec<String>,
        }
        let RegionRequest { map, scene, tile } = &self.request;
        let side = |axis: MapAxis| {
            let row = axis.name.row();
            AxisAnswer { parameter: row.path, unit: row.unit, from: axis.from, to: axis.to, count: axis.count }
        };
        let mut notes = vec!["scene is one of the region; x and y replace its two fields".to_owned()];
        if self.cells.iter().any(|cell| cell.value.is_none()) {
            let beside = match map.quantity {
                MapQuantity::Survival | MapQuantity::MaxTheta => "",
                MapQuantity::SpectralRadius => ", has no fixed point or has noise",
                MapQuantity::Residue => {
                    ", has no fixed point or has noise; and where the angle has no block of its own: of a point mass, with \
                     state feedback, and where friction holds the contact"
                }
            };
            notes.push(format!("a value is null where the scene cannot be{beside}"));
        }
        Json {
            scene: Resolved(scene),
            impacts: map.impacts,
            quantity: quantity_name(map.quantity),
            axes: [side(map.x), side(map.y)],
            tile: *tile,
            x: (0..map.x.count).map(|column| map.x.value(column)).collect(),
            y: self.request.rows().map(|row| map.y.value(row)).collect(),
            values: self.rows().map(|(_, cells)| RowValues { cells, whole: self.request.is_whole() }).collect(),
            outcomes: self.rows().map(|(_, cells)| Outcomes(cells)).collect(),
            outcome_names: outcome_names().collect(),
            boundary: self
                .boundary
                .iter()
                .map(|&(residue, a, b)| SegmentAnswer { residue, x: [a[0], b[0]], y: [a[1], b[1]] })
                .collect(),
            counts: self.counts(),
            notes,
        }
        .serialize(serializer)
    }
}
