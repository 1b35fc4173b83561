//! A map over two fields: how long each cell's run survives, what the linear analysis says, or if a catch succeeds.

use crate::analysis::linear_verdict::LinearVerdict;
use crate::analysis::small_deviations::small_deviations;
use crate::catching::catch_outcome;
use crate::catching::outcome::{CatchFailure, CatchOutcomeKind};
use crate::catching::settings::CatchSettings;
use crate::run::ending::EndingKind;
use crate::run::lanes::batch_run::{LaneRunEnd, Watch};
use crate::run::lanes::model::BatchModel;
use crate::scene::capability::Analysis;
use crate::scene::{Draft, Name, Scene, Value};
use crate::surveys::run_each;
use std::ops::Range;

/// One side of a region: a field and the values it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapAxis {
    /// A field with numbers as values.
    pub name: Name,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Number of values.
    pub count: usize,
}

impl MapAxis {
    /// Value number `index`, evenly spaced from `from` to `to`, both exact.
    pub fn value(&self, index: usize) -> f64 {
        self.at(index as f64 / (self.count.max(2) - 1) as f64)
    }

    fn at(&self, share: f64) -> f64 {
        if share == 1.0 { self.to } else { self.from + (self.to - self.from) * share }
    }
}

/// Quantity that a cell shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuantity {
    /// Contacts survived.
    Survival,
    /// Largest |θ| at a contact, rad.
    MaxTheta,
    /// Greene's residue at the fixed point.
    Residue,
    /// Largest modulus of an eigenvalue at the fixed point.
    SpectralRadius,
    /// 1 if the body is caught, 0 if it is not.
    Caught,
    /// Time from which a caught body rests, s.
    RestTime,
}

impl MapQuantity {
    /// True if cells are catches: their outcomes are those of catches.
    pub fn is_of_catches(self) -> bool {
        matches!(self, Self::Caught | Self::RestTime)
    }
}

/// Outcome of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapOutcome {
    /// Ending of a run.
    Run(EndingKind),
    /// Outcome of a catch.
    Catch(CatchOutcomeKind),
}

impl MapOutcome {
    /// Place among the outcomes of its kind.
    pub fn code(self) -> usize {
        match self {
            Self::Run(ending) => ending as usize,
            Self::Catch(outcome) => outcome as usize,
        }
    }

    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run(ending) => ending.name(),
            Self::Catch(outcome) => outcome.name(),
        }
    }
}

/// A region: a scene, two of its fields, and the number of contacts that each run is watched for.
#[derive(Clone, Copy, Debug)]
pub struct StabilityMap {
    /// The scene without the two fields.
    pub scene: Draft,
    /// The field that grows along a row.
    pub x: MapAxis,
    /// The field that grows from row to row.
    pub y: MapAxis,
    /// Number of contacts that each run is watched for.
    pub impacts: u64,
    /// Quantity of the cells.
    pub quantity: MapQuantity,
    /// Settings of the catches, of a quantity of catches.
    pub catch: CatchSettings,
}

/// A cell of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapCell {
    /// Value of the quantity; `None` for an impossible scene and for one without a fixed point.
    pub value: Option<f64>,
    /// Outcome of the run or catch; `None` without one.
    pub outcome: Option<MapOutcome>,
}

/// A segment of the linear boundary: its residue, and its two ends (x, y).
pub type BoundarySegment = (f64, [f64; 2], [f64; 2]);

const NOTHING: MapCell = MapCell { value: None, outcome: None };

impl StabilityMap {
    /// The scene of a cell; `None` for an invalid one, such as a release below the table or a missing target height.
    pub fn scene(&self, column: usize, row: usize) -> Option<Scene> {
        self.scene_at(self.x.value(column), self.y.value(row))
    }

    fn scene_at(&self, x: f64, y: f64) -> Option<Scene> {
        let mut draft = self.scene;
        draft.set(self.x.name, Some(Value::Number(x))).ok()?;
        draft.set(self.y.name, Some(Value::Number(y))).ok()?;
        draft.build().ok()
    }

    /// Tells whether all runs fit in lanes, judged by the corners of the map. Runs outside lanes take many times as long.
    pub fn fits_lanes(&self) -> bool {
        self.corners().all(|scene| BatchModel::of(&scene.running_model(), &scene.rules()).is_some())
    }

    /// Tells whether the table errs in any run, judged by the corners of the map. In lanes such runs take some three times as long.
    pub fn errs(&self) -> bool {
        self.corners().any(|scene| scene.has_noise())
    }

    fn corners(&self) -> impl Iterator<Item = Scene> {
        let corners = [(0, 0), (self.x.count - 1, 0), (0, self.y.count - 1), (self.x.count - 1, self.y.count - 1)];
        corners.into_iter().filter_map(|(column, row)| self.scene(column, row))
    }

