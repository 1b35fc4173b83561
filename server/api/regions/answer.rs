//! The request and the answer of `regions`: two fields of a scene, and what becomes of each pair of their values.

use std::ops::Range;

use equipoise_physics::batch::batch_run::Outcome;
use equipoise_physics::scene::{Kind, Scene, field};
use equipoise_physics::stability::fixed_point::JUDGED;
use equipoise_physics::surveys::stability_map;
use equipoise_physics::surveys::stability_map::{Axis, Cell, Quantity, Region};
use serde::{Serialize, Serializer};

use crate::api::scene::{Resolved, build_scene, read_draft};
use crate::api::shared::tile::Tile;
use crate::charts::{HeatAxis, HeatMap, heat_map};
use crate::http::problem::shortened;
use crate::http::{Errors, Reader};
use crate::limits;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// The region.
    pub region: Region,
    /// A scene of it that can be, to show.
    pub scene: Scene,
    /// Which rows, a band of whole ones.
    pub tile: Tile,
}

/// The name that a cell without a run has among the outcomes.
const NO_RUN: &str = "none";

impl Request {
    /// Reads a request.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let draft = read_draft(reader);
        let axes = [read_axis(reader, "x"), read_axis(reader, "y")];
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(1000);
        let quantities = [
            ("survival", Quantity::Survival),
            ("max_theta", Quantity::MaxTheta),
            ("residue", Quantity::Residue),
            ("spectral_radius", Quantity::SpectralRadius),
        ];
        let quantity = reader.choice("quantity", &quantities).unwrap_or(Quantity::Survival);
        let tile = Tile::read(reader, limits::REGION_SIDE);
        let ([Some(x), Some(y)], Some(draft), Some(tile)) = (axes, draft, tile) else { return None };
        if x.name == y.name {
            reader.refuse("y", format!("y has the parameter of x, {}; a region needs two", x.name.row().path));
            return None;
        }
        if tile.of > y.count as u64 {
            reader.refuse("tile", format!("tile has {} bands, but y has only {} rows", tile.of, y.count));
            return None;
        }
        let region = Region { scene: draft, x, y, impacts, quantity };
        let corners = [(0, 0), (x.count - 1, 0), (0, y.count - 1), (x.count - 1, y.count - 1)];
        let middle = (x.count / 2, y.count / 2);
        let possible = corners.into_iter().chain([middle]).find_map(|(column, row)| region.scene(column, row));
        let Some(scene) = possible else {
            let mut draft = draft;
            let mut errors = Errors::default();
            for axis in [x, y] {
                // Within its range, so it is admitted.
                let _ = draft.set(axis.name, Some(equipoise_physics::scene::Value::Number(axis.from)));
            }
            build_scene(draft, &reader.pointer_to("scene"), &mut errors);
            let problem = errors.into_result().err();
            for error in problem.iter().flat_map(|problem| problem.errors()) {
                reader
                    .errors()
                    .push(error.pointer.clone(), format!("{} (so at all corners of the region)", error.detail));
            }
            return None;
        };
        let linear = matches!(region.quantity, Quantity::Residue | Quantity::SpectralRadius);
        if let Some(error) = scene.beyond(&JUDGED).filter(|_| linear) {
            let pointer = reader.pointer_to("scene");
            reader.errors().push(format!("{pointer}/{}", error.path.replace('.', "/")), error.detail);
            return None;
        }
        Some(Self { region, scene, tile })
    }

    /// The rows of the tile.
    pub fn rows(&self) -> Range<usize> {
        let rows = self.tile.share(self.region.y.count as u64);
        rows.start as usize..rows.end as usize
    }

    /// How many cells the tile has.
    pub fn cells(&self) -> u64 {
        (self.rows().len() * self.region.x.count) as u64
    }

    /// The numbers of its cells, which are counted over the whole region, row after row.
    pub fn numbers(&self) -> Range<usize> {
        let (rows, columns) = (self.rows(), self.region.x.count);
        rows.start * columns..rows.end * columns
    }

    /// How many cells make a block, a matter of the request alone.
    pub fn block_cells(&self) -> usize {
        let cells = limits::REGION_BLOCK_WORK / self.cell_price().max(1);
        let (least, most) = limits::REGION_BLOCK_CELLS.into_inner();
        cells.clamp(least, most) as usize
    }

    /// How many bounces the runs of some of its cells took, as far as their values say it.
    pub fn bounces_of(&self, cells: &[Cell]) -> u64 {
        cells.iter().filter_map(|cell| cell.value.filter(|_| self.is_whole())).map(|value| value as u64).sum()
    }

    /// Whether values are whole numbers.
    pub(crate) fn is_whole(&self) -> bool {
        self.region.quantity == Quantity::Survival
    }

    /// Price, in bounces of lanes.
    pub fn price(&self) -> u64 {
        // Scenes of the boundary: the nodes of its grid, and some 80 for each of its crossings.
        let [columns, rows] =
            [self.region.x, self.region.y].map(|axis| axis.count.clamp(2, limits::REGION_BOUNDARY_NODES) as u64);
        let scenes = columns * rows + 80 * (columns + rows);
        let boundary = scenes * (limits::REGION_LINEAR_CELL_PRICE + self.polygon_price());
        self.cells().saturating_mul(self.cell_price()).saturating_add(boundary + limits::REGION_ANSWER_PRICE)
    }

    /// Price of making a scene beyond that of a rod: of a polygon each side is held against each other.
    fn polygon_price(&self) -> u64 {
        let vertices = self.region.scene.vertices().map_or(0, |vertices| vertices.places().len() as u64);
        vertices * vertices * 3 / 2
    }

    /// Price of one of its cells at most.
    fn cell_price(&self) -> u64 {
        let (once, bounce) = match self.region.quantity {
            Quantity::Residue | Quantity::SpectralRadius => (limits::REGION_LINEAR_CELL_PRICE, 0),
            Quantity::Survival | Quantity::MaxTheta if self.region.fits_lanes() => (limits::REGION_CELL_PRICE, 1),
            Quantity::Survival | Quantity::MaxTheta => (limits::REGION_ALONE_CELL_PRICE, limits::REGION_ALONE_PRICE),
        };
        once + self.polygon_price() + bounce * self.region.impacts
    }
}

