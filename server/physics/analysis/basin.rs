//! The basin of a scene: the release angles from which a run survives.
//!
//! A scan and a search of its edges, in lanes where they hold the model. Not a map over two fields, and no proof: between two angles of the scan a
//! narrow hole stays unseen.

use crate::analysis::return_map::ReturnMap;
use crate::map::body::Release;
use crate::map::strike::State;
use crate::run::ending::EndingKind;
use crate::run::lanes::batch_run::Watch;
use crate::run::lanes::model::BatchModel;
use crate::run::orbit::Orbit;
use crate::scene::capability::{Analysis, Lack};
use crate::scene::{Name, Scene};
use crate::surveys::run_each;

/// Angles of the rough scan, over all there are, and of the fine one, over those that matter.
const ROUGH: usize = 128;
const FINE: usize = 256;

/// Angles tried at once in the search of an edge, a full set of lanes, and how often: each divides the interval by nine.
const TRIED: usize = 8;
const ROUNDS: usize = 4;

/// Runs that one basin takes at most.
pub const RUNS: u64 = (1 + ROUGH + FINE + 2 * TRIED * ROUNDS) as u64;

/// The release angles from which a run at rest survives, the same on both sides: by the mirror symmetry, and without it those that survive on
/// both.
#[derive(Clone, Debug, PartialEq)]
pub struct ReleaseBasin {
    /// The largest angle found that survives, rad.
    pub theta: f64,
    /// The angle up to which all that were tried survive, rad; equal to `theta` where there are no holes.
    pub unbroken: f64,
    /// Intervals below `theta` in which the angles tried fall, from the first to the last of them, rad.
    pub holes: Vec<(f64, f64)>,
    /// Contacts that had to be survived.
    pub impacts: u64,
    /// Largest error of the two edges, rad.
    pub tolerance: f64,
    /// Distance of the angles of the scan, rad: the narrowest hole that cannot be missed.
    pub spacing: f64,
    /// Contacts of all runs that were made for it.
    pub bounces: u64,
}

/// Reason for which there is no basin.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBasin {
    /// The search was cancelled.
    Stopped,
    /// The scene lacks what a basin needs.
    Lacks(Lack),
    /// There is none, for this reason.
    Because(String),
}

/// The basin of release angles at rest that survive `impacts` contacts. `go_on` is asked every few thousand bounces.
pub fn find_basin(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Result<ReleaseBasin, NoBasin> {
    if let Some(lack) = Analysis::Basin.lack(scene) {
        return Err(NoBasin::Lacks(lack));
    }
    let (body, rules, height) = (scene.running_model(), scene.rules(), scene.release().height);
    if height <= body.rod.contact_distance {
        return Err(NoBasin::Because(format!(
            "released at rest at {height} m, not above contact_distance {} m, it does not fall",
            body.rod.contact_distance
        )));
    }
    let is_polygon = scene.outline().is_some();
    let orbit = |theta: f64| {
        // No vertex of a polygon may be below the table.
        let may_start = !is_polygon || scene.with([(Name::Theta, Some(theta))]).is_ok();
        let state = State { theta, ..State::default() };
        may_start.then(|| Orbit::new(body, rules, &Release { x: 0.0, height, state }))
    };
    let signs: &[f64] = if sides(scene) == 2 { &[1.0, -1.0] } else { &[1.0] };
    let mut bounces = 0;
    let mut survive = |angles: &[f64]| {
        let mut survivors = vec![true; angles.len()];
        for sign in signs {
            let mut watch = Watch { contacts: &[], see: &mut |_, _| () };
            let orbit = |index: usize| orbit(sign * angles[index]);
            let ends = run_each(impacts, angles.len(), &mut watch, orbit, &mut go_on).ok_or(NoBasin::Stopped)?;
            for (survives, end) in survivors.iter_mut().zip(ends) {
                *survives &= end.is_some_and(|end| end.outcome == EndingKind::Completed);
                bounces += end.map_or(0, |end| end.impacts);
            }
        }
        Ok(survivors)
    };
    if !survive(&[0.0])?[0] {
        return Err(NoBasin::Because(format!("the run of {impacts} contacts does not survive from upright either")));
    }
    let grid =
        |count: usize, span: f64| -> Vec<f64> { (1..=count).map(|index| span * index as f64 / count as f64).collect() };
    let rough = grid(ROUGH, scene.topple_angle().min(std::f64::consts::FRAC_PI_2));
    let fine = grid(FINE, rough[reached(&survive(&rough)?).min(ROUGH - 1)]);
    let survivors = survive(&fine)?;
    let spacing = fine[0];
    // The edge beyond so many angles of the scan.
    let mut edge = |count: usize, kept: fn(&[bool]) -> usize| {
        // Upright survives.
        let mut low = if count == 0 { 0.0 } else { fine[count - 1] };
        let Some(&(mut high)) = fine.get(count) else { return Ok(low) };
        for _ in 0..ROUNDS {
            let width = (high - low) / (TRIED as f64 + 1.0);
            let tried: Vec<f64> = (1..=TRIED).map(|index| low + width * index as f64).collect();
            let kept = kept(&survive(&tried)?);
            high = if kept == TRIED { high } else { tried[kept] };
            low = if kept == 0 { low } else { tried[kept - 1] };
        }
        Ok(low)
    };
    let (first, end) = (whole(&survivors), reached(&survivors));
    let unbroken = edge(first, whole)?;
    let theta = if end == first { unbroken } else { edge(end, reached)? };
    let below: Vec<(f64, bool)> = fine.into_iter().zip(survivors).take(end).collect();
    let parts = below.chunk_by(|one, next| one.1 == next.1).filter(|part| !part[0].1);
    let holes = parts.map(|part| (part[0].0, part[part.len() - 1].0)).collect();
    let tolerance = (0..ROUNDS).fold(spacing, |width, _| width / (TRIED as f64 + 1.0));
    Ok(ReleaseBasin { theta, unbroken, holes, impacts, tolerance, spacing, bounces })
}

/// Number of angles that survive before the first that does not.
fn whole(survivors: &[bool]) -> usize {
    survivors.iter().position(|survives| !survives).unwrap_or(survivors.len())
}

/// Number of angles up to the last that survives.
fn reached(survivors: &[bool]) -> usize {
    survivors.iter().rposition(|survives| *survives).map_or(0, |last| last + 1)
}

/// Sides on which the runs of a scene's basin are made: both where mirrored releases may end otherwise.
pub fn sides(scene: &Scene) -> u64 {
    let speed = (2.0 * scene.gravity() * (scene.release().height - scene.parameters::<f64>().contact_distance)).sqrt();
    // Errors at random, and the vertices of a polygon, are no part of the map.
    let is_mirrored = scene.outline().is_none()
        && !scene.has_noise()
        && (speed.is_nan() || ReturnMap::new(&scene.model(), 1).is_mirrored(speed));
    if is_mirrored { 1 } else { 2 }
}

/// Tells whether the runs of a scene's basin fit into lanes. Other runs are made one by one.
pub fn runs_in_lanes(scene: &Scene) -> bool {
    BatchModel::of(&scene.running_model(), &scene.rules()).is_some()
}
