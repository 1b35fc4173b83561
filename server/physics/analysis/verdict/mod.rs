//! The verdict on a scene: what the linear analysis, the normal forms and the run say, weighed against each other.
//!
//! Not here: how any of them comes about ([`crate::analysis::linear_verdict`], [`crate::analysis::lyapunov`], [`crate::analysis::loss_of_stability`], [`crate::analysis::regularity`]).

mod air;
mod kinds;

use crate::analysis::boundary::{BoundaryCoefficient, boundary_coefficient, period_two_angle, underived};
use crate::analysis::contact_regime::{
    ContactRegime, DraggedAngle, contact_regime, dragging_turn, stick_cone, sticking_polynomial_at_one,
};
use crate::analysis::fixed_point::{FixedPoint, drift_speed};
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC};
use crate::analysis::loss_of_stability::{CriticalParameter, SettledMotion, StabilityLoss, losses};
use crate::analysis::lyapunov::{LyapunovCoefficient, SwingFate, lyapunov_coefficient};
use crate::analysis::nonlinear_run::NonlinearRun;
use crate::analysis::regularity::{CHAOTIC, ChaosIndicator};
use crate::analysis::swing_pump::{SwingPump, swing_pump};
use crate::control::bounce_model::{ANGLE, ClosedLoop, STATE};
use crate::map::strike::EnergyFeedback;
use crate::run::ending::Ending;
use crate::scene::Scene;
use air::assess_in_air;
pub use kinds::{Assessment, DecidedBy, Verdict};

/// The evidence of second and third derivatives of the map about a fixed point.
#[derive(Clone, Debug, PartialEq)]
pub struct HigherOrder {
    /// Boundary coefficient at κ_c.
    pub boundary: Option<BoundaryCoefficient>,
    /// First Lyapunov coefficient of a swing about the fixed point, or why there is none.
    pub lyapunov: Result<LyapunovCoefficient, String>,
    /// Loss of stability at each end of the linear verdict for which it is derived.
    pub losses: Vec<StabilityLoss>,
    /// Reasons why it is not derived for others.
    pub notes: Vec<String>,
}

impl HigherOrder {
    /// Collects them for a scene.
    pub fn of(scene: &Scene, fixed_point: &FixedPoint, linear: &LinearVerdict) -> Self {
        let scene = &scene.with_tilt_law();
        let boundary = boundary_coefficient(&scene.model(), fixed_point);
        let (losses, notes) = losses(scene, fixed_point, linear, boundary);
        Self { boundary, lyapunov: lyapunov_coefficient(scene, fixed_point, linear), losses, notes }
    }

    /// The soft loss at an end, and where the scene settles beyond it.
    pub(crate) fn settled_beyond(&self, end: CriticalParameter) -> Option<(&StabilityLoss, SettledMotion)> {
        let loss = self.losses.iter().find(|loss| loss.end == end && loss.is_soft() && loss.settles.is_some())?;
        Some((loss, loss.settles?))
    }
}

/// Weighs the linear verdict, the higher orders, the run and how regular it is against each other. A run that ended is no balance, whatever its
/// small deviations do.
pub fn assess(
    scene: &Scene,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    higher: &HigherOrder,
    run: &NonlinearRun,
    chaos: Option<ChaosIndicator>,
) -> Assessment {
    let found = weigh(scene, fixed_point, linear, higher, run, chaos);
    match found.verdict {
        _ if run.ending == Ending::Completed => found,
        Verdict::WeaklyUnstable => Assessment { verdict: Verdict::Unstable, ..found },
        Verdict::WeaklyAttracting => {
            Assessment { verdict: Verdict::Unstable, decided_by: DecidedBy::Nonlinear, ..found }
        }
        _ => found,
    }
}

