//! The linear verdict on a scene in closed form, and what a run of the scene says beside it. What is concluded from them is
//! [`crate::stability::verdict`].
//!
//! The angle is judged by Greene's residue R (J. M. Greene, 1979), never by |λ|: at R = 1 a computed double eigenvalue is
//! off by the square root of rounding.

use crate::control::{BounceModel, ClosedLoop};
use crate::numbers::trig;
use crate::run::ending::Ending;
use crate::run::orbit::{LOOK, run};
use crate::scene::{BodyShape, Scene};
use crate::stability::contact_regime::Grip;
use crate::stability::fixed_point::FixedPoint;
use crate::stability::jacobian::{modulus, sort_eigenvalues};
use crate::table::actuator_load::{Demand, Meter};
use nalgebra::Complex;

/// |R| or |R − 1| up to which the angle is called parabolic; likewise for the energy eigenvalue at ±1.
pub const PARABOLIC: f64 = 1e-9;

/// How the angle moves near the fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// It comes back (point mass).
    Attracting,
    /// It circles, 0 < R < 1.
    Elliptic,
    /// R = 0 or R = 1: a double eigenvalue ±1, on which the linear analysis is silent.
    Parabolic,
    /// It leaves.
    Hyperbolic,
}

impl Class {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Attracting => "attracting",
            Self::Elliptic => "elliptic",
            Self::Parabolic => "parabolic",
            Self::Hyperbolic => "hyperbolic",
        }
    }
}

/// The linear verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// How the angle moves.
    pub class: Class,
    /// R = (κ − 1)V²l/(Gρ²), with ρ² + l² for ρ² where a matched contact sticks; none for a point mass, and where the contact sticks to
    /// a table that only tilts.
    pub residue: Option<f64>,
    /// σ, rad per bounce, cos σ = 1 − 2R; where it is elliptic or parabolic.
    pub rotation: Option<f64>,
    /// Eigenvalues of the whole map, largest modulus first; with state feedback those of the closed loop, without the energy's.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Least κ that balances; infinite where none does.
    pub lower_tilt_gain: f64,
    /// κ_c, greatest κ that balances: 1 + Gρ²/(V²l), eq. (18), for every e and κ_E, with ρ² as in the residue; −∞ where none does.
    pub critical_tilt_gain: f64,
    /// Greatest κ_E that holds the energy, 2/((1 + e)V²), s²/m².
    pub upper_energy_gain: f64,
    /// 1 − (1 + e)κ_E V².
    pub energy_eigenvalue: f64,
    /// What the state feedback does, where the table has one.
    pub closed_loop: Option<ClosedLoop>,
}

impl Linear {
    /// Largest modulus of an eigenvalue; exactly 1 where the angle circles, whatever rounding says. With state feedback a height that
    /// nothing steers is left out, which would always be 1.
    pub fn spectral_radius(&self) -> f64 {
        if let Some(closed) = self.closed_loop.as_ref().filter(|_| self.energy_eigenvalue == 1.0) {
            return closed.spectral_radius;
        }
        let angle = match self.class {
            Class::Elliptic | Class::Parabolic => 1.0,
            Class::Attracting | Class::Hyperbolic => self.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max),
        };
        angle.max(self.energy_eigenvalue.abs())
    }

    /// Whether it says that a small deviation stays small.
    pub fn says_bounded(&self) -> bool {
        matches!(self.class, Class::Attracting | Class::Elliptic) && self.energy_eigenvalue.abs() <= 1.0 + PARABOLIC
    }
}

/// What happens at κ_c, by the next order of the normal form: κ − κ_c ≈ a C θ² on the branch of period-2 orbits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// C; positive is soft (runs stay bounded at and a little beyond κ_c), negative hard (they fall).
    pub coefficient: f64,
}

impl Boundary {
    /// `soft`, `hard` or, at C = 0, `degenerate`.
    pub fn kind(&self) -> &'static str {
        if self.coefficient > 0.0 {
            "soft"
        } else if self.coefficient < 0.0 {
            "hard"
        } else {
            "degenerate"
        }
    }
}

/// What the run of the scene itself says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nonlinear {
    /// How it ended.
    pub ending: Ending,
    /// Contacts until then.
    pub impacts: u64,
    /// When, s.
    pub t: f64,
    /// Largest |θ| at a contact, rad.
    pub max_theta: f64,
    /// The most that it asked of the table.
    pub demand: Demand,
}

