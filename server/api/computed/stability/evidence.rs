//! Evidence as part of the answer: the linear verdict, rotation number, chaos and basin, with the notes on each, and the orbit of one cycle
//! of a program of heights.

use equipoise_physics::analysis::evidence::{Balance, Swing};
use equipoise_physics::analysis::limits::Parameter;
use equipoise_physics::analysis::linear_verdict::{AngleClass, LinearVerdict};
use equipoise_physics::analysis::losses::SettledMotion;
use equipoise_physics::analysis::periodic_orbits::multipliers::Bifurcation;
use equipoise_physics::analysis::periodic_orbits::{OrbitFailure, OrbitProblem, find};
use equipoise_physics::analysis::regularity::{FEWEST, Regularity, TOLERANCE, WATCHED};
use equipoise_physics::analysis::small_deviations::Motion;
use equipoise_physics::analysis::swing::NoSwingForm;
use equipoise_physics::analysis::{basin, losses, regularity};
use equipoise_physics::scene::Scene;

use crate::api::prelude::*;

/// Distance of the rotation number from the resonances 1/3 and 1/4, in turns per bounce, within which the answer names them.
const NEAR: f64 = 0.02;

words! {
    /// Behaviour of a swing beyond first order.
    pub LyapunovKind = ["repelling", "attracting", "neutral"];

    /// Way in which stability is lost at an end.
    pub LossKind = ["soft", "hard", "degenerate"];

    /// A field of the scene whose value reaches its end, or for `table.feedback` a factor on all its gains.
    pub LossField =
        [Parameter::TILT_GAIN, Parameter::ENERGY_GAIN, Parameter::FeedbackFactor].map(Parameter::name);

    /// An eigenvalue leaves the unit circle at −1, at 1 (`fold`: the bounce itself ends), or as a complex pair.
    pub LossBifurcation = Bifurcation::ALL.map(Bifurcation::name);
}

/// The rational p/q with q up to 8 that is nearest to `measured`, or to `small` if `measured` is null.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Resonance")]
pub(crate) struct ResonanceAnswer {
    pub(crate) p: u32,
    pub(crate) q: u32,
    /// Distance from p/q.
    pub(crate) distance: f64,
}

/// Mean turns about the fixed point per bounce, in the coordinates in which the linear map is a rotation. In air that takes the spin, with a
/// delay or with state feedback the turns are of the complex pair of eigenvalues that swings the angle most, and are counted until the swing has
/// died out. Null if small deviations do not circle, for a point mass, with noise, and without a fixed point.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct RotationNumber {
    /// Weighted average over the first 500 impacts of the run; needs about 50.
    pub(crate) measured: Option<f64>,
    /// Rotation number of small deviations, arg λ / 2π.
    pub(crate) small: f64,
    pub(crate) resonance: ResonanceAnswer,
    /// The strong resonance, 1/3 or 1/4, within 0.02 of `measured` or `small`. Near it the basin may have a dent, which the linear verdict does not
    /// see. Null if there is none.
    pub(crate) strong_resonance: Option<ResonanceAnswer>,
}

/// The strong resonance that a rotation number is near.
fn strong_resonance(rotation: &regularity::Rotation) -> Option<ResonanceAnswer> {
    let near = |q: u32| {
        let from = |turns: f64| (turns - 1.0 / f64::from(q)).abs();
        let distance = rotation.measured.map_or(f64::INFINITY, from).min(from(rotation.linear));
        ResonanceAnswer { p: 1, q, distance }
    };
    [3, 4].map(near).into_iter().find(|resonance| resonance.distance <= NEAR)
}

impl From<regularity::Rotation> for RotationNumber {
    fn from(rotation: regularity::Rotation) -> Self {
        let regularity::Resonance { p, q, distance } = rotation.resonance;
        Self {
            measured: rotation.measured,
            small: rotation.linear,
            resonance: ResonanceAnswer { p, q, distance },
            strong_resonance: strong_resonance(&rotation),
        }
    }
}

