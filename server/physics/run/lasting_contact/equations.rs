//! One kind of contact: the equations of motion while it lasts, in any kind of number, and the vertex on which the body stands.
//!
//! With the force N n + F t at the contact point, unit mass, β = θ − α and the mobilities A, B, C of
//! [`crate::map::friction`], the contact point accelerates by A F + C N along the table and C F + B N along its normal, beside
//! gravity and lθ̇². It stays at the table's height if the vertical part vanishes:
//!
//! (cos α + (l²/ρ²) sin β sin θ) N + (sin α + (l²/ρ²) cos β sin θ) F = G − lθ̇² cos θ.
//!
//! A table that accelerates upwards at a has G + a in place of G. Air adds its forces at the centre of gravity, and takes spin.

use crate::map::friction::{Friction, Mobility, Slide};
use crate::map::polygon::{Outline, VertexClearance};
use crate::map::strike::Rod;
use crate::map::table::control_law::Gains;
use crate::numbers::number::Number;
use crate::numbers::trig;
use crate::run::lasting_contact::request::{ContactStart, HoldLaw, HoldRequest, Motion};
use differential_equations::ode::ODE;

/// Longest step of the integrator, s, while the table goes to the tilt of its law in less than that.
const STEP_ON_THE_WAY: f64 = 1e-3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mode {
    /// F = φN with a fixed φ: no friction, or sliding one way.
    Sliding(f64),
    /// On a table that moves along itself with the contact point: F does not accelerate that along the table, and is at most μN.
    Matched(f64),
    /// The contact point stays on one point of the table's surface.
    Sticking,
}

/// The way of the table to the tilt of its law, at a constant rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TiltWay {
    /// α at the beginning of the piece, rad.
    pub(super) from: f64,
    /// α̇, rad/s.
    pub(super) rate: f64,
}

/// Vertical motion of the table's surface, at a time of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TableFall {
    /// Height, m, velocity, m/s, and acceleration, m/s², upwards.
    pub(super) y: f64,
    pub(super) y_dot: f64,
    pub(super) y_ddot: f64,
    /// Time at which a braking table stands, s. From that time on, exactly, it does not brake: the difference of both times would be rounded.
    pub(super) stands: f64,
}

impl TableFall {
    pub(super) fn at(request: &HoldRequest, t: f64) -> Self {
        let ContactStart { t: begin, table_speed: speed, .. } = request.start;
        let elapsed = t - begin;
        let Some(brake) = request.brake.filter(|brake| *brake > 0.0) else {
            return Self { y: speed * elapsed, y_dot: speed, y_ddot: 0.0, stands: f64::INFINITY };
        };
        let acceleration = -brake.copysign(speed);
        let stop = (speed / acceleration).abs();
        let stands = begin + stop;
        if t >= stands {
            return Self { y: 0.5 * speed * stop, y_dot: 0.0, y_ddot: 0.0, stands };
        }
        let y = elapsed * (speed + 0.5 * acceleration * elapsed);
        Self { y, y_dot: speed + acceleration * elapsed, y_ddot: acceleration, stands }
    }
}

/// A motion while the kind of contact stays the same, and all that stays the same with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<'a> {
    pub(super) request: &'a HoldRequest,
    pub(super) stance: Stance,
    pub(super) law: HoldLaw,
    pub(super) way: Option<TiltWay>,
    pub(super) mode: Mode,
    /// Time of the run at its beginning, s.
    pub(super) begin: f64,
    pub(super) fall: TableFall,
    /// A vertex that has just left the table and may be on it, up to rounding, until this time of the piece, s.
    pub(super) rising: Option<(usize, f64)>,
}

impl HoldLaw {
    /// True if the surface moves along x to balance a contact that sticks.
    pub(super) fn is_cart_pole(&self) -> bool {
        matches!(self, Self::CartPole { .. })
    }

    pub(super) fn tilt<N: Number>(&self, motion: &Motion<N>) -> N {
        match self {
            Self::Tilting(gains, constant) => fed_back(gains, motion) + N::from_f64(*constant),
            Self::CartPole { tilt, .. } => N::from_f64(*tilt),
            Self::Level => N::from_f64(0.0),
        }
    }

