//! `/v1/paper`: each equation, table, figure and claim of the paper, as printed and as computed.
//!
//! Not here: the printed values of the paper's cases, which stand with the presets.

mod figures;
mod item;
mod linear_equations;
mod strike_equations;

use std::sync::OnceLock;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::paper::item::{Item, ItemAnswer};
use crate::api::scene::presets;
use crate::api::scenes::{RESOURCE, fixed};
use crate::http::{ApiRequest, Problem};

/// Price of the checks, without the presets' values, in bounces.
const CHECKS: u64 = 25_000;

/// The answer, once it has been computed.
static PAPER: OnceLock<Paper> = OnceLock::new();

/// Answer of `/v1/paper`.
#[derive(Debug, Serialize, JsonSchema)]
struct Paper {
    /// The items, in the order of the paper.
    items: Vec<ItemAnswer>,
}

impl Paper {
    /// The answer. None if `go_on` says no before it is complete.
    fn get(go_on: &dyn Fn() -> bool) -> Option<&'static Self> {
        if PAPER.get().is_none() {
            let items = items().map(|(section, item)| item.answer(section, go_on)).collect::<Option<_>>()?;
            // Another thread that was faster has set the same.
            let _ = PAPER.set(Self { items });
        }
        PAPER.get()
    }
}

/// The items of each section of the paper.
const SECTIONS: [(&str, &[Item]); 7] = [
    ("2.1.1 System equations", &strike_equations::LOSSLESS),
    ("2.1.2 Linearized analysis", &linear_equations::ITEMS),
    ("2.1.3 Empirical verification", &figures::LOSSLESS),
    ("2.2 Losses, energy feedback and friction", &strike_equations::EXTENSIONS),
    ("2.2 and 3 Verification and conclusions", &figures::EXTENSIONS),
    ("A Impact dynamics", &strike_equations::IMPACT),
    ("B and C Linear and nonlinear systems", &linear_equations::APPENDICES),
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
    let price = if PAPER.get().is_some() { 0 } else { CHECKS + presets };
    fixed(&app, &api_request, "paper", price, |slice| Paper::get(&|| slice.should_continue())).await
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

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