/// Indicator of exponential separation of nearby runs. Null if the run did not last 500 impacts or stays at the fixed point, with noise, and
/// without a fixed point.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Chaos {
    /// Mean exponential growth factor of nearby orbits (MEGNO), averaged over the impacts: up to 2 for regular runs.
    pub(crate) indicator: f64,
    /// True if the indicator is above 2.2. On runs of other bodies than those for which the limit was chosen, labelled by their behaviour over
    /// 30,000 impacts, 1 in 64 regular runs was called chaotic and 1 in 11 chaotic runs was missed (not counting runs that fall within the 500
    /// impacts).
    pub(crate) chaotic: bool,
    /// Number of impacts used.
    bounces: u64,
}

impl From<regularity::ChaosIndicator> for Chaos {
    fn from(chaos: regularity::ChaosIndicator) -> Self {
        Self { indicator: chaos.indicator, chaotic: chaos.chaotic, bounces: chaos.impacts }
    }
}

/// The release angles, at rest at x = 0 and the height of the scene, from which a run survives; the same to both sides, on both of which it
/// survives. Null unless requested; also for a point mass, if the run from upright does not survive, and if the height is not above the contact
/// distance. With noise all runs have the errors of the scene's run.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Basin {
    /// Largest angle found that survives, rad.
    pub(crate) theta: f64,
    /// Number of impacts that a run has to survive.
    bounces: u64,
    /// Intervals below `theta` from which the runs tried fall, rad.
    #[schemars(with = "Vec<[f64; 2]>")]
    holes: Vec<(f64, f64)>,
    /// Angle up to which all runs tried survive, rad.
    pub(crate) unbroken: f64,
    /// Accuracy of the two edges, rad.
    tolerance: f64,
    /// Spacing of the angles tried, rad. A narrower hole can be missed.
    spacing: f64,
}

impl From<basin::ReleaseBasin> for Basin {
    fn from(basin: basin::ReleaseBasin) -> Self {
        let basin::ReleaseBasin { theta, unbroken, holes, impacts, tolerance, spacing, bounces: _ } = basin;
        Self { theta, bounces: impacts, holes, unbroken, tolerance, spacing }
    }
}

/// Behaviour of a swing beyond first order, if the angle circles: its amplitude A obeys dA/dn = ℓA³ a bounce. The first Lyapunov coefficient of a
/// Neimark–Sacker pair on its centre manifold (Kuznetsov, Elements of Applied Bifurcation Theory, §§ 5.4 and 7.3). Null, with a note, where
/// strikes keep the energy of a frictionless rod, where a swing moves a kept quantity, and at a third of a turn beside a drift.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct Lyapunov {
    /// ℓ, per bounce and rad². Positive: every swing grows, however small. Negative: small swings decay.
    pub(crate) coefficient: f64,
    #[schemars(with = "LyapunovKind")]
    pub(crate) kind: &'static str,
    /// Approximate number of impacts in which a swing as large as that of this release leaves upright, 1/(2ℓA₀²). Null unless repelling, and for
    /// a release that does not swing: the number would be 2⁵³ or more.
    pub(crate) escape_bounces: Option<u64>,
    detail: String,
}

/// Distance of the rotation from a quarter turn, in turns per bounce, within which the detail names the resonance.
const NEAR_QUARTER: f64 = 0.02;

