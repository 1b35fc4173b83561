//! Places and words of the reasons for which there is no fit.

use equipoise_physics::fitting::{DataError, FitFailure, FitRequest};

use crate::api::scene::explain;

/// The JSON pointer to the field for which there is no fit, and a sentence on it; `None` of cancelled work.
pub(super) fn place(request: &FitRequest, why: FitFailure) -> Option<(String, String)> {
    let scene = |detail: String| ("/scene".to_owned(), detail);
    Some(match why {
        FitFailure::Cancelled => return None,
        FitFailure::Data(DataError { column, row, detail }) => {
            let pointer = match (column, row) {
                ("", _) => "/measured".to_owned(),
                (column, None) => format!("/measured/{column}"),
                (column, Some(row)) => format!("/measured/{column}/{row}"),
            };
            (pointer, detail)
        }
        FitFailure::Unknown(index, detail) => (format!("/unknown/{index}"), detail),
        FitFailure::Scene(errors) => {
            let details: Vec<String> = explain(errors).into_iter().map(|error| error.detail).collect();
            scene(format!("on the way the fit came to a scene that cannot be: {}", details.join("; ")))
        }
        FitFailure::TooFew { values, unknowns } => {
            let detail = format!(
                "there are {values} values for {unknowns} unknowns, the {} fields and the initial states of the windows; at least {} are \
                 needed",
                request.unknown.len(),
                unknowns + 3
            );
            ("/measured".to_owned(), detail)
        }
        FitFailure::RunEnds => scene(
            "the run of the scene ends among the measured impacts, whatever the start; give first values closer to the rig, and check the units \
             of the data"
                .to_owned(),
        ),
    })
}
