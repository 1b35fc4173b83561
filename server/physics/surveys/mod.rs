//! Surveys of many runs: stability maps over two fields, and ensembles with noise.

pub mod ensemble;
pub mod stability_map;

use crate::map::body::NoContact;
use crate::run::lanes::batch_run::{LaneRunEnd, Watch, run_watched};
use crate::run::orbit::Orbit;

/// Makes `count` runs of up to `impacts` contacts, each from the orbit of its number; `None` for a number without one. A run without a
/// first contact ends before it. Returns `None` once `go_on` returns false.
pub(crate) fn run_each(
    impacts: u64,
    count: usize,
    watch: &mut Watch<'_>,
    orbit: impl Fn(usize) -> Option<Result<Orbit, NoContact>>,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<Option<LaneRunEnd>>> {
    let (mut numbers, mut unstarted, mut ends) = (0..count, Vec::new(), vec![None; count]);
    let mut next = || {
        numbers.find_map(|number| match orbit(number)? {
            Ok(orbit) => Some((number, orbit)),
            Err(no_contact) => {
                unstarted.push((number, no_contact));
                None
            }
        })
    };
    let mut done = |number: usize, end| ends[number] = Some(end);
    if !run_watched(impacts, watch, &mut next, &mut done, go_on) {
        return None;
    }
    for (number, no_contact) in unstarted {
        let outcome = no_contact.ending(0.0, 0.0).into();
        ends[number] = Some(LaneRunEnd { impacts: 0, outcome, max_theta: 0.0 });
    }
    Some(ends)
}