fn read_axis(reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Axis> {
    if !reader.has(name) {
        reader.refuse(
            name,
            format!("{name} is missing: {{parameter, from, to, count}}, a field of the scene and its values"),
        );
        return None;
    }
    reader.within(name, |axis| {
        axis.require(&["parameter", "from", "to", "count"]);
        let path = axis.text("parameter");
        let row = path.and_then(field);
        let range = match row.map(|row| row.kind) {
            Some(Kind::Number { minimum, maximum }) => Some(minimum..=maximum),
            _ => None,
        };
        if let (Some(path), None) = (path, &range) {
            axis.refuse("parameter", format!("parameter is {:?}; it must be a field of a scene whose values are numbers, such as table.tilt_gain", shortened(path)));
        }
        // Without a range the ends are read all the same, so that they count as known.
        let ends = range.clone().unwrap_or(f64::MIN..=f64::MAX);
        let unit = row.map_or("", |row| row.unit);
        let (from, to) = (axis.number("from", ends.clone(), unit), axis.number("to", ends, unit));
        let count = axis.integer("count", 1..=limits::REGION_SIDE);
        range?;
        Some(Axis { name: row?.name, from: from?, to: to?, count: usize::try_from(count?).ok()? })
    })?
}

/// The answer: the cells of a tile.
#[derive(Debug)]
pub struct Answer {
    request: Request,
    cells: Vec<Cell>,
    boundary: Vec<stability_map::Segment>,
}

impl Answer {
    /// From the cells of the tile's rows, one row after the other; none once `go_on` said no while the boundary was looked for.
    pub fn new(request: Request, cells: Vec<Cell>, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        let boundary = request.region.boundary(limits::REGION_BOUNDARY_NODES, &mut go_on)?;
        Some(Self { request, cells, boundary })
    }

    /// The tile as a heat map with the linear boundary over it, as SVG.
    pub fn to_picture(&self) -> String {
        let Request { region, tile, .. } = &self.request;
        let rows = self.request.rows();
        let side = |axis: &Axis, first: usize, count: usize| {
            let row = axis.name.row();
            HeatAxis {
                name: row.title,
                symbol: row.symbol,
                unit: row.unit,
                from: axis.value(first),
                to: axis.value(first + count.max(1) - 1),
                count,
            }
        };
        let (quantity, unit) = match region.quantity {
            Quantity::Survival => ("contacts survived", "1"),
            Quantity::MaxTheta => ("largest |θ|", "rad"),
            Quantity::Residue => ("residue R", "1"),
            Quantity::SpectralRadius => ("spectral radius", "1"),
        };
        let values: Vec<Option<f64>> = self.cells.iter().map(|cell| cell.value).collect();
        let outcomes: Vec<u8> = self.cells.iter().map(|cell| code(cell) as u8).collect();
        let finite = || values.iter().flatten().copied().filter(|value| value.is_finite());
        let scale = match region.quantity {
            Quantity::Survival => (0.0, region.impacts as f64),
            _ => (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)),
        };
        let part = if tile.of > 1 { format!(", tile {} of {}", tile.index + 1, tile.of) } else { String::new() };
        heat_map(&HeatMap {
            title: &format!("{} over {} and {}", quantity, region.x.name.row().title, region.y.name.row().title),
            subtitle: &format!("runs of up to {} contacts{part}", region.impacts),
            x: side(&region.x, 0, region.x.count),
            y: side(&region.y, rows.start, rows.len()),
            values: &values,
            outcomes: &outcomes,
            scale,
            quantity,
            unit,
            boundary: &self.boundary,
        })
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &[Cell])> {
        self.request.rows().zip(self.cells.chunks(self.request.region.x.count))
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

/// The number of a cell's outcome; one more than there are where there was no run.
fn code(cell: &Cell) -> usize {
    cell.outcome.map_or(Outcome::ALL.len(), |outcome| outcome as usize)
}

pub(crate) fn outcome_name(cell: &Cell) -> &'static str {
    cell.outcome.map_or(NO_RUN, Outcome::name)
}

pub(crate) fn quantity_name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Survival => "survival",
        Quantity::MaxTheta => "max_theta",
        Quantity::Residue => "residue",
        Quantity::SpectralRadius => "spectral_radius",
    }
}

