//! The quality of a fit in words: does the model explain the data?

use super::statistics::chi_squared_deviate;

/// A judgement of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityKind {
    /// Residuals are as large as the standard deviations say, and random.
    Good,
    /// Residuals are smaller than the standard deviations say.
    DeviationsTooLarge,
    /// Residuals follow a pattern.
    NotRandom,
    /// Short windows explain the data, longer ones do not.
    NotFollowed,
    /// Residuals are larger than the standard deviations allow.
    NotExplained,
    /// The iterations ran out.
    NotConverged,
}

names!(
    QualityKind: Good => "good", DeviationsTooLarge => "deviations_too_large", NotRandom => "not_random",
        NotFollowed => "not_followed", NotExplained => "not_explained", NotConverged => "not_converged"
);

/// A judgement with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// The judgement.
    pub kind: QualityKind,
    /// Reason, in a sentence with numbers.
    pub detail: String,
}

/// Normal deviate beyond which χ², or the correlation of neighbours, is no chance: one of a thousand is beyond it.
const NO_CHANCE: f64 = 3.3;

#[derive(Clone, Copy, Debug)]
pub(super) struct FitFacts {
    pub(super) converged: bool,
    pub(super) chi_squared: f64,
    pub(super) freedom: f64,
    /// True if no standard deviation was estimated.
    pub(super) all_given: bool,
    /// Impacts of the longest window.
    pub(super) longest_window: usize,
    /// False if longer windows do not explain the data.
    pub(super) is_followed: bool,
}

/// Judges a fit by χ² (which says something where a standard deviation was given), by the length of its windows, and by the correlation of
/// neighbouring residuals: name of the column, correlation, and number of pairs.
pub(super) fn judge(facts: &FitFacts, neighbours: Option<(&'static str, f64, usize)>) -> Quality {
    let FitFacts { converged, chi_squared, freedom, all_given, longest_window, is_followed } = *facts;
    let quality = |kind, detail| Quality { kind, detail };
    if !converged {
        let detail = "the iterations ran out before the minimum was found; the estimates are not to be used";
        return quality(QualityKind::NotConverged, detail.to_owned());
    }
    let ratio = chi_squared / freedom;
    if all_given {
        let deviate = chi_squared_deviate(chi_squared, freedom);
        if deviate > NO_CHANCE {
            let detail = format!(
                "chi_squared is {ratio} per degree of freedom, {deviate} standard deviations too much: the model does not explain the \
                 data at these sd, so neither estimates nor intervals are to be trusted"
            );
            return quality(QualityKind::NotExplained, detail);
        }
        if deviate < -NO_CHANCE {
            let detail = format!(
                "chi_squared is {ratio} per degree of freedom: sd are larger than the residuals show, and so are the intervals"
            );
            return quality(QualityKind::DeviationsTooLarge, detail);
        }
    }
    if !is_followed {
        let detail = format!(
            "windows of up to {longest_window} impacts explain the data and longer ones do not: something that adds up from impact to impact \
             is missing in the model, a wrong field or noise of the table; estimates are those of the short windows"
        );
        return quality(QualityKind::NotFollowed, detail);
    }
    if let Some((column, correlation, count)) = neighbours
        && correlation.abs() * (count as f64).sqrt() > NO_CHANCE
    {
        let detail = format!(
            "neighbouring residuals of {column} have a correlation of {correlation}, which {count} random ones would not have: the model \
             may not explain the data"
        );
        return quality(QualityKind::NotRandom, detail);
    }
    let detail = if all_given {
        format!("chi_squared is {ratio} per degree of freedom, as the sd say, and residuals look random")
    } else {
        "residuals look random; sd is estimated from them, so compare it with what the instruments are known for"
            .to_owned()
    };
    quality(QualityKind::Good, detail)
}