    /// Acceleration of the table's surface along x, m/s².
    fn acceleration<N: Number>(&self, motion: &Motion<N>) -> N {
        match self {
            Self::CartPole { gains, acceleration, .. } => fed_back(gains, motion) + N::from_f64(*acceleration),
            Self::Tilting(..) | Self::Level => N::from_f64(0.0),
        }
    }

    /// α̇, rad/s, from the motion's derivative: the law is linear, so its rate is the law of the rates.
    pub(super) fn tilt_rate(&self, change: &Motion) -> f64 {
        if let Self::Tilting(gains, _) = self { fed_back(gains, change) } else { 0.0 }
    }
}

fn fed_back<N: Number>(gains: &Gains, &[x, theta, x_dot, theta_dot]: &Motion<N>) -> N {
    let gain = |value: f64| N::from_f64(value);
    -(gain(gains.x) * x + gain(gains.theta) * theta + gain(gains.x_dot) * x_dot + gain(gains.theta_dot) * theta_dot)
}

impl HoldRequest {
    /// The kind of contact by a law, and the friction μ with which a contact that sticks may slide as well.
    pub(super) fn kind(&self, law: HoldLaw) -> (Mode, Option<f64>) {
        let is_level = law == HoldLaw::Level && self.body.outline.is_some();
        match self.body.rough() {
            _ if law.is_cart_pole() => (Mode::Sticking, None),
            None => (Mode::Sliding(0.0), None),
            Some(_) if is_level => (Mode::Sticking, None),
            Some(Friction { coefficient, slide: Slide::Matched, .. }) => (Mode::Matched(coefficient), None),
            Some(Friction { coefficient, slide: Slide::None, .. }) => (Mode::Sticking, Some(coefficient)),
        }
    }
}

impl Piece<'_> {
    /// G + a, m/s².
    pub(super) fn gravity(&self) -> f64 {
        self.request.body.rod.gravity + self.fall.y_ddot
    }

    /// α `t` s after the beginning of the piece, rad.
    pub(super) fn tilt<N: Number>(&self, t: f64, motion: &Motion<N>) -> N {
        self.way.map_or_else(|| self.law.tilt(motion), |way| N::from_f64(way.from + way.rate * t))
    }

    pub(super) fn has_arrived(&self, t: f64, motion: &Motion) -> bool {
        self.way.is_some_and(|way| (self.law.tilt(motion) - self.tilt(t, motion)) * way.rate.signum() <= 0.0)
    }

    /// Longest step of the integrator, s: the time to the tilt of a law that stands still, or until a vertex may land.
    pub(super) fn longest_step(&self, motion: &Motion) -> f64 {
        let time = |way: TiltWay| ((self.law.tilt(motion) - way.from) / way.rate).max(STEP_ON_THE_WAY);
        let rising = self.rising.map_or(f64::INFINITY, |(_, until)| until);
        rising.min(self.way.map_or(f64::INFINITY, time))
    }

    /// Accelerations and the force of the table `t` s after the beginning of the piece.
    pub(super) fn accelerations<N: Number>(&self, t: f64, motion: &Motion<N>) -> ContactMotion<N> {
        let alpha = self.tilt(t, motion);
        let theta = motion[1] + N::from_f64(self.stance.turn);
        let rod = self.stance.rod.lift::<N>();
        let force = match self.mode {
            Mode::Sliding(share) => TangentialForce::Sliding(N::from_f64(share)),
            Mode::Matched(friction) => {
                let (sin_beta, cos_beta) = (theta - alpha).sincos();
                let mobility = Mobility::new(&rod, sin_beta, cos_beta);
                TangentialForce::Sliding(mobility.slope_from_rest(N::from_f64(friction)))
            }
            Mode::Sticking => TangentialForce::Sticking(self.law.acceleration(motion)),
        };
        let air = self.request.body.drag.map(|air| air.map(N::from_f64)).map(|air| {
            let speed = N::from_f64(self.fall.y_dot + self.fall.y_ddot * t);
            air.taken([motion[2], speed - rod.contact_distance * motion[3] * theta.sincos().0, motion[3]])
        });
        ContactMotion::new(&rod, N::from_f64(self.gravity()), [theta, motion[3], alpha], force, air)
    }
}