impl Scene {
    /// The linear verdict about a fixed point, in closed form: eq. (14) with the energy term.
    pub fn linear(&self, fixed_point: &FixedPoint) -> Linear {
        let speed_squared = fixed_point.speed * fixed_point.speed;
        let loop_gain = (1.0 + self.restitution) * speed_squared;
        let energy_eigenvalue = 1.0 - self.energy_gain * loop_gain;
        let upper_energy_gain = 2.0 / loop_gain;
        let real = |value: f64| Complex::new(value, 0.0);
        if let Some(closed) = self.steered(fixed_point) {
            return Linear {
                class: if closed.is_stable() { Class::Attracting } else { Class::Hyperbolic },
                residue: None,
                rotation: None,
                eigenvalues: closed.eigenvalues.clone(),
                lower_tilt_gain: f64::INFINITY,
                critical_tilt_gain: f64::NEG_INFINITY,
                upper_energy_gain,
                energy_eigenvalue,
                closed_loop: Some(closed),
            };
        }
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else {
            // Eq. (4): the angle of the velocity is multiplied by 1 − 2κ.
            let angle = 1.0 - 2.0 * self.tilt_gain;
            let class = if angle.abs() < 1.0 { Class::Attracting } else { Class::Hyperbolic };
            let mut eigenvalues = vec![real(angle), real(energy_eigenvalue)];
            sort_eigenvalues(&mut eigenvalues);
            return Linear {
                class,
                residue: None,
                rotation: None,
                eigenvalues,
                lower_tilt_gain: 0.0,
                critical_tilt_gain: 1.0,
                upper_energy_gain,
                energy_eigenvalue,
                closed_loop: None,
            };
        };
        if self.grip() == Grip::Held {
            let mut eigenvalues = self.held_eigenvalues(fixed_point.speed).to_vec();
            eigenvalues.push(real(energy_eigenvalue));
            sort_eigenvalues(&mut eigenvalues);
            return Linear {
                class: Class::Hyperbolic,
                residue: None,
                rotation: None,
                eigenvalues,
                lower_tilt_gain: f64::INFINITY,
                critical_tilt_gain: f64::NEG_INFINITY,
                upper_energy_gain,
                energy_eigenvalue,
                closed_loop: None,
            };
        }
        let turning = self.turning_radius_squared(contact_distance, radius_of_gyration);
        // a = κ_c − 1.
        let width = self.gravity * turning / (speed_squared * contact_distance);
        let residue = (self.tilt_gain - 1.0) / width;
        let class = class(residue);
        let half_trace = 1.0 - 2.0 * residue;
        let pair = match class {
            Class::Parabolic => [real(half_trace.signum()); 2],
            Class::Elliptic => {
                // 1 − (1 − 2R)² without cancellation near R = 0 and R = 1.
                let imaginary = 2.0 * (residue * (1.0 - residue)).sqrt();
                [Complex::new(half_trace, imaginary), Complex::new(half_trace, -imaginary)]
            }
            Class::Attracting | Class::Hyperbolic => {
                let large = half_trace + half_trace.signum() * 2.0 * (residue * (residue - 1.0)).sqrt();
                [real(large), real(1.0 / large)]
            }
        };
        let mut eigenvalues = vec![pair[0], pair[1], real(1.0), real(energy_eigenvalue)];
        sort_eigenvalues(&mut eigenvalues);
        Linear {
            class,
            residue: Some(residue),
            rotation: matches!(class, Class::Elliptic | Class::Parabolic)
                .then(|| trig::acos(half_trace.clamp(-1.0, 1.0))),
            eigenvalues,
            lower_tilt_gain: 1.0,
            critical_tilt_gain: 1.0 + width,
            upper_energy_gain,
            energy_eigenvalue,
            closed_loop: None,
        }
    }

