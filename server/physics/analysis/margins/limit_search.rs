//! Search of the largest distance up to which all distances tried keep a verdict.

use super::judgement::{Judgement, LimitedBy, NoBudget, VerdictLimit};
use crate::analysis::limits::Bracket;

/// Distances of the first scan: from the end of the range down, each half of the one before.
const HALVES: u32 = 20;

/// Distances of the scan further down if the first one is lost already, each half of the one before: to 1e-9 of the range. If these are lost too,
/// no distance is left.
const FURTHER_HALVES: usize = 10;

/// Bisections of the distance at which the verdict is lost: to 1/4096 of it.
const BISECTIONS: usize = 12;

/// Evenly spaced distances within the limit at which the verdict is looked at again.
const CHECKS: usize = 16;

/// Most distances of one search that are judged with a run. A scan further down is in place of one up, and shorter.
pub(super) const MOST_TRIED: u64 = HALVES as u64 + 1 + 2 * BISECTIONS as u64 + CHECKS as u64;

/// The limit of a distance up to `end`, by `judge`. `small` is where the limit of small deviations is, if it has one: beyond it no run is needed.
pub(super) fn search(
    end: f64,
    small: Option<VerdictLimit>,
    mut judge: impl FnMut(f64) -> Result<Judgement, NoBudget>,
) -> Result<VerdictLimit, NoBudget> {
    let mut judged = |distance: f64| {
        let judgement = judge(distance)?;
        let is_kept = judgement == Judgement::Kept;
        Ok((judgement, is_kept))
    };
    let reach = small.as_ref().map_or(end, |limit| limit.value);
    let mut found = if reach == 0.0 { None } else { first_loss(reach, &mut judged)? };
    let kept = found.as_ref().map_or(reach, |bracket| bracket.kept.0);
    let spacing = kept / (CHECKS + 1) as f64;
    let mut below = 0.0;
    for check in 1..=if kept == 0.0 { 0 } else { CHECKS } {
        let distance = spacing * check as f64;
        let (judgement, is_kept) = judged(distance)?;
        if !is_kept {
            let mut gap = Bracket { kept: (below, Judgement::Kept), lost: (distance, judgement) };
            gap.halve(BISECTIONS, |distance, _| judged(distance))?;
            found = Some(gap);
            break;
        }
        below = distance;
    }
    let linear = small.as_ref().and_then(|limit| limit.linear);
    Ok(match (found, small) {
        (Some(Bracket { kept: (value, _), lost: (beyond, Judgement::Lost { by, ending, detail }) }), _) => {
            VerdictLimit { value, accuracy: beyond - value, spacing, by, ending, detail, linear }
        }
        (_, Some(small)) => VerdictLimit { spacing, ..small },
        (_, None) => VerdictLimit {
            value: end,
            accuracy: 0.0,
            spacing,
            by: LimitedBy::Range,
            ending: None,
            detail: "nothing is lost up to the end of the range".to_owned(),
            linear: None,
        },
    })
}

/// The first loss on the way to `end`, narrowed; `None` if nothing is lost at the distances scanned.
fn first_loss(
    end: f64,
    mut judged: impl FnMut(f64) -> Result<(Judgement, bool), NoBudget>,
) -> Result<Option<Bracket<Judgement>>, NoBudget> {
    let mut kept = (0.0, Judgement::Kept);
    for step in (0..=HALVES).rev() {
        let distance = end / f64::from(1_u32 << step);
        let (judgement, is_kept) = judged(distance)?;
        if is_kept {
            kept = (distance, judgement);
            continue;
        }
        let mut bracket = Bracket { kept, lost: (distance, judgement) };
        if step == HALVES {
            bracket.halve(FURTHER_HALVES, |distance, _| judged(distance))?;
        }
        if bracket.kept.0 > 0.0 {
            bracket.halve(BISECTIONS, |distance, _| judged(distance))?;
        }
        return Ok(Some(bracket));
    }
    Ok(None)
}