impl ODE<f64, Motion> for Piece<'_> {
    fn diff(&self, t: f64, motion: &Motion, change: &mut Motion) {
        let ContactMotion { x_ddot, theta_ddot, .. } = self.accelerations(t, motion);
        *change = [motion[2], motion[3], x_ddot, theta_ddot];
    }
}

/// Decides the force along the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialForce<N = f64> {
    /// F = φN with this φ: sliding, or no friction at all.
    Sliding(N),
    /// The contact point does not accelerate along x but by this, m/s², as the table's surface does.
    Sticking(N),
}

/// The force of the table per unit mass, and the accelerations of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMotion<N = f64> {
    /// N, along the table's normal, m/s².
    pub normal: N,
    /// F, along the table, m/s².
    pub tangential: N,
    /// ẍ of the centre of gravity, m/s².
    pub x_ddot: N,
    /// θ̈, rad/s².
    pub theta_ddot: N,
}

impl<N: Number> ContactMotion<N> {
    /// The motion at angle θ, angular velocity and tilt α on a table with this force, under `gravity` G + a, in air that takes so much of the
    /// velocities ẋ, ẏ (m/s²) and θ̇ (rad/s²), if it takes some.
    ///
    /// The normal force may come out negative: then no table keeps the contact.
    pub fn new(
        rod: &Rod<N>,
        gravity: N,
        [theta, theta_dot, alpha]: [N; 3],
        force: TangentialForce<N>,
        air: Option<[N; 3]>,
    ) -> Self {
        let ((sin_theta, cos_theta), (sin_alpha, cos_alpha)) = (theta.sincos(), alpha.sincos());
        let (one, zero) = (N::from_f64(1.0), N::from_f64(0.0));
        let l = rod.contact_distance;
        let leverage = l / (rod.radius_of_gyration * rod.radius_of_gyration);
        let spin = l * theta_dot * theta_dot;
        let [air_x, air_y, air_turn] = air.unwrap_or([zero; 3]);
        // Two equations for the force (X, Y) in the plane. The contact point stays at its height, and along the table the force is of the kind asked
        // for: (1 + l² cos²θ/ρ²) X + (l² sin θ cos θ/ρ²) Y = a + lθ̇² sin θ where it sticks, and likewise along y.
        let (sin_lever, cos_lever) = (l * leverage * sin_theta, l * leverage * cos_theta);
        let cross = sin_lever * cos_theta;
        let upright = one + sin_lever * sin_theta;
        let load = gravity - spin * cos_theta + (air_y + l * sin_theta * air_turn);
        let (by_x, by_y, along) = match force {
            TangentialForce::Sliding(share) => (cos_alpha + share * sin_alpha, sin_alpha - share * cos_alpha, zero),
            TangentialForce::Sticking(acceleration) => {
                let along = acceleration + spin * sin_theta + (air_x + l * cos_theta * air_turn);
                (one + cos_lever * cos_theta, cross, along)
            }
        };
        let determinant = by_x * upright - by_y * cross;
        let x = (along * upright - by_y * load) / determinant;
        let y = (by_x * load - along * cross) / determinant;
        let normal = cos_alpha * y - sin_alpha * x;
        let tangential = match force {
            TangentialForce::Sliding(share) => share * normal,
            TangentialForce::Sticking(_) => cos_alpha * x + sin_alpha * y,
        };
        Self {
            normal,
            tangential,
            x_ddot: x - air_x,
            theta_ddot: leverage * (sin_theta * y + cos_theta * x) - air_turn,
        }
    }
}

