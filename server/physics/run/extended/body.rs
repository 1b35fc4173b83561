//! A body with 31 digits: its falls, strikes and flights, by the formulas of the bodies in doubles.
//!
//! Numbers that are drawn or given as doubles, such as the errors of a table, are the same here. Other vertices of a polygon are looked
//! for in doubles: they end runs and change no bounce.

use crate::body::general::LEAST_FLIGHT;
use crate::body::lifted::LiftedBody;
use crate::body::polygon::Outline;
use crate::body::{Arrival, NoContact, PreImpact, Release, Touch};
use crate::bounce::drag::flight::DragFlight;
use crate::bounce::flight::Flight;
use crate::bounce::friction;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::numbers::number::Number;
use crate::numbers::trig;
use crate::run::extended::contact_time::{
    first_contact, first_contact_in_air, first_descent, first_descent_in_air, in_doubles,
};
use crate::table::noise::{Noise, NoiseModel, NoiseSample};

/// A body with 31 digits.
#[derive(Clone, Copy, Debug)]
pub struct ExtendedBody {
    /// All of it but the vertices.
    pub lifted: LiftedBody<DoubleDouble>,
    /// The vertices of a polygon.
    pub outline: Option<Outline>,
    /// True for a point mass, whose angle is that of its velocity.
    pub is_point: bool,
}

impl ExtendedBody {
    /// Same as [`crate::body::Body::fall`].
    ///
    /// # Errors
    /// The reason if there is no first contact; likewise in [`ExtendedBody::fly`].
    pub fn fall(&self, release: &Release) -> Result<Arrival<DoubleDouble>, NoContact> {
        let zero = DoubleDouble::from_f64(0.0);
        let start = release.state.map(DoubleDouble::from);
        let (sin, cos) = start.theta.sincos();
        let height = self.lifted.rod.contact_distance * cos;
        let clearance = DoubleDouble::from_f64(release.height) - height;
        // As in doubles: a height typed as l cos θ means a contact.
        let typed = 4.0 * f64::EPSILON * f64::max(release.height.abs(), height.to_f64().abs());
        let flight = Flight {
            start,
            sin_cos_theta: (sin, cos),
            clearance: if clearance.to_f64() <= typed { zero } else { clearance },
            contact_distance: self.lifted.rod.contact_distance,
            gravity: self.lifted.rod.gravity,
        };
        if let Some(drag) = self.lifted.drag {
            let flight = DragFlight { free: flight, drag };
            let gap = flight.gap(zero);
            let falls = gap.slope < zero || (gap.slope == zero && gap.bend <= zero);
            let on_table = flight.free.clearance == zero && falls;
            let t = if on_table { zero } else { first_contact_in_air(&flight)? };
            return Ok(self.arrive_in_air(&flight, t, 1));
        }
        let gap = flight.gap(zero);
        let falls = gap.slope < zero || (gap.slope == zero && gap.bend <= zero);
        let t = if flight.clearance == zero && falls { zero } else { first_contact(&flight)? };
        self.arrive(&flight, t, 1, release.x.into())
    }

    /// Same as [`crate::body::Body::strike`].
    pub fn strike(&self, coming: &PreImpact<DoubleDouble>) -> Strike<DoubleDouble> {
        self.lifted.strike(coming)
    }

    /// Same as [`crate::body::Body::fly`].
    ///
    /// # Errors
    /// Same as [`ExtendedBody::fall`].
    pub fn fly(
        &self,
        from: &PreImpact<DoubleDouble>,
        strike: &Strike<DoubleDouble>,
    ) -> Result<Arrival<DoubleDouble>, NoContact> {
        let flight = Flight { clearance: from.clearance, ..self.lifted.rod.flight(strike) };
        if let Some(drag) = self.lifted.drag {
            let flight = DragFlight { free: flight, drag };
            let t = if from.clearance.to_f64() < 0.0 {
                first_descent_in_air(&flight)?.ok_or(NoContact::Sinking)?
            } else {
                first_contact_in_air(&flight)?
            };
            return Ok(self.arrive_in_air(&flight, t, from.n + 1));
        }
        let t = if flight.clearance.to_f64() < 0.0 {
            first_descent(&flight)?.ok_or(NoContact::Sinking)?
        } else {
            first_contact(&flight)?
        };
        self.arrive(&flight, t, from.n + 1, from.x)
    }

    /// Same as [`crate::body::Body::touches`].
    pub(super) fn touches(&self, theta: DoubleDouble, alpha: DoubleDouble) -> Option<Touch> {
        let nearest = self.outline.as_ref()?.below_table((theta - alpha).to_f64())?;
        Some(Touch { vertex: nearest.vertex, t: 0.0 })
    }

