//! Words for a verdict: what the evidence of the physics says, in sentences with numbers.

use crate::api::stability::rig::SteadyDriftAnswer;
use equipoise_physics::analysis::boundary::{BoundaryCoefficient, period_two_angle};
use equipoise_physics::analysis::contact_regime::{
    ContactRegime, contact_regime, stick_cone, sticking_polynomial_at_one,
};
use equipoise_physics::analysis::evidence::{Balance, Course, Evidence, Judgement, SMALL_SWING, SmallRun, Swing};
use equipoise_physics::analysis::jacobian::modulus;
use equipoise_physics::analysis::linear_verdict::{AngleClass, PARABOLIC};
use equipoise_physics::analysis::losses::SettledMotion;
use equipoise_physics::analysis::nonlinear_run::NonlinearRun;
use equipoise_physics::analysis::regularity::{CHAOTIC, ChaosIndicator};
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::Y_DOT;
use equipoise_physics::analysis::small_deviations::Motion;
use equipoise_physics::analysis::swing::NoSwingForm;
use equipoise_physics::analysis::verdict::{DecidedBy, Verdict};
use equipoise_physics::numbers::rounded::rounded;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene, Value};

use crate::api::stability::verdict_name::words;

/// The verdict in words.
pub(super) fn verdict(judgement: &Judgement, run: &NonlinearRun) -> String {
    match &judgement.evidence {
        Evidence::Ensemble { survived, runs, impacts, .. } if judgement.verdict == Verdict::Random => {
            format!("random, {survived} of {runs} runs survive {impacts} bounces")
        }
        _ => words(judgement.verdict, run.impacts),
    }
}

/// The run in words.
fn outcome(run: &NonlinearRun) -> String {
    if run.ending == Ending::Completed {
        format!("this run of {} bounces came to |θ| = {} rad", run.impacts, run.max_theta)
    } else {
        format!("this run ended as `{}` at contact {}", run.ending.name(), run.impacts)
    }
}

/// The reason of a judgement of a scene and its run.
pub(super) fn reason(
    scene: &Scene,
    judgement: &Judgement,
    run: &NonlinearRun,
    chaos: Option<ChaosIndicator>,
) -> String {
    let outcome = outcome(run);
    match &judgement.evidence {
        Evidence::Ensemble { survived, runs, impacts, interval: (low, high) } => format!(
            "with noise {survived} of {runs} runs survive {impacts} bounces, so one does with a probability of {low:.3} to {high:.3} (95 %); {outcome}"
        ),
        Evidence::NoContact => format!("the release comes to no contact; {outcome}"),
        Evidence::NothingRepeats(why) => format!("{}; {outcome}", nothing_repeats(scene, why)),
        Evidence::Balances(balance) => {
            let mut reason = balanced(scene, balance, run);
            if let Some(bounces) = balance.leaves {
                reason += &format!(
                    "; but nothing brings a drift of {} m/s back, and it takes the body off the table after about {bounces} bounces",
                    balance.small.lasting_drift()
                );
            }
            if judgement.verdict == Verdict::Elliptic
                && let Some(ChaosIndicator { indicator, chaotic: true, impacts }) = chaos
            {
                reason += &format!(
                    ", but the run is chaotic (MEGNO {indicator} over {impacts} impacts, above {CHAOTIC}), so that it may still fall later"
                );
            }
            format!(
                "{reason}; {outcome}{}",
                if judgement.decided_by == DecidedBy::Nonlinear && judgement.says_bounded {
                    lost_run(scene, run)
                } else {
                    String::new()
                }
            )
        }
    }
}

/// Why a run ended although small deviations stay small; empty for one that did not.
fn lost_run(scene: &Scene, run: &NonlinearRun) -> String {
    match run.ending {
        Ending::Completed => String::new(),
        Ending::OffTable { .. } => ": the analysis of small deviations knows no ends of the table".to_owned(),
        _ => {
            let theta = scene.start().theta;
            let cone = stick_cone(&scene.with_tilt_law().model()).filter(|cone| theta.abs() > *cone);
            let beside = cone.map_or_else(String::new, |cone| {
                format!(", and theta {theta} rad outside the stick cone, |θ| up to about {cone} rad")
            });
            format!(": the start is outside the basin, or the rules of the run ended it{beside}")
        }
    }
}

