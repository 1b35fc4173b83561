//! Samples of the flights between contacts, evenly in time, each flight from its start.

use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::Scene;

use crate::api::scene::has_angle;
use crate::api::shared::table::gather::{Gathered, Read};
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns::{DATES, date};

/// A point of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlightSample {
    impact: u64,
    time: Option<u64>,
    t: f64,
    x: f64,
    y: f64,
    theta: Option<f64>,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

/// The columns of samples: name, unit, and the way they are read. Dates are left out if the time of release is unknown.
const COLUMNS: [(&str, &str, Read<FlightSample>); 9] = [
    ("impact", "", Read::Count(|sample| sample.impact)),
    (DATES, "", Read::SparseCount(|sample| sample.time)),
    ("t", "s", Read::Number(|sample| sample.t)),
    ("x", "m", Read::Number(|sample| sample.x)),
    ("y", "m", Read::Number(|sample| sample.y)),
    ("theta", "rad", Read::Sparse(|sample| sample.theta)),
    ("x_dot", "m/s", Read::Number(|sample| sample.x_dot)),
    ("y_dot", "m/s", Read::Number(|sample| sample.y_dot)),
    ("theta_dot", "rad/s", Read::Sparse(|sample| sample.theta_dot)),
];

/// The columns of an answer.
pub(crate) fn columns(dated: bool) -> impl Iterator<Item = (&'static str, &'static str, Read<FlightSample>)> {
    COLUMNS.into_iter().filter(move |(name, ..)| dated || *name != DATES)
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
pub(crate) struct Flights {
    epoch: Option<u64>,
    body: Body,
    has_angle: bool,
    per_flight: u64,
    columns: Vec<(&'static str, &'static str, Gathered<FlightSample>)>,
}

impl Flights {
    /// No samples yet. With an `epoch`, unix ms, they have dates.
    pub(crate) fn new(scene: &Scene, per_flight: u64, epoch: Option<u64>) -> Self {
        let columns = columns(epoch.is_some()).map(|(name, unit, read)| (name, unit, Gathered::with_capacity(read, 0)));
        let columns = columns.collect();
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
                time: self.epoch.map(|epoch| date(epoch, t + since)),
                t: t + since,
                x: x + way,
                y: y + rise,
                theta: angle(end.theta),
                x_dot: end.x_dot,
                y_dot: end.y_dot,
                theta_dot: angle(end.theta_dot),
            };
            for (_, _, gathered) in &mut self.columns {
                gathered.push(&sample);
            }
        }
    }

    /// All of them.
    pub(crate) fn into_table(self) -> Table {
        let column = |(name, unit, gathered): (_, _, Gathered<FlightSample>)| Column {
            name,
            unit,
            cells: gathered.into_cells(),
        };
        Table(self.columns.into_iter().map(column).collect())
    }
}
