//! A case of the gallery: a scene, made from the paper's rod, what each method claims about it, and what is true.

use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::jacobian;
use equipoise_physics::analysis::jacobian::modulus;
use equipoise_physics::analysis::linear_verdict::PARABOLIC;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::Rod;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Contact, Orbit, run};
use equipoise_physics::scene::Value::Number;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};

/// A scene on which a common method is wrong.
#[derive(Clone, Copy, Debug)]
pub struct FailureCase {
    /// Name in requests.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// The usual method that fails.
    pub method: &'static str,
    /// Paragraph that says why it fails.
    pub why: &'static str,
    /// Contacts that its runs have at most.
    pub impacts: u64,
    /// The request that shows the truth, beside the scene: a resource, and the rest of its query.
    pub ask: (&'static str, &'static str),
    /// Cost of the claims, or of the picture, in bounces of the plain rod.
    pub price: u64,
    /// Fields of the scene beside those of the paper's rod.
    pub(super) scene: &'static [(Name, Value)],
    pub(super) find: fn(&Scene, u64) -> Findings,
    pub(super) picture: fn(&Scene, u64) -> CasePicture,
}

/// The picture of a case without its title.
pub(super) struct CasePicture {
    pub(super) subtitle: String,
    pub(super) caption: String,
    pub(super) plots: Vec<Plot>,
}

impl FailureCase {
    /// The scene.
    pub fn scene(&self) -> Scene {
        let mut draft = Draft::default();
        for (name, value) in PAPER.iter().chain(self.scene) {
            draft.set(*name, Some(*value)).expect("a test builds every case");
        }
        draft.build().expect("a test builds every case")
    }

    /// The claims of the methods, and the truth.
    pub fn findings(&self) -> Findings {
        (self.find)(&self.scene(), self.impacts)
    }

    /// The picture.
    pub fn picture(&self) -> Chart {
        let CasePicture { subtitle, caption, plots } = (self.picture)(&self.scene(), self.impacts);
        Chart { title: self.title, subtitle, caption, plots }
    }
}

/// Findings on a scene.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The truth, in the words of the verdicts.
    pub truth: &'static str,
    /// Evidence for it, with numbers.
    pub detail: String,
    /// By each method, the usual one first.
    pub says: Vec<MethodClaim>,
}

/// Claim of a method. It is right if its verdict is the truth.
#[derive(Clone, Debug)]
pub struct MethodClaim {
    /// Name of the method.
    pub method: &'static str,
    /// In a word or two.
    pub verdict: &'static str,
    /// The number that it rests on.
    pub value: Option<f64>,
    /// Unit of that; `None` for a pure number.
    pub unit: Option<&'static str>,
    /// Derivation of the claim, in a sentence.
    pub detail: String,
}

/// The claim of a method.
pub(super) fn claim(
    method: &'static str,
    verdict: &'static str,
    value: Option<f64>,
    unit: Option<&'static str>,
    detail: String,
) -> MethodClaim {
    MethodClaim { method, verdict, value, unit, detail }
}

/// θ at the contacts of a run and how it ended.
pub(crate) struct AngleHistory {
    /// θ at contact 1 and on, rad.
    pub(crate) angles: Vec<f64>,
    pub(crate) ending: Ending,
}

impl AngleHistory {
    /// The history of a scene, up to a number of contacts.
    pub(crate) fn of(scene: &Scene, impacts: u64) -> Self {
        Self::of_orbit(scene.orbit().ok(), impacts)
    }

    /// The history of an orbit, if there is one.
    pub(crate) fn of_orbit(orbit: Option<Orbit>, impacts: u64) -> Self {
        let mut angles = Vec::new();
        let ending = orbit.and_then(|mut orbit| {
            run(&mut orbit, impacts, |contact| {
                angles.push(contact.state.theta);
                true
            })
        });
        Self { angles, ending: ending.unwrap_or(Ending::Completed) }
    }

    /// The history of the linear map: θ' = (1 − 4R)θ + u, u' = u − 4Rθ with u = τθ̇.
    pub(crate) fn linear(scene: &Scene, fixed_point: &FixedPoint, impacts: u64) -> Self {
        let residue = small_deviations(scene).ok().and_then(|small| small.linear.residue).unwrap_or_default();
        let start = scene.start();
        let limit = scene.rules().topple_angle;
        let (mut theta, mut turn) = (start.theta, fixed_point.flight_time * start.theta_dot);
        let mut angles = Vec::new();
        for _ in 0..impacts {
            angles.push(theta);
            if theta.abs() >= limit {
                return Self { angles, ending: Ending::Toppled { theta, limit } };
            }
            turn -= 4.0 * residue * theta;
            theta += turn;
        }
        Self { angles, ending: Ending::Completed }
    }

    /// Time at which the bounces end, if they do, s.
    pub(crate) fn settle_time(&self) -> Option<f64> {
        if let Ending::Settled { settle_time, .. } = self.ending { Some(settle_time) } else { None }
    }

    pub(crate) fn survived(&self) -> bool {
        self.ending == Ending::Completed
    }

    pub(crate) fn max(&self) -> f64 {
        self.angles.iter().map(|theta| theta.abs()).fold(0.0, f64::max)
    }

