//! Every picture, with any numbers, is well-formed, safe under a strict CSP, bounded, and has the same bytes everywhere.

use super::*;

pub(crate) const AWKWARD: [f64; 12] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 5e-324, -0.0, 0.0, 1e-12, 1.0, -3.7, 1e17];

/// Checks the rules for every picture, and returns its text.
pub(crate) fn sound(picture: &str) -> String {
    let document = roxmltree::Document::parse(picture).unwrap_or_else(|error| panic!("{error}:\n{picture}"));
    let root = document.root_element();
    assert_eq!(root.tag_name().name(), "svg");
    assert_eq!(root.attribute("role"), Some("img"));
    for name in ["width", "height", "viewBox"] {
        assert!(root.attribute(name).is_some(), "{name}");
    }
    for name in ["title", "desc"] {
        assert!(root.children().any(|node| node.has_tag_name(("http://www.w3.org/2000/svg", name))), "{name}");
    }
    let known = ["svg", "g", "title", "desc", "rect", "path", "circle", "text", "tspan"];
    for node in root.descendants().filter(roxmltree::Node::is_element) {
        assert!(known.contains(&node.tag_name().name()), "{node:?}");
        for attribute in node.attributes() {
            let name = attribute.name();
            assert!(!name.starts_with("on") && name != "style" && name != "href" && name != "class", "{name}");
            assert!(!attribute.value().contains("NaN") && !attribute.value().contains("inf"), "{attribute:?}");
        }
    }
    // The part with the charts is inside of the sheet.
    let numbers = |name: &str| -> Vec<f64> {
        root.attribute(name).unwrap().split(' ').map(|number| number.parse().unwrap()).collect()
    };
    let (sheet, charts) = (numbers("viewBox"), numbers("data-charts"));
    assert!(charts[0] == 0.0 && charts[2] == sheet[2] && charts[1] >= 0.0 && charts[1] + charts[3] <= sheet[3]);
    root.descendants().filter(roxmltree::Node::is_text).filter_map(|node| node.text()).collect::<Vec<_>>().join("|")
}

fn planes<'a>(theta: &'a [f64], theta_dot: Option<&'a [f64]>, x_dot: &'a [f64], y_dot: &'a [f64]) -> String {
    phase_planes(&PhasePlanes { title: "A rod", subtitle: "completed", theta, theta_dot, x_dot, y_dot })
}

fn spectrum(eigenvalues: &[(f64, f64)]) -> Spectrum<'_> {
    Spectrum { eigenvalues, tilt_gain: 1.1, lower: 1.0, critical: 1.5, residue: Some(0.2), rotation: Some(0.927) }
}

fn verdict(linear: Option<Spectrum<'_>>) -> String {
    eigenvalues(&Eigenvalues { title: "A rod", verdict: "unstable", reason: "it falls", linear })
}

