//! The contacts of a run and samples of its flights, gathered one by one into tables.
//!
//! Not here: how the run is computed, and how it ended ([`crate::api::trajectories::answer`]).

use equipoise_physics::body::Body;
use equipoise_physics::bounce::state::State;
use equipoise_physics::bounce::strike::Strike;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::extended;
use equipoise_physics::run::method::ComputedImpact;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::Model;

use crate::api::scene::has_angle;
use crate::api::shared::table::{Cells, Column, Table};

/// Dates, unix ms, of times since the release; none where nobody said when that was.
#[derive(Debug, Default)]
struct Dates(Option<(u64, Vec<u64>)>);

impl Dates {
    fn since(epoch: Option<u64>) -> Self {
        Self(epoch.map(|epoch| (epoch, Vec::new())))
    }

    fn push(&mut self, t: f64) {
        if let Some((epoch, dates)) = &mut self.0 {
            dates.push((*epoch as f64 + 1e3 * t).round() as u64);
        }
    }

    fn into_column(self) -> Option<Column> {
        self.0.map(|(_, dates)| Column { name: "time", unit: "", cells: Cells::Counts(dates) })
    }
}

/// The contacts of a run, gathered one by one.
#[derive(Debug)]
pub(crate) struct Contacts {
    body: Model,
    gravity: f64,
    has_angle: bool,
    n: Vec<u64>,
    dates: Dates,
    numbers: [Vec<f64>; 8],
    theta_dot: Vec<Option<f64>>,
    strikes: [Vec<Option<f64>>; 4],
    contact_mode: Vec<Option<&'static str>>,
    clearance: Vec<f64>,
    flight_time: Vec<Option<f64>>,
    error_estimate: Vec<Option<f64>>,
    /// Of the columns that are not counts, words or bounds, where the method has more digits than doubles.
    digits: Option<Digits>,
}

impl Contacts {
    /// None yet, with room for some. With an `epoch`, unix ms, they have their dates too.
    pub(crate) fn new(scene: &Scene, epoch: Option<u64>, expected: usize) -> Self {
        let room = expected.min(1 << 16);
        Self {
            body: scene.model(),
            gravity: scene.gravity(),
            has_angle: has_angle(scene),
            n: Vec::with_capacity(room),
            dates: Dates::since(epoch),
            numbers: std::array::from_fn(|_| Vec::with_capacity(room)),
            theta_dot: Vec::with_capacity(room),
            strikes: std::array::from_fn(|_| Vec::with_capacity(room)),
            contact_mode: Vec::with_capacity(room),
            clearance: Vec::with_capacity(room),
            flight_time: Vec::with_capacity(room),
            error_estimate: Vec::with_capacity(room),
            digits: None,
        }
    }

    /// Adds one.
    pub(crate) fn push(&mut self, impact: &ComputedImpact<'_>) {
        let contact = &impact.contact;
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        // + 0.0: a table at rest moves by 0, not by −0.
        let struck = |value: &dyn Fn(&Strike) -> f64| {
            contact.strike.map(|strike| value(&strike) + 0.0).filter(|value| value.is_finite())
        };
        let numbers = [
            contact.t,
            contact.x,
            theta,
            x_dot,
            y_dot,
            contact.alpha,
            self.body.energy(&contact.state) + self.gravity * contact.clearance,
            self.body.contact_speed(&contact.state),
        ];
        self.n.push(contact.n);
        self.dates.push(contact.t);
        for (column, value) in self.numbers.iter_mut().zip(numbers) {
            column.push(value);
        }
        self.theta_dot.push(self.has_angle.then_some(theta_dot));
        let values: [&dyn Fn(&Strike) -> f64; 4] = [
            &|strike| strike.table_velocity.0,
            &|strike| strike.table_velocity.1,
            &|strike| strike.impulse_normal,
            &|strike| strike.impulse_tangential,
        ];
        for (column, value) in self.strikes.iter_mut().zip(values) {
            column.push(struck(value));
        }
        self.contact_mode.push(contact.strike.map(|strike| strike.mode.name()));
        self.clearance.push(contact.clearance);
        self.flight_time.push(contact.flight_time);
        self.error_estimate.push(Some(impact.error_estimate).filter(|bound| bound.is_finite()));
        if let Some((orbit, contact)) = impact.extended {
            self.digits.get_or_insert_default().push(orbit, contact, self.has_angle);
        }
    }