    /// The claim of the run about the angle.
    pub(crate) fn says(&self, method: &'static str) -> MethodClaim {
        let (verdict, end) = if self.survived() {
            ("bounded", format!("{} contacts survived", self.angles.len()))
        } else {
            ("falls", format!("ends as `{}` at contact {}", self.ending.name(), self.angles.len()))
        };
        let detail = format!("{end}; the largest angle at a contact is {:.4} rad", self.max());
        claim(method, verdict, Some(self.max()), Some("rad"), detail)
    }

    /// |θ| against the number of the contact: the largest of each of some hundred stretches, each a few percent longer than
    /// the one before.
    pub(crate) fn outline(&self, label: &'static str, style: CurveStyle) -> Curve {
        let mut points = Vec::new();
        let mut first = 0;
        while first < self.angles.len() {
            let next = (first + 1 + first / 32).min(self.angles.len());
            let largest = (first..next).max_by(|a, b| self.angles[*a].abs().total_cmp(&self.angles[*b].abs()));
            points.extend(largest.map(|index| (index as f64 + 1.0, self.angles[index].abs())));
            first = next;
        }
        Curve::new(label, style, points)
    }
}

/// A value at each contact of a run.
pub(super) fn at_contacts<T>(scene: &Scene, impacts: u64, value: impl Fn(&Contact) -> T) -> Vec<T> {
    let mut values = Vec::new();
    if let Ok(mut orbit) = scene.orbit() {
        run(&mut orbit, impacts, |contact| {
            values.push(value(contact));
            true
        });
    }
    values
}

/// The axes of outlines.
pub(crate) const CONTACT: ChartAxis = BOUNCE.logarithmic();
pub(crate) const ANGLE: ChartAxis = ChartAxis::new("angle at the contact", "|θ|", "rad").logarithmic();

/// Axes that several pictures have.
pub(super) const BOUNCE: ChartAxis = ChartAxis::new("bounce", "n", "");
pub(super) const TIME: ChartAxis = ChartAxis::new("time", "t", "s");
pub(super) const CONTACT_ANGLE: ChartAxis = ChartAxis::new("angle at the contact", "θ", "rad");

/// Verdict by the largest modulus of the computed Jacobian's eigenvalues at the fixed point, and the eigenvalue of the angle
/// farthest from 1: (re, im).
fn spectral_radius(scene: &Scene, fixed_point: &FixedPoint) -> (&'static str, f64, (f64, f64)) {
    let matrix = jacobian::jacobian(&scene.model(), &fixed_point.state(), 1).map(|linearization| linearization.matrix);
    let values = matrix.ok().and_then(|matrix| jacobian::eigenvalues(&matrix)).unwrap_or_default();
    let radius = values.iter().copied().map(modulus).fold(0.0, f64::max);
    let verdict = match radius {
        radius if radius > 1.0 + PARABOLIC => "unstable",
        radius if radius < 1.0 - PARABOLIC => "stable",
        _ => "neutral",
    };
    let least = values.iter().min_by(|a, b| a.re.total_cmp(&b.re)).map_or((0.0, 0.0), |value| (value.re, value.im));
    (verdict, radius, least)
}

/// The upright bounce, which every scene of this gallery has.
pub(crate) fn upright(scene: &Scene) -> FixedPoint {
    small_deviations(scene).expect("a test builds every case").fixed_point
}

/// The claim of the eigenvalues of a computed Jacobian.
pub(crate) fn eigenvalue(method: &'static str, scene: &Scene, fixed_point: &FixedPoint) -> MethodClaim {
    let (verdict, radius, (re, im)) = spectral_radius(scene, fixed_point);
    let exact = small_deviations(scene).map_or(f64::NAN, |small| small.linear.spectral_radius());
    let imaginary = if im == 0.0 { String::new() } else { format!(" ± {:.2e}i", im.abs()) };
    let excess = match radius - 1.0 {
        0.0 => String::new(),
        excess => format!(" {} {:.2e}", if excess < 0.0 { '−' } else { '+' }, excess.abs()),
    };
    let detail = format!(
        "the largest modulus comes out as 1{excess} (exactly: {exact:.6}), the angle's eigenvalue as {re:.9}{imaginary}"
    );
    claim(method, verdict, Some(radius), None, detail)
}

/// The paper's l and ρ, m, and its height of release.
const PAPER: [(Name, Value); 3] = [
    (Name::ContactDistance, Number(0.4 / 3.0)),
    (Name::RadiusOfGyration, Number(0.094_280_904_158_206_35)),
    (Name::Height, Number(0.2)),
];

/// The radius of gyration that the paper's triangle really has, m: ρ² = b²/24 + h²/18 with b = 0.1 m, h = 0.2 m.
pub(super) const TRUE_RHO: (Name, Value) = (Name::RadiusOfGyration, Number(0.051_370_116_691_408_14));

/// A table that stands still.
pub(super) const STILL: (Name, Value) = (Name::Strike, Value::Choice("still"));

/// The scene with other numbers.
pub(super) fn changed(scene: &Scene, numbers: &[(Name, f64)]) -> Scene {
    let mut draft = scene.draft();
    for (name, number) in numbers {
        draft.set(*name, Some(Number(*number))).expect("a test builds every case");
    }
    draft.build().expect("a test builds every case")
}

/// The rod of a scene: there are no point masses and no friction in the gallery.
pub(super) fn rod_of(scene: &Scene) -> Rod {
    scene.model().rod
}