    /// The boundary coefficient C at κ_c, with a = κ_c − 1 and γ = Gl/V²: (1+a)²/2 + a²/6 − (1−a)γ, and with a positive
    /// energy gain, which holds η and not the energy, −(1+a)²/2 + a²/6 − γ. None for a point mass, and with friction, for which it
    /// is not derived.
    pub fn boundary(&self, fixed_point: &FixedPoint) -> Option<Boundary> {
        if self.grip() != Grip::Smooth || self.feedback().is_some() {
            return None;
        }
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return None };
        let gamma = self.gravity * contact_distance / (fixed_point.speed * fixed_point.speed);
        let lever = radius_of_gyration / contact_distance;
        let a = gamma * lever * lever;
        let half_square = 0.5 * (1.0 + a) * (1.0 + a);
        let sixth = a * a / 6.0;
        let coefficient =
            if self.energy_gain > 0.0 { sixth - half_square - gamma } else { half_square + sixth - (1.0 - a) * gamma };
        Some(Boundary { coefficient })
    }

    /// θ, rad, of the mirror-symmetric period-2 orbit at the energy of the fixed point, the one nearest to upright; none
    /// where there is none within the topple angle.
    ///
    /// Its states are (±θ, ±V tan κθ, −V, ±Gθ/V) with V² = Gρ²θ cos κθ / (l sin((κ − 1)θ)); with energy feedback η is held in
    /// place of the energy. None with friction, for which it is not derived.
    pub fn period_two(&self, fixed_point: &FixedPoint) -> Option<f64> {
        if self.grip() != Grip::Smooth || self.feedback().is_some() {
            return None;
        }
        let BodyShape::Rod { contact_distance, radius_of_gyration } = self.body else { return None };
        let (kappa, gravity) = (self.tilt_gain, self.gravity);
        let weight = gravity * contact_distance;
        // What the orbit with angle θ has more than the fixed point; not a number where there is no such orbit.
        let excess = |theta: f64| {
            let (sin_alpha, cos_alpha) = trig::sin_cos(kappa * theta);
            let (sin_beta, _) = trig::sin_cos((kappa - 1.0) * theta);
            let (_, versine) = trig::sin_versine(theta);
            let rho_squared = radius_of_gyration * radius_of_gyration;
            let speed_squared = gravity * rho_squared * theta * cos_alpha / (contact_distance * sin_beta);
            let slant = sin_alpha / cos_alpha;
            let aside = slant * slant * speed_squared + rho_squared * gravity * gravity * theta * theta / speed_squared;
            let held = if self.energy_gain > 0.0 { 0.0 } else { 0.5 * aside };
            let speed = fixed_point.speed;
            if cos_alpha > 0.0 && speed_squared > 0.0 {
                0.5 * (speed_squared - speed * speed) + held - weight * versine
            } else {
                f64::NAN
            }
        };
        let step = self.topple_angle / 1024.0;
        let (mut low, mut high) = (step * 1e-6, step);
        while excess(low) * excess(high) > 0.0 && high < self.topple_angle {
            (low, high) = (high, high + step);
        }
        let (below, above) = (excess(low), excess(high));
        if below.is_nan() || above.is_nan() || below * above > 0.0 {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(middle) * below > 0.0 { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// Runs the scene for up to `impacts` contacts; `go_on` is asked now and then, and a `false` gives none.
    pub fn nonlinear(&self, impacts: u64, mut go_on: impl FnMut() -> bool) -> Option<Nonlinear> {
        let mut orbit = match self.orbit() {
            Ok(orbit) => orbit,
            Err(none) => {
                let (ending, t) = (none.ending(0.0, 0.0), 0.0);
                let max_theta = self.start().theta.abs();
                return Some(Nonlinear { ending, impacts: 0, t, max_theta, demand: Demand::default() });
            }
        };
        let mut max_theta: f64 = 0.0;
        let mut t = 0.0;
        let mut meter = Meter::default();
        let ending = run(&mut orbit, impacts, |contact| {
            meter.look(contact);
            max_theta = max_theta.max(contact.state.theta.abs());
            t = contact.t;
            !contact.n.is_multiple_of(LOOK) || go_on()
        })?;
        Some(Nonlinear { ending, impacts: orbit.contacts(), t, max_theta, demand: meter.most })
    }
}

impl Scene {
    /// What the state feedback of the scene does near a bounce in place; none where it has none.
    pub fn steered(&self, fixed_point: &FixedPoint) -> Option<ClosedLoop> {
        let gain = self.feedback()?;
        let model = BounceModel::new(&self.parameters(), fixed_point.speed, self.grip());
        model.closed_loop(gain, gain[0] != 0.0)
    }
}

/// The class of a residue.
pub fn class(residue: f64) -> Class {
    if residue.abs() <= PARABOLIC || (residue - 1.0).abs() <= PARABOLIC {
        Class::Parabolic
    } else if residue > 0.0 && residue < 1.0 {
        Class::Elliptic
    } else {
        Class::Hyperbolic
    }
}
