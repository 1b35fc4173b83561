//! Catching up: computes a live run from its release up to the present.

use equipoise_physics::run::cancellation::CHECK_INTERVAL;

use crate::compute::{Cancelled, OverBudget, Price, TimeSlice};
use crate::http::Problem;
use crate::limits;
use crate::limits::Limit;
use crate::live::run_url::LiveRequest;
use crate::live::session::SessionContext;
use crate::runs::playback::Playback;
use crate::runs::run::Run;

/// Reasons not to catch up with a run.
#[derive(Debug)]
pub enum CatchUpError {
    /// The work would pass the limit.
    OverBudget(OverBudget),
    /// The client has gone.
    Cancelled,
}

/// Returns the run just before impact `from`; without `from`, just before the last impact so far. The run is computed up to the run
/// time `until`, s, in any case, so that the price of all impacts up to then is known.
///
/// # Errors
/// The work passes `limit`, or it is cancelled.
pub fn catch_up(
    run: &Run,
    from: Option<u64>,
    until: f64,
    limit: &Limit,
    slice: &TimeSlice,
) -> Result<Playback, CatchUpError> {
    let mut playback = Playback::new(run, limits::LIVE_BOUNCES);
    let mut begin = None;
    let (mut spent, mut next_check) = (Price::bounces(0), 0);
    while let (Some(t), Some(n)) = (playback.next_t(), playback.next_n())
        && t <= until
    {
        // A hold is sent from its beginning, after the last strike.
        let starts = match from {
            Some(from) => n == from && begin.is_none(),
            None => playback.held_until().is_none(),
        };
        if starts {
            begin = Some(playback.clone());
        }
        if from.is_some_and(|from| n >= from) {
            spent = spent.and(Price::bounces(limits::LIVE_IMPACT_PRICE));
        }
        let (_, price) =
            playback.advance(run, &mut || slice.should_continue()).map_err(|Cancelled| CatchUpError::Cancelled)?;
        spent = spent.and(price).within(limit).map_err(CatchUpError::OverBudget)?;
        if spent.as_bounces() >= next_check {
            next_check = spent.as_bounces() + CHECK_INTERVAL;
            slice.check().map_err(|Cancelled| CatchUpError::Cancelled)?;
        }
    }
    Ok(begin.unwrap_or(playback))
}

/// Computes the run up to the first impact to send: on this thread if it is little work, else in the pool.
///
/// # Errors
/// The work is over its limit, or the pool is overloaded.
pub async fn catch_up_with(request: &LiveRequest, context: &SessionContext) -> Result<Playback, Problem> {
    let until = request.live.clock.run_time((context.wall)());
    let limit = context.bounds.catch_up;
    let little = Limit { most: limit.most.min(limits::INLINE_BOUNCES), ..limit };
    let playback =
        match context.pool.run_inline(|slice| catch_up(&request.live.run, request.from, until, &little, slice)).await {
            None | Some(Err(CatchUpError::OverBudget(_))) => {
                let (run, from) = (request.live.run.clone(), request.from);
                let work = move |slice: &TimeSlice| catch_up(&run, from, until, &limit, slice).map_err(Problem::from);
                context.pool.run_on_worker(work).await?
            }
            Some(other) => other?,
        };
    context.bounces.inc_by(playback.next_n().unwrap_or_default());
    Ok(playback)
}

impl From<CatchUpError> for Problem {
    fn from(error: CatchUpError) -> Self {
        match error {
            CatchUpError::OverBudget(over) => over.into(),
            CatchUpError::Cancelled => Cancelled.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::run::tests::case;

    const PLENTY: Limit = Limit { name: "work", most: 1_000_000, unit: "bounces" };

    /// Time of impact n, s.
    fn time_of(run: &Run, n: usize) -> f64 {
        let mut playback = Playback::new(run, limits::LIVE_BOUNCES);
        std::iter::from_fn(|| playback.next_impact(run, &mut || true).unwrap().map(|(contact, _)| contact.t))
            .nth(n - 1)
            .unwrap()
    }

    fn caught_up(run: &Run, from: Option<u64>, until: f64, limit: &Limit) -> Result<Playback, CatchUpError> {
        catch_up(run, from, until, limit, &TimeSlice::unbounded())
    }

    #[test]
    fn catching_up_begins_where_it_was_asked_to() {
        let run = case("case-1");
        let until = time_of(&run, 20);
        let begin = |from| caught_up(&run, from, until, &PLENTY).unwrap().next_n();
        assert_eq!(
            [begin(None), begin(Some(7)), begin(Some(20)), begin(Some(21)), begin(Some(25))].map(Option::unwrap),
            [20, 7, 20, 21, 21]
        );
        assert_eq!(caught_up(&run, None, -5.0, &PLENTY).unwrap().next_n(), Some(1));
    }

    #[test]
    fn catching_up_has_a_price_and_telling_a_higher_one() {
        let limit = Limit { most: 100, ..PLENTY };
        let run = case("case-1");
        let until = time_of(&run, 50);
        assert!(caught_up(&run, None, until, &limit).is_ok());
        let over = caught_up(&run, Some(1), until, &limit).unwrap_err();
        assert!(matches!(over, CatchUpError::OverBudget(_)));
        assert!(caught_up(&run, None, 1e6, &limit).is_err());
    }

    #[test]
    fn a_run_that_has_ended_is_told_from_its_last_impact() {
        let run = case("case-3");
        assert_eq!(caught_up(&run, None, 1e6, &PLENTY).unwrap().next_n(), Some(49));
        assert_eq!(caught_up(&run, Some(60), 1e6, &PLENTY).unwrap().outcome().unwrap().kind, "sinking");
    }
}