/// The reason for which no bounce of a scene repeats.
fn nothing_repeats(scene: &Scene, why: &NoRepeatingBounce) -> String {
    let mut said = Vec::new();
    if scene.constant_tilt() != 0.0 {
        said.push(format!(
            "the table tilts by {} rad beside its law (table.errors, body.offset)",
            rounded(scene.constant_tilt())
        ));
    }
    if !scene.steers_energy() {
        let restitution = scene.parameters::<f64>().restitution;
        if scene.value(Name::Strike) == Some(Value::Choice("still")) {
            said.push(format!("the table stands still and restitution is {restitution}"));
        } else if scene.assumed_restitution() != restitution || scene.moves_late() {
            said.push(scene.belief());
        }
    }
    if let (Some(drag), false) = (scene.drag(), scene.steers_energy())
        && drag.linear != 0.0
    {
        said.push(format!("air.drag is {} 1/s: every flight loses energy to the air", drag.linear));
    }
    if let NoRepeatingBounce::Moves { at, change, .. } = why {
        let speed = at[Y_DOT].abs();
        let alone = why.moved().len() == 1 && change[Y_DOT] != 0.0;
        if alone {
            let loses = change[Y_DOT] > 0.0;
            said.push(format!("every bounce {} energy, so no bounce repeats", if loses { "loses" } else { "gains" }));
        }
        said.push(why.to_string());
        // Beside other changes, ẏ may come to a balance of its own.
        if alone && change[Y_DOT] > 0.0 {
            said.push(format!(
                "a bounce of {speed} m/s is lost after about {} bounces at this rate",
                (speed / change[Y_DOT]).ceil()
            ));
        }
    } else {
        said.push(why.to_string());
    }
    if let Some(SteadyDriftAnswer { theta: Some(theta), acceleration: Some(acceleration), time_on_table, .. }) =
        SteadyDriftAnswer::of(scene, Err(why))
    {
        said.push(format!(
            "the table is square to the body at {} rad, and there every strike drives it aside, at {} m/s² while the drift is slow",
            rounded(theta),
            rounded(acceleration)
        ));
        if let Some(time) = time_on_table {
            said.push(format!("from rest in the middle it leaves the table after about {} s", rounded(time)));
        }
    }
    said.join("; ")
}

/// Notes on parts of an answer that are null for a kind of scene, given its drift, whether it is driven aside and whether a bounce repeats.
pub(super) fn null_notes(scene: &Scene, drift: Option<f64>, is_driven: bool, repeats: bool) -> Option<String> {
    let model = scene.model();
    let note = match drift {
        _ if model.is_point => {
            "max_theta is of the velocity's angle; residue, rotation, boundary and drift_speed are null: a point mass has no angle of its own, and \
             its drift dies out"
        }
        _ if is_driven => "drift_speed is null: no bounce stays in place; see steady_drift",
        None if !repeats => "drift_speed is null: no bounce repeats",
        Some(_) if model.feedback().is_some() => {
            "linear.residue, linear.rotation and boundary are null, and margins have no table.tilt_gain: with feedback of theta_dot nothing circles for \
             ever"
        }
        None if model.feedback().is_some() => {
            "drift_speed, linear.residue, linear.rotation and boundary are null, and margins have no table.tilt_gain: with state feedback nothing drifts \
             or circles for ever"
        }
        _ if contact_regime(&model) == ContactRegime::Sticking => {
            "drift_speed, linear.residue, linear.rotation and boundary are null, and margins have no table.tilt_gain: the contact sticks to a table that only \
             tilts, so nothing drifts, the angle has no block of its own, and no tilt_gain balances"
        }
        Some(_) => return None,
        None if model.drag.is_some_and(|drag| drag.linear != 0.0) => {
            "drift_speed is null: the air brings every drift to that of fixed_point"
        }
        None if model.rod.tilt_gain == 1.0 => "drift_speed is null: at tilt_gain 1 the angle itself drifts off",
        None => "drift_speed is null: no drift is kept beside this bounce",
    };
    Some(note.to_owned())
}