    /// All of them, in the order of the contract.
    pub(crate) fn into_table(self) -> Table {
        let [t, x, theta, x_dot, y_dot, alpha, energy, contact_speed] = self.numbers.map(Cells::Numbers);
        let [table_x, table_y, normal, tangential] = self.strikes.map(Cells::Sparse);
        let columns = [
            ("n", "", Cells::Counts(self.n)),
            ("t", "s", t),
            ("x", "m", x),
            ("theta", "rad", theta),
            ("x_dot", "m_per_s", x_dot),
            ("y_dot", "m_per_s", y_dot),
            ("theta_dot", "rad_per_s", Cells::Sparse(self.theta_dot)),
            ("alpha", "rad", alpha),
            ("table_velocity_x", "m_per_s", table_x),
            ("table_velocity_y", "m_per_s", table_y),
            ("impulse_normal", "m_per_s", normal),
            ("impulse_tangential", "m_per_s", tangential),
            ("contact_mode", "", Cells::Words(self.contact_mode)),
            ("energy", "m2_per_s2", energy),
            ("flight_time", "s", Cells::Sparse(self.flight_time)),
            ("contact_speed", "m_per_s", contact_speed),
            ("clearance", "m", Cells::Numbers(self.clearance)),
            ("error_estimate", "m_per_s", Cells::Sparse(self.error_estimate)),
        ];
        let mut digits = self.digits;
        let column = |(name, unit, cells)| {
            let cells = digits.as_mut().and_then(|digits| digits.take(name)).map_or(cells, Cells::Decimals);
            Column { name, unit, cells }
        };
        let mut columns: Vec<Column> = columns.into_iter().map(column).collect();
        columns.splice(1..1, self.dates.into_column());
        Table(columns)
    }
}

/// Columns of decimals, by the names of the contract.
#[derive(Debug)]
struct Digits([(&'static str, Vec<Option<DoubleDouble>>); 13]);

impl Default for Digits {
    fn default() -> Self {
        let names = [
            "t",
            "x",
            "theta",
            "x_dot",
            "y_dot",
            "theta_dot",
            "alpha",
            "energy",
            "contact_speed",
            "flight_time",
            "table_velocity_x",
            "table_velocity_y",
            "impulse_normal",
        ];
        Self(names.map(|name| (name, Vec::new())))
    }
}

impl Digits {
    fn push(&mut self, orbit: &extended::ExtendedOrbit, contact: &extended::ExtendedContact, has_angle: bool) {
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        let strike = contact.strike;
        let values = [
            Some(contact.t),
            Some(contact.x),
            Some(theta),
            Some(x_dot),
            Some(y_dot),
            has_angle.then_some(theta_dot),
            Some(orbit.rod().tilt_gain * theta),
            Some(orbit.energy(&contact.state)),
            Some(orbit.contact_speed(&contact.state)),
            contact.flight_time,
            strike.map(|strike| strike.table_velocity.0),
            strike.map(|strike| strike.table_velocity.1),
            strike.map(|strike| strike.impulse_normal),
        ];
        for ((_, column), value) in self.0.iter_mut().zip(values) {
            column.push(value);
        }
    }

    fn take(&mut self, name: &str) -> Option<Vec<Option<DoubleDouble>>> {
        self.0.iter_mut().find(|(known, _)| *known == name).map(|(_, column)| std::mem::take(column))
    }
}

/// Samples of the flights between contacts, evenly in time, each flight from its start.
#[derive(Debug, Default)]
pub(crate) struct Flights {
    impact: Vec<u64>,
    dates: Dates,
    numbers: [Vec<f64>; 5],
    theta: Vec<Option<f64>>,
    theta_dot: Vec<Option<f64>>,
}

impl Flights {
    /// None yet; `epoch` as for contacts.
    pub(crate) fn new(epoch: Option<u64>) -> Self {
        Self { dates: Dates::since(epoch), ..Self::default() }
    }

    /// Adds `samples` of the flight that follows contact `impact` (0: the fall from the release) at time `t`, place `x`
    /// and height `y` of the centre of gravity.
    #[expect(clippy::too_many_arguments, reason = "a flight is that many numbers")]
    pub(crate) fn push(
        &mut self,
        scene: &Scene,
        impact: u64,
        t: f64,
        x: f64,
        y: f64,
        start: &State,
        length: f64,
        samples: u64,
    ) {
        let gravity = scene.gravity();
        for sample in 0..samples {
            let since = length * sample as f64 / samples as f64;
            let numbers = [
                t + since,
                x + start.x_dot * since,
                y + since * (start.y_dot - 0.5 * gravity * since),
                start.x_dot,
                start.y_dot - gravity * since,
            ];
            self.impact.push(impact);
            self.dates.push(t + since);
            for (column, value) in self.numbers.iter_mut().zip(numbers) {
                column.push(value);
            }
            let has_angle = has_angle(scene);
            self.theta.push(has_angle.then_some(start.theta + start.theta_dot * since));
            self.theta_dot.push(has_angle.then_some(start.theta_dot));
        }
    }

    /// All of them, in the order of the contract.
    pub(crate) fn into_table(self) -> Table {
        let [t, x, y, x_dot, y_dot] = self.numbers.map(Cells::Numbers);
        let columns = [
            ("impact", "", Cells::Counts(self.impact)),
            ("t", "s", t),
            ("x", "m", x),
            ("y", "m", y),
            ("theta", "rad", Cells::Sparse(self.theta)),
            ("x_dot", "m_per_s", x_dot),
            ("y_dot", "m_per_s", y_dot),
            ("theta_dot", "rad_per_s", Cells::Sparse(self.theta_dot)),
        ];
        let mut columns = columns.map(|(name, unit, cells)| Column { name, unit, cells }).to_vec();
        columns.splice(1..1, self.dates.into_column());
        Table(columns)
    }
}
