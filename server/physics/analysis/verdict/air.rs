//! The verdict on a bounce in air that drags the body.

use super::kinds::{Assessment, DecidedBy, Verdict};
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC};
use crate::analysis::nonlinear_run::NonlinearRun;
use crate::map::flight::AirDrag;
use crate::run::ending::Ending;
use crate::scene::Scene;

/// The verdict on a scene in air, by its linear verdict and its run; `None` without drag, and with state feedback of a height that holds, which
/// are judged as elsewhere.
pub(super) fn assess_in_air(scene: &Scene, linear: &LinearVerdict, run: &NonlinearRun) -> Option<Assessment> {
    let AirDrag { linear: drag, rotational } = scene.drag()?;
    let survived = run.ending == Ending::Completed;
    let agree = linear.says_bounded() == survived;
    let assessment = |verdict, decided_by, reason| Some(Assessment { verdict, decided_by, agree, reason });
    let fell = format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts);
    let outcome = if survived { format!("this run of {} bounces has not left yet", run.impacts) } else { fell.clone() };
    let height = linear.energy_eigenvalue;
    if height.abs() > 1.0 + PARABOLIC {
        let reason = format!("in air deviations of the height grow by {height} a bounce; {outcome}");
        return assessment(Verdict::Unstable, DecidedBy::Linear, reason);
    }
    if linear.closed_loop.is_some() {
        return None;
    }
    let (kappa, critical) = (scene.parameters::<f64>().tilt_gain, linear.critical_tilt_gain);
    let within = format!("tilt_gain {kappa} is between 1 and {critical}");
    let outside = "the start is outside the basin, or the table has ends";
    let start = scene.start();
    let undisturbed = start.theta == 0.0 && start.theta_dot == 0.0;
    match linear.class {
        AngleClass::Attracting if survived => {
            let verdict = if drag == 0.0 { Verdict::StableDrifting } else { Verdict::StableInPlace };
            let place = if drag == 0.0 { "beside a drift that stays" } else { "and so does the drift" };
            let reason = format!(
                "the air takes {rotational} 1/s of the spin, and {within}: small deviations of the angle die out, {place}"
            );
            assessment(verdict, DecidedBy::Linear, reason)
        }
        AngleClass::Attracting => {
            let reason =
                format!("{fell}, although {within} and small deviations of the angle die out in air: {outside}");
            assessment(Verdict::Unstable, DecidedBy::Nonlinear, reason)
        }
        AngleClass::Elliptic if survived => {
            let reason = format!(
                "{within}, so small deviations circle, since the air takes none of the spin, and the run survived; whether a swing grows or dies \
                 out in third order is not derived in air"
            );
            assessment(Verdict::Elliptic, DecidedBy::Linear, reason)
        }
        AngleClass::Elliptic => {
            let reason = format!(
                "{fell}, although {within} and small deviations circle in air: {outside}, or swings grow in third order, which is not derived"
            );
            assessment(Verdict::Unstable, DecidedBy::Nonlinear, reason)
        }
        AngleClass::Parabolic | AngleClass::Hyperbolic if survived && !undisturbed && kappa > critical => {
            let reason = format!(
                "tilt_gain {kappa} is beyond {critical}, yet the run of {} bounces stayed within |θ| ≤ {} rad",
                run.impacts, run.max_theta
            );
            assessment(Verdict::BoundedBeyondBoundary, DecidedBy::Nonlinear, reason)
        }
        AngleClass::Parabolic | AngleClass::Hyperbolic => {
            let reason =
                format!("in air balance takes a tilt_gain between 1 and {critical}, and it is {kappa}; {outcome}");
            assessment(Verdict::Unstable, DecidedBy::Linear, reason)
        }
    }
}
