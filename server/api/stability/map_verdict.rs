//! The verdict on a scene for which no closed form is derived, from its return map: words for the evidence.

use equipoise_physics::analysis::evidence::{Balance, Course, Evidence, Judgement, Motion, SMALL_SWING, SmallRun};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::jacobian::modulus;
use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::analysis::nonlinear_run::NonlinearRun;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, SPIN, X, X_DOT, Y_DOT};
use equipoise_physics::analysis::swing::NoSwingForm;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::numbers::trig::acos;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene};

use crate::api::stability::linear::{EnergyGainAnswer, LinearPart};
use crate::api::stability::verdict_name::words;

/// Parts of an answer that follow from the return map.
pub(super) struct MapVerdict {
    /// The verdict in words.
    pub(super) verdict: String,
    /// One sentence with numbers.
    pub(super) reason: String,
    /// The bounce that repeats, if one does.
    pub(super) fixed_point: Option<FixedPoint>,
    /// Eigenvalues about it.
    pub(super) linear: Option<LinearPart>,
}

impl MapVerdict {
    /// Words for a judgement of a scene and its run; `underived` says why no closed form holds.
    pub(super) fn of(scene: &Scene, judgement: &Judgement, run: &NonlinearRun, underived: &str) -> Self {
        let balance = match &judgement.evidence {
            Evidence::Balances(balance) => Some(&**balance),
            Evidence::Ensemble { .. } | Evidence::NoContact | Evidence::NothingRepeats { .. } => None,
        };
        let verdict = match &judgement.evidence {
            Evidence::Ensemble { survived, runs, impacts, .. } if judgement.verdict == Verdict::Random => {
                format!("random, {survived} of {runs} runs survive {impacts} bounces")
            }
            _ => words(judgement.verdict, run),
        };
        Self {
            verdict,
            reason: reason(judgement, run, underived),
            fixed_point: balance.map(|balance| fixed_point(scene, balance)),
            linear: balance.map(|balance| linear(scene, balance)),
        }
    }
}

fn fixed_point(scene: &Scene, balance: &Balance) -> FixedPoint {
    let at = &balance.bounce.at;
    let places = balance.map.components().contains(&X);
    let rise = at[Y_DOT] * at[Y_DOT] / (2.0 * scene.gravity());
    FixedPoint {
        x: if places { at[X] } else { 0.0 },
        x_dot: at[X_DOT],
        speed: -at[Y_DOT],
        flight_time: balance.flight_time / balance.map.period() as f64,
        apex_height: balance.map.body().contact_height(&balance.map.state(at)) + rise,
    }
}

