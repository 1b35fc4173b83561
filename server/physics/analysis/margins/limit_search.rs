//! Search of the largest distance up to which all distances tried keep a verdict.

use super::judgement::{Judgement, LimitedBy, NoBudget};

/// Distances of the first scan: from the end of the range down, each half of the one before.
const HALVES: u32 = 20;

/// Distances of the scan further down if the first one is lost already, each half of the one before: to 1e-9 of the range. If these are lost too,
/// no distance is left.
const FURTHER_HALVES: u32 = 10;

/// Bisections of the distance at which the verdict is lost: to 1/4096 of it.
const BISECTIONS: usize = 12;

/// Bisections of the linear limit, which needs no run: to rounding.
const LINEAR_BISECTIONS: usize = 60;

/// Evenly spaced distances within the limit at which the verdict is looked at again.
const CHECKS: usize = 16;

/// Most distances of one search that are judged with a run. A scan further down is in place of one up, and shorter.
pub(super) const MOST_TRIED: u64 = HALVES as u64 + 1 + 2 * BISECTIONS as u64 + CHECKS as u64;

/// A limit of an error, or of a factor on errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Largest distance from 0 up to which every distance tried keeps the verdict.
    pub value: f64,
    /// Distance from there to the nearest one found that loses it; 0 where nothing is lost up to the end of the range.
    pub accuracy: f64,
    /// Spacing of the distances tried below it: a narrower gap may have been missed.
    pub spacing: f64,
    /// Criterion that is lost.
    pub by: LimitedBy,
    /// End of the run that is lost, where one is.
    pub ending: Option<&'static str>,
    /// Loss in a sentence.
    pub detail: String,
    /// Limit by the linear verdict alone, that is for small deviations of the state; `None` where errors leave no linear verdict, and where
    /// it is kept over the whole range.
    pub linear: Option<f64>,
}

/// The loss at a distance.
struct Loss {
    by: LimitedBy,
    ending: Option<&'static str>,
    detail: String,
}

/// A distance that keeps the verdict and a larger one that does not.
struct Bracket {
    kept: f64,
    lost: f64,
    loss: Loss,
}

/// The limit of a distance up to `end`. `judge` takes a distance, and whether the linear verdict is enough.
pub(super) fn search(
    end: f64,
    mut judge: impl FnMut(f64, bool) -> Result<Judgement, NoBudget>,
) -> Result<Limit, NoBudget> {
    let linear = first_loss(end, LINEAR_BISECTIONS, |distance| judge(distance, true))?;
    // Beyond it no run is needed.
    let reach = linear.as_ref().map_or(end, |bracket| bracket.kept);
    let mut found = if reach == 0.0 { None } else { first_loss(reach, BISECTIONS, |distance| judge(distance, false))? };
    let kept = found.as_ref().map_or(reach, |bracket| bracket.kept);
    let spacing = kept / (CHECKS + 1) as f64;
    let mut below = 0.0;
    let checks = if kept == 0.0 { 0 } else { CHECKS };
    for check in 1..=checks {
        let distance = spacing * check as f64;
        if let Some(loss) = lost(judge(distance, false)?) {
            let gap = Bracket { kept: below, lost: distance, loss };
            found = Some(narrowed(gap, BISECTIONS, |distance| judge(distance, false))?);
            break;
        }
        below = distance;
    }
    let is_linear = |bracket: &&Bracket| bracket.loss.by != LimitedBy::Refused;
    let linear_limit = linear.as_ref().filter(is_linear).map(|bracket| bracket.kept);
    let limit = match found.or(linear) {
        Some(Bracket { kept, lost, loss: Loss { by, ending, detail } }) => {
            Limit { value: kept, accuracy: lost - kept, spacing, by, ending, detail, linear: linear_limit }
        }
        None => Limit {
            value: end,
            accuracy: 0.0,
            spacing,
            by: LimitedBy::Range,
            ending: None,
            detail: "nothing is lost up to the end of the range".to_owned(),
            linear: None,
        },
    };
    Ok(limit)
}

fn lost(judgement: Judgement) -> Option<Loss> {
    match judgement {
        Judgement::Kept => None,
        Judgement::Lost { by, ending, detail } => Some(Loss { by, ending, detail }),
    }
}

/// The first loss on the way to `end`, narrowed; `None` if nothing is lost at the distances scanned.
fn first_loss(
    end: f64,
    bisections: usize,
    mut judge: impl FnMut(f64) -> Result<Judgement, NoBudget>,
) -> Result<Option<Bracket>, NoBudget> {
    let mut kept = 0.0;
    let mut distance = end / f64::from(1_u32 << HALVES);
    if let Some(loss) = lost(judge(distance)?) {
        return further_down(Bracket { kept, lost: distance, loss }, bisections, judge).map(Some);
    }
    for step in (0..HALVES).rev() {
        kept = distance;
        distance *= 2.0;
        let at = if step == 0 { end } else { distance };
        if let Some(loss) = lost(judge(at)?) {
            return narrowed(Bracket { kept, lost: at, loss }, bisections, judge).map(Some);
        }
    }
    Ok(None)
}

/// The loss below a distance that is lost, narrowed; at 0 if all that are scanned are lost.
fn further_down(
    mut bracket: Bracket,
    bisections: usize,
    mut judge: impl FnMut(f64) -> Result<Judgement, NoBudget>,
) -> Result<Bracket, NoBudget> {
    for _ in 0..FURTHER_HALVES {
        let distance = 0.5 * bracket.lost;
        match lost(judge(distance)?) {
            None => return narrowed(Bracket { kept: distance, ..bracket }, bisections, judge),
            Some(loss) => (bracket.lost, bracket.loss) = (distance, loss),
        }
    }
    Ok(bracket)
}

fn narrowed(
    mut bracket: Bracket,
    bisections: usize,
    mut judge: impl FnMut(f64) -> Result<Judgement, NoBudget>,
) -> Result<Bracket, NoBudget> {
    for _ in 0..bisections {
        let middle = 0.5 * (bracket.kept + bracket.lost);
        if middle <= bracket.kept || middle >= bracket.lost {
            break;
        }
        match lost(judge(middle)?) {
            None => bracket.kept = middle,
            Some(loss) => (bracket.lost, bracket.loss) = (middle, loss),
        }
    }
    Ok(bracket)
}
