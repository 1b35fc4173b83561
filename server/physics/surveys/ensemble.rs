//! Many runs of one scene with noise of their own: how many still go on after each contact, and how far from upright.
//!
//! Every run is watched for the same number of contacts, so none is lost sight of before the last: the survival curve of
//! Kaplan and Meier is the share of runs still going, and its intervals are binomial.

use crate::run::ending::EndingKind;
use crate::run::lanes::batch_run::{LaneRunEnd, Watch};
use crate::run::lanes::model::BatchModel;
use crate::scene::Scene;
use crate::surveys::run_each;
use std::ops::Range;

/// The shares of runs below the quantiles of |θ|.
pub const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// The standard normal deviate with 95 % between it and its negative.
const DEVIATE: f64 = 1.959_963_984_540_054;

/// Runs of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Ensemble {
    /// The scene; run k has the noise that its seed gives run k.
    pub scene: Scene,
    /// Number of runs.
    pub runs: u64,
    /// For how many contacts each is watched.
    pub impacts: u64,
    /// At how many of them, at most, angles are kept.
    pub angle_contacts: u64,
}

/// Record of some runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnsembleRuns {
    /// Ends of the runs, in their order.
    pub ends: Vec<LaneRunEnd>,
    /// For each contact of [`Ensemble::watched`], |θ| there in rad of those that went on; in their order.
    pub angles: Vec<Vec<f64>>,
}

/// A contact of the survival curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurvivalPoint {
    /// Runs that came to it, or would have come to the first one.
    pub at_risk: u64,
    /// Runs of these that ended there.
    pub ended: u64,
    /// The share of all runs that went on.
    pub share: f64,
    /// Confidence interval (95 %) of the probability to go on.
    pub interval: (f64, f64),
}

impl Ensemble {
    /// The contacts at which angles are kept: the first, the last, and evenly spread ones between them.
    pub fn watched(&self) -> Vec<u64> {
        let count = self.angle_contacts.min(self.impacts);
        (0..count).map(|index| 1 + index * (self.impacts - 1) / count.saturating_sub(1).max(1)).collect()
    }

    /// Tells whether all runs are the same, because no noise tells them apart.
    pub fn is_uniform(&self) -> bool {
        !self.scene.has_noise()
    }

    /// Tells whether its runs fit in lanes. Outside lanes they take some ten times as long.
    pub fn fits_lanes(&self) -> bool {
        BatchModel::of(&self.scene.running_model(), &self.scene.rules()).is_some()
    }

    /// Some of the runs, counted from 0; `None` if `go_on` said `false`, which is asked every hundred contacts, in lanes every few thousand.
    pub fn runs(&self, numbers: Range<u64>, go_on: &mut dyn FnMut() -> bool) -> Option<EnsembleRuns> {
        let watched = self.watched();
        let count = (numbers.end - numbers.start) as usize;
        let mut angles = vec![Vec::new(); count];
        let mut see = |index: usize, theta: f64| angles[index].push(theta.abs());
        let mut watch = Watch { contacts: &watched, see: &mut see };
        let orbit = |index: usize| Some(self.scene.orbit_of(numbers.start + index as u64));
        let ends = run_each(self.impacts, count, &mut watch, orbit, go_on)?;
        let mut found = EnsembleRuns { ends: Vec::new(), angles: vec![Vec::new(); watched.len()] };
        for (end, seen) in ends.into_iter().zip(angles) {
            let end = end?;
            found.ends.push(end);
            let went_on = |contact: &u64| *contact < end.impacts || end.outcome == EndingKind::Completed;
            for ((contact, angle), angles) in watched.iter().zip(seen).zip(&mut found.angles) {
                if went_on(contact) {
                    angles.push(angle);
                }
            }
        }
        go_on().then_some(found)
    }
}

impl EnsembleRuns {
    /// These runs so many times: of one run of a uniform ensemble, as many of its runs.
    #[must_use]
    pub fn repeated(&self, count: usize) -> Self {
        Self { ends: self.ends.repeat(count), angles: self.angles.iter().map(|angles| angles.repeat(count)).collect() }
    }