/// A row of values; contacts are counted, and written as whole numbers.
pub(crate) struct Values<'a> {
    pub(crate) cells: &'a [Cell],
    pub(crate) whole: bool,
}

impl Serialize for Values<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.cells.iter().map(|cell| cell.value);
        if self.whole {
            serializer.collect_seq(values.map(|value| value.map(|value| value as u64)))
        } else {
            serializer.collect_seq(values)
        }
    }
}

pub(crate) struct Outcomes<'a>(pub(crate) &'a [Cell]);

impl Serialize for Outcomes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(code))
    }
}

/// How many cells there are of each outcome.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Counts {
    #[serde(serialize_with = "by_name")]
    counts: [u64; Outcome::ALL.len() + 1],
}

impl Counts {
    pub(crate) fn add(&mut self, cells: &[Cell]) {
        for cell in cells {
            self.counts[code(cell)] += 1;
        }
    }
}

fn by_name<S: Serializer>(counts: &[u64; Outcome::ALL.len() + 1], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(outcome_names().zip(counts))
}

fn outcome_names() -> impl Iterator<Item = &'static str> {
    Outcome::ALL.into_iter().map(Outcome::name).chain([NO_RUN])
}

/// A line of the linear boundary.
#[derive(Debug, Serialize)]
struct Segment {
    residue: f64,
    x: [f64; 2],
    y: [f64; 2],
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Side {
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
            axes: [Side; 2],
            tile: Tile,
            x: Vec<f64>,
            y: Vec<f64>,
            values: Vec<Values<'a>>,
            outcomes: Vec<Outcomes<'a>>,
            outcome_names: Vec<&'static str>,
            boundary: Vec<Segment>,
            #[serde(flatten)]
            counts: Counts,
            notes: Vec<String>,
        }
        let Request { region, scene, tile } = &self.request;
        let side = |axis: Axis| {
            let row = axis.name.row();
            Side { parameter: row.path, unit: row.unit, from: axis.from, to: axis.to, count: axis.count }
        };
        let mut notes = vec!["scene is one of the region; x and y replace its two fields".to_owned()];
        if self.cells.iter().any(|cell| cell.value.is_none()) {
            let beside = match region.quantity {
                Quantity::Survival | Quantity::MaxTheta => "",
                Quantity::SpectralRadius => ", has no fixed point or has noise",
                Quantity::Residue => {
                    ", has no fixed point or has noise; and where the angle has no block of its own: of a point mass, with \
                     state feedback, and where friction holds the contact"
                }
            };
            notes.push(format!("a value is null where the scene cannot be{beside}"));
        }
        Json {
            scene: Resolved(scene),
            impacts: region.impacts,
            quantity: quantity_name(region.quantity),
            axes: [side(region.x), side(region.y)],
            tile: *tile,
            x: (0..region.x.count).map(|column| region.x.value(column)).collect(),
            y: self.request.rows().map(|row| region.y.value(row)).collect(),
            values: self.rows().map(|(_, cells)| Values { cells, whole: self.request.is_whole() }).collect(),
            outcomes: self.rows().map(|(_, cells)| Outcomes(cells)).collect(),
            outcome_names: outcome_names().collect(),
            boundary: self
                .boundary
                .iter()
                .map(|&(residue, a, b)| Segment { residue, x: [a[0], b[0]], y: [a[1], b[1]] })
                .collect(),
            counts: self.counts(),
            notes,
        }
        .serialize(serializer)
    }
}