/// The range of tilt gains that a balance takes, with the gain of the scene; empty where there is none.
fn range(scene: &Scene, balance: &Balance) -> String {
    let (lower, critical) = (balance.small.linear.lower_tilt_gain, balance.small.linear.critical_tilt_gain);
    let kappa = scene.with_tilt_law().parameters::<f64>().tilt_gain;
    if !lower.is_finite() || !critical.is_finite() {
        String::new()
    } else if kappa <= lower || kappa >= critical {
        let (side, limit) = if kappa <= lower { ("not above", lower) } else { ("not below", critical) };
        format!("tilt_gain {kappa} is {side} {limit}, so ")
    } else {
        format!("tilt_gain {kappa} is between {lower} and {critical}, so ")
    }
}

/// The eigenvalue that is silent or grows, with the motion that is known beyond the end of stability.
fn beyond(scene: &Scene, balance: &Balance) -> String {
    let (linear, judged) = (&balance.small.linear, scene.with_tilt_law());
    let model = judged.model();
    let range = range(scene, balance);
    let height = linear.energy_eigenvalue;
    let mut reason = match balance.small.motion {
        Motion::Silent(value) => match balance.boundary {
            Some(BoundaryCoefficient { coefficient }) if value < 0.0 => {
                let course = if coefficient > 0.0 { "soft" } else { "hard: every small start falls in the end" };
                format!("tilt_gain is κ_c, where eigenvalues are silent, and C = {coefficient} is {course}")
            }
            _ => format!("{range}an eigenvalue is {value}, on which the derivative of the map is silent"),
        },
        _ if height.abs() > 1.0 + PARABOLIC && linear.class != AngleClass::Hyperbolic => {
            format!("small deviations of the height grow by {height} a bounce")
        }
        _ if model.feedback().is_none() && !model.is_point && contact_regime(&model) == ContactRegime::Sticking => {
            format!(
                "the contact sticks for any friction above 0, since friction is {} and slide is `none`: the derivative there has the characteristic \
                 polynomial −4lV²/(G(l² + ρ²)) = {} < 0 at 1, so that for every tilt_gain one eigenvalue is beyond 1",
                judged.number(Name::Friction).unwrap_or_default(),
                sticking_polynomial_at_one(&model.rod, balance.small.fixed_point.speed)
            )
        }
        _ => format!("{range}small deviations grow: an eigenvalue has the modulus {}", linear.spectral_radius()),
    };
    for loss in balance.losses.iter().filter(|loss| loss.is_soft()) {
        let (name, value, bifurcation) = (loss.end.name(), loss.value, loss.bifurcation.name());
        match loss.settles {
            Some(SettledMotion::Swing(swing)) => {
                reason += &format!(
                    "; stability is lost softly, at {value} times the gains of {name} ({bifurcation}), so that a swing grows to about {swing} rad"
                );
            }
            Some(SettledMotion::Heights { heights: [low, high], .. }) => {
                reason +=
                    &format!("; stability is lost softly: bounces settle on heights of {low} m and {high} m in turn");
            }
            None => {}
        }
    }
    let is_beyond = linear.class == AngleClass::Hyperbolic && linear.critical_tilt_gain.is_finite();
    if let Some(theta) =
        period_two_angle(&model, judged.number(Name::ToppleAngle).unwrap_or_default(), &balance.small.fixed_point)
            .filter(|_| is_beyond)
    {
        reason += &format!("; beside it is the period-2 orbit at θ = ±{theta} rad");
    }
    reason
}

