//! A hold within a run: the body in lasting contact with the table, told part by part.

use std::ops::Range;
use std::sync::Arc;

use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::map::table::actuator_load::Pose;
use equipoise_physics::numbers::trig;
use equipoise_physics::run::lasting_contact::HoldSample;

/// Samples in one part of a hold: 0.1 s of a hold of 6 s. A throw acts at the end of a part that was sent.
const PART: usize = 10;

/// A hold, and how much of it is over.
#[derive(Debug, Clone)]
pub struct HeldRun {
    samples: Arc<[HoldSample]>,
    /// Index of the last sample that was sent.
    held: usize,
}

/// Samples of a hold that follow one another. They stay valid without the run.
#[derive(Debug, Clone)]
pub struct HoldPart {
    samples: Arc<[HoldSample]>,
    range: Range<usize>,
}

impl HoldPart {
    /// The samples; the first one is also the last one of the part before.
    pub fn samples(&self) -> &[HoldSample] {
        self.samples.get(self.range.clone()).unwrap_or_default()
    }

    /// Time from the first sample to the last, s.
    pub fn length(&self) -> f64 {
        let samples = self.samples();
        samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.t - first.t)
    }

    /// This part and the one that follows it, if it does.
    pub fn joined(self, next: &Self) -> Result<Self, Self> {
        let follows = Arc::ptr_eq(&self.samples, &next.samples) && self.range.end == next.range.start + 1;
        if follows { Ok(Self { range: self.range.start..next.range.end, ..self }) } else { Err(self) }
    }
}

impl HeldRun {
    /// A hold at its beginning.
    pub fn new(samples: Vec<HoldSample>) -> Self {
        Self { samples: samples.into(), held: 0 }
    }

    /// All samples.
    pub fn samples(&self) -> &[HoldSample] {
        &self.samples
    }

    /// Last sample so far.
    pub fn sample(&self) -> Option<&HoldSample> {
        self.samples.get(self.held)
    }

    /// Next part; `None` at the end.
    pub fn next_part(&mut self) -> Option<HoldPart> {
        let begin = self.held;
        let end = (begin + PART).min(self.samples.len().saturating_sub(1));
        if begin >= end {
            return None;
        }
        self.held = end;
        Some(HoldPart { samples: self.samples.clone(), range: begin..end + 1 })
    }
}

/// A body that is held, before a strike that is to follow, and the table that holds it.
pub fn held_body(n: u64, rod: &Rod, sample: &HoldSample) -> (PreImpact, Pose) {
    let (sin, _) = trig::sin_cos(sample.theta);
    // The contact point is as fast as the table, and as high.
    let y_dot = sample.table_y_dot - rod.contact_distance * sample.theta_dot * sin;
    let state = State { theta: sample.theta, x_dot: sample.x_dot, y_dot, theta_dot: sample.theta_dot };
    let pose = Pose { alpha: sample.alpha, velocity: (0.0, sample.table_y_dot) };
    (PreImpact { n, x: sample.x, state, clearance: sample.table_y, plan: None }, pose)
}