    /// Computes the cells with these numbers, counted row after row. `None` once `go_on` returns `false`; it is called every
    /// hundred contacts, in lanes every few thousand, and at every strike of a catch.
    pub fn cells(&self, numbers: Range<usize>, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<MapCell>> {
        let first = numbers.start;
        let scene = |index: usize| self.scene((first + index) % self.x.count, (first + index) / self.x.count);
        match self.quantity {
            MapQuantity::Residue | MapQuantity::SpectralRadius => {
                let value = |index| scene(index).and_then(|scene| self.linear(&scene));
                let cell = |index| go_on().then(|| MapCell { value: value(index), ..NOTHING });
                (0..numbers.len()).map(cell).collect()
            }
            MapQuantity::Caught | MapQuantity::RestTime => {
                let cell = |index| scene(index).map_or(Some(NOTHING), |scene| self.catch_in(&scene, go_on));
                (0..numbers.len()).map(cell).collect()
            }
            MapQuantity::Survival | MapQuantity::MaxTheta => {
                let mut watch = Watch { contacts: &[], see: &mut |_, _| () };
                let orbit = |index| scene(index).map(|scene| scene.orbit());
                let ends = run_each(self.impacts, numbers.len(), &mut watch, orbit, go_on)?;
                Some(ends.into_iter().map(|end| end.map_or(NOTHING, |end| self.cell(&end))).collect())
            }
        }
    }

    fn cell(&self, end: &LaneRunEnd) -> MapCell {
        let value = if self.quantity == MapQuantity::MaxTheta { end.max_theta } else { end.impacts as f64 };
        MapCell { value: Some(value), outcome: Some(MapOutcome::Run(end.outcome)) }
    }

    /// The cell of a catch; `None` once cancelled. There is none of a point mass, and none if the weights give no law.
    fn catch_in(&self, scene: &Scene, go_on: &mut dyn FnMut() -> bool) -> Option<MapCell> {
        match catch_outcome(scene, &self.catch, go_on) {
            Ok((outcome, rest)) => {
                let caught = f64::from(u8::from(outcome.is_caught()));
                let value = if self.quantity == MapQuantity::Caught { Some(caught) } else { rest };
                Some(MapCell { value, outcome: Some(MapOutcome::Catch(outcome.kind())) })
            }
            Err(CatchFailure::Stopped) => None,
            Err(CatchFailure::Point | CatchFailure::NoLaw(_)) => Some(NOTHING),
        }
    }

    fn linear(&self, scene: &Scene) -> Option<f64> {
        let linear = linear(scene)?;
        if self.quantity == MapQuantity::Residue { linear.residue } else { Some(linear.spectral_radius()) }
    }

    /// The lines of residue 0 and 1, the ends of the linear verdict, as segments (residue, from, to) of points (x, y).
    ///
    /// Uses a grid of at most `nodes` × `nodes` over the whole region, and refines every crossing of an edge to 1e-12 of the
    /// region. `None` once `go_on` returns `false`; it is called every one or two hundred scenes.
    pub fn boundary(&self, nodes: usize, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<BoundarySegment>> {
        let residue = |[u, v]: [f64; 2]| linear(&self.scene_at(self.x.at(u), self.y.at(v))?)?.residue;
        let (columns, rows) = (self.x.count.clamp(2, nodes), self.y.count.clamp(2, nodes));
        let place =
            |(column, row): (usize, usize)| [column as f64 / (columns - 1) as f64, row as f64 / (rows - 1) as f64];
        let mut grid: Vec<Option<f64>> = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            if !go_on() {
                return None;
            }
            grid.extend((0..columns).map(|column| residue(place((column, row)))));
        }
        let mut segments = Vec::new();
        let squares = || (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (column, row)));
        for (level, (column, row)) in [0.0, 1.0].into_iter().flat_map(|level| squares().map(move |it| (level, it))) {
            if !go_on() {
                return None;
            }
            let corners = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
            let mut crossings = Vec::new();
            for edge in 0..4 {
                let ends = [corners[edge], corners[(edge + 1) % 4]];
                if let [Some(one), Some(other)] = ends.map(|(column, row)| grid[row * columns + column])
                    && (one < level) != (other < level)
                {
                    let [low, high] = ends.map(place);
                    let [u, v] = cross(low, high, |point| residue(point).map(|at| at - level));
                    crossings.push([self.x.at(u), self.y.at(v)]);
                }
            }
            segments.extend(crossings.chunks_exact(2).map(|pair| (level, pair[0], pair[1])));
        }
        Some(segments)
    }
}

/// The linear verdict on a scene without its noise.
fn linear(scene: &Scene) -> Option<LinearVerdict> {
    let scene = &scene.without_noise();
    if Analysis::LinearMap.lack(scene).is_some() {
        return None;
    }
    small_deviations(scene).ok().map(|small| small.linear)
}

/// Sign change of a function between two points, by bisection.
fn cross(mut low: [f64; 2], mut high: [f64; 2], function: impl Fn([f64; 2]) -> Option<f64>) -> [f64; 2] {
    let negative = |point| function(point).is_some_and(|value| value < 0.0);
    let side = negative(low);
    let middle = |low: [f64; 2], high: [f64; 2]| [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    for _ in 0..40 {
        let between = middle(low, high);
        if negative(between) == side { low = between } else { high = between }
    }
    middle(low, high)
}