fn weigh(
    scene: &Scene,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    higher: &HigherOrder,
    run: &NonlinearRun,
    chaos: Option<ChaosIndicator>,
) -> Assessment {
    let scene = &scene.with_tilt_law();
    let survived = run.ending == Ending::Completed;
    let agree = linear.says_bounded() == survived;
    let assessment = |verdict, decided_by, reason| Assessment { verdict, decided_by, agree, reason };
    let start = scene.start();
    let undisturbed = start.theta == 0.0 && start.theta_dot == 0.0;
    let kappa = scene.tilt_gain;
    let model = scene.model();
    let critical = linear.critical_tilt_gain;
    let boundary = higher.boundary;
    let fell = format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts);
    if let Some(found) = assess_in_air(scene, linear, run) {
        return found;
    }
    if linear.energy_eigenvalue.abs() > 1.0 + PARABOLIC {
        let deviations = format!("deviations of the height grow by {} a bounce", linear.energy_eigenvalue);
        let gain = scene.energy_gain;
        let grows = if linear.upper_energy_gain.is_finite() {
            format!("energy_gain is {gain} s²/m² and must be between 0 and {}: {deviations}", linear.upper_energy_gain)
        } else {
            format!("energy_gain is {gain} s²/m², and with the delay {deviations}")
        };
        let Some((_, SettledMotion::Heights { heights: [low, high], angle_bounded })) =
            higher.settled_beyond(CriticalParameter::EnergyGain)
        else {
            return assessment(Verdict::Unstable, DecidedBy::Linear, grows);
        };
        let softly = format!("{grows}, softly: bounces settle on heights of {low} m and {high} m in turn");
        return match (angle_bounded, survived) {
            (true, true) => {
                let reason = format!("{softly}, on which the angle stays bounded, and the run survived");
                assessment(Verdict::BoundedBeyondBoundary, DecidedBy::Boundary, reason)
            }
            (true, false) => assessment(Verdict::Unstable, DecidedBy::Nonlinear, format!("{softly}, but {fell}")),
            (false, _) => {
                let reason = format!("{softly}, on which the angle does not stay bounded");
                assessment(Verdict::Unstable, DecidedBy::Linear, reason)
            }
        };
    }
    if let Some(closed) = &linear.closed_loop {
        return assess_feedback(closed, higher, run);
    }
    if let Some(found) = assess_turning(scene, fixed_point, linear, run) {
        return found;
    }
    if let Ok(found) = &higher.lyapunov
        && found.kind != SwingFate::Neutral
    {
        return assess_swing(scene, found, run, agree);
    }
    if !survived && linear.class != AngleClass::Hyperbolic && linear.class != AngleClass::Parabolic {
        let cone = stick_cone(&model).filter(|cone| start.theta.abs() > *cone).map_or_else(String::new, |cone| {
            format!(", and theta {} rad outside the stick cone, |θ| up to about {cone} rad", start.theta)
        });
        let why = if left_table(run) { NO_ENDS.to_owned() } else { format!("the start is outside the basin{cone}") };
        let reason = format!("{fell}, although the linear analysis is stable: {why}");
        return assessment(Verdict::Unstable, DecidedBy::Nonlinear, reason);
    }
    if contact_regime(&model) == ContactRegime::Sticking {
        let largest = linear.eigenvalues.iter().map(|value| value.re).fold(1.0, f64::max);
        let reason = format!(
            "friction is {} and slide is `none`: at the fixed point the contact sticks for any friction above 0, and the \
             derivative there has the characteristic polynomial −4lV²/(G(l² + ρ²)) = {} < 0 at 1, so for every tilt_gain one \
             eigenvalue is beyond 1 ({largest} here); {}",
            scene.friction,
            sticking_polynomial_at_one(&model.rod, fixed_point.speed),
            if survived { "this run has not left yet" } else { fell.as_str() }
        );
        return assessment(Verdict::Unstable, DecidedBy::Linear, reason);
    }
    match linear.class {
        AngleClass::Attracting => {
            let reason = format!("the angle of the velocity shrinks by {} a bounce (eq. 4)", 1.0 - 2.0 * kappa);
            assessment(Verdict::StableInPlace, DecidedBy::Linear, reason)
        }
        AngleClass::Elliptic => {
            let mut reason = format!(
                "tilt_gain {kappa} is between {} and {critical}, so small deviations circle, and the run survived",
                linear.lower_tilt_gain
            );
            if higher.lyapunov.is_ok() {
                reason += "; to third order a swing neither grows nor dies out, because the table holds the energy of the swing too";
            }
            if let Some(ChaosIndicator { indicator, chaotic: true, impacts }) = chaos {
                reason += &format!(
                    ", but it is chaotic (MEGNO {indicator} over {impacts} impacts, above {CHAOTIC}), so that it may still \
                     fall later"
                );
            }
            assessment(Verdict::Elliptic, DecidedBy::Linear, reason)
        }
        AngleClass::Parabolic if kappa > 0.5 * (1.0 + critical) => match boundary {
            Some(BoundaryCoefficient { coefficient }) if coefficient > 0.0 && survived => assessment(
                Verdict::BoundedBeyondBoundary,
                DecidedBy::Boundary,
                format!(
                    "tilt_gain is κ_c, where eigenvalues are silent; C = {coefficient} > 0 is soft, and the run survived"
                ),
            ),
            Some(BoundaryCoefficient { coefficient }) if coefficient > 0.0 => assessment(
                Verdict::Unstable,
                DecidedBy::Nonlinear,
                format!("tilt_gain is κ_c and C = {coefficient} > 0 is soft for small starts, but {fell}"),
            ),
            None => assessment(
                if survived { Verdict::BoundedBeyondBoundary } else { Verdict::Unstable },
                DecidedBy::Nonlinear,
                format!(
                    "tilt_gain is κ_c, where eigenvalues are silent, and C is not derived {}; {}",
                    underived(&model, fixed_point).unwrap_or("here"),
                    if survived { "the run survived" } else { fell.as_str() }
                ),
            ),
            Some(_) => assessment(
                Verdict::Unstable,
                DecidedBy::Boundary,
                format!(
                    "tilt_gain is κ_c, where eigenvalues are silent; C = {} is not positive: hard, every small start \
                     falls in the end",
                    boundary.map_or(0.0, |boundary| boundary.coefficient)
                ),
            ),
        },
        AngleClass::Parabolic => assessment(
            Verdict::Unstable,
            DecidedBy::Linear,
            "tilt_gain is 1, where the angle drifts off at a constant rate".to_owned(),
        ),
        AngleClass::Hyperbolic if survived && !undisturbed && kappa > critical => assessment(
            Verdict::BoundedBeyondBoundary,
            DecidedBy::Nonlinear,
            format!(
                "tilt_gain {kappa} is beyond κ_c = {critical}, yet the run of {} bounces stayed within |θ| ≤ {} rad{}{}",
                run.impacts,
                run.max_theta,
                period_two_angle(&model, scene.topple_angle, fixed_point)
                    .map_or_else(String::new, |theta| format!(", around the period-2 orbit at θ = ±{theta} rad")),
                boundary.filter(|boundary| boundary.coefficient <= 0.0).map_or_else(String::new, |boundary| format!(
                    "; C = {} is not positive, so stability is lost hard and a longer run may still fall",
                    boundary.coefficient
                ))
            ),
        ),
        AngleClass::Hyperbolic => {
            let side = if kappa < linear.lower_tilt_gain { "below" } else { "beyond" };
            let limit = if kappa < linear.lower_tilt_gain { linear.lower_tilt_gain } else { critical };
            let shown = if survived { "this run has not left yet" } else { fell.as_str() };
            let reason = format!("tilt_gain {kappa} is {side} {limit}, so small deviations grow; {shown}");
            assessment(Verdict::Unstable, DecidedBy::Linear, reason)
        }
    }
}

