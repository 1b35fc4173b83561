//! The upright bounce through air that drags the body: where the energy that the table gives in a strike is what the air takes in a flight.

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::map::contact_time::first_contact;
use crate::map::flight::{AirDrag, Decay, Flight};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::numbers::rounded::rounded;
use crate::scene::{Name, Scene};

/// Most steps of the search for a speed.
const MOST_STEPS: u32 = 200;

/// Speeds, m/s, between which one is looked for.
const SLOWEST: f64 = 1e-6;
const FASTEST: f64 = 1e6;

/// An upright bounce through air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UprightInAir {
    /// V, m/s: speed just before a contact.
    pub speed: f64,
    /// U, m/s: speed just after it.
    pub rise: f64,
    /// s.
    pub flight_time: f64,
    /// Height of the top of the bounce above its ends, m.
    pub climb: f64,
    /// Derivative of the speed before a contact by that before the last one.
    pub eigenvalue: f64,
    /// Velocities of place after a flight.
    pub place: Decay<f64>,
    /// Velocities of rotation after a flight.
    pub turn: Decay<f64>,
}

/// Speed after a strike of an upright rod at the speed V, and its derivative by V.
fn struck(rod: &Rod, speed: f64) -> (f64, f64) {
    let lifted: Rod<Dual<1>> = rod.lift();
    let zero = Dual::from_f64(0.0);
    let coming = State { theta: zero, x_dot: zero, y_dot: Dual::along(-speed, 0, -1.0), theta_dot: zero };
    let after = lifted.strike(&coming).after.y_dot;
    (after.value, after.partials[0])
}

/// The flight of an upright rod that rises at the speed U.
fn flight(rod: &Rod, drag: AirDrag, rise: f64) -> Flight {
    let start = State { theta: 0.0, x_dot: 0.0, y_dot: rise, theta_dot: 0.0 };
    let (contact_distance, gravity) = (rod.contact_distance, rod.gravity);
    Flight { start, sin_cos_theta: (0.0, 1.0), clearance: 0.0, contact_distance, gravity, drag: Some(drag) }
}

/// Length of that flight, s, the speed V at its end, and its derivative by U, all of the place alone; `None` past the work limit.
fn flown(rod: &Rod, drag: AirDrag, rise: f64) -> Option<(f64, f64, f64)> {
    let flight = flight(rod, drag, rise);
    let t = first_contact(&flight).ok()?;
    let Decay { left, way, .. } = Decay::new(drag.linear, t);
    let speed = rod.gravity * way - rise * left;
    // ∂t/∂U = s/V at y(t) = 0.
    let slope = (rod.gravity + drag.linear * rise) * left * way / speed - left;
    Some((t, speed, slope))
}

impl UprightInAir {
    /// The bounce of a rod that comes down at `speed` (m/s); `None` if no bounce follows.
    pub fn at(rod: &Rod, drag: AirDrag, speed: f64) -> Option<Self> {
        let (rise, by_speed) = struck(rod, speed);
        if rise <= 0.0 {
            return None;
        }
        let (flight_time, _, by_rise) = flown(rod, drag, rise)?;
        let AirDrag { linear, rotational, .. } = drag;
        let to_top = if linear == 0.0 { rise / rod.gravity } else { libm::log1p(linear * rise / rod.gravity) / linear };
        Some(Self {
            speed,
            rise,
            flight_time,
            climb: flight(rod, drag, rise).travel(to_top).1,
            eigenvalue: by_speed * by_rise,
            place: Decay::new(linear, flight_time),
            turn: Decay::new(rotational, flight_time),
        })
    }

    /// Refuses scenes for which no bounce in air is derived.
    ///
    /// # Errors
    /// A sentence that says why.
    pub fn refuse(scene: &Scene) -> Result<(), String> {
        let path = scene.drag_field().map_or("", |name| name.row().path);
        let model = scene.model();
        if contact_regime(&model) == ContactRegime::Sticking {
            return Err(format!(
                "{path} drags the body, and with friction on a table that only tilts the bounce in air is not derived"
            ));
        }
        let tilt = scene.constant_tilt();
        if tilt != 0.0 && !model.feedback().is_some_and(|[x, ..]| x != 0.0) {
            return Err(format!(
                "{path} drags the body, and the table tilts by {} rad beside its law: the motion along the table is not derived in air",
                rounded(tilt)
            ));
        }
        if scene.drag().is_some_and(|drag| drag.wind != 0.0) {
            return Err("air.wind takes the body along, and the bounce in moving air has no closed form".to_owned());
        }
        if scene.program().is_some() {
            return Err(format!(
                "{path} drags the body, and for a program of heights the bounce in air is not derived"
            ));
        }
        Ok(())
    }

    /// The bounce that repeats in a scene with drag of place. U = h(V) after a strike and V = f(U) after a flight: f(U)/U falls from 1 to 0 as U
    /// grows, and h(V)/V does not grow with V unless κ_E is negative, so there is one such bounce at most.
    ///
    /// # Errors
    /// A sentence that says why there is none.
    pub fn repeating(scene: &Scene) -> Result<Self, String> {
        let (rod, Some(drag)) = (scene.parameters::<f64>(), scene.drag()) else {
            return Err("no air drags the body".to_owned());
        };
        let rate = drag.linear;
        if rod.energy_feedback != EnergyFeedback::OneStrike && rod.strike_gain_per_energy < 0.0 {
            return Err(format!(
                "air.drag is {rate} 1/s, and for a negative energy_gain the bounce in air is not derived"
            ));
        }
        if !scene.steers_energy() && rod.strike_gain <= 2.0 {
            return Err(format!(
                "air.drag is {rate} 1/s: every flight loses energy to the air and nothing gives it back, so no bounce repeats"
            ));
        }
        // U − h(f(U)) grows through 0.
        let missing = |rise: f64| {
            let (_, speed, by_rise) = flown(&rod, drag, rise)?;
            let (after, by_speed) = struck(&rod, speed);
            Some((rise - after, 1.0 - by_speed * by_rise)).filter(|(rest, _)| !rest.is_nan())
        };
        let lost =
            || format!("air.drag is {rate} 1/s, and no bounce of a speed up to {FASTEST} m/s was found to repeat");
        if missing(SLOWEST).ok_or_else(lost)?.0 >= 0.0 {
            let height = scene.number(Name::TargetHeight).unwrap_or_default();
            return Err(format!(
                "air.drag is {rate} 1/s, and target_height {height} m gives the strikes no energy for it: no bounce repeats"
            ));
        }
        let (mut low, mut high) = (SLOWEST, (2.0 * rod.gravity * rod.contact_distance).sqrt());
        while missing(high).ok_or_else(lost)?.0 <= 0.0 {
            (low, high) = (high, 2.0 * high);
            if high > FASTEST {
                return Err(lost());
            }
        }
        let mut rise = 0.5 * (low + high);
        for _ in 0..MOST_STEPS {
            let (rest, slope) = missing(rise).ok_or_else(lost)?;
            if rest < 0.0 {
                low = rise
            } else {
                high = rise
            }
            let newton = rise - rest / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let is_done = (next - rise).abs() <= 2.0 * f64::EPSILON * rise;
            rise = next;
            if is_done {
                break;
            }
        }
        let speed = flown(&rod, drag, rise).ok_or_else(lost)?.1;
        Self::at(&rod, drag, speed).ok_or_else(lost)
    }
}
