//! Every heat map keeps the rules for pictures, and stays small with any number of cells.

use crate::charts::tests::{AWKWARD, sound};
use crate::charts::*;

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
