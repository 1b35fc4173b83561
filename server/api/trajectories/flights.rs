//! Samples of the flights between contacts, evenly in time, each flight from its start.

use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;

use crate::api::scene::has_angle;
use crate::api::shared::table::columns::{ColumnWord, RowColumn};
use crate::api::shared::table::gather::{Gathered, Read};
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns::{DATES, date};
use crate::column_lists;

/// A point of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlightSample {
    impact: u64,
    time_ms: Option<u64>,
    t: f64,
    x: f64,
    y: f64,
    theta: Option<f64>,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

/// The columns of samples. Dates are left out if the time of release is unknown.
static COLUMNS: [RowColumn<FlightSample>; 9] = [
    RowColumn::new("impact", "", "Number of the impact before it.", Read::Count(|sample| sample.impact)),
    RowColumn::new(DATES, "", "Wall time since 1970 (UTC), ms.", Read::SparseCount(|sample| sample.time_ms)),
    RowColumn::new("t", "s", "Time since the release.", Read::Number(|sample| sample.t)),
    RowColumn::new("x", "m", "Horizontal position of the centre of gravity.", Read::Number(|sample| sample.x)),
    RowColumn::new("y", "m", "Height of the centre of gravity.", Read::Number(|sample| sample.y)),
    RowColumn::new("theta", "rad", "Angle. Null for a point mass.", Read::Sparse(|sample| sample.theta)),
    RowColumn::new("x_dot", "m/s", "", Read::Number(|sample| sample.x_dot)),
    RowColumn::new("y_dot", "m/s", "", Read::Number(|sample| sample.y_dot)),
    RowColumn::new("theta_dot", "rad/s", "Null for a point mass.", Read::Sparse(|sample| sample.theta_dot)),
];

/// The columns of an answer.
pub(crate) fn columns(dated: bool) -> impl Iterator<Item = &'static RowColumn<FlightSample>> {
    COLUMNS.iter().filter(move |column| dated || column.name != DATES)
}

column_lists! {
    /// Points along the flights: columns of one length. Impact 0 is the fall from the release.
    pub(crate) Flights = columns(true).map(RowColumn::word).map(|word| match word.name {
        DATES => ColumnWord { kind: (word.kind.0, false), ..word.only("with `epoch_ms`") },
        _ => word,
    });
}

/// A flight: its start and its length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampledFlight {
    /// Number of the contact before it; 0 for the fall from the release.
    pub(crate) impact: u64,
    /// Time of the start, s.
    pub(crate) t: f64,
    /// Place of the centre of gravity at the start, m.
    pub(crate) x: f64,
    /// Height of the centre of gravity at the start, m.
    pub(crate) y: f64,
    /// Angle and velocities at the start.
    pub(crate) start: State,
    /// Time to the next contact, s.
    pub(crate) length: f64,
}

/// Samples so far.
#[derive(Debug)]
pub(crate) struct FlightSamples {
    epoch: Option<u64>,
    body: Body,
    has_angle: bool,
    per_flight: u64,
    columns: Vec<(&'static RowColumn<FlightSample>, Gathered<FlightSample>)>,
}

impl FlightSamples {
    /// No samples yet. With an `epoch_ms`, unix ms, they have dates.
    pub(crate) fn new(scene: &Scene, per_flight: u64, epoch: Option<u64>) -> Self {
        let columns =
            columns(epoch.is_some()).map(|column| (column, Gathered::with_capacity(column.read, 0))).collect();
        Self { epoch, body: scene.running_model(), has_angle: has_angle(scene), per_flight, columns }
    }

    /// Adds the samples of a flight.
    pub(crate) fn push(&mut self, flight: &SampledFlight) {
        let SampledFlight { impact, t, x, y, start, length } = *flight;
        let flight = self.body.flight(start, 0.0);
        for number in 0..self.per_flight {
            let since = length * number as f64 / self.per_flight as f64;
            let angle = |value| self.has_angle.then_some(value);
            let (end, (way, rise)) = (flight.end(since), flight.travel(since));
            let sample = FlightSample {
                impact,
                time_ms: self.epoch.map(|epoch| date(epoch, t + since)),
                t: t + since,
                x: x + way,
                y: y + rise,
                theta: angle(end.theta),
                x_dot: end.x_dot,
                y_dot: end.y_dot,
                theta_dot: angle(end.theta_dot),
            };
            for (_, gathered) in &mut self.columns {
                gathered.push(&sample);
            }
        }
    }

    /// All of them.
    pub(crate) fn into_table(self) -> Table {
        let column = |(column, gathered): (&RowColumn<_>, Gathered<_>)| Column {
            name: column.name,
            unit: column.unit,
            cells: gathered.into_cells(),
        };
        Table(self.columns.into_iter().map(column).collect())
    }
}