    /// Adds the runs that come after these.
    pub fn append(&mut self, others: Self) {
        self.ends.extend(others.ends);
        self.angles.resize_with(others.angles.len(), Vec::new);
        for (angles, others) in self.angles.iter_mut().zip(others.angles) {
            angles.extend(others);
        }
    }

    /// The survival curve, from contact 1 to the last.
    pub fn survival(&self, impacts: u64) -> Vec<SurvivalPoint> {
        let runs = self.ends.len() as u64;
        let mut ended = vec![0; usize::try_from(impacts).unwrap_or(usize::MAX)];
        for end in self.ends.iter().filter(|end| end.outcome != EndingKind::Completed) {
            ended[end.impacts.max(1) as usize - 1] += 1;
        }
        let mut at_risk = runs;
        let curve = ended.into_iter().map(|ended| {
            let left = at_risk - ended;
            let point = SurvivalPoint {
                at_risk,
                ended,
                share: left as f64 / runs as f64,
                interval: wilson_interval(left, runs),
            };
            at_risk = left;
            point
        });
        curve.collect()
    }

    /// Number of runs with this outcome.
    pub fn count(&self, outcome: EndingKind) -> u64 {
        self.ends.iter().filter(|end| end.outcome == outcome).count() as u64
    }

    /// Contacts of a run on average, those beyond the last one watched left out.
    pub fn mean_impacts(&self) -> f64 {
        self.ends.iter().map(|end| end.impacts).sum::<u64>() as f64 / self.ends.len() as f64
    }
}

/// The first contact after which no more than half of the runs go on; `None` if more than half outlast them all.
pub fn median_impacts(curve: &[SurvivalPoint]) -> Option<u64> {
    curve.iter().position(|point| point.share <= 0.5).map(|place| place as u64 + 1)
}

/// In how many contacts half of the runs end that have come to the second half of the curve: ln 2 over their rate there, that
/// of a run that ends with the same probability at each contact. `None` if no run ends there.
pub fn late_half_life(curve: &[SurvivalPoint]) -> Option<f64> {
    let late = &curve[curve.len() / 2..];
    let ended: u64 = late.iter().map(|point| point.ended).sum();
    let at_risk: u64 = late.iter().map(|point| point.at_risk).sum();
    // All that were there ended at once: no rate.
    (0 < ended && ended < at_risk).then(|| -std::f64::consts::LN_2 / libm::log1p(-(ended as f64 / at_risk as f64)))
}

/// The interval of 95 % confidence for a probability of which `successes` out of `trials` are known (E. B. Wilson 1927). It
/// never leaves 0 to 1, and is not empty where all or none succeeded.
pub fn wilson_interval(successes: u64, trials: u64) -> (f64, f64) {
    let count = trials as f64;
    let (share, square) = (successes as f64 / count, DEVIATE * DEVIATE);
    let middle = share + square / (2.0 * count);
    let half = DEVIATE * (share * (1.0 - share) / count + square / (4.0 * count * count)).sqrt();
    let whole = 1.0 + square / count;
    // The bounds 0 and 1 are exact; the formula would round them.
    let lower = if successes == 0 { 0.0 } else { (middle - half) / whole };
    let upper = if successes == trials { 1.0 } else { (middle + half) / whole };
    (lower, upper)
}

/// The quantiles of some values at [`SHARES`], on straight lines between the sorted ones (number 7 of Hyndman and Fan 1996,
/// what R and NumPy take); `None` without values, which come sorted.
pub fn quantiles(values: &[f64]) -> Option<[f64; SHARES.len()]> {
    let last = values.len().checked_sub(1)?;
    Some(SHARES.map(|share| {
        let place = share * last as f64;
        let below = place.floor();
        let (low, high) = (values[below as usize], values[(below as usize + 1).min(last)]);
        low + (place - below) * (high - low)
    }))
}