/// The verdict on a tilt gain with a turning table, where the contact does not stick to a table that only tilts; `None` for other
/// scenes.
fn assess_turning(
    scene: &Scene,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    run: &NonlinearRun,
) -> Option<Assessment> {
    let turning = scene.acting_turn()?;
    let model = scene.model();
    if model.feedback().is_some() || contact_regime(&model) == ContactRegime::Sticking {
        return None;
    }
    let survived = run.ending == Ending::Completed;
    let agree = linear.says_bounded() == survived;
    let fell = format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts);
    let outcome = if survived { format!("this run of {} bounces has not left yet", run.impacts) } else { fell.clone() };
    let (kappa, critical) = (scene.tilt_gain, linear.critical_tilt_gain);
    let assessment = |verdict, decided_by, reason| Some(Assessment { verdict, decided_by, agree, reason });
    if dragging_turn(&model).is_some() {
        let depth = turning.depth;
        let DraggedAngle { determinant, .. } = DraggedAngle::new(&model.rod, fixed_point.speed, depth);
        let about = format!(
            "the table turns about a pivot {depth} m below its surface and drags the contact along: the angle has determinant {determinant}"
        );
        return match (linear.class, survived) {
            (AngleClass::Attracting, true) => assessment(
                Verdict::StableDrifting,
                DecidedBy::Linear,
                format!(
                    "{about}, and tilt_gain {kappa} is between 1 and {critical}, so small deviations of the angle die out beside a drift"
                ),
            ),
            (AngleClass::Attracting, false) => assessment(
                Verdict::Unstable,
                DecidedBy::Nonlinear,
                format!(
                    "{fell}, although small deviations of the angle die out ({about}): the start is outside the basin, or the table has ends"
                ),
            ),
            (AngleClass::Elliptic | AngleClass::Parabolic | AngleClass::Hyperbolic, _) => {
                let range = if critical > 1.0 {
                    format!("balance takes a tilt_gain between 1 and {critical}, and it is {kappa}")
                } else {
                    "no tilt_gain balances".to_owned()
                };
                assessment(Verdict::Unstable, DecidedBy::Linear, format!("{about}; {range}; {outcome}"))
            }
        };
    }
    let Some(SwingPump { swing, distance, energy, impacts }) = swing_pump(scene, fixed_point, linear) else {
        let reason = format!(
            "tilt_gain {kappa} is not between {} and {critical}, so small deviations do not circle, and the table strikes harder or softer as it \
             turns; {outcome}",
            linear.lower_tilt_gain
        );
        return assessment(Verdict::Unstable, DecidedBy::Linear, reason);
    };
    let course = impacts.map_or_else(
        || if energy < 0.0 { "the bounce loses its height" } else { "any swing would change its height" }.to_owned(),
        |impacts| format!("the bounce grows to the height at which tilt_gain is critical, after about {impacts} bounces at this rate"),
    );
    let drift = drift_speed(scene).unwrap_or(0.0);
    let beside = if drift.abs() > PARABOLIC * fixed_point.speed {
        format!("; a drift of {drift} m/s takes the body farther from the pivot")
    } else {
        String::new()
    };
    let reason = format!(
        "in first order the angle circles, since tilt_gain {kappa} is between {} and {critical}; but the surface of the turning table strikes in step \
         with the swing: in second order a swing of {swing} rad, as here, at {distance} m from the pivot, changes the energy by {energy} m²/s² a bounce, and \
         {course}{beside}; {outcome}",
        linear.lower_tilt_gain
    );
    assessment(Verdict::WeaklyUnstable, DecidedBy::Lyapunov, reason)
}