impl Lyapunov {
    /// The coefficient of the swing of a release about a bounce that repeats.
    ///
    /// # Errors
    /// A sentence that says why there is none.
    pub(crate) fn of(balance: &Balance) -> Result<Self, &'static str> {
        match (balance.small.motion, &balance.swing) {
            (Motion::DiesOut, _) => Err("small deviations die out in first order already"),
            (Motion::Grows(_), _) => Err("small deviations grow in first order already"),
            (Motion::Silent(_), _) => Err("an eigenvalue is on the unit circle, and does not circle"),
            (Motion::Circles(_), None) => {
                Err("strikes keep the energy, so no direction contracts and a swing has nothing to grow or shrink by")
            }
            (Motion::Circles(_), Some(Err(NoSwingForm::Resonance))) => {
                Err("the rotation is a third of a turn, a strong resonance")
            }
            (Motion::Circles(_), Some(Err(NoSwingForm::Double))) => Err("the eigenvalue is double"),
            (Motion::Circles(_), Some(Err(NoSwingForm::NoDerivative))) => Err("the map has no third derivative there"),
            (Motion::Circles(_), Some(Ok(swing))) if swing.shifts.iter().any(|shift| *shift != 0.0) => {
                Err("a swing changes a kept quantity in second order already")
            }
            (Motion::Circles(_), Some(Ok(swing))) => {
                Ok(Self::of_swing(swing, balance.small.linear.rotation.unwrap_or_default()))
            }
        }
    }

    fn of_swing(swing: &Swing, rotation: f64) -> Self {
        let (coefficient, amplitude) = (swing.form.growth, swing.amplitude);
        let kind = match coefficient {
            growth if growth > 0.0 => "repelling",
            growth if growth < 0.0 => "attracting",
            _ => "neutral",
        };
        let mut detail = format!(
            "the amplitude A of a swing, the largest |θ| of its linear ellipse, obeys dA/dn = ℓA³ a bounce to third order; A is {amplitude} \
             rad at the first contact of this release"
        );
        let from_quarter = (rotation / std::f64::consts::TAU - 0.25).abs();
        if from_quarter <= NEAR_QUARTER {
            detail += &format!(
                "; the rotation is within {from_quarter} turns of the strong resonance 1/4: the nearer, the smaller the swings for which it \
                 holds"
            );
        }
        Self { coefficient, kind, escape_bounces: swing.escape_bounces().map(|bounces| bounces as u64), detail }
    }
}

/// An end of the linear verdict: stability is lost softly there, to a small swing that grows with the distance from the end, or hard, so that the
/// body falls from every small deviation. From the cubic coefficient of the normal form, with second and third derivatives of the map.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct LossOfStability {
    #[schemars(with = "LossField")]
    field: &'static str,
    /// Value at the end: the tilt gain, the energy gain in s²/m², or the factor.
    value: f64,
    #[schemars(with = "LossBifurcation")]
    bifurcation: &'static str,
    /// Positive: soft. No unit for the tilt gain (as `boundary`), in s²/m² of the bounce speed for the energy gain, per bounce and rad² for
    /// feedback.
    coefficient: f64,
    #[schemars(with = "LossKind")]
    kind: &'static str,
    /// Largest angle of the swing on which this scene settles, if its feedback is beyond a soft end, rad. To leading order, so accurate just
    /// beyond the end.
    swing: Option<f64>,
    /// The two heights of the centre of gravity at the top between which bounces alternate, if the energy gain is beyond its soft end, m.
    heights: Option<[f64; 2]>,
}

impl From<&losses::StabilityLoss> for LossOfStability {
    fn from(loss: &losses::StabilityLoss) -> Self {
        let (swing, heights) = match loss.settles {
            None => (None, None),
            Some(SettledMotion::Swing(swing)) => (Some(swing), None),
            Some(SettledMotion::Heights { heights, .. }) => (None, Some(heights)),
        };
        Self {
            field: loss.end.name(),
            value: loss.value,
            bifurcation: loss.bifurcation.name(),
            coefficient: loss.coefficient,
            kind: loss.kind(),
            swing,
            heights,
        }
    }
}

