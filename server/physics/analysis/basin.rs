//! The basin of a scene: the release angles from which a run survives.
//!
//! A scan and a search of its edges, in lanes where they hold the model. Not a map over two fields, and no proof: between two angles of the scan a
//! narrow hole stays unseen.

use crate::analysis::return_map::ReturnMap;
use crate::map::body::Release;
use crate::map::strike::State;
use crate::run::ending::EndingKind;
use crate::run::lanes::batch_run::{LaneRunEnd, run_all};
use crate::run::lanes::model::BatchModel;
use crate::run::orbit::Orbit;
use crate::scene::capability::{Analysis, Lack};
use crate::scene::{Name, Scene};
use std::cell::Cell;

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
    let because = |why: String| NoBasin::Because(why);
    let (body, rules) = (scene.running_model(), scene.rules());
    if let Some(lack) = Analysis::Basin.lack(scene) {
        return Err(NoBasin::Lacks(lack));
    }
    let (is_polygon, two_sided) = (scene.outline().is_some(), sides(scene) == 2);
    let orbit = |theta: f64| {
        let state = State { theta, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 };
        let may_start = !is_polygon || may_be_released_at(scene, theta);
        Orbit::new(body, rules, &Release { x: 0.0, height: scene.release().height, state }).ok().filter(|_| may_start)
    };
    let height = scene.release().height;
    if height <= body.rod.contact_distance {
        return Err(because(format!(
            "released at rest at {height} m, not above contact_distance {} m, it does not fall",
            body.rod.contact_distance
        )));
    }
    let bounces = Cell::new(0);
    let mut run_from = |angles: &[f64]| {
        let mut survivors = vec![false; angles.len()];
        let mut orbits = angles.iter().enumerate().filter_map(|(index, theta)| Some((index, orbit(*theta)?)));
        let mut done = |index: usize, end: LaneRunEnd| {
            survivors[index] = end.outcome == EndingKind::Completed;
            bounces.set(bounces.get() + end.impacts);
        };
        let is_done = run_all(impacts, &mut || orbits.next(), &mut done, &mut go_on);
        if is_done { Ok(survivors) } else { Err(NoBasin::Stopped) }
    };
    let mut survive = |angles: &[f64]| {
        let mut survivors = run_from(angles)?;
        if two_sided {
            let mirrored: Vec<f64> = angles.iter().map(|theta| -theta).collect();
            let others = run_from(&mirrored)?;
            survivors.iter_mut().zip(others).for_each(|(survives, other)| *survives &= other);
        }
        Ok(survivors)
    };
    if !survive(&[0.0])?[0] {
        return Err(because(format!("the run of {impacts} contacts does not survive from upright either")));
    }
    let grid =
        |count: usize, span: f64| -> Vec<f64> { (1..=count).map(|index| span * index as f64 / count as f64).collect() };
    let span = scene.topple_angle().min(std::f64::consts::FRAC_PI_2);
    let rough = grid(ROUGH, span);
    let last = survive(&rough)?.iter().rposition(|survives| *survives);
    let fine = grid(FINE, rough[last.map_or(0, |last| last + 1).min(ROUGH - 1)]);
    let survivors = survive(&fine)?;
    let spacing = fine[0];
    // Upright survives.
    let angle = |count: usize| if count == 0 { 0.0 } else { fine[count - 1] };
    let first = survivors.iter().position(|survives| !survives).unwrap_or(FINE);
    let end = survivors.iter().rposition(|survives| *survives).map_or(0, |last| last + 1);
    let mut search = |count: usize, nearest_first: bool| {
        let mut low = angle(count);
        if count == FINE {
            return Ok(low);
        }
        let mut high = fine[count];
        for _ in 0..ROUNDS {
            let width = (high - low) / (TRIED as f64 + 1.0);
            let tried: Vec<f64> = (1..=TRIED).map(|index| low + width * index as f64).collect();
            let survivors = survive(&tried)?;
            let kept = if nearest_first {
                survivors.iter().position(|survives| !survives).unwrap_or(TRIED)
            } else {
                survivors.iter().rposition(|survives| *survives).map_or(0, |last| last + 1)
            };
            high = if kept == TRIED { high } else { tried[kept] };
            low = if kept == 0 { low } else { tried[kept - 1] };
        }
        Ok(low)
    };
    let unbroken = search(first, true)?;
    let theta = if end == first { unbroken } else { search(end, false)? };
    let mut holes: Vec<(f64, f64)> = Vec::new();
    let mut inside = false;
    for (theta, survives) in fine.iter().zip(&survivors).take(end) {
        if !survives {
            match holes.last_mut() {
                Some(hole) if inside => hole.1 = *theta,
                Some(_) | None => holes.push((*theta, *theta)),
            }
        }
        inside = !survives;
    }
    let tolerance = (0..ROUNDS).fold(spacing, |width, _| width / (TRIED as f64 + 1.0));
    Ok(ReleaseBasin { theta, unbroken, holes, impacts, tolerance, spacing, bounces: bounces.get() })
}

/// Tells whether a scene can be released at an angle, rad: whether no vertex of its polygon is below the table there.
fn may_be_released_at(scene: &Scene, theta: f64) -> bool {
    scene.with([(Name::Theta, Some(theta))]).is_ok()
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
