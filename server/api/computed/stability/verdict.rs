//! A verdict in answers: its code for programs, its words and numbers, and the effects of the constant errors of a rig and of a turning table.

use std::f64::consts::FRAC_PI_2;

use equipoise_physics::analysis::boundary::period_two_angle;
use equipoise_physics::analysis::contact_regime::{
    ContactRegime, contact_regime, stick_cone, sticking_polynomial_at_one,
};
use equipoise_physics::analysis::evidence::{
    Balance, Course, Evidence, Judgement, NOISY_IMPACTS, NOISY_RUNS, SMALL_GROWING, SMALL_SWING, SmallRun, Swing,
};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::linear_verdict::{AngleClass, PARABOLIC};
use equipoise_physics::analysis::losses::SettledMotion;
use equipoise_physics::analysis::nonlinear_run::NonlinearRun;
use equipoise_physics::analysis::regularity::{CHAOTIC, ChaosIndicator};
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, SPIN, X_DOT, Y_DOT};
use equipoise_physics::analysis::small_deviations::{Motion, SmallDeviations, small_deviations};
use equipoise_physics::analysis::swing::NoSwingForm;
use equipoise_physics::analysis::verdict::{DecidedBy, Verdict};
use equipoise_physics::numbers::rounded::rounded;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::model_words::belief;
use crate::words;

words! {
    /// Code of a verdict on this setting and this release, from the most stable to the least. A run that ended is `unstable`, whatever small
    /// deviations do; `reason` and `lyapunov` say what those do. `stable_in_place`: a small deviation dies out. `stable_drifting`: a small
    /// deviation of the angle dies out, and a drift stays. `weakly_attracting`: the angle circles in first order, and a swing dies out in third.
    /// `elliptic`: the angle circles, and the run did for as long as it was watched. `bounded_beyond_boundary`: at or beyond an end of the
    /// linear verdict, yet bounded over 20,000 bounces. `weakly_unstable`: the angle circles in first order, and every swing grows in a higher
    /// one. `random`: with noise, the run survived, and others do with the probability in `reason`. `unstable`: the body falls, or would fall
    /// from a slightly different start, or a drift takes it off its table.
    pub VerdictCode = CODES;

    /// The analysis that decided. `boundary`: the way stability is lost at an end of the linear verdict (`loss_of_stability`). `fixed_point`: no
    /// bounce repeats, or a drift leaves the table. `ensemble`: runs with noise.
    pub VerdictDecidedBy = DecidedBy::ALL.map(DecidedBy::name);
}

/// Pattern of a verdict in words.
const VERDICT: &str = "^(stable in place|stable, drifting|unstable|(elliptic|weakly attracting|weakly unstable|bounded beyond the boundary), [0-9]+ bounces survived|random, [0-9]+ of [0-9]+ runs survive [0-9]+ bounces)$";

/// A verdict.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Verdict")]
pub struct VerdictAnswer {
    /// The verdict for programs.
    #[schemars(with = "VerdictCode")]
    pub(super) code: &'static str,
    /// The verdict in words. A number in it is how many bounces the run was watched for, and with noise the runs of an ensemble that survive.
    #[schemars(extend("pattern" = VERDICT))]
    pub(super) text: String,
    #[schemars(with = "VerdictDecidedBy")]
    pub(super) decided_by: &'static str,
    /// One sentence, with numbers.
    pub reason: String,
}

/// The verdict in words, with the number of bounces of the run that it rests on.
pub(super) fn words(verdict: Verdict, bounces: u64) -> String {
    let name = verdict.name();
    match verdict {
        Verdict::StableInPlace | Verdict::StableDrifting | Verdict::Random | Verdict::Unstable => name.to_owned(),
        Verdict::WeaklyAttracting | Verdict::WeaklyUnstable | Verdict::Elliptic | Verdict::BoundedBeyondBoundary => {
            format!("{name}, {bounces} bounces survived")
        }
    }
}

/// Code of a verdict, whatever its run was.
pub const fn code(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::StableInPlace => "stable_in_place",
        Verdict::StableDrifting => "stable_drifting",
        Verdict::Elliptic => "elliptic",
        Verdict::WeaklyAttracting => "weakly_attracting",
        Verdict::WeaklyUnstable => "weakly_unstable",
        Verdict::BoundedBeyondBoundary => "bounded_beyond_boundary",
        Verdict::Random => "random",
        Verdict::Unstable => "unstable",
    }
}

