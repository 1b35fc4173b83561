//! The request for `regions`: two fields of a scene, their values, and the quantity that is mapped.

use std::ops::Range;

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::scene::{Draft, FieldKind, Name, Scene, field};
use equipoise_physics::surveys::stability_map::{MapAxis, MapCell, MapQuantity, StabilityMap};
use serde_json::json;

use crate::api::computed::catches::request::{canonical_settings, whole_catch_price};
use crate::api::prelude::*;
use crate::api::scene::{build_scene, complete_law};
use crate::api::shared::request_parts::{Tile, TileOf};
use crate::api::shared::write;
use crate::http::Errors;
use crate::http::problem::shortened;

/// A request for a stability map.
#[derive(Debug, Clone, Copy)]
pub struct RegionRequest {
    /// The map.
    pub map: StabilityMap,
    /// A valid scene of the map, which is shown in the answer.
    pub scene: Scene,
    /// The tile: a band of whole rows.
    pub tile: Tile,
}

request_fields! {
    /// The fields of a request.
    pub(super) struct RegionFields {
        /// The scene. With a quantity of catches it needs no law.
        scene: Draft = SceneSpec,
        /// The field that varies along a row, and its values.
        x: MapAxis = AxisSpec,
        /// The field that varies from row to row, and its values.
        y: MapAxis = AxisSpec,
        /// Largest number of contacts of each run.
        bounces: u64 = whole(1..=limits::BOUNCES).or(1000),
        /// Quantity that a cell shows: contacts survived; the largest |θ| at a contact, rad; Greene's residue; the spectral radius; of catches, 1 if
        /// the body is caught and 0 if it is not; or the time from which it rests, s.
        quantity: MapQuantity = choice(&QUANTITIES).or(MapQuantity::Survival),
        /// Settings of the catches. Needs `quantity` caught or rest_time.
        catch: Option<CatchSettings> = CatchOfCells,
        /// A band of whole rows.
        tile: Tile = TileOf(limits::REGION_SIDE),
    }
}

/// Quantities by their names in requests and answers.
const QUANTITIES: [(&str, MapQuantity); 6] = [
    ("survival", MapQuantity::Survival),
    ("max_theta", MapQuantity::MaxTheta),
    ("residue", MapQuantity::Residue),
    ("spectral_radius", MapQuantity::SpectralRadius),
    ("caught", MapQuantity::Caught),
    ("rest_time", MapQuantity::RestTime),
];

words! {
    /// Quantity that a cell shows.
    pub(super) RegionQuantity = QUANTITIES.map(|(name, _)| name);
}

impl Fields for RegionRequest {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let RegionFields { scene: mut draft, x, y, bounces, quantity, catch, tile } = Fields::read_fields(reader)?;
        if catch.is_some() && !quantity.is_of_catches() {
            let name = quantity_name(quantity);
            reader.refuse(
                "catch",
                format!(
                    "catch is for the quantities caught and rest_time, and quantity is {name}; leave one of them out"
                ),
            );
        }
        if quantity.is_of_catches() {
            // The table of a catch follows no law of the scene.
            complete_law(&mut draft);
        }
        if x.name == y.name {
            reader.refuse("y", format!("y has the field of x, {}; a region needs two", x.name.row().path));
            return None;
        }
        if tile.of > y.count as u64 {
            reader.refuse("tile", format!("tile has {} bands, but y has only {} rows", tile.of, y.count));
            return None;
        }
        let map = StabilityMap { scene: draft, x, y, impacts: bounces, quantity, catch: catch.unwrap_or_default() };
        let Some(scene) = some_scenes(&map).next() else {
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
        let analysis = match quantity {
            MapQuantity::Residue | MapQuantity::SpectralRadius => Some(Analysis::LinearMap),
            MapQuantity::Caught | MapQuantity::RestTime => Some(Analysis::Catch),
            MapQuantity::Survival | MapQuantity::MaxTheta => None,
        };
        if let Some(detail) = analysis.and_then(|analysis| lacking(&scene, analysis)) {
            reader.refuse("quantity", detail);
            return None;
        }
        Some(Self { map, scene, tile })
    }