    /// Same as [`crate::body::Body::rise_rounding`].
    pub(super) fn rise_rounding(&self, before: &State<DoubleDouble>, strike: &Strike<DoubleDouble>) -> f64 {
        match self.lifted.friction {
            None => strike.rise_rounding(before.y_dot, ROUNDING),
            Some(_) => friction::rise_rounding(&self.lifted.rod, before, strike, ROUNDING),
        }
    }

    /// The contact number `n` that ends a flight through air whose contact point is at y = 0 at the time `t`.
    fn arrive_in_air(&self, flight: &DragFlight<DoubleDouble>, t: DoubleDouble, n: u64) -> Arrival<DoubleDouble> {
        let timing = self.lifted.noise.map_or(0.0, |noise| noise.draw(n).timing);
        let (mut struck, mut clearance) = (t, DoubleDouble::from_f64(0.0));
        if timing != 0.0 {
            let (late, least) = (t + DoubleDouble::from_f64(timing), DoubleDouble::from_f64(LEAST_FLIGHT));
            struck = if late < least { least } else { late };
            clearance = flight.gap(struck).value;
        }
        let travel = Some(flight.travel(struck).0);
        Arrival { t: struck, state: flight.end(struck), clearance, plan: None, travel }
    }

    /// The contact number `n` that ends a flight from `x` whose contact point is at y = 0 at the time `t`.
    fn arrive(
        &self,
        flight: &Flight<DoubleDouble>,
        t: DoubleDouble,
        n: u64,
        x: DoubleDouble,
    ) -> Result<Arrival<DoubleDouble>, NoContact> {
        let mut arrival = match &self.lifted.noise {
            None => {
                let state = flight.end(t);
                let zero = DoubleDouble::from_f64(0.0);
                let plan = self.lifted.late_motion(n, x + state.x_dot * t, &state, zero, t);
                Arrival { plan, ..Arrival::from((t, state)) }
            }
            Some(noise) => self.meet_timed(noise, flight, t, n, x)?,
        };
        if let Some(outline) = &self.outline
            && let Some(touch) = outline.first_touch(&in_doubles(flight), t.to_f64().min(arrival.t.to_f64()))?
        {
            return Err(NoContact::OtherVertex(touch));
        }
        if self.is_point {
            arrival.state.theta = fall_angle(&arrival.state);
        }
        Ok(arrival)
    }

    /// End of a flight at a table that errs about the time `t`, when the contact point is at y = 0.
    fn meet_timed(
        &self,
        noise: &Noise,
        flight: &Flight<DoubleDouble>,
        t: DoubleDouble,
        n: u64,
        x: DoubleDouble,
    ) -> Result<Arrival<DoubleDouble>, NoContact> {
        let NoiseSample { timing, angle } = noise.draw(n);
        let least = DoubleDouble::from_f64(LEAST_FLIGHT);
        let later = |time: DoubleDouble| if time < least { least } else { time };
        let struck = if timing == 0.0 { t } else { later(t + DoubleDouble::from_f64(timing)) };
        let state = flight.end(struck);
        let clearance = if timing == 0.0 { DoubleDouble::from_f64(0.0) } else { flight.gap(struck).value };
        match noise.model {
            NoiseModel::Strike => {
                let plan = self.lifted.late_motion(n, x + state.x_dot * struck, &state, clearance, struck);
                Ok(Arrival { t: struck, state, clearance, plan, travel: None })
            }
            NoiseModel::Plan => {
                let plan = self.lifted.planned_motion(n, x + state.x_dot * struck, &state, angle, struck);
                let relative = plan.relative(flight, struck, &state);
                let met = if relative.gravity.to_f64() > 0.0 { first_descent(&relative)? } else { None };
                match met {
                    Some(met) => {
                        let t = later(met);
                        let (state, clearance) = (flight.end(t), flight.gap(t).value);
                        Ok(Arrival { t, state, clearance, plan: Some(plan), travel: None })
                    }
                    // Released onto the table: it is on the plane, whatever was planned for later.
                    None if t.to_f64() == 0.0 => Ok((least, flight.end(least)).into()),
                    None => Err(NoContact::Missed),
                }
            }
        }
    }
}

/// The angle of a velocity from straight down, rad: that in doubles, turned by the little that is left. Its square is lost.
fn fall_angle(state: &State<DoubleDouble>) -> DoubleDouble {
    let State { x_dot, y_dot, .. } = *state;
    if x_dot == DoubleDouble::from_f64(0.0) && y_dot == x_dot {
        return x_dot;
    }
    let angle = DoubleDouble::from_f64(trig::atan2(x_dot.to_f64(), -y_dot.to_f64()));
    let (sin, cos) = angle.sincos();
    angle + (x_dot * cos + y_dot * sin) / (x_dot * sin - y_dot * cos)
}