/// Adds notes on the first contacts of a run: the reasons for nulls, and warnings about the rest. A run with noise has no regularity.
pub(crate) fn explain(regularity: Option<&Regularity>, linear: &LinearVerdict, notes: &mut Vec<String>) {
    let Some(regularity) = regularity else {
        notes.push(
            "rotation_number, chaos and predictable_bounces are null: errors of the table scatter at random".to_owned(),
        );
        return;
    };
    let watched = regularity.growth.len();
    match regularity.rotation {
        None => notes.push("rotation_number is null: small deviations do not circle here".to_owned()),
        Some(rotation) => {
            if rotation.measured.is_none() {
                notes.push(format!(
                    "rotation_number.measured is null: it takes {FEWEST} turns aside from the fixed point, and {watched} bounces \
                     were watched"
                ));
            }
            if let Some(ResonanceAnswer { p, q, distance }) = strong_resonance(&rotation) {
                let residue = linear.residue.unwrap_or_default();
                notes.push(format!(
                    "resonance {p}/{q}: the rotation number is within {distance} of it (named up to {NEAR}) at residue {residue}; near \
                     it the basin may have a dent, which the linear verdict does not see"
                ));
            }
        }
    }
    if regularity.chaos.is_none() {
        notes.push(format!(
            "chaos is null: it takes {WATCHED} impacts aside from the fixed point, and {watched} were watched"
        ));
    }
    if regularity.predictable_impacts(TOLERANCE).is_none() {
        let growth = regularity.growth.last().copied().unwrap_or_default();
        notes.push(format!(
            "predictable_bounces is null: over the {watched} bounces watched, deviations grew by e^{growth}, which does not \
             bring rounding up to {TOLERANCE} of the contact speed"
        ));
    }
}

words! {
    /// Kind of the linear map.
    pub LinearKind = AngleClass::ALL.map(AngleClass::name);
}

/// The verdict of the linearization at the fixed point.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Linear")]
pub struct LinearPart {
    #[schemars(with = "LinearKind")]
    pub(super) kind: &'static str,
    /// Greene's residue R of the angle block: elliptic for 0 < R < 1. Null for a point mass, with state feedback, and if friction couples the
    /// angle with the other components.
    pub(super) residue: Option<f64>,
    /// Rotation about the fixed point per bounce, rad. Null if the residue is null, below 0 or above 1.
    pub(super) rotation: Option<f64>,
    /// Largest modulus of the eigenvalues. With state feedback, of the components that are fed back, and of the height if an energy gain
    /// controls it.
    pub(super) spectral_radius: f64,
    /// Eigenvalues of the return map, largest modulus first. What is kept has the eigenvalue 1.
    pub(super) eigenvalues: Vec<Eigenvalue>,
    /// Factor on a deviation of the height at each bounce.
    pub(super) energy_eigenvalue: f64,
}

impl LinearPart {
    /// The linear verdict on a scene with a tilt law.
    pub fn new(linear: &LinearVerdict) -> Self {
        Self {
            kind: linear.class.name(),
            residue: linear.residue,
            rotation: linear.rotation,
            spectral_radius: linear.spectral_radius(),
            eigenvalues: linear.eigenvalues.iter().map(|&value| value.into()).collect(),
            energy_eigenvalue: linear.energy_eigenvalue,
        }
    }
}

/// A sentence on small deviations from the orbit of one cycle. None without a program.
pub(super) fn cycle_sentence(scene: &Scene) -> Option<String> {
    let period = scene.program()?.heights().len();
    let orbit = OrbitProblem::of(scene)
        .map_err(OrbitFailure::Scene)
        .and_then(|problem| find(&problem, period, &problem.upright()));
    Some(match orbit {
        Ok(orbit) => {
            let deviations = match orbit.multipliers.stable {
                Some(true) => "small deviations stay small",
                Some(false) => "small deviations grow",
                None => "the linear analysis is silent there",
            };
            let (radius, time) = (orbit.multipliers.spectral_radius(), orbit.flight_time);
            let evidence = match orbit.multipliers.residue {
                Some(residue) => format!("its residue is {residue}"),
                None => format!("its spectral radius is {radius}"),
            };
            format!("about the orbit of one cycle ({period} strikes, {time} s) {deviations}: {evidence}")
        }
        Err(failure) => format!("the orbit of one cycle is not found: {failure}"),
    })
}