    fn describe_fields(list: &mut FieldList) {
        RegionFields::describe_fields(list);
    }
}

impl ResourceRequest for RegionRequest {
    /// Price, in bounces of lanes.
    fn work(&self) -> u64 {
        // Scenes of the boundary: the nodes of its grid, and some 80 for each of its crossings.
        let [columns, rows] =
            [self.map.x, self.map.y].map(|axis| axis.count.clamp(2, limits::REGION_BOUNDARY_NODES) as u64);
        let has_boundary = u64::from(!self.map.quantity.is_of_catches());
        let scenes = has_boundary * (columns * rows + 80 * (columns + rows));
        let boundary = scenes * (limits::REGION_LINEAR_CELL_PRICE + self.polygon_price());
        self.cells().saturating_mul(self.cell_price()).saturating_add(boundary + limits::REGION_ANSWER_PRICE)
    }

    fn answer_numbers(&self) -> u64 {
        self.cells().saturating_mul(2)
    }

    fn bytes(&self) -> u64 {
        self.cells().saturating_mul(limits::REGION_CELL_BYTES)
    }

    fn limit(limits: &Limits) -> Limit {
        limits.of_region_work()
    }
}

impl RegionRequest {
    /// Canonical form.
    pub(super) fn canonical(&self) -> Vec<u8> {
        let StabilityMap { x, y, impacts, quantity, catch, .. } = self.map;
        let sides = [x, y].map(|axis| (axis.name.row().path, axis.from, axis.to, axis.count));
        let catch = quantity.is_of_catches().then(|| canonical_settings(&catch));
        write::canonical(&self.scene, &(sides, impacts, quantity as u8, self.tile, catch))
    }
}

impl RegionRequest {
    /// The rows of the tile.
    pub fn rows(&self) -> Range<usize> {
        let rows = self.tile.share(self.map.y.count as u64);
        rows.start as usize..rows.end as usize
    }

    /// Number of cells of the tile.
    pub fn cells(&self) -> u64 {
        (self.rows().len() * self.map.x.count) as u64
    }

    /// Numbers of the tile's cells, counted over the whole map, row after row.
    pub fn numbers(&self) -> Range<usize> {
        let (rows, columns) = (self.rows(), self.map.x.count);
        rows.start * columns..rows.end * columns
    }

    /// Number of cells in a block, which depends on the request alone.
    pub fn block_cells(&self) -> usize {
        let cells = limits::REGION_BLOCK_WORK / self.cell_price().max(1);
        let (least, most) = limits::REGION_BLOCK_CELLS.into_inner();
        cells.clamp(least, most) as usize
    }

    /// Number of bounces that the runs of some cells took, as far as their values tell it.
    pub fn bounces_of(&self, cells: &[MapCell]) -> u64 {
        let runs = self.map.quantity == MapQuantity::Survival;
        cells.iter().filter_map(|cell| cell.value.filter(|_| runs)).map(|value| value as u64).sum()
    }

    /// Tells whether values are whole numbers.
    pub(crate) fn is_whole(&self) -> bool {
        matches!(self.map.quantity, MapQuantity::Survival | MapQuantity::Caught)
    }

    /// Price of making a scene beyond that of a rod: each side of a polygon is compared with each other side.
    fn polygon_price(&self) -> u64 {
        let vertices = self.map.scene.vertices().map_or(0, |vertices| vertices.places().len() as u64);
        vertices * vertices * 3 / 2
    }