/// The codes of all verdicts, from the most stable to the least.
pub const CODES: [&str; 8] = [
    code(Verdict::StableInPlace),
    code(Verdict::StableDrifting),
    code(Verdict::WeaklyAttracting),
    code(Verdict::Elliptic),
    code(Verdict::BoundedBeyondBoundary),
    code(Verdict::WeaklyUnstable),
    code(Verdict::Random),
    code(Verdict::Unstable),
];

/// The verdict in words.
pub(super) fn verdict(judgement: &Judgement, run: &NonlinearRun) -> String {
    match &judgement.evidence {
        Evidence::Ensemble { survived, .. } if judgement.verdict == Verdict::Random => {
            format!("random, {survived} of {NOISY_RUNS} runs survive {NOISY_IMPACTS} bounces")
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
        Evidence::Ensemble { survived, interval: (low, high), .. } => format!(
            "with noise {survived} of {NOISY_RUNS} runs survive {NOISY_IMPACTS} bounces, so one does with a probability of {low:.3} to {high:.3} (95 %); {outcome}"
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
pub(crate) fn nothing_repeats(scene: &Scene, why: &NoRepeatingBounce) -> String {
    let mut said = Vec::new();
    if scene.running_model().constant_tilt != 0.0 {
        said.push(format!(
            "the table tilts by {} rad beside its law (table.errors, body.offset)",
            rounded(scene.running_model().constant_tilt)
        ));
    }
    if !scene.steers_energy() {
        let restitution = scene.parameters::<f64>().restitution;
        if scene.value(Name::Strike) == Some(Value::Choice("still")) {
            said.push(format!("the table stands still and restitution is {restitution}"));
        } else if scene.assumed_restitution() != restitution || scene.moves_late() {
            said.push(belief(scene));
        }
    }
    if let (Some(drag), false) = (scene.running_model().drag, scene.steers_energy())
        && drag.linear != 0.0
    {
        said.push(format!("air.drag is {} 1/s: every flight loses energy to the air", drag.linear));
    }
    if let NoRepeatingBounce::Moves { at, change, .. } = why {
        let speed = at[Y_DOT].abs();
        let alone = why.moved().len() == 1 && why.moves(Y_DOT);
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
            Some(coefficient) if value < 0.0 => {
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
        let end = match (small.survived, small.rests) {
            (true, _) => "stayed",
            (false, true) => "came to rest",
            (false, false) => "left",
        };
        let start = match (small.is_own, small.growing) {
            (true, _) => "this release".to_owned(),
            (false, [0.0, 0.0]) => format!("a swing of {SMALL_SWING} rad"),
            (false, _) => format!("a deviation of {SMALL_GROWING} of the bounce speed"),
        };
        let still = if small.survived && balance.grows_on() { ", and it still grew" } else { "" };
        format!("a run from {start} {end}, {} bounces and |θ| up to {} rad{still}", small.impacts, small.max_theta())
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
            balance.small.slowest()
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

/// The course of a swing to third order.
fn course(swing: &Swing, run: &NonlinearRun) -> String {
    let Swing { form, amplitude, shifts, .. } = swing;
    let growth = form.growth;
    let shift = shifts.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let pumps =
        format!("to second order a swing of {amplitude} rad, as here, changes a kept quantity by {shift} a bounce");
    let course = match swing.course_here() {
        Course::Circles => "to third order a swing neither grows nor dies out".to_owned(),
        Course::Grows => {
            let grows = match swing.escape_bounces() {
                Some(bounces) => format!(
                    "so a swing of {amplitude} rad, as here, grows, and leaves upright after about {} bounces",
                    bounces.ceil()
                ),
                None => "so every swing grows, however small; this release has none".to_owned(),
            };
            format!("to third order the amplitude obeys dA/dn = ℓA³ with ℓ = {growth} per bounce and rad², {grows}")
        }
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
        Course::Locks => {
            "at a quarter turn a swing locks to the bounces, and to third order it grows, however small".to_owned()
        }
    };
    match swing.farther.filter(|farther| *farther != form.course()) {
        None => course,
        Some(farther) => {
            let then = match farther {
                Course::Circles => "circles",
                Course::Grows | Course::Pumps | Course::Locks => "grows",
                Course::DiesOut | Course::Settles => "dies out",
                Course::Shifts => "changes a kept quantity, and nothing brings that back",
            };
            format!("{course}; but a drift takes the body along the table, to where a swing {then}")
        }
    }
}

/// Motion aside of a body that the table balances, where no bounce repeats in place: to which a constant error of the tilt, or a wind, drives it.
/// Absent without one, and with state feedback of x, which takes it back at `fixed_point.x`. All are null where the angle stays nowhere.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "SteadyDrift")]
pub(super) struct SteadyDriftAnswer {
    /// Lean at which the angle stays, rad.
    pub(super) theta: Option<f64>,
    /// Horizontal acceleration while the drift is slow, m/s².
    pub(super) acceleration: Option<f64>,
    /// Steady horizontal velocity, m/s: with state feedback of x_dot, and in air.
    speed: Option<f64>,
    /// Time after which a body that started at rest in the middle has left the table, if `table.length` is given, s.
    pub(super) time_on_table: Option<f64>,
}

impl SteadyDriftAnswer {
    /// The motion of a scene, if no bounce of it stays in place.
    pub(super) fn of(scene: &Scene, small: Result<&SmallDeviations, &NoRepeatingBounce>) -> Option<Self> {
        let half_length = scene.rules().half_length;
        let (theta, acceleration, speed, time) = match small {
            Ok(SmallDeviations { fixed_point, drifts: true, drift: None, .. }) => {
                let time = half_length / fixed_point.x_dot.abs();
                (Some(fixed_point.theta), Some(0.0), Some(fixed_point.x_dot), time)
            }
            Err(why @ NoRepeatingBounce::Moves { at, change, flight_time }) if why.moves(X_DOT) => {
                let theta = at[ARC] / scene.model().rod.radius_of_gyration;
                let acceleration = change[X_DOT] / flight_time;
                let turns = why.moves(ARC) || why.moves(SPIN) || theta.abs() >= FRAC_PI_2;
                let [theta, acceleration] = [theta, acceleration].map(|part| (!turns).then_some(part));
                let time = acceleration.map_or(f64::INFINITY, |it| (2.0 * half_length / it.abs()).sqrt());
                (theta, acceleration, None, time)
            }
            _ => return None,
        };
        Some(Self { theta, acceleration, speed, time_on_table: Some(time).filter(|time| time.is_finite()) })
    }
}

/// Energy that a table which turns as it strikes (`table.tilt_rate`) gives to a swing at each bounce, to second order in the angle. Present with
/// a pivot at a place at which the angle circles, where a swing moves a kept quantity.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "SwingPump")]
pub(super) struct SwingPumpAnswer {
    /// Largest angle of the swing of the release by the linear map, rad.
    swing: f64,
    /// Mean distance of the body from the pivot at the first contact, m.
    distance: f64,
    /// Mean change of the energy per bounce and unit mass, m²/s².
    energy: f64,
    /// Number of bounces until the height is critical, at the present rate. Null if the height does not grow, and for a swing of rounding.
    critical_bounces: Option<u64>,
}

impl SwingPumpAnswer {
    /// The pump of a scene whose table turns about a place as it strikes.
    pub(super) fn of(scene: &Scene, balance: &Balance) -> Option<Self> {
        let place = scene.acting_turn()?.place?;
        let Swing { amplitude, place: swings_at, shifts, energy, .. } = balance.swing.as_ref()?.as_ref().ok()?;
        if shifts.iter().all(|shift| *shift == 0.0) {
            return None;
        }
        let critical_bounces = balance.bounces_until_critical();
        Some(Self { swing: *amplitude, distance: swings_at - place, energy: *energy, critical_bounces })
    }
}

/// Sentences on the height of a bounce, if nothing steers it and strikes or air change the energy of a swing.
pub(super) fn height_note(scene: &Scene, balance: &Balance) -> Option<String> {
    let SmallDeviations { fixed_point, motion, .. } = &balance.small;
    if let (Some(drag), Some(height)) = (scene.running_model().drag, scene.target_height(1))
        && drag.linear != 0.0
    {
        return Some(format!(
            "the law of the table does not know the air: with target_height {height} m the bounce has its top at {} m, where strikes give back what \
             flights lose",
            fixed_point.apex_height
        ));
    }
    let changes = scene.acting_turn().is_some() || scene.running_model().drag.is_some();
    (changes && !scene.steers_energy()).then(|| {
        if *motion == Motion::DiesOut {
            "fixed_point has the height at which the run settles, since a swing changes the energy as long as it lasts; if the run does not settle, it \
             has that of the release"
        } else {
            "fixed_point has the height of the release, which a swing changes as long as it lasts"
        }
        .to_owned()
    })
}

/// Sentences on gains that the table has by its errors, which are not those that it was given.
pub(super) fn gain_notes(scene: &Scene) -> Vec<String> {
    let errors = scene.table_errors();
    let mut notes = Vec::new();
    if errors.tilt_gain != 0.0 {
        notes.push(format!(
            "margins of table.tilt_gain are of the gain as it is set; the table tilts by {} times its law, and reason has the gain by which it acts",
            scene.tilt_factor()
        ));
    }
    if errors.speed != 0.0 && scene.steers_energy() {
        notes.push(format!(
            "margins of table.energy_gain are of the gain as it is set; the table moves at {} times its law",
            scene.speed_factor()
        ));
    }
    notes
}

/// Sentences on a delay that the table does not predict: the law by which it acts, and the growth of a swing.
pub(super) fn delay_notes(scene: &Scene, fixed_point: &FixedPoint) -> Vec<String> {
    let (lag, model) = (scene.running_model().lag, scene.model());
    if lag > fixed_point.flight_time {
        return vec![format!(
            "table.delay is {lag} s and the bounce takes {} s from strike to strike: the table strikes by a state from before the last strike, and \
             the motion that it has planned is a part of the state",
            fixed_point.flight_time
        )];
    }
    let Some([x, theta, x_dot, theta_dot]) = model.feedback().filter(|_| lag != 0.0) else { return Vec::new() };
    let mut notes = vec![format!(
        "table.delay without prediction is the state feedback K = ({x}, {theta}, {x_dot}, {theta_dot}) of (x, theta, x_dot, theta_dot) at the \
         strike: K_x_dot − K_x·delay and K_theta_dot − K_theta·delay"
    )];
    if x == 0.0 && x_dot == 0.0 && contact_regime(&model) == ContactRegime::Frictionless {
        let rod = model.rod;
        let turning = rod.radius_of_gyration * rod.radius_of_gyration;
        let determinant = 1.0 + 2.0 * fixed_point.speed * rod.contact_distance * theta_dot / turning;
        if determinant > 1.0 && scene.number(Name::TiltGain).is_some() {
            notes.push(format!(
                "a swing of the angle grows by the square root of {determinant} a bounce, the determinant 1 + (2Vl/ρ²)K_theta_dot: with a \
                 delay and without prediction no tilt_gain above 0 balances"
            ));
        }
    }
    notes
}

/// Friction that the note on a verdict without friction looks at.
const SOME_FRICTION: f64 = 1e-4;

/// Sentence on a verdict without friction that any friction loses; `None` if a little of it keeps the linear verdict bounded.
pub(super) fn friction_note(scene: &Scene) -> Option<String> {
    if scene.number(Name::Friction) != Some(0.0) {
        return None;
    }
    let mut draft = scene.draft();
    draft.set(Name::Friction, Some(Value::Number(SOME_FRICTION))).ok()?;
    let rough = match draft.build() {
        Ok(rough) => rough,
        Err(errors) => {
            let why = errors.into_iter().next()?.detail;
            return Some(format!(
                "the verdict is of a contact without friction, and such a scene cannot have any: {why}"
            ));
        }
    };
    let linear = small_deviations(&rough).ok()?.linear;
    let radius = linear.spectral_radius();
    if linear.says_bounded() || !radius.is_finite() {
        return None;
    }
    let law =
        if scene.model().feedback().is_some() { "this feedback does not balance" } else { "no tilt_gain balances" };
    Some(format!(
        "the verdict is of a contact without friction: with contact.friction {SOME_FRICTION} the contact sticks to the table, and small deviations grow \
         (spectral radius {radius}). With friction {law} unless table.slide is `matched`; budget=true has the limit"
    ))
}
