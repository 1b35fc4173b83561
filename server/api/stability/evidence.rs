//! Evidence beyond the linear analysis, as part of the answer: rotation number, chaos and basin, with the notes on each.

use equipoise_physics::analysis::evidence::{Balance, Swing};
use equipoise_physics::analysis::linear_verdict::LinearVerdict;
use equipoise_physics::analysis::losses::SettledMotion;
use equipoise_physics::analysis::nonlinear_run::WatchedRun;
use equipoise_physics::analysis::regularity::{FEWEST, Regularity, TOLERANCE, WATCHED};
use equipoise_physics::analysis::small_deviations::Motion;
use equipoise_physics::analysis::swing::NoSwingForm;
use equipoise_physics::analysis::{basin, losses, regularity};
use equipoise_physics::scene::Scene;
use serde::Serialize;

/// Distance of the rotation number from the resonances 1/3 and 1/4, in turns per bounce, within which a note names them.
const NEAR: f64 = 0.02;

#[derive(Debug, Clone, Serialize)]
pub(crate) struct ResonanceAnswer {
    pub(crate) p: u32,
    pub(crate) q: u32,
    pub(crate) distance: f64,
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct RotationNumber {
    pub(crate) measured: Option<f64>,
    pub(crate) linear: f64,
    pub(crate) resonance: ResonanceAnswer,
}

impl From<regularity::Rotation> for RotationNumber {
    fn from(rotation: regularity::Rotation) -> Self {
        let regularity::Resonance { p, q, distance } = rotation.resonance;
        Self { measured: rotation.measured, linear: rotation.linear, resonance: ResonanceAnswer { p, q, distance } }
    }
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Chaos {
    pub(crate) indicator: f64,
    pub(crate) chaotic: bool,
    impacts: u64,
}

impl From<regularity::ChaosIndicator> for Chaos {
    fn from(chaos: regularity::ChaosIndicator) -> Self {
        Self { indicator: chaos.indicator, chaotic: chaos.chaotic, impacts: chaos.impacts }
    }
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Basin {
    pub(crate) theta: f64,
    impacts: u64,
    holes: Vec<(f64, f64)>,
    pub(crate) unbroken: f64,
    tolerance: f64,
    spacing: f64,
}

impl From<basin::ReleaseBasin> for Basin {
    fn from(basin: basin::ReleaseBasin) -> Self {
        let basin::ReleaseBasin { theta, unbroken, holes, impacts, tolerance, spacing, bounces: _ } = basin;
        Self { theta, impacts, holes, unbroken, tolerance, spacing }
    }
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct Lyapunov {
    pub(crate) coefficient: f64,
    pub(crate) kind: &'static str,
    pub(crate) escape_impacts: Option<u64>,
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
            (Motion::Circles(_), Some(Err(NoSwingForm::Resonance(_)))) => Err("the rotation is at a strong resonance"),
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

    fn of_swing(Swing { form, amplitude, .. }: &Swing, rotation: f64) -> Self {
        let coefficient = form.growth;
        let contacts = 0.5 / (coefficient * amplitude * amplitude);
        // A cast keeps to the range of the type.
        let escape_impacts = (coefficient > 0.0 && contacts.is_finite()).then_some(contacts as u64);
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
                "; the rotation is within {from_quarter} turns of the strong resonance 1/4, where ℓ is not defined: the nearer, the \
                 smaller the swings for which it holds"
            );
        }
        Self { coefficient, kind, escape_impacts, detail }
    }
}

#[derive(Debug, Clone, Serialize)]
pub(crate) struct LossOfStability {
    parameter: &'static str,
    value: f64,
    bifurcation: &'static str,
    coefficient: f64,
    kind: &'static str,
    swing: Option<f64>,
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
            parameter: loss.end.name(),
            value: loss.value,
            bifurcation: loss.bifurcation.name(),
            coefficient: loss.coefficient,
            kind: loss.kind(),
            swing,
            heights,
        }
    }
}

/// Evidence from the first contacts of a run. One with noise has none.
#[derive(Debug)]
pub(crate) struct Evidence(Option<Regularity>);

impl Evidence {
    pub(crate) fn new(scene: &Scene, run: &WatchedRun, balance: &Balance) -> Self {
        Self(run.regularity(scene, &balance.small))
    }

    pub(crate) fn bounces(&self) -> u64 {
        self.0.as_ref().map_or(0, Regularity::bounces)
    }

    pub(crate) fn rotation(&self) -> Option<regularity::Rotation> {
        self.0.as_ref()?.rotation
    }

    pub(crate) fn chaos(&self) -> Option<regularity::ChaosIndicator> {
        self.0.as_ref()?.chaos
    }

    pub(crate) fn predictable_impacts(&self) -> Option<u64> {
        self.0.as_ref()?.predictable_impacts(TOLERANCE)
    }

    /// Adds notes: the reasons for nulls, and warnings about the rest.
    pub(crate) fn explain(&self, linear: &LinearVerdict, notes: &mut Vec<String>) {
        let Some(regularity) = &self.0 else {
            notes.push(
                "rotation_number, chaos and predictable_impacts are null: errors of the table scatter at random"
                    .to_owned(),
            );
            return;
        };
        let watched = regularity.growth.len();
        match regularity.rotation {
            None => notes.push("rotation_number is null: small deviations do not circle here".to_owned()),
            Some(rotation) => {
                if rotation.measured.is_none() {
                    notes.push(format!(
                        "rotation_number.measured is null: it takes {FEWEST} turns aside from the fixed point, and {watched} impacts \
                         were watched"
                    ));
                }
                for order in [3, 4] {
                    let near = |turns: f64| (turns - 1.0 / f64::from(order)).abs();
                    let distance = rotation.measured.map_or(f64::INFINITY, near).min(near(rotation.linear));
                    if distance <= NEAR {
                        let residue = linear.residue.unwrap_or_default();
                        notes.push(format!(
                            "resonance 1/{order}: the rotation number is within {distance} of it (named up to {NEAR}) at residue \
                             {residue}; near it the basin may have a dent, which the linear verdict does not see"
                        ));
                    }
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
                "predictable_impacts is null: over the {watched} impacts watched, deviations grew by e^{growth}, which does not \
                 bring rounding up to {TOLERANCE} of the contact speed"
            ));
        }
    }
}