fn balanced(scene: &Scene, balance: &Balance, run: &NonlinearRun) -> String {
    let small = |small: &SmallRun| {
        let end = if small.survived { "stayed" } else { "left" };
        let start = if small.is_own { "this release".to_owned() } else { format!("a swing of {SMALL_SWING} rad") };
        format!("a run from {start} {end}, {} bounces and |θ| up to {} rad", small.impacts, small.max_theta)
    };
    let by_run = balance.small_run.as_ref().map_or_else(String::new, |run| format!("; {}", small(run)));
    let beside = if balance.small.drifts { "; a drift stays as it is" } else { "" };
    let range = range(scene, balance);
    let near = match (balance.resonance, &balance.swing) {
        (Some(resonance), _) => format!(
            "; the swing is wide for its distance from the strong resonance of order {}, where no normal form tells whether it leaves",
            resonance.order
        ),
        (None, Some(Ok(swing))) if swing.is_wide() => format!(
            "; the swing of this release changes the speed of the bounce by {} of it, and no normal form tells whether it leaves",
            swing.of_speed
        ),
        _ => String::new(),
    };
    match (balance.small.motion, &balance.swing) {
        (Motion::DiesOut, _) => format!(
            "{range}small deviations die out: the largest modulus of an eigenvalue beside what is kept is {}{beside}{by_run}",
            beside_neutral(balance)
        ),
        (Motion::Grows(_) | Motion::Silent(_), _) => format!("{}{by_run}", beyond(scene, balance)),
        (Motion::Circles(_), None) => {
            format!("{range}small deviations circle, since strikes keep the energy{near}{by_run}")
        }
        (Motion::Circles(_), Some(Ok(swing))) => {
            format!("{range}small deviations circle in first order; {}{near}{by_run}", course(swing, run))
        }
        (Motion::Circles(_), Some(Err(why))) => {
            let why = match why {
                NoSwingForm::Resonance => "the rotation is a third of a turn, a strong resonance",
                NoSwingForm::Double => "the eigenvalue is double",
                NoSwingForm::NoDerivative => "the map has no third derivative there",
            };
            format!("{range}small deviations circle, and {why}{by_run}")
        }
    }
}

/// Largest modulus below 1.
fn beside_neutral(balance: &Balance) -> f64 {
    let values = balance.small.linear.eigenvalues.iter().copied().map(modulus);
    values.filter(|value| *value < 1.0).fold(0.0, f64::max)
}

/// The course of a swing to third order.
fn course(swing: &Swing, run: &NonlinearRun) -> String {
    let Swing { form, amplitude, shifts, .. } = swing;
    let growth = form.growth;
    let shift = shifts.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let pumps =
        format!("to second order a swing of {amplitude} rad, as here, changes a kept quantity by {shift} a bounce");
    let course = match form.course() {
        Course::Circles => "to third order a swing neither grows nor dies out".to_owned(),
        Course::Grows => format!(
            "to third order the amplitude obeys dA/dn = ℓA³ with ℓ = {growth} per bounce and rad², so a swing of {amplitude} rad, as here, grows, and \
             leaves upright after about {} bounces",
            (0.5 / (growth * amplitude * amplitude)).ceil()
        ),
        Course::DiesOut => {
            let basin =
                if run.ending == Ending::Completed { "" } else { ", though not from this start, outside the basin" };
            format!(
                "to third order the amplitude obeys dA/dn = ℓA³ with ℓ = {growth} per bounce and rad², so a swing of {amplitude} rad, as here, dies \
                 out{basin}"
            )
        }
        Course::Pumps => format!("{pumps}, which makes it grow"),
        Course::Settles => format!("{pumps}, which makes it die out"),
        Course::Shifts => format!("{pumps}, and nothing brings that back"),
    };
    match swing.farther.filter(|farther| *farther != form.course()) {
        None => course,
        Some(farther) => {
            let then = match farther {
                Course::Circles => "circles",
                Course::Grows | Course::Pumps => "grows",
                Course::DiesOut | Course::Settles => "dies out",
                Course::Shifts => "changes a kept quantity, and nothing brings that back",
            };
            format!("{course}; but a drift takes the body along the table, to where a swing {then}")
        }
    }
}
