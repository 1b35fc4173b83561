//! `/v1/paper`: each equation, table, figure and claim of the paper, as printed and as computed.
//!
//! Not here: the printed values of the paper's cases, which stand with the presets.

mod equations;
mod item;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::catching::catch;
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::scene::Name::{EnergyGain, Friction, Height, Strike, Theta, ThetaDot, TiltGain, XDot};
use equipoise_physics::scene::Value::{Choice, Number};
use equipoise_physics::scene::{Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::paper::item::{Check, Item, Kind, PaperItem};
use crate::api::scene::presets;
use crate::api::scene::quantity::Quantity;
use crate::api::scenes::{RESOURCE, fixed};
use crate::http::{ApiRequest, Problem};

/// Price of the checks, without the presets' values, in bounces.
const CHECKS: u64 = 25_000;

/// Answer of `/v1/paper`.
#[derive(Debug, Serialize, JsonSchema)]
struct Paper {
    /// The items, in the order of the paper.
    items: Vec<PaperItem>,
}

/// The items of each section of the paper.
const SECTIONS: [(&str, &[Item]); 7] = [
    ("2.1.1 System equations", &SYSTEM),
    ("2.1.2 Linearized analysis", &LINEARIZED),
    ("2.1.3 Empirical verification", &LOSSLESS),
    ("2.2 Losses, energy feedback and friction", &LOSSES),
    ("2.2 and 3 Verification and conclusions", &EXTENSIONS),
    ("A Impact dynamics", &IMPACT),
    ("B and C Linear and nonlinear systems", &APPENDICES),
];

/// All items with their sections, in the order of the paper.
fn items() -> impl Iterator<Item = (&'static str, &'static Item)> {
    SECTIONS.iter().flat_map(|&(section, items)| items.iter().map(move |item| (section, item)))
}

/// The route.
pub(super) fn routes() -> Router<App> {
    Router::new().route("/v1/paper", get(paper))
}

/// Adds the path to the contract.
pub(super) fn describe(contract: &mut Contract) {
    contract.document::<Paper>("Gallery", "paper", "listPaper", RESOURCE.formats);
}

async fn paper(State(app): State<App>, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
    let presets: u64 = presets::all().iter().map(presets::Preset::price).sum();
    fixed(&app, &api_request, "paper", CHECKS + presets, |slice| {
        let go_on = || slice.should_continue();
        Some(Paper { items: items().map(|(section, item)| item.answer(section, &go_on)).collect::<Option<_>>()? })
    })
    .await
}

/// A figure of the phase planes of a run.
const fn planes(id: &'static str, place: &'static str, title: &'static str, printed: &'static str) -> Item {
    Item::new(Kind::Figure, id, place, title, printed).ask("trajectories", "bounces=2000").drawn()
}

/// α = κθ at the first contact.
fn tilt(scene: &Scene) -> Option<Vec<Check>> {
    let contact = scene.orbit().ok()?.advance();
    let printed = scene.parameters::<f64>().tilt_gain * contact.state.theta;
    Some(vec![Check::formula(["table tilt at the first contact", "α", "rad"], printed, contact.alpha)])
}

/// Velocities of the body at the end of a catch: those of the table, which stands.
fn caught(scene: &Scene) -> Option<Vec<Check>> {
    let settings = CatchSettings { strategy: Some(Strategy::BounceDown), ..CatchSettings::default() };
    let hold = catch(scene, &settings, None, &mut || true).ok()?.hold?;
    let end = hold.samples.last()?;
    let at_rest = |words, value| Check::within(words, 0.0, value, 1e-3);
    Some(vec![
        at_rest(["horizontal velocity after the hold", "ẋ", "m/s"], end.x_dot),
        at_rest(["angular velocity after the hold", "θ̇", "rad/s"], end.theta_dot),
    ])
}

/// Case 4 in the middle of its swing, so that all terms differ from 0.
const SWINGING: [(Name, Value); 2] = [(ThetaDot, Number(0.5)), (XDot, Number(0.1))];

/// The same on a table that does not move.
const STILL: [(Name, Value); 4] =
    [(Strike, Choice("still")), (EnergyGain, Number(0.0)), (ThetaDot, Number(0.5)), (XDot, Number(0.1))];

/// Case 1 with friction: the first contact slides.
const SLIDING: [(Name, Value); 2] = [(Friction, Number(0.02)), (XDot, Number(0.3))];

/// Section 2.1.2.
#[rustfmt::skip]
const LINEARIZED: [Item; 6] = [
    Item::new(Kind::Equation, "speed", "(10)", "Speed of the upright bounce", "ẏ* = −√(2G(y₀ − l cos θ) + v₀ᵀv₀)")
        .ask("stability", "bounces=2000").checked(equations::speed)
        .because("Eq. (10) gives the speed of the first impact. The upright bounce of the same energy has l in place of l cos θ, and the energy of the drift less: ẏ* = −√(2G(y₀ − l) + v₀ᵀv₀ − c²). Table 1's κ_critical is computed with it"),
    Item::new(Kind::Equation, "linearization", "(11), (12), (13)", "The linear map near the upright bounce", "δxₙ = [J(x*)]ⁿ δx₀")
        .of("case-1").with(&[(Theta, Number(1e-4))]).ask("trajectories", "bounces=20&method=linear").checked(equations::linearization),
    Item::new(Kind::Equation, "jacobian", "(14)", "The Jacobian at the upright bounce",
        "J₁₁ = 1 + 4ẏ*²(1 − κ)l/(Gρ²), J₁₄ = −2ẏ*/G, J₂₁ = 2ẏ*κ/ρ, J₄₁ = 2ẏ*(κ − 1)l/ρ², 1 on the rest of the diagonal")
        .ask("jacobians", "at=fixed_point").checked(equations::entries),
    Item::new(Kind::Equation, "eigenvalues", "(15)", "The eigenvalues of the angle", "λ₃,₄ = [2ẏ*²l(1 − κ) + Gρ² ± 2ẏ*²l √(κ − 1) √(ẏ*²l(κ − 1) − Gρ²)]/(Gρ²)")
        .ask("stability", "bounces=2000&format=svg").checked(equations::eigenvalues)
        .because("(15) has the factor 2ẏ*²l before the two roots and needs 2ẏ*√l. κ = 1.1 then gives 0.6 ± 0.8i, of modulus 1, as (18) says"),
    Item::new(Kind::Equation, "solution", "(16), (20)–(23)", "The solution of the linear map",
        "δxₙ = c₁(0, 1, 0, 0) + c₂(0, 0, 1, 0) + 2 Re(c₃ e^(jσn) (a + jb, g, 0, h)), c₁ = δx₀ − (ρδθ₀/h) g")
        .of("case-2").ask("trajectories", "bounces=200").drawn().checked(equations::solution)
        .because("(21)–(23) lack dots: c₁ = δẋ₀ − (ρδθ̇₀/h) g, c₂ = δẏ₀ − ẏ*, and the first two terms of c₃ have δθ̇₀. With the dots c₁ is the drift of the balanced rod"),
    Item::new(Kind::Equation, "stable-range", "(17), (18), (19)", "The stable range of the tilt gain",
        "κ < 1: unstable; 1 < κ < 1 + Gρ²/(ẏ*²l): |λ₃,₄| = 1, stable; above: unstable")
        .ask("stability", "bounces=2000").checked(equations::stable_range),
];

/// Appendices B and C.
#[rustfmt::skip]
const APPENDICES: [Item; 2] = [
    Item::new(Kind::Claim, "conservative", "Appendix B", "Determinant and pairs of eigenvalues", "det J = 1; with λ also 1/λ is an eigenvalue")
        .ask("jacobians", "at.impact=1").checked(equations::conservative).quoting(&[("case-1", Quantity::Determinant)]),
    Item::new(Kind::Equation, "jordan", "(37), (38)", "At κ_critical", "λ₃,₄ = 1; δxₙ = … + (c₃(−1)ⁿ + n c₄) V₃ + c₄(−1)ⁿ V₄")
        .of("critical-soft").ask("stability", "bounces=20000")
        .quoting(&[("critical-soft", Quantity::CriticalEigenvalue), ("critical-soft", Quantity::SecondPower)]),
];

/// Section 2.1, the lossless strike and the flight.
#[rustfmt::skip]
const SYSTEM: [Item; 4] = [
    Item::new(Kind::Equation, "reflection", "(1), (2), (6)", "The lossless strike is a reflection",
        "Δv = −2 (n̂ᵀv⁻) n̂ with n̂ = ρ/√(ρ² + l² sin²β) · (−sin α, cos α, (l/ρ) sin β); v⁺ = (I − 2n̂n̂ᵀ) v⁻")
        .of("case-1").with(&SWINGING).ask("trajectories", "bounces=10")
        .checked(equations::reflection),
    Item::new(Kind::Equation, "point-mass", "(3), (4), (5), Fig. 2, Fig. 3", "The angle of a ball's velocity shrinks geometrically",
        "θₙ₊₁ = θₙ − 2αₙ, with α = κθ: θₙ = (1 − 2κ)ⁿ θ₀")
        .of("point-mass").with(&[(TiltGain, Number(0.3))]).ask("trajectories", "bounces=20").drawn().checked(equations::point_mass),
    Item::new(Kind::Equation, "flight", "(7), (8)", "The flight and the time of the next contact",
        "ẏ(t) = ẏ₀ − Gt; ẋ and ρθ̇ stay; l cos θ₀ + ẏ₀t − ½Gt² = l cos(θ₀ + θ̇₀t) at the next contact")
        .ask("trajectories", "bounces=10&samples_per_flight=8").checked(equations::flight),
    Item::new(Kind::Equation, "recurrence", "(9)", "The return map", "xₙ₊₁ = f(α, xₙ, τ(xₙ)) with x = (ρθ, ẋ, ẏ, ρθ̇)")
        .ask("trajectories", "bounces=10").checked(equations::recurrence),
];

/// Section 2.2: restitution, energy feedback, friction.
#[rustfmt::skip]
const LOSSES: [Item; 4] = [
    Item::new(Kind::Equation, "inelastic", "(24)", "A lossy strike of a moving table", "v⁺ = (I − (1 + e) n̂n̂ᵀ) v⁻ + (1 + e) n̂n̂ᵀ v_table")
        .of("case-4").with(&SWINGING).ask("trajectories", "bounces=10").checked(equations::inelastic),
    Item::new(Kind::Equation, "compensation", "(25), (26), (27)", "The table makes up for the loss",
        "v_table = −(1 − e)/(1 + e) v⁻, or −(1 − e)/(1 + e) n̂n̂ᵀ(ẋ_c, ẏ_c, 0) with ẋ_c = ẋ + lθ̇ cos θ, ẏ_c = ẏ + lθ̇ sin θ")
        .of("case-4").with(&[(EnergyGain, Number(0.0)), (ThetaDot, Number(0.5)), (XDot, Number(0.1))])
        .ask("trajectories", "bounces=10").checked(equations::compensation)
        .because("With (25) the strike is that of the lossless case, as the paper says. As a velocity of the table, (27) needs the contact point's speed along the normal itself: n̂ has length 1 in (x, y, ρθ) and not in the plane, so its first two components alone would be too slow by ρ²/(ρ² + l² sin²β)"),
    Item::new(Kind::Equation, "energy-feedback", "(28)", "Energy feedback", "v_table = −[(1 − e)/(1 + e) + κ_E(η* − η)] v_contact, η* = Gy*, η = Gl cos θ + ½ẏ²")
        .of("case-4").with(&SWINGING).ask("trajectories", "bounces=100").checked(equations::energy_feedback),
    Item::new(Kind::Equation, "friction-moment", "(30), Fig. 10", "The moment of an impulse with friction",
        "M = P_n l sin β + P_t l cos β, with P_t = μP_n sgn(−v_tc) while it slides")
        .of("case-1").with(&SLIDING).ask("trajectories", "bounces=10").checked(equations::friction_moment),
];

/// Appendix A, the dynamics of an impact.
#[rustfmt::skip]
const IMPACT: [Item; 3] = [
    Item::new(Kind::Equation, "impulses", "(31), (32), (33)", "Impulses and the velocity of the contact point",
        "v_t − v_t0 = P_t, v_n − v_n0 = P_n, ρ²(ω − ω₀) = P_t l cos β + P_n l sin β (m = 1); v_tc = v_t + lω cos β, v_nc = v_n + lω sin β")
        .of("case-1").with(&SLIDING).ask("trajectories", "bounces=10").checked(equations::impulses),
    Item::new(Kind::Equation, "newton", "(34), (35)", "Newton's impact without friction",
        "P_t = 0, P_n = −(1 + e) ρ²/(ρ² + l² sin²β) v_nc0, P_ω = l sin β P_n (m = 1)")
        .of("case-4").with(&STILL).ask("trajectories", "bounces=10").checked(equations::newton),
    Item::new(Kind::Equation, "lossy-reflection", "(36)", "The strike in the axes of the plane", "Δv = −(1 + e) n̂n̂ᵀ v⁻")
        .of("case-4").with(&STILL).ask("trajectories", "bounces=10").checked(equations::lossy_reflection),
];

/// Section 2.1.3.
#[rustfmt::skip]
const LOSSLESS: [Item; 8] = [
    Item::new(Kind::Figure, "figure-1", "Fig. 1", "The geometry of the system", "β = θ − α; α, β and θ count counter-clockwise; α = κθ")
        .checked(tilt).because("The scene shows these symbols at the first contact"),
    Item::new(Kind::Table, "table-1", "Table 1", "The lossless cases", "κ_critical = 1.5 in cases 1 to 3; case 2 starts with θ̇₀ = 0.1 rad/s")
        .ask("stability", "bounces=2000")
        .quoting(&[("case-1", Quantity::CriticalTiltGain), ("case-2", Quantity::CriticalTiltGain), ("case-3", Quantity::CriticalTiltGain), ("case-2-figure", Quantity::ReleaseSpin)]),
    Item::new(Kind::Figure, "figure-4", "Fig. 4", "The simulated triangle", "isosceles, 0.10 m wide and 0.20 m high, ρ = 9.428 cm")
        .of("triangle-polygon").ask("trajectories", "bounces=2000").drawn().quoting(&[("triangle-polygon", Quantity::RadiusOfGyration)]),
    planes("figure-5", "Fig. 5", "Case 1: both planes are centred on the origin", "θ₀ = 0.3 rad, θ̇₀ = 0, κ = 1.1"),
    planes("figure-6", "Fig. 6", "Case 2: the rod drifts", "θ₀ = 0, θ̇₀ = 0.2 rad/s, κ = 1.1")
        .of("case-2-figure"),
    planes("figure-7", "Fig. 7", "Case 3: the swings grow until it falls", "θ₀ = 0.1 rad, κ = 1.55 > κ_critical")
        .of("case-3"),
    Item::new(Kind::Claim, "angles", "section 2.1.3", "The angles that are stable", "stable for angular deviations up to about ±0.4 rad")
        .ask("regions", "x.field=release.theta&x.from=0&x.to=0.5&x.count=101&y.field=table.tilt_gain&y.from=1.1&y.to=1.1&y.count=1")
        .quoting(&[("case-1", Quantity::BoundedAngle)]),
    Item::new(Kind::Claim, "angles-critical", "section 2.1.3, at κ_critical", "Small angles up to the critical gain",
        "±0.15 rad or less is stable up to and including κ_critical")
        .of("critical-soft").ask("stability", "bounces=20000")
        .quoting(&[("critical-soft", Quantity::BoundedAngle), ("critical-soft", Quantity::BoundedTiltGain)]),
];

/// Sections 2.2.2 to 3.
#[rustfmt::skip]
const EXTENSIONS: [Item; 11] = [
    Item::new(Kind::Equation, "critical-gain-lossy", "(29)", "The critical tilt gain with restitution", "κ_critical = 1 + 2Gρ²/((1 + e)ẏ*²l)")
        .of("case-4").ask("stability", "bounces=2000").checked(equations::critical_gain_lossy)
        .because("κ_c does not depend on e: the table makes up for the loss, so that the strike is that of the lossless case. (18) holds, and Table 2's 1.28 is its value"),
    Item::new(Kind::Claim, "energy-gain", "section 2.2.2", "The range of the energy gain", "0 < κ_E < 4/((1 + e)ẏ*²); the eigenvalue of ẏ is 1 − κ_E/κ_E,max")
        .of("case-4").ask("stability", "bounces=2000")
        .quoting(&[("case-4", Quantity::UpperEnergyGain), ("case-4", Quantity::EnergyEigenvalue)]),
    Item::new(Kind::Table, "table-2", "Table 2", "The cases with energy feedback", "ẏ* = −1.27 m/s, κ_critical = 1.28, κ_E = 0.165, E = 1.73")
        .of("case-4").ask("stability", "bounces=2000")
        .quoting(&[("case-4", Quantity::FixedPointSpeed), ("case-4", Quantity::CriticalTiltGain), ("case-4", Quantity::TargetEnergy), ("case-4", Quantity::GravityInPlane)]),
    planes("figure-8", "Fig. 8", "Case 4: the energy settles", "converges to the correct energy level, E = 1.73")
        .of("case-4").quoting(&[("case-4", Quantity::SettledEnergy), ("case-4", Quantity::SettledVerticalEnergy)]),
    planes("figure-9", "Fig. 9", "Case 5: then like the lossless case", "then the behaviour of the system is similar to the lossless case")
        .of("case-5").quoting(&[("case-5", Quantity::AngleGrowth)]),
    Item::new(Kind::Claim, "friction", "section 2.2.3", "Friction and the energy gain", "increasing κ_E also prolongs the time that the object can be kept upright")
        .of("case-4").ask("trajectories", "bounces=2000").quoting(&[("case-4", Quantity::HelpedFriction)]),
    planes("figure-11", "Fig. 11", "Case 1 with noise", "remains stable in a similar range, with 10 ms of Gaussian noise in the time of impact")
        .of("case-1-noise").because("One run says little: of many runs of case 1 under this noise some 45 % survive 400 bounces"),
    planes("figure-12", "Fig. 12", "Case 4 with noise", "as Fig. 11, for case 4")
        .of("case-4-noise").because("Of many runs of case 4 under this noise some 91 % survive 400 bounces"),
    Item::new(Kind::Claim, "settling", "section 3", "To settle is to come to rest", "the stable state of catching is zero relative velocity")
        .of("still-lossy").ask("trajectories", "bounces=2000").quoting(&[("still-lossy", Quantity::SettledSpin)]),
    Item::new(Kind::Claim, "catching", "section 3", "Catching is the dual problem",
        "we would like to plan the movements of the hand so that the object does not fall or bounce away, but settles there")
        .of("case-1").with(&[(Height, Number(0.25)), (Theta, Number(0.1))]).ask("catches", "strategy=bounce_down").drawn()
        .checked(caught)
        .because("The paper leaves this open. Neither its energy feedback nor α = κθ settles the object. Strikes that each halve the contact speed do, with a tilt that follows position and velocities, and then the table holds it"),
    Item::new(Kind::Claim, "radius", "section 2.1.2", "The stable range with the triangle's own radius of gyration", "κ_critical = 1.5")
        .of("triangle-polygon").ask("stability", "bounces=2000").quoting(&[("triangle-polygon", Quantity::CriticalTiltGain)]),
];

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_item_is_computed_and_a_difference_has_a_reason() {
        let mut ids = HashSet::new();
        for (section, item) in items() {
            assert!(ids.insert(item.id), "{} occurs twice", item.id);
            let answer = item.answer(section, &|| true).unwrap();
            for check in &answer.checks {
                assert!(check.computed.is_finite(), "{}: {check:?}", item.id);
                let reason = check.why.is_some() || item.why.is_some();
                assert!(check.agrees || reason, "{}: {check:?}", item.id);
            }
            assert!(
                !answer.checks.is_empty() || answer.picture.is_some() || item.why.is_some(),
                "{} shows nothing",
                item.id
            );
        }
    }

    #[test]
    fn all_equations_tables_and_figures_of_the_paper_are_there() {
        let mut places = HashSet::new();
        for (_, item) in items() {
            for part in item.place.split(", ") {
                if let Some((first, last)) = part.split_once('–') {
                    let number = |text: &str| text.trim_matches(['(', ')']).parse::<u32>().unwrap();
                    places.extend((number(first)..=number(last)).map(|number| format!("({number})")));
                } else {
                    places.insert(part.to_owned());
                }
            }
        }
        let equations = (1..=38).map(|number| format!("({number})"));
        let tables = (1..=2).map(|number| format!("Table {number}"));
        let figures = (1..=12).map(|number| format!("Fig. {number}"));
        for place in equations.chain(tables).chain(figures) {
            assert!(places.contains(&place), "{place} is missing");
        }
    }

    #[test]
    fn the_errata_are_found_and_nothing_else_differs() {
        let differs: Vec<_> = items()
            .filter(|(section, item)| item.answer(section, &|| true).unwrap().checks.iter().any(|check| !check.agrees))
            .map(|(_, item)| item.id)
            .collect();
        let known = [
            "speed",
            "eigenvalues",
            "table-1",
            "figure-4",
            "angles",
            "angles-critical",
            "critical-gain-lossy",
            "energy-gain",
            "table-2",
            "figure-8",
            "figure-9",
            "friction",
            "settling",
            "radius",
            "conservative",
            "jordan",
        ];
        assert_eq!(differs.iter().collect::<HashSet<_>>(), known.iter().collect::<HashSet<_>>(), "{differs:?}");
    }
}
