//! A rig simulated from Newton's and Euler's equations, with the axis of its rod for the angle: the table's errors as they stand in the
//! contract, not as they are reduced. Only the random numbers are those of the physics.

#![allow(dead_code, reason = "each test file uses its own part")]

use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::table::noise::Noise;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::paper;
use crate::support::scenes::upright_bounce;

/// A rod on a table with constant and random errors, without friction and errors of timing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rig {
    /// Centre of gravity from the contact point, along the axis and across it, m.
    along: f64,
    across: f64,
    rho: f64,
    /// True for a point mass, whose angle is that of its velocity.
    is_point: bool,
    gravity: f64,
    /// Rates at which the air takes velocity and spin, 1/s, and its own velocity, m/s.
    drag: [f64; 2],
    wind: f64,
    restitution: f64,
    assumed: f64,
    energy_gain: f64,
    target: f64,
    /// K of x, θ, ẋ, θ̇.
    gains: [f64; 4],
    bias: f64,
    offset: f64,
    gain_error: f64,
    speed_error: f64,
    /// Place of the pivot and its depth, m, of a table whose turning its law does not know.
    pivot: Option<[f64; 2]>,
    noise: Option<Noise>,
    /// Time from sensing to the strike, s, and whether the table carries what it senses on.
    delay: f64,
    predicts: bool,
    /// Time of the flight before a strike, s, and its beginning in the order of `at`.
    flight_time: f64,
    start: [f64; 6],
    /// Place and height of the centre of gravity, angle of the axis, and their velocities.
    at: [f64; 6],
}

