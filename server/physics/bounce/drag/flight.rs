//! The flight of a rod through air that drags it, in closed form.
//!
//! Not here: which root of the gap is the next contact ([`crate::bounce::drag::contact_time`]).

use crate::bounce::drag::AirDrag;
use crate::bounce::drag::decay::Decay;
use crate::bounce::flight;
use crate::bounce::flight::{Flight, Gap};
use crate::bounce::state::State;
use crate::numbers::number::Number;

/// A flight through air, from the moment it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragFlight<N = f64> {
    /// The flight that the body would make without air.
    pub free: Flight<N>,
    /// The air.
    pub drag: AirDrag,
}

impl<N: Number> DragFlight<N> {
    fn decays(&self, t: N) -> (Decay<N>, Decay<N>) {
        let AirDrag { linear, rotational } = self.drag;
        let place = Decay::new(linear, t);
        (place, if rotational == linear { place } else { Decay::new(rotational, t) })
    }

    /// g(t) = h₀ + ẏs − Gr + l cos θ − l cos(θ + θ̇s_θ) with its derivatives; s and r are [`Decay::way`] and [`Decay::fall`].
    ///
    /// As in [`Flight::gap`] the trivial root t = 0 is divided out.
    pub fn gap(&self, t: N) -> Gap<N> {
        let (place, turn) = self.decays(t);
        let Flight { start, sin_cos_theta: (sin_theta, cos_theta), clearance, contact_distance, gravity } = self.free;
        let State { y_dot, theta_dot, .. } = start;
        let (sin, versine) = (theta_dot * turn.way).sin_versine();
        let omega = theta_dot * turn.left;
        let sin_then = sin_theta + (cos_theta * sin - sin_theta * versine);
        let cos_then = cos_theta - (cos_theta * versine + sin_theta * sin);
        let turned = contact_distance * (sin_theta * sin + cos_theta * versine);
        let pull = gravity + N::from_f64(self.drag.linear) * y_dot;
        let braked = N::from_f64(self.drag.rotational) * sin_then;
        Gap {
            value: (clearance + (y_dot * place.way - gravity * place.fall)) + turned,
            slope: (y_dot * place.left - gravity * place.way) + contact_distance * omega * sin_then,
            bend: contact_distance * omega * (omega * cos_then - braked) - pull * place.left,
        }
    }

    /// Angle and velocities after a time `t`.
    pub fn end(&self, t: N) -> State<N> {
        let (place, turn) = self.decays(t);
        let State { theta, x_dot, y_dot, theta_dot } = self.free.start;
        State {
            theta: theta + theta_dot * turn.way,
            x_dot: x_dot * place.left,
            y_dot: y_dot * place.left - self.free.gravity * place.way,
            theta_dot: theta_dot * turn.left,
        }
    }

    /// Way of the centre of gravity along x and up after a time `t`, m.
    pub fn travel(&self, t: N) -> (N, N) {
        let Decay { way, fall, .. } = Decay::new(self.drag.linear, t);
        let State { x_dot, y_dot, .. } = self.free.start;
        (x_dot * way, y_dot * way - self.free.gravity * fall)
    }

    /// Same as [`Flight::lift_root`].
    pub fn lift_root(&self, root: f64) -> N {
        flight::lifted(root, |t| self.gap(t))
    }
}