/// A body that stands on one of its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stance {
    /// The rod from the centre of gravity to the vertex.
    pub(super) rod: Rod,
    /// Angle of that rod when θ = 0, rad: 0 for the contact vertex.
    pub(super) turn: f64,
    pub(super) vertex: usize,
    outline: Option<Outline>,
}

/// The end of a vertex on the table by the landing of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Landing {
    /// θ̇⁺/θ̇⁻; not positive if the body stops on the edge.
    pub(super) ratio: f64,
    /// |P_t|/P_n of the impulse.
    pub(super) needed_friction: f64,
    /// True if the centre of gravity is between the two vertices, so that the edge bears the body.
    pub(super) bears: bool,
    pub(super) stance: Stance,
}

impl Stance {
    pub(super) fn new(request: &HoldRequest) -> Self {
        let vertex = request.body.outline.map_or(0, |outline| outline.contact_vertex);
        Self { rod: request.body.rod, turn: 0.0, vertex, outline: request.body.outline }
    }

    /// Velocity of the contact point along x, m/s.
    pub(super) fn contact_speed(&self, motion: &Motion) -> f64 {
        let (_, cos) = trig::sin_cos(motion[1] + self.turn);
        motion[2] + self.rod.contact_distance * cos * motion[3]
    }

    /// Place of the contact point along x, m.
    pub(super) fn contact_place(&self, motion: &Motion) -> f64 {
        let (sin, _) = trig::sin_cos(motion[1] + self.turn);
        motion[0] + self.rod.contact_distance * sin
    }

    /// From the centre of gravity to a vertex, at the angle θ.
    fn arm(&self, vertex: usize, theta: f64) -> [f64; 2] {
        let (sin, cos) = trig::sin_cos(theta);
        let place = self.outline.as_ref().and_then(|outline| outline.vertices().get(vertex).copied());
        let [x, y] = place.unwrap_or([0.0, -self.rod.contact_distance]);
        [x * cos - y * sin, x * sin + y * cos]
    }

    /// The vertex nearest to the table beside the one that stands on it and `without`.
    pub(super) fn nearest(&self, theta: f64, alpha: f64, without: Option<usize>) -> Option<VertexClearance> {
        Some(self.outline.as_ref()?.nearest_beside(self.vertex, without, trig::sin_cos(theta - alpha)))
    }

    /// Plastic landing of `vertex` at the angle θ of a body that turns about its present vertex at θ̇.
    /// The angular momentum about the landing vertex is kept: θ̇⁺/θ̇⁻ = (ρ² + r_A·r_B)/(ρ² + |r_B|²) if both vertices stick. On a table
    /// without friction the impulse is vertical, and the horizontal parts of both arms take their place.
    pub(super) fn land(&self, vertex: usize, theta: f64, sticks: bool) -> Landing {
        let (from, onto) = (self.arm(self.vertex, theta), self.arm(vertex, theta));
        let share = if sticks { 1.0 } else { 0.0 };
        let rho_squared = self.rod.radius_of_gyration * self.rod.radius_of_gyration;
        let ratio = (rho_squared + from[0] * onto[0] + share * from[1] * onto[1])
            / (rho_squared + onto[0] * onto[0] + share * onto[1] * onto[1]);
        // The centre of gravity moves at θ̇(r_y, −r_x) about a vertex at r from it. A body that stops loses all of that.
        let kept = ratio.max(0.0);
        let impulse = [kept * onto[1] - from[1], from[0] - kept * onto[0]];
        let outline = self.outline.as_ref();
        let place = outline.and_then(|outline| outline.vertices().get(vertex).copied()).unwrap_or_default();
        let distance = (place[0] * place[0] + place[1] * place[1]).sqrt();
        Landing {
            ratio,
            needed_friction: if sticks { (impulse[0] / impulse[1]).abs() } else { 0.0 },
            bears: from[0] * onto[0] < 0.0,
            stance: Self {
                rod: Rod { contact_distance: distance, ..self.rod },
                turn: libm::atan2(place[0], -place[1]),
                vertex,
                outline: self.outline,
            },
        }
    }
}