/// Reason for which a run left its table although the linear analysis is stable.
const NO_ENDS: &str = "it knows no ends of the table";

/// Tells whether a run ended beyond an end of the table.
fn left_table(run: &NonlinearRun) -> bool {
    matches!(run.ending, Ending::OffTable { .. })
}

/// The verdict where the swing grows or dies out in third order.
fn assess_swing(scene: &Scene, found: &LyapunovCoefficient, run: &NonlinearRun, agree: bool) -> Assessment {
    let LyapunovCoefficient { coefficient, amplitude, .. } = found;
    let (verdict, course) = match found.escape_impacts() {
        Some(impacts) => (Verdict::WeaklyUnstable, format!("grows, and leaves upright after about {impacts} bounces")),
        None if found.kind == SwingFate::Repelling => (Verdict::WeaklyUnstable, "would grow".to_owned()),
        None => (Verdict::WeaklyAttracting, "dies out".to_owned()),
    };
    let outcome = match (run.ending == Ending::Completed, verdict) {
        (true, _) => format!("this run of {} bounces came to |θ| = {} rad", run.impacts, run.max_theta),
        (false, Verdict::WeaklyAttracting) => format!(
            "this run ended as `{}` at contact {}: its start is outside the basin",
            run.ending.name(),
            run.impacts
        ),
        (false, _) => format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts),
    };
    let law = match scene.energy_feedback {
        EnergyFeedback::Vertical | EnergyFeedback::Total => format!("energy_gain {} s²/m²", scene.energy_gain),
        EnergyFeedback::OneStrike => "energy_law `one_strike` and a wrong assumed_restitution".to_owned(),
    };
    let reason = format!(
        "with {law} the angle circles in first order only: to third order the amplitude obeys dA/dn = ℓA³ with \
         ℓ = {coefficient} per bounce and rad², so a swing of {amplitude} rad, as here, {course}; {outcome}",
    );
    Assessment { verdict, decided_by: DecidedBy::Lyapunov, agree, reason }
}