fn linear(scene: &Scene, balance: &Balance) -> LinearPart {
    let class = match balance.motion {
        Motion::DiesOut => AngleClass::Attracting,
        Motion::Circles(_) => AngleClass::Elliptic,
        Motion::Silent(_) => AngleClass::Parabolic,
        Motion::Grows(_) => AngleClass::Hyperbolic,
    };
    let rotation = match balance.motion {
        Motion::Circles(value) => Some(acos(value.re.clamp(-1.0, 1.0))),
        Motion::DiesOut | Motion::Silent(_) | Motion::Grows(_) => None,
    };
    let fall = balance.map.components().iter().position(|&index| index == Y_DOT).unwrap_or_default();
    LinearPart {
        class: class.name(),
        residue: None,
        rotation,
        spectral_radius: balance.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max),
        eigenvalues: balance.eigenvalues.iter().map(|&value| value.into()).collect(),
        tilt_gain: None,
        energy_gain: EnergyGainAnswer {
            value: scene.number(Name::EnergyGain).unwrap_or_default(),
            upper: None,
            eigenvalue: balance.bounce.matrix[(fall, fall)],
            margin: None,
        },
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

fn reason(judgement: &Judgement, run: &NonlinearRun, underived: &str) -> String {
    let outcome = outcome(run);
    match &judgement.evidence {
        Evidence::Ensemble { survived, runs, impacts, interval: (low, high) } => format!(
            "with noise {survived} of {runs} runs survive {impacts} bounces, so one does with a probability of {low:.3} to {high:.3} (95 %); {outcome}"
        ),
        Evidence::NoContact => format!("the release comes to no contact; {outcome}"),
        Evidence::NothingRepeats { why, speed } => format!("{underived}; {}; {outcome}", nothing_repeats(why, *speed)),
        Evidence::Balances(balance) => {
            let fell = if run.ending != Ending::Completed && judgement.says_bounded {
                ": the start is outside the basin, or the rules of the run ended it"
            } else {
                ""
            };
            format!("{}; {outcome}{fell}", balanced(balance))
        }
    }
}

fn nothing_repeats(why: &NoRepeatingBounce, speed: f64) -> String {
    match why {
        NoRepeatingBounce::Moves { change } => {
            let named =
                [(ARC, "ρθ", "m"), (X_DOT, "ẋ", "m/s"), (Y_DOT, "ẏ", "m/s"), (SPIN, "ρθ̇", "m/s"), (X, "x", "m")];
            let largest = change.iter().fold(0.0_f64, |size, part| size.max(part.abs()));
            let moved: Vec<String> = named
                .into_iter()
                .filter(|(index, ..)| change[*index].abs() > 1e-3 * largest)
                .map(|(index, name, unit)| format!("{name} by {} {unit}", change[index]))
                .collect();
            let fall = change[Y_DOT];
            // Beside other changes, ẏ may come to a balance of its own.
            let rest = if fall > 0.0 && moved.len() == 1 {
                format!(
                    ", so that a bounce of {speed} m/s is lost after about {} bounces at this rate",
                    (speed / fall).ceil()
                )
            } else {
                String::new()
            };
            format!("beside the upright bounce each one changes {}{rest}", moved.join(" and "))
        }
        NoRepeatingBounce::Rests => "bounces die out, down to the body at rest on the table".to_owned(),
        NoRepeatingBounce::NotFound => "Newton's iteration on the return map found no bounce that repeats".to_owned(),
    }
}

fn balanced(balance: &Balance) -> String {
    let radius = balance.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
    let small = |run: &SmallRun| {
        let end = if run.survived { "stayed" } else { "left" };
        format!(
            "a run from a swing of {SMALL_SWING} rad {end}, {} bounces and |θ| up to {} rad",
            run.impacts, run.max_theta
        )
    };
    let by_run = balance.small_run.as_ref().map_or_else(String::new, |run| format!("; {}", small(run)));
    let beside = if balance.drifts { "; a drift stays as it is" } else { "" };
    match (balance.motion, &balance.swing) {
        (Motion::DiesOut, _) => {
            format!("small deviations from the bounce that repeats die out, by the derivative of the map{beside}")
        }
        (Motion::Grows(_), _) => {
            format!("small deviations grow: the derivative of the map has an eigenvalue of modulus {radius}{by_run}")
        }
        (Motion::Silent(value), _) => {
            format!("the derivative of the map has an eigenvalue {value}, on which it is silent{by_run}")
        }
        (Motion::Circles(_), Some(Ok(form))) => {
            let (growth, amplitude) = (form.growth, balance.amplitude);
            match form.course() {
                Course::Circles => {
                    "small deviations circle, and to third order a swing neither grows nor dies out".to_owned()
                }
                Course::Grows => format!(
                    "small deviations circle in first order only: to third order a swing grows by {growth} per bounce and rad², one of \
                     {amplitude} rad, as here, over about {} bounces",
                    (0.5 / (growth * amplitude * amplitude)).ceil()
                ),
                Course::DiesOut => format!(
                    "small deviations circle in first order only: to third order a swing dies out by {growth} per bounce and rad²"
                ),
                Course::Pumps => format!(
                    "small deviations circle in first order only: a swing of {amplitude} rad, as here, changes a kept quantity by {} a bounce, \
                     which makes it grow",
                    shift(balance)
                ),
                Course::Settles => format!(
                    "small deviations circle in first order only: a swing of {amplitude} rad, as here, changes a kept quantity by {} a bounce, \
                     which makes it die out",
                    shift(balance)
                ),
                Course::Shifts => format!(
                    "small deviations circle in first order only: a swing of {amplitude} rad, as here, changes a kept quantity by {} a bounce, and \
                     nothing brings that back",
                    shift(balance)
                ),
            }
        }
        (Motion::Circles(_), Some(Err(why))) => {
            let why = match why {
                NoSwingForm::Resonance(order) => format!("the rotation is at the strong resonance of order {order}"),
                NoSwingForm::Double => "the eigenvalue is double".to_owned(),
                NoSwingForm::NoDerivative => "the map has no third derivative there".to_owned(),
            };
            format!("small deviations circle, and {why}{by_run}")
        }
        (Motion::Circles(_), None) => format!("small deviations circle{by_run}"),
    }
}

/// Largest change of a kept quantity a bounce by the swing of the release, m/s or m along its direction.
fn shift(balance: &Balance) -> f64 {
    let Some(Ok(form)) = &balance.swing else { return 0.0 };
    let square = balance.amplitude * balance.amplitude;
    form.shifts.iter().map(|shift| shift * square).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
}