    /// Highest price of one cell; of a catch, the mean of some cells.
    fn cell_price(&self) -> u64 {
        let (once, bounce) = match self.map.quantity {
            MapQuantity::Caught | MapQuantity::RestTime => {
                // The lasting contact takes the longest where gravity is high and the body small, at a corner.
                let prices = some_scenes(&self.map).map(|scene| whole_catch_price(&scene, &self.map.catch));
                let (count, sum) =
                    prices.fold((0, 0_u64), |(count, sum), price| (count + 1, sum.saturating_add(price)));
                let catch = sum / count.max(1);
                (limits::REGION_PLAIN_PRICE.saturating_mul(catch).saturating_add(limits::REGION_CELL_PRICE), 0)
            }
            MapQuantity::Residue | MapQuantity::SpectralRadius => (limits::REGION_LINEAR_CELL_PRICE, 0),
            MapQuantity::Survival | MapQuantity::MaxTheta if self.map.fits_lanes() => {
                let has_program = self.map.scene.get(Name::Program).is_some();
                let bounce = if self.map.errs() {
                    limits::REGION_NOISE_PRICE
                } else if has_program {
                    limits::REGION_PROGRAM_PRICE
                } else {
                    1
                };
                (limits::REGION_CELL_PRICE, bounce)
            }
            MapQuantity::Survival | MapQuantity::MaxTheta => {
                (limits::REGION_ALONE_CELL_PRICE, limits::REGION_ALONE_PRICE)
            }
        };
        once.saturating_add(self.polygon_price() + bounce * self.map.impacts)
    }
}

/// The scenes at the corners of a map and in its middle, those that can be.
fn some_scenes(map: &StabilityMap) -> impl Iterator<Item = Scene> {
    let (x, y) = (map.x.count, map.y.count);
    let places = [(0, 0), (x - 1, 0), (0, y - 1), (x - 1, y - 1), (x / 2, y / 2)];
    places.into_iter().filter_map(|(column, row)| map.scene(column, row))
}

/// Name of a quantity in requests and answers.
pub(crate) fn quantity_name(quantity: MapQuantity) -> &'static str {
    QUANTITIES.iter().find(|(_, known)| *known == quantity).map_or("", |(name, _)| name)
}

/// Settings of a catch, with which not every request goes: there are no examples.
#[derive(Debug, Clone, Copy)]
struct CatchOfCells;

impl FieldSpec<Option<CatchSettings>> for CatchOfCells {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Option<CatchSettings>> {
        Object.optional().read(reader, name)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let first = list.parameters.len();
        FieldSpec::<Option<CatchSettings>>::describe(&Object.optional(), name, about, list);
        list.parameters[first..].iter_mut().for_each(|parameter| parameter.example = None);
    }
}

/// A field of a scene and its values along a side of the map.
#[derive(Debug, Clone, Copy)]
struct AxisSpec;

impl FieldSpec<MapAxis> for AxisSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<MapAxis> {
        if !reader.has(name) {
            reader.refuse(
                name,
                format!("{name} is missing: {{field, from, to, count}}, a field of the scene and its values"),
            );
            return None;
        }
        reader.within(name, |axis| {
            axis.require(&["field", "from", "to", "count"]);
            let path = axis.text("field");
            let row = path.and_then(field);
            let range = match row.map(|row| row.kind) {
                Some(FieldKind::Number { minimum, maximum }) => Some(minimum..=maximum),
                _ => None,
            };
            if let (Some(path), None) = (path, &range) {
                axis.refuse("field", format!("field is {:?}; it must be a field of a scene whose values are numbers, such as table.tilt_gain", shortened(path)));
            }
            // Without a range the ends are read all the same, so that they count as known.
            let ends = range.clone().unwrap_or(f64::MIN..=f64::MAX);
            let unit = row.map_or("", |row| row.unit);
            let (from, to) = (axis.number("from", ends.clone(), unit), axis.number("to", ends, unit));
            let count = axis.integer("count", 1..=limits::REGION_SIDE);
            range?;
            Some(MapAxis { name: row?.name, from: from?, to: to?, count: usize::try_from(count?).ok()? })
        })?
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, |axis| {
            let number = json!({"type": "number"});
            axis.leaf("field", "Dotted path of a numeric field.", json!({"type": "string"}), None);
            axis.leaf("from", "First value, in the unit of the field.", number.clone(), None);
            axis.leaf("to", "Last value, in the unit of the field.", number, None);
            axis.leaf(
                "count",
                "Number of values, evenly spaced.",
                json!({"type": "integer", "minimum": 1, "maximum": limits::REGION_SIDE}),
                None,
            );
            ["field", "from", "to", "count"].into_iter().for_each(|name| axis.require(name));
        });
        list.property(name, about, &schema);
        list.require(name);
    }
}