/// Tells whether a law with feedback is stable in place, by its closed loop, its normal form and a run.
fn assess_feedback(closed: &ClosedLoop, higher: &HigherOrder, run: &NonlinearRun) -> Assessment {
    let survived = run.ending == Ending::Completed;
    let (stable, radius) = (closed.is_stable(), closed.spectral_radius);
    let fell = format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts);
    let states = closed.eigenvalues.len();
    let drifts = states == ANGLE.len();
    let what = if states == STATE.len() {
        "x, theta, x_dot and theta_dot"
    } else if drifts {
        "theta and theta_dot"
    } else {
        "theta, x_dot and theta_dot"
    };
    let beside = if drifts { "; neither x nor x_dot is fed back, so a drift stays as it is" } else { "" };
    let (verdict, decided_by, reason) = match (stable, survived) {
        (true, true) => (
            if drifts { Verdict::StableDrifting } else { Verdict::StableInPlace },
            DecidedBy::Linear,
            format!("every small deviation of {what} dies out: the closed loop has spectral radius {radius}{beside}"),
        ),
        (true, false) => (
            Verdict::Unstable,
            DecidedBy::Nonlinear,
            format!(
                "{fell}, although the closed loop has spectral radius {radius}: {}",
                if left_table(run) { NO_ENDS } else { "the start is outside the basin" }
            ),
        ),
        (false, _) => {
            let grows = format!(
                "a small deviation does not die out: the closed loop has spectral radius {radius}, which must be below 1"
            );
            match (higher.settled_beyond(CriticalParameter::FeedbackFactor), survived) {
                (Some((loss, SettledMotion::Swing(swing))), true) => (
                    Verdict::BoundedBeyondBoundary,
                    DecidedBy::Boundary,
                    format!(
                        "{grows}; but stability is lost softly, at {} times these gains ({}), so that a swing grows to about \
                         {swing} rad and no further; this run came to {} rad",
                        loss.value,
                        loss.bifurcation.name(),
                        run.max_theta
                    ),
                ),
                (_, true) => (Verdict::Unstable, DecidedBy::Linear, format!("{grows}; this run has not left yet")),
                (_, false) => (Verdict::Unstable, DecidedBy::Linear, format!("{grows}; {fell}")),
            }
        }
    };
    Assessment { verdict, decided_by, agree: stable == survived, reason }
}
