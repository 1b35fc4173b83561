//! Restitution that the strikes of a plan have shown.
//!
//! A table that moves as planned gives the impulse P = (1 + e)J with a J that does not depend on the restitution e. Between two contacts the
//! energy of the centre of gravity is kept, so that its velocity after the first one follows from what is seen at the second one.

use super::bounce::{BouncingRod, Node};
use crate::body::PreImpact;
use crate::numbers::trig;

/// Difference from the belief below which strikes are taken to confirm it: noise of rounding, not of the contact.
const CONFIRMED: f64 = 1e-6;

/// A strike that was aimed, until the next contact shows what it did.
#[derive(Clone, Copy, Debug)]
struct AimedStrike {
    /// Height of the centre of gravity, m.
    height: f64,
    /// ẏ before, m/s.
    y_dot: f64,
    /// Change of ẏ for each unit of 1 + e, m/s.
    unit: f64,
}

/// Least squares of 1 + e over the strikes so far; strong strikes weigh more.
#[derive(Clone, Copy, Debug, Default)]
pub struct LearnedRestitution {
    /// ΣJ², m²/s².
    squares: f64,
    /// ΣJP, m²/s².
    products: f64,
    last: Option<AimedStrike>,
}

impl LearnedRestitution {
    /// Remembers a strike of `body` at the tilt `alpha` (rad) with the height ratio `ratio`.
    pub fn aimed(&mut self, body: &BouncingRod, coming: &PreImpact, alpha: f64, ratio: f64) {
        let node = Node { x: coming.x, state: coming.state };
        self.last = body.aimed(&node, alpha, ratio).ok().map(|(_, strike)| AimedStrike {
            height: height(body, coming),
            y_dot: coming.state.y_dot,
            unit: (strike.after.y_dot - coming.state.y_dot) / (1.0 + body.rod.restitution),
        });
    }

    /// The restitution that the strikes have shown up to a coming contact, if it is not that of `body`.
    pub fn seen(&mut self, body: &BouncingRod, coming: &PreImpact) -> Option<f64> {
        let AimedStrike { height: from, y_dot, unit } = self.last.take()?;
        let squared = coming.state.y_dot * coming.state.y_dot + 2.0 * body.rod.gravity * (height(body, coming) - from);
        let change = squared.max(0.0).sqrt() - y_dot;
        self.squares += unit * unit;
        self.products += unit * change;
        let shown = self.products / self.squares - 1.0;
        // A sum that is not a number shows nothing.
        ((shown - body.rod.restitution).abs() > CONFIRMED).then_some(shown.clamp(0.0, 1.0))
    }
}

/// Height of the centre of gravity at a contact, m.
fn height(body: &BouncingRod, coming: &PreImpact) -> f64 {
    let (_, cos_theta) = trig::sin_cos(coming.state.theta);
    coming.clearance + body.rod.contact_distance * cos_theta
}