impl Rig {
    /// The rig of a scene, as it is released.
    pub(crate) fn of(scene: &Scene) -> Self {
        let number = |name| scene.number(name).unwrap_or(0.0);
        let (along, across) = (number(Name::ContactDistance), number(Name::Offset));
        let restitution = number(Name::Restitution);
        let gains = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot].map(number);
        let gravity = number(Name::Gravity) * number(Name::Incline).sin();
        Self {
            along,
            across,
            rho: scene.number(Name::RadiusOfGyration).unwrap_or(1.0),
            is_point: along == 0.0,
            gravity,
            drag: [Name::Drag, Name::RotationDrag].map(number),
            wind: number(Name::Wind),
            restitution,
            assumed: scene.number(Name::AssumedRestitution).unwrap_or(restitution),
            energy_gain: number(Name::EnergyGain),
            target: gravity * number(Name::TargetHeight),
            gains: [gains[0], gains[1] - number(Name::TiltGain), gains[2], gains[3]],
            bias: number(Name::AngleBias),
            offset: number(Name::TiltOffset),
            gain_error: number(Name::TiltGainError),
            speed_error: number(Name::SpeedError),
            pivot: (scene.value(Name::TiltRate) == Some(Value::Choice("follows")))
                .then(|| scene.number(Name::PivotX))
                .flatten()
                .map(|place| [place, number(Name::PivotDepth)]),
            noise: noise(scene),
            delay: number(Name::Delay),
            predicts: scene.value(Name::Prediction) == Some(Value::Choice("flight")),
            flight_time: 0.0,
            start: [0.0; 6],
            at: [
                number(Name::X),
                number(Name::Height),
                number(Name::Theta) + across.atan2(along),
                number(Name::XDot),
                number(Name::YDot),
                number(Name::ThetaDot),
            ],
        }
    }

    /// From the centre of gravity to the contact point, the axis at an angle.
    fn foot(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        [self.along * sin - self.across * cos, -self.along * cos - self.across * sin]
    }

    /// After a free flight.
    fn flown(&self, t: f64) -> [f64; 6] {
        let [x, y, angle, x_dot, y_dot, spin] = self.at;
        let [c, turn] = self.drag;
        let turned = if turn == 0.0 { t } else { -(-turn * t).exp_m1() / turn };
        let spin_then = spin * (-turn * t).exp();
        if c == 0.0 {
            let y_then = y + y_dot * t - 0.5 * self.gravity * t * t;
            return [x + x_dot * t, y_then, angle + spin * turned, x_dot, y_dot - self.gravity * t, spin_then];
        }
        let (left, way) = ((-c * t).exp(), -(-c * t).exp_m1() / c);
        // (t − way)/c, for a short time by the series of the exponential.
        let mut fall = (t - way) / c;
        if c * t < 0.5 {
            let terms = (2..25).scan(t, |term, n| {
                *term *= -c * t / f64::from(n);
                Some(*term)
            });
            fall = -terms.sum::<f64>() / c;
        }
        let y_then = y + y_dot * way - self.gravity * fall;
        // As seen by the air.
        let along = x_dot - self.wind;
        let (x_then, x_dot_then) = (x + self.wind * t + along * way, self.wind + along * left);
        [x_then, y_then, angle + spin * turned, x_dot_then, y_dot * left - self.gravity * way, spin_then]
    }

    /// Time until the contact point comes down to 0; its height has one top. `None` if it does not rise.
    fn flight(&self) -> Option<f64> {
        let height = |t: f64| {
            let then = self.flown(t);
            then[1] + self.foot(then[2])[1]
        };
        let reach = 2.0 * self.along.hypot(self.across);
        let up = self.at[4].abs();
        let mut high = (up + (up * up + 2.0 * self.gravity * (self.at[1].abs() + reach)).sqrt()) / self.gravity + 0.1;
        high += self.drag[0] * high * high;
        let mut low = 1e-6 * high;
        if height(low) <= 0.0 {
            return None;
        }
        assert!(height(high) < 0.0);
        while high - low > f64::EPSILON * high {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if height(middle) > 0.0 { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// Tilt of the table by x, θ, ẋ and θ̇ as it senses them.
    fn law(&self, sensed: [f64; 4]) -> f64 {
        let law: f64 = -self.gains.iter().zip(sensed).map(|(gain, value)| gain * value).sum::<f64>();
        (1.0 + self.gain_error) * law + self.offset
    }

    /// Tilt of the table for a state that it senses, its angle with an error.
    fn tilt(&self, [x, _, angle, x_dot, y_dot, spin]: [f64; 6], error: f64) -> f64 {
        let angle = if self.is_point { x_dot.atan2(-y_dot) } else { angle };
        self.law([x, angle + error + self.bias, x_dot, spin])
    }

    /// Rate of that tilt as the body goes on in its flight, by differences of fourth order.
    fn tilt_rate(&self, seen: [f64; 6]) -> f64 {
        // Without drag the law of a rod is linear in time, so wide differences are exact but for rounding.
        let step = match (self.is_point, self.drag) {
            (true, _) => 2e-4,
            (false, [0.0, 0.0]) => 0.1,
            (false, _) => 1e-3,
        };
        let tilt = |steps: f64| self.tilt(Self { at: seen, ..*self }.flown(steps * step), 0.0);
        (8.0 * (tilt(1.0) - tilt(-1.0)) - (tilt(2.0) - tilt(-2.0))) / (12.0 * step)
    }

    /// Velocities after strike `n`.
    fn strike(&mut self, n: u64) {
        let [x, y, angle, x_dot, y_dot, spin] = self.at;
        let off = self.noise.and_then(|noise| noise.sensing(n)).unwrap_or_default();
        let turned = self.noise.map_or(0.0, |noise| noise.angle_error(n));
        let back = self.delay.min(self.flight_time);
        let mut seen = Self { at: self.start, ..*self }.flown(self.flight_time - back);
        let exact = seen;
        // What it senses, with errors, goes on like any flight.
        seen = [
            seen[0] + off.x,
            seen[1],
            seen[2] + turned,
            seen[3] + off.x_dot,
            seen[4] + off.y_dot,
            seen[5] + off.theta_dot,
        ];
        let mut seen_angle = exact[2];
        if self.predicts {
            seen = Self { at: seen, ..*self }.flown(back);
            seen_angle = Self { at: exact, ..*self }.flown(back)[2];
        }
        let [_, _, _, seen_x_dot, seen_y_dot, seen_spin] = seen;
        // Of a point mass the error of the angle is beside the velocity.
        let alpha = self.tilt(seen, if self.is_point { turned } else { 0.0 });
        let normal = [-alpha.sin(), alpha.cos()];
        let foot = self.foot(angle);
        let arm = foot[0] * normal[1] - foot[1] * normal[0];
        let seen_foot = self.foot(seen_angle);
        let seen_arm = seen_foot[0] * normal[1] - seen_foot[1] * normal[0];
        let speed = normal[0] * x_dot + normal[1] * y_dot + arm * spin;
        let seen_speed = normal[0] * seen_x_dot + normal[1] * seen_y_dot + seen_arm * seen_spin;
        let energy = 0.5 * seen_y_dot * seen_y_dot - self.gravity * seen_foot[1];
        let wanted = (1.0 - self.assumed) / (1.0 + self.assumed) + self.energy_gain * (self.target - energy);
        let mut table = -(1.0 + self.speed_error) * wanted * seen_speed;
        if let Some([place, depth]) = self.pivot {
            let rate = self.tilt_rate(seen);
            let contact = [x + foot[0], y + foot[1]];
            // The hinge is as high as puts the contact `depth` above it along the normal.
            let hinge = contact[1] - (depth - (contact[0] - place) * normal[0]) / normal[1];
            let from_hinge = [contact[0] - place, contact[1] - hinge];
            table += rate * (from_hinge[0] * normal[1] - from_hinge[1] * normal[0]);
        }
        let restitution = self.noise.map_or(self.restitution, |noise| noise.restitution(n, self.restitution));
        let impulse = -(1.0 + restitution) * (speed - table) / (1.0 + arm * arm / (self.rho * self.rho));
        self.at[3] += impulse * normal[0];
        self.at[4] += impulse * normal[1];
        self.at[5] += impulse * arm / (self.rho * self.rho);
    }

    /// t, x, θ, ẋ, ẏ, θ̇ just before so many contacts, or up to the last, θ of the line from contact point to centre of gravity.
    pub(crate) fn course(mut self, contacts: usize) -> Vec<[f64; 6]> {
        let lean = self.across.atan2(self.along);
        let mut t = 0.0;
        let mut course = Vec::new();
        for contact in 0..contacts {
            if contact > 0 {
                self.strike(contact as u64);
            }
            let Some(flight) = self.flight() else { break };
            t += flight;
            (self.start, self.flight_time) = (self.at, flight);
            self.at = self.flown(flight);
            let [x, _, angle, x_dot, y_dot, spin] = self.at;
            let angle = if self.is_point { x_dot.atan2(-y_dot) } else { angle - lean };
            course.push([t, x, angle, x_dot, y_dot, spin]);
        }
        course
    }
}

/// The noise of a scene, as its fields say.
fn noise(scene: &Scene) -> Option<Noise> {
    let sd = |name| scene.number(name).unwrap_or(0.0);
    let Some(Value::Integer(seed)) = scene.value(Name::Seed) else { return None };
    Some(Noise {
        angle_sd: sd(Name::AngleSd),
        x_sd: sd(Name::XSd),
        x_dot_sd: sd(Name::XDotSd),
        y_dot_sd: sd(Name::YDotSd),
        theta_dot_sd: sd(Name::ThetaDotSd),
        restitution_sd: sd(Name::RestitutionSd),
        seed,
        ..Noise::NONE
    })
}

/// Gains of state feedback: K of x, θ, ẋ, θ̇.
const GAINS: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// The draft with other numbers.
pub(crate) fn with_numbers(mut draft: Draft, values: &[(Name, f64)]) -> Draft {
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft
}

/// The draft with other words.
pub(crate) fn worded(mut draft: Draft, words: &[(Name, &'static str)]) -> Draft {
    for &(name, word) in words {
        draft.set(name, Some(Value::Choice(word))).unwrap();
    }
    draft
}

/// The paper's rod with κ = 1.1, released at 0.1 rad, with other numbers.
pub(crate) fn scene(values: &[(Name, f64)]) -> Scene {
    with(paper::scene(1.1, 0.1).draft(), values)
}

/// The scene of a draft with other numbers.
pub(crate) fn with(draft: Draft, values: &[(Name, f64)]) -> Scene {
    with_numbers(draft, values).build().unwrap()
}

/// The scene of a draft with K in place of its tilt law.
pub(crate) fn fed_back(mut draft: Draft, gains: [f64; 4]) -> Scene {
    draft.set(Name::TiltGain, None).unwrap();
    with(draft, &std::array::from_fn::<_, 4, _>(|index| (GAINS[index], gains[index])))
}

/// K that brings the bounce of the paper's rod to rest.
pub(crate) fn gains() -> [f64; 4] {
    let scene = paper::scene(1.1, 0.1);
    let place = small_deviations(&scene).unwrap().fixed_point;
    let model = upright_bounce(&scene.parameters(), place.speed, ContactRegime::Frictionless);
    design_lqr(&model, [1.0, 10.0, 0.1, 0.1], 10.0).unwrap().gain
}

/// t, x, θ, ẋ, ẏ, θ̇ at the contacts, and the ending.
pub(crate) fn states(scene: &Scene, impacts: u64) -> (Vec<[f64; 6]>, Ending) {
    let mut states = Vec::new();
    let ending = run(&mut scene.orbit().unwrap(), impacts, |contact| {
        let state = contact.state;
        states.push([contact.t, contact.x, state.theta, state.x_dot, state.y_dot, state.theta_dot]);
        true
    });
    (states, ending.unwrap())
}

/// Holds the course of a scene to its simulation, within a share of 1 and the number. Returns the number of contacts.
pub(crate) fn hold_to_simulation(course: &[[f64; 6]], scene: &Scene, within: f64) -> usize {
    let other = Rig::of(scene).course(course.len());
    for (one, other) in course.iter().zip(&other) {
        for (a, b) in one.iter().zip(other) {
            assert!((a - b).abs() < within * (1.0 + b.abs()), "{one:?}\n{other:?}\n{scene:?}");
        }
    }
    course.len().min(other.len())
}