#[test]
fn phase_planes_show_every_impact() {
    let theta: Vec<f64> = (0..100).map(|n| f64::from(n) * 0.003).collect();
    let picture = planes(&theta, Some(&theta), &theta, &theta);
    let text = sound(&picture);
    for wanted in ["θ", "θ̇", "ẋ", "ẏ", " (rad)", " (rad/s)", " (m/s)", "A rod", "last (n = 100)", "100 impacts"]
    {
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
    let dots = picture
        .lines()
        .filter(|line| line.contains("round") && line.contains("h0"))
        .map(|line| line.matches("h0").count());
    assert_eq!(dots.collect::<Vec<_>>(), [100, 100, 1]);
}

#[test]
fn a_point_mass_has_one_plane_and_says_so() {
    let text = sound(&planes(&[0.1], None, &[0.1], &[-1.0]));
    assert!(text.contains("no orientation") && !text.contains("θ"), "{text}");
}

#[test]
fn no_numbers_break_phase_planes() {
    for a in AWKWARD {
        for b in AWKWARD {
            sound(&planes(&[a, b], Some(&[b, a]), &[a, a], &[b, b]));
            sound(&planes(&[a], Some(&[b]), &[a], &[b]));
        }
    }
    assert!(sound(&planes(&[], Some(&[]), &[], &[])).contains("no impact"));
    // Slices of different lengths are a mistake of the caller and must not panic.
    sound(&planes(&[1.0], Some(&[]), &[1.0, 2.0], &[0.5]));
    let text = sound(&planes(&[0.0, f64::NAN], Some(&[0.0, 1.0]), &[0.0, 0.1], &[0.0, 0.1]));
    assert!(text.contains("1 that are not finite numbers are left out"), "{text}");
}

#[test]
fn many_impacts_are_thinned_and_the_caption_says_so() {
    let many: Vec<f64> = (0..100_000).map(|n| f64::from(n % 977) - 3.3).collect();
    let picture = planes(&many, Some(&many), &many, &many);
    let text = sound(&picture);
    assert!(text.contains("100000 impacts. One in 5 is drawn"), "{text}");
    assert!(picture.len() < 1_000_000, "{} bytes", picture.len());
}

#[test]
fn eigenvalues_say_the_verdict_with_its_numbers() {
    let text = sound(&verdict(Some(spectrum(&[(0.6, 0.8), (0.6, -0.8), (1.0, 0.0), (1.0, 0.0)]))));
    for wanted in [
        "unstable: it falls",
        " = 1.5",
        "R = 0.2",
        "σ = 0.927 rad per bounce",
        "×2",
        "Re ",
        "Im ",
        "|λ|",
        "1.1",
        "1.2",
        "1.3",
        "1.4",
    ] {
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
    for (lower, critical, wanted) in
        [(1.0, f64::INFINITY, "stable κ: 1 and more."), (f64::NEG_INFINITY, 1.5, "stable κ: up to κ_c = 1.5.")]
    {
        let text = sound(&verdict(Some(Spectrum { lower, critical, ..spectrum(&[(0.6, 0.8)]) })));
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
}

#[test]
fn without_a_fixed_point_the_picture_gives_the_reason() {
    let text = sound(&verdict(None));
    assert!(text.contains("it falls") && text.contains("no fixed point"), "{text}");
}

#[test]
fn no_numbers_break_eigenvalues() {
    for a in AWKWARD {
        for b in AWKWARD {
            let pair = [(a, b), (b, a), (1.0, 0.0)];
            let point = Spectrum { residue: None, rotation: None, ..spectrum(&pair) };
            for linear in [
                Spectrum { tilt_gain: a, residue: Some(b), ..spectrum(&pair) },
                Spectrum { lower: a, critical: b, rotation: Some(a), ..spectrum(&pair) },
                Spectrum { tilt_gain: a, critical: b, ..point },
                Spectrum { eigenvalues: &[], residue: Some(a), ..spectrum(&[]) },
            ] {
                sound(&verdict(Some(linear)));
            }
        }
    }
}

#[test]
fn no_numbers_break_speed_against_accuracy() {
    for a in AWKWARD {
        for b in AWKWARD {
            let series: Vec<_> = SYMBOLS
                .into_iter()
                .map(|symbol| {
                    let points = [([a, b, a], b), ([1.0; 3], a)].into_iter().enumerate();
                    let points = points.map(|(index, (cost, error))| CostAndError { index, cost, error }).collect();
                    Series { symbol, name: "one", label: "<one>", points }
                })
                .collect();
            let picture = speed_accuracy(&SpeedAccuracy {
                title: "Cost",
                subtitle: "error over cost",
                caption: "none",
                cost: ("clock time", "ns"),
                error: "error",
                series: &series,
                front: &[(a, b), (b, a)],
                rounding: a,
            });
            assert!(sound(&picture).contains("<one>"));
        }
    }
}

fn ensemble(curve: &[SurvivalAt], angles: &[AnglesAt]) -> String {
    let subtitle = "12 completed, 8 toppled";
    survival_curve(&SurvivalCurve { title: "Survival", subtitle, caption: "Wilson", curve, angles })
}

#[test]
fn a_survival_curve_says_how_many_were_there() {
    let at = |n: u64| SurvivalAt { at_risk: 2001 - n, share: 1.0 - n as f64 / 2000.0, interval: (0.0, 1.0) };
    let curve: Vec<_> = (1..=1000).map(at).collect();
    let angles = [1, 500, 1000].map(|n| AnglesAt { n, quantiles: [0.0, 0.1, 0.2, 0.3, 0.4] });
    let text = sound(&ensemble(&curve, &angles));
    for wanted in ["at risk", "2000", "1801", "1001", "runs still going", "|θ|", " (rad)", "95 % interval", "5 to 95 %"]
    {
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
    let picture = ensemble(&curve, &angles);
    let document = roxmltree::Document::parse(&picture).unwrap();
    let with =
        |name: &str, value: &str| document.descendants().find(|node| node.attribute(name) == Some(value)).unwrap();
    // A page reads the contact at a place from the panels, and finds the curve, its interval and the number at risk.
    let [upper, lower] = ["survival", "angle"].map(|name| with("data-panel", name));
    assert_eq!((upper.attribute("data-x"), upper.attribute("data-y")), (Some("0 1000"), Some("0 1")));
    assert_eq!((lower.attribute("data-x"), lower.attribute("x")), (Some("0 1000"), upper.attribute("x")));
    let number = |name| upper.attribute(name).unwrap().parse::<f64>().unwrap();
    let curve = with("data-curve", "survival").attribute("d").unwrap();
    let (x, y) = curve.rsplit('L').next().unwrap().split_once(' ').unwrap();
    assert_eq!(x.parse::<f64>().unwrap(), number("x") + number("width"));
    assert_eq!(y.parse::<f64>().unwrap(), number("y") + 0.5 * number("height"));
    assert_eq!(with("data-curve", "interval").children().filter(roxmltree::Node::is_element).count(), 1);
    let risk: Vec<_> = with("data-row", "at-risk").children().filter_map(|node| node.text()).map(str::trim).collect();
    assert!(risk.contains(&"2000") && risk.contains(&"1001"), "{risk:?}");
    let long: Vec<_> = (0..100_000).map(|_| at(1)).collect();
    let falling: Vec<_> = (0..100_000).map(|n| SurvivalAt { share: 1.0 - n as f64 * 1e-5, ..at(1) }).collect();
    assert!(ensemble(&long, &[]).len() < 20_000 && ensemble(&falling, &angles).len() < 100_000);
}

#[test]
fn no_numbers_break_a_survival_curve() {
    for a in AWKWARD {
        for b in AWKWARD {
            let curve = [SurvivalAt { at_risk: u64::MAX, share: a, interval: (b, a) }; 3];
            sound(&ensemble(&curve, &[AnglesAt { n: u64::MAX, quantiles: [a, b, a, b, a] }]));
        }
    }
    sound(&ensemble(&[], &[]));
}

#[test]
fn text_is_escaped_and_bounded() {
    let nasty = "<script>&\"'\u{0}\u{ffff}]]>\n".to_owned() + &"x".repeat(5000);
    let none = Eigenvalues { title: &nasty, verdict: &nasty, reason: &nasty, linear: None };
    let picture = eigenvalues(&none);
    let text = sound(&picture);
    assert!(text.contains("<script>&\"'\u{fffd}\u{fffd}]]>") && !picture.contains("<script"), "{picture}");
    let data = PhasePlanes { title: &nasty, subtitle: &nasty, theta: &[], theta_dot: None, x_dot: &[], y_dot: &[] };
    sound(&phase_planes(&data));
}

#[test]
fn code_has_no_marks_in_a_picture() {
    let text = sound(&eigenvalues(&Eigenvalues {
        title: "A rod",
        verdict: "unstable",
        reason: "ends as `sinking`",
        linear: None,
    }));
    assert!(text.contains("ends as sinking") && !text.contains('`'), "{text}");
}

#[test]
fn an_angle_of_rounding_is_zero_in_a_branch() {
    let changes = [(1.127e-27, "period_doubling"), (0.25, "fold")]
        .map(|(theta, kind)| StabilityChange { at: (1.5, theta), kind });
    let text = sound(&branches(&Branches {
        title: "Orbits",
        name: "Tilt gain",
        symbol: "κ",
        unit: "",
        ends: (1.4, 1.6),
        points: &[(1.5, 1.127e-27, None), (1.55, 0.25, Some(true))],
        changes: &changes,
        critical: None,
    }));
    assert!(text.contains("period doubling at 1.5 (θ = 0 rad), fold at 1.5 (θ = 0.25 rad)"), "{text}");
}

#[test]
fn the_same_numbers_give_the_same_bytes() {
    let theta: Vec<f64> = (0..500).map(|n| f64::from(n * n % 97) * 0.01).collect();
    assert_eq!(planes(&theta, Some(&theta), &theta, &theta), planes(&theta, Some(&theta), &theta, &theta));
    let pair = [(-1.863_324_958, 0.0), (-0.536_675_042, 0.0), (1.0, 0.0), (1.0, 0.0)];
    let beyond = Spectrum { tilt_gain: 1.55, residue: Some(1.1), rotation: None, ..spectrum(&pair) };
    assert_eq!(verdict(Some(beyond)), verdict(Some(beyond)));
}

// Heat maps stay small with any number of cells.

const KAPPA: HeatAxis<'_> = HeatAxis { name: "tilt gain", symbol: "κ", unit: "", from: 1.0, to: 1.6, count: 4 };
const THETA: HeatAxis<'_> =
    HeatAxis { name: "release angle", symbol: "θ₀", unit: "rad", from: 0.0, to: 0.5, count: 3 };

fn map(values: &[Option<f64>]) -> HeatMap<'_> {
    HeatMap {
        title: "A rod",
        subtitle: "1000 impacts",
        x: KAPPA,
        y: THETA,
        values,
        outcomes: &[],
        scale: (0.0, 1000.0),
        quantity: "impacts survived",
        unit: "",
        boundary: &[(1.0, [1.5, 0.0], [1.5, 0.5]), (0.0, [1.0, 0.0], [1.0, 0.5])],
    }
}

/// Draws a heat map and checks that any reader of SVG takes its elements and attributes.
fn checked(map: &HeatMap<'_>) -> String {
    let known = [
        "role",
        "width",
        "height",
        "viewBox",
        "font-family",
        "font-size",
        "font-style",
        "font-weight",
        "text-anchor",
        "x",
        "y",
        "dx",
        "dy",
        "rx",
        "d",
        "fill",
        "stroke",
        "stroke-width",
        "stroke-dasharray",
        "stroke-linejoin",
        "transform",
        "shape-rendering",
        "data-charts",
    ];
    let picture = heat_map(map);
    let document = roxmltree::Document::parse(&picture).expect("XML");
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        for attribute in node.attributes() {
            assert!(known.contains(&attribute.name()), "{attribute:?}");
        }
    }
    sound(&picture);
    picture
}

fn words(map: &HeatMap<'_>) -> String {
    sound(&checked(map))
}

#[test]
fn a_heat_map_says_what_it_shows() {
    let values: Vec<_> = (0..12).map(|n| (n != 5).then_some(f64::from(n) * 100.0)).collect();
    let text = words(&map(&values));
    for wanted in [
        "tilt gain ",
        "κ",
        "θ₀",
        " (rad)",
        "impacts survived",
        "4 × 3 cells",
        "No such scene: 1 cell.",
        "no such scene",
        "(residue 1)",
        "κ = 1 (residue 0)",
        "Beyond the colour bar, and in the colour of its nearer end: 1.",
    ] {
        assert!(text.contains(wanted), "{wanted} is not in {text}");
    }
    let text = words(&HeatMap { boundary: &[], ..map(&[Some(1.0); 12]) });
    assert!(!text.contains("such scene") && !text.contains("boundary") && !text.contains("Beyond"), "{text}");
}

#[test]
fn many_cells_are_binned_and_the_caption_says_so() {
    // Noise: no two neighbours of one colour, the largest a picture can be.
    let values: Vec<_> = (0..4_000_000_u64)
        .map(|n| n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40)
        .map(|noise| (noise % 9 != 0).then_some((noise % 1000) as f64))
        .collect();
    let x = HeatAxis { count: 2000, ..KAPPA };
    let y = HeatAxis { count: 2000, ..THETA };
    let binned = HeatMap { x, y, ..map(&values) };
    let text = words(&binned);
    assert!(text.contains("2000 × 2000 cells") && text.contains("Drawn as 512 × 512; the shade of each"), "{text}");
    let outcomes: Vec<u8> = (0..4_000_000).map(|n| u8::from(n % 2000 < 100)).collect();
    let even = vec![Some(1.0); 4_000_000];
    // Columns 98 to 101 are drawn as one.
    let text = words(&HeatMap { values: &even, outcomes: &outcomes, ..binned });
    assert!(text.replace('|', " ").contains("Mixed are 512: "), "{text}");
    let (x, y) = (HeatAxis { count: 512, ..KAPPA }, HeatAxis { count: 512, ..THETA });
    let noise = checked(&HeatMap { x, y, ..map(&values) });
    assert!(noise.len() < 5_000_000, "{} bytes", noise.len());
    let (x, y) = (HeatAxis { count: 4_000_000, ..KAPPA }, HeatAxis { count: 1, ..THETA });
    let row = checked(&HeatMap { x, y, ..map(&values) });
    assert!(row.len() < 100_000, "{} bytes", row.len());
    let even = vec![Some(1.0); 512 * 512];
    let (x, y) = (HeatAxis { count: 512, ..KAPPA }, HeatAxis { count: 512, ..THETA });
    let even = checked(&HeatMap { x, y, ..map(&even) });
    assert!(even.len() < 60_000, "{} bytes", even.len());
}

#[test]
fn no_numbers_break_heat_maps() {
    for a in AWKWARD {
        for b in AWKWARD {
            let values = [Some(a), None, Some(b), Some(0.5), Some(a), Some(b)];
            let boundary = [(1.0, [a, b], [b, a]), (0.0, [a, a], [1.2, 0.2]), (a, [1.0, 0.1], [1.2, b])];
            for count in [0, 1, 2, 3] {
                let x = HeatAxis { from: a, to: b, count, ..KAPPA };
                let y = HeatAxis { from: b, to: a, count: 2, ..THETA };
                checked(&HeatMap { x, y, scale: (a, b), boundary: &boundary, ..map(&values) });
            }
            checked(&HeatMap { scale: (b, a), boundary: &boundary, ..map(&values) });
        }
    }
}

#[test]
fn degenerate_maps_are_pictures() {
    assert!(words(&map(&[])).contains("No such scene: 12 cells."));
    assert!(words(&map(&[None; 12])).contains("No such scene: 12 cells."));
    assert!(words(&map(&[Some(f64::NAN); 12])).contains("Left out as not finite numbers: 12."));
    let none = HeatAxis { count: 0, ..KAPPA };
    assert!(words(&HeatMap { x: none, ..map(&[]) }).contains("There are no cells to draw."));
    let one = HeatAxis { count: 1, ..KAPPA };
    let alone = HeatMap { x: one, y: HeatAxis { count: 1, ..THETA }, scale: (7.0, 7.0), ..map(&[Some(7.0)]) };
    assert!(words(&alone).contains("1 cell."));
    let huge = HeatAxis { count: usize::MAX, ..KAPPA };
    checked(&HeatMap { x: huge, y: HeatAxis { count: usize::MAX, ..THETA }, ..map(&[Some(7.0)]) });
}

#[test]
fn the_same_map_gives_the_same_bytes() {
    let values: Vec<_> = (0..12).map(|n| (n % 5 != 0).then_some(f64::from(n * n % 7) * 100.0)).collect();
    assert_eq!(heat_map(&map(&values)), heat_map(&map(&values)));
}

#[test]
fn turned_axes_give_the_same_picture() {
    let values: Vec<_> = (0..12).map(|n| Some(f64::from(n) * 10.0)).collect();
    let turned: Vec<_> = values.iter().rev().copied().collect();
    let x = HeatAxis { from: KAPPA.to, to: KAPPA.from, ..KAPPA };
    let y = HeatAxis { from: THETA.to, to: THETA.from, ..THETA };
    assert_eq!(heat_map(&map(&values)), heat_map(&HeatMap { x, y, ..map(&turned) }));
}
