//! The end of a flight in dual numbers, at a table that may err: its derivative by all that it depends on.

use crate::body::Arrival;
use crate::body::Body;
use crate::body::bounce::LEAST_FLIGHT;
use crate::bounce::contact_time;
use crate::bounce::flight::Flight;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::table::noise::NoiseModel;

/// The end of a flight, and how its time is found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing<const K: usize> {
    pub(super) arrival: Arrival<Dual<K>>,
    /// Slope of the gap where the contact is, m/s.
    pub(super) speed: Dual<K>,
    /// Contact times at y = 0 and at a planned plane, s.
    pub(super) times: [Dual<K>; 2],
    /// Sizes of further terms that are rounded, m.
    pub(super) parts: f64,
}

impl<const K: usize> Landing<K> {
    /// The end of a flight of length `t` from a place `x` to contact `n`, its time off by `aside`; `None` if it is not found. The flight is
    /// given in doubles too.
    pub(super) fn new(
        body: &Body<Dual<K>>,
        (flight, flying): (&Flight, &Flight<Dual<K>>),
        (n, x): (u64, Dual<K>),
        t: f64,
        aside: Dual<K>,
    ) -> Option<Self> {
        // A root ≤ 0 is a release on the table.
        let lift = |root: f64| if root > 0.0 { flying.lift_root(root) + aside } else { Dual::from_f64(0.0) };
        let Some(noise) = body.noise else {
            let time = lift(t);
            let state = flying.end(time);
            let plan = body.late_motion(n, x + flying.travel(time).0, &state, Dual::from_f64(0.0), time);
            let arrival = Arrival { plan, ..Arrival::at(flying, time) };
            return Some(Self { arrival, speed: flying.gap(time).slope, times: [time; 2], parts: 0.0 });
        };
        let sample = noise.draw(n);
        match noise.model {
            NoiseModel::Strike => {
                let time = lift(t - sample.timing);
                let is_least = t <= LEAST_FLIGHT;
                let struck = if is_least { Dual::from_f64(t) } else { time + Dual::from_f64(sample.timing) };
                let exact = sample.timing == 0.0;
                let clearance = if exact { Dual::from_f64(0.0) } else { flying.gap(struck).value };
                let state = flying.end(struck);
                let way = flying.travel(struck).0;
                let plan = body.late_motion(n, x + way, &state, clearance, struck);
                let arrival = Arrival { t: struck, state, clearance, plan, way };
                let speed = flying.gap(time).slope;
                Some(Self { arrival, speed, times: [time; 2], parts: 0.0 })
            }
            NoiseModel::Plan => {
                let root = if flight.clearance < 0.0 {
                    contact_time::first_descent(flight).ok()??
                } else if flight.clearance == 0.0 && flight.gap(0.0).slope <= 0.0 {
                    0.0
                } else {
                    contact_time::first_contact(flight).ok()?
                };
                let time = lift(root);
                let is_least = root + sample.timing <= LEAST_FLIGHT;
                let planned = time + Dual::from_f64(sample.timing);
                let struck = if is_least { Dual::from_f64(LEAST_FLIGHT) } else { planned };
                let state = flying.end(struck);
                let plan = body.planned_motion(n, x + flying.travel(struck).0, &state, sample.angle, struck);
                let relative = plan.relative(flying, struck, &state);
                let met = if t <= LEAST_FLIGHT { Dual::from_f64(t) } else { relative.lift_root(t) };
                let (state, clearance) = (flying.end(met), flying.gap(met).value);
                let arrival = Arrival { t: met, state, clearance, plan: Some(plan), way: flying.travel(met).0 };
                // The plane may be met more nearly along it than y = 0 is.
                let (level, own) = (flying.gap(time).slope, relative.gap(met).slope);
                let speed = if own.value.abs() < level.value.abs() { own } else { level };
                let parts = (plan.normal_velocity.value * struck.value).abs() + (flight.start.x_dot * t).abs();
                Some(Self { arrival, speed, times: [time, met], parts })
            }
        }
    }
}
