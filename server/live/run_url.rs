//! Live runs as values: a run with a clock, and the URL of both.
//!
//! The URL of a run reads back as the same run. A request gets all errors at once.

use form_urlencoded::Serializer;

use crate::api::scene::scene_to_query;
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, Objects, exact_whole, number, whole};
use crate::http::request::reader;
use crate::limits;
use crate::live::clock::{Clock, ClockEntry, SPEEDS};
use crate::request_fields;
use crate::runs::interventions::{HeldRunSpec, intervention_parameters, number_text};
use crate::runs::run::Run;

/// Path of live runs.
pub const PATH: &str = "/v1/live";

/// Range of a clock's run times, s: everything between the earliest and the latest time at the highest speed. An epoch in s instead
/// of ms is decades ago, and its run can still be paused.
const RUN_TIMES: std::ops::RangeInclusive<f64> = -2e14..=2e14;

/// Largest difference between the clocks of two servers, ms.
const CLOCK_SKEW_MS: u64 = 60_000;

/// Bytes kept free in a URL for clock entries and `from`, so that pausing never fails.
const CLOCK_ROOM: usize = limits::LIVE_CLOCK_ENTRIES * 100 + 40;

/// A run on the wall clock. Equal live runs have the same impacts at the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveRun {
    /// Scene and interventions.
    pub run: Run,
    /// Run time at each wall time.
    pub clock: Clock,
}

impl LiveRun {
    /// Releases the run again at `epoch`, unix ms, at the present speed. Fields set up to impact `reached` are in force from the
    /// start; no other intervention is kept.
    pub fn restarted(&self, epoch: u64, reached: u64) -> Self {
        Self { run: self.run.restarted(reached), clock: Clock::new(epoch, self.clock.speed()) }
    }
}

/// A request for a live run.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveRequest {
    /// The run and its clock.
    pub live: LiveRun,
    /// First impact to send; None is the last one so far.
    pub from: Option<u64>,
}

request_fields! {
    /// The parameters of a live run.
    #[derive(Debug)]
    pub struct LiveParameters {
        /// Ratio of run time to wall time, no unit.
        speed: f64 = number(SPEEDS, "").or(1.0),
        /// Wall time of the release on the server's clock, since 1970 (UTC), ms. By default now.
        epoch_ms: Option<u64> = exact_whole().optional(),
        /// Number of the first impact to send, counted from 1. By default the last impact so far; without an `epoch_ms`, the first.
        from: Option<u64> = whole(1..=limits::LIVE_BOUNCES).optional(),
        /// The run.
        run: Run = HeldRunSpec,
        /// Changes of the clock of the run, in their order. Written by the server into `url`.
        clock: Vec<ClockEntry> = Objects(limits::LIVE_CLOCK_ENTRIES),
    }
}

request_fields! {
    impl ClockEntry {
        /// Wall time from which the run goes at this speed, since 1970 (UTC), ms. Indices count from 0.
        wall_ms: u64 = exact_whole().required(),
        /// Run time then.
        run: f64 = number(RUN_TIMES, "s").required(),
        /// Ratio of run time to wall time from then on; 0 is paused.
        speed: f64 = number(0.0..=*SPEEDS.end(), "").required(),
    }
}

/// Reads a live run, released at `now`, unix ms, unless it has an epoch. Returns None if something is wrong; the reader then has
/// the errors.
pub fn read(reader: &mut Reader<'_, '_>, now: u64) -> Option<LiveRequest> {
    let LiveParameters { speed, epoch_ms: epoch, from, run, clock: entries } = LiveParameters::read_fields(reader)?;
    // A run that is released by this request is sent from its first impact.
    let from = from.or(epoch.is_none().then_some(1));
    let mut clock = Clock::new(epoch.unwrap_or(now), speed);
    for (index, entry) in entries.into_iter().enumerate() {
        let pointer = format!("{}/{index}", reader.pointer_to("clock"));
        if entry.speed != 0.0 && entry.speed < *SPEEDS.start() {
            let range = reader::describe_range(&SPEEDS, "");
            let detail = format!("speed is {}; it must be {range}, or 0 for a pause", entry.speed);
            reader.errors().push(format!("{pointer}/speed"), detail);
            continue;
        }
        // A change before the release has the wall time of the release.
        let latest = now.saturating_add(CLOCK_SKEW_MS).max(clock.epoch());
        let pushed = if entry.wall_ms > latest {
            Err(format!("wall_ms is {} ms, which is still to come: it is {now} ms", entry.wall_ms))
        } else {
            clock.push(entry)
        };
        if let Err(detail) = pushed {
            reader.errors().push(pointer, detail);
        }
    }
    Some(LiveRequest { live: LiveRun { run, clock }, from })
}

/// The URL of a live run: path and query, without `from`, which is of one client.
pub fn url(live: &LiveRun) -> String {
    let LiveRun { run, clock } = live;
    let start = format!("{PATH}?");
    let length = start.len();
    let mut query = Serializer::for_suffix(start, length);
    query.extend_pairs(scene_to_query(run.scene()));
    query.append_pair("speed", &number_text(clock.first_speed()));
    query.append_pair("epoch_ms", &clock.epoch().to_string());
    if run.hold() > 0.0 {
        query.append_pair("hold", &number_text(run.hold()));
    }
    query.extend_pairs(intervention_parameters(run));
    for (index, entry) in clock.entries().iter().enumerate() {
        let prefix = format!("clock.{index}");
        query.append_pair(&format!("{prefix}.wall_ms"), &entry.wall_ms.to_string());
        query.append_pair(&format!("{prefix}.run"), &number_text(entry.run));
        query.append_pair(&format!("{prefix}.speed"), &number_text(entry.speed));
    }
    query.finish()
}

/// Tells whether the URL of a live run is too long to be asked for once its clock is full.
pub fn is_too_long(live: &LiveRun) -> bool {
    let clock = Clock::new(live.clock.epoch(), live.clock.first_speed());
    url(&LiveRun { run: live.run.clone(), clock }).len() + CLOCK_ROOM > limits::URL_BYTES
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::scene::has_angle;
    use crate::http::Errors;
    use crate::http::request::reader::LARGEST_EXACT;
    use crate::http::request::reader::Source;
    use crate::http::request::tree;
    use crate::runs::run::ThrowOrder;
    use crate::runs::run::tests::case;
    use equipoise_physics::catching::settings::CatchSettings;
    use equipoise_physics::catching::throw::ThrowTarget;
    use equipoise_physics::map::body::Kick;
    use equipoise_physics::scene::capability::Analysis;
    use equipoise_physics::scene::{Name, Value as FieldValue};
    use proptest::prelude::*;

    const NOW: u64 = LARGEST_EXACT;

    fn read_url(url: &str) -> Result<LiveRequest, Vec<(String, String)>> {
        read_url_at(url, NOW)
    }

    fn read_url_at(url: &str, now: u64) -> Result<LiveRequest, Vec<(String, String)>> {
        let query = url.strip_prefix("/v1/live?").unwrap();
        let fields = tree::unfold(tree::parameters(query).unwrap()).unwrap();
        let mut errors = Errors::default();
        let mut reader = Reader::new(&fields, String::new(), Source::Query, &mut errors);
        let request = read(&mut reader, now);
        reader.finish();
        match errors.into_result() {
            Ok(()) => Ok(request.unwrap()),
            Err(problem) => Err(problem.into_errors().into_iter().map(|error| (error.pointer, error.detail)).collect()),
        }
    }

    #[derive(Debug, Clone)]
    enum Did {
        Set(Name, f64),
        Kick(f64, f64, f64),
        Catch(CatchSettings),
        Throw(f64, f64, Option<f64>),
        Pause,
        Resume,
        Speed(f64),
        Step,
    }

    fn did() -> impl Strategy<Value = Did> {
        prop_oneof![
            (-100.0..=100.0).prop_map(|value| Did::Set(Name::TiltGain, value)),
            (0.0..=1.0).prop_map(|value| Did::Set(Name::Restitution, value)),
            (0.01..=3.0).prop_map(|value| Did::Set(Name::ToppleAngle, value)),
            (-1.0..=1.0, -1.0..=1.0, -2.0..=2.0).prop_map(|(x, y, theta)| Did::Kick(x, y, theta)),
            Just(Did::Kick(0.0, -0.0, 0.0)),
            Just(Did::Catch(CatchSettings::default())),
            (0.05..=0.98, 0.0..=1e6, 0.1..=60.0).prop_map(|(ratio, weight, hold)| {
                Did::Catch(CatchSettings {
                    strategy: Some(equipoise_physics::catching::settings::Strategy::Plan),
                    ratio: Some(ratio),
                    strikes: Some(7),
                    state_weights: [weight, 10.0, 0.1, 2.0],
                    hold,
                    ..CatchSettings::default()
                })
            }),
            (0.0..=100.0, -9.0..=9.0, proptest::option::of(0.0..=1e9))
                .prop_map(|(height, theta, t)| Did::Throw(height, theta, t)),
            Just(Did::Pause),
            Just(Did::Resume),
            Just(Did::Step),
            (0.05..=20.0).prop_map(Did::Speed),
        ]
    }

    proptest! {
        #[test]
        fn a_url_reads_back_as_the_same_run(
            preset in 0..crate::api::scene::presets::all().len(), speed in 0.05..=20.0, epoch in 0..LARGEST_EXACT / 2,
            from in proptest::option::of(1_u64..1000), hold in prop_oneof![Just(0.0), 0.0..=60.0],
            all in proptest::collection::vec((0_u64..3, 0_u64..100_000, did()), 0..40),
        ) {
            let scene = crate::api::scene::presets::all()[preset].draft().build().unwrap();
            let can_be_caught = Analysis::Catch.lack(&scene).is_none();
            let mut live = LiveRun { run: Run::new(scene).holding(hold), clock: Clock::new(epoch, speed) };
            let (mut impact, mut wall) = (1, epoch);
            for (impacts, time, did) in all {
                (impact, wall) = (impact + impacts, wall + time);
                match did {
                    Did::Set(name, value) => drop(live.run.set(impact, &[(name, FieldValue::Number(value))])),
                    Did::Kick(x_dot, y_dot, theta_dot) => {
                        let theta_dot = if has_angle(&scene) { theta_dot } else { 0.0 };
                        live.run.kick(impact, Kick { x_dot, y_dot, theta_dot }).unwrap();
                    }
                    Did::Catch(settings) if can_be_caught => live.run.catch(impact, settings).unwrap(),
                    Did::Throw(height, theta, t) if can_be_caught => {
                        live.run.throw(impact, ThrowOrder { apex: ThrowTarget { height, theta }, t }).unwrap();
                    }
                    Did::Catch(_) | Did::Throw(..) => {}
                    Did::Pause => live.clock.pause(wall),
                    Did::Resume => live.clock.resume(wall),
                    Did::Speed(speed) => live.clock.set_speed(wall, speed),
                    Did::Step => {
                        live.clock.pause(wall);
                        live.clock.step(wall, live.clock.run_time(wall) + 0.1);
                    }
                }
                live.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
            }
            let mut text = url(&live);
            if let Some(from) = from {
                text += &format!("&from={from}");
            }
            prop_assert_eq!(read_url(&text).unwrap(), LiveRequest { live, from });
        }
    }

    #[test]
    fn a_run_paused_before_its_release_reads_back() {
        let (now, released) = (1_000_000, 5_000_000);
        let mut live = LiveRun { run: case("case-1"), clock: Clock::new(released, 1.0) };
        live.clock.pause(now);
        assert_eq!(read_url_at(&url(&live), now).unwrap().live, live);
        live.clock.resume(released + 2);
        assert_eq!(read_url_at(&url(&live), now).unwrap_err()[0].0, "/clock/1");
    }

    #[test]
    fn a_run_of_long_ago_or_far_ahead_reads_back_when_it_is_paused() {
        for (now, released) in [(1_800_000_000_000, 18_001), (LARGEST_EXACT, 0), (0, LARGEST_EXACT)] {
            let mut live = LiveRun { run: case("case-2"), clock: Clock::new(released, *SPEEDS.end()) };
            live.clock.set_speed(now, 1.0);
            live.clock.pause(now);
            assert_eq!(read_url_at(&url(&live), now).unwrap().live, live, "released at {released}");
        }
    }

    #[test]
    fn the_defaults_are_now_at_normal_speed() {
        let request = read_url("/v1/live?preset=case-1").unwrap();
        assert_eq!((request.live.clock, request.from), (Clock::new(NOW, 1.0), Some(1)));
        let gone = read_url("/v1/live?preset=case-1&columns=flat").unwrap_err();
        assert!(gone.len() == 1 && gone[0].0 == "/columns" && gone[0].1.contains("since 0.3"), "{gone:?}");
    }

    #[test]
    fn everything_wrong_is_told_at_once() {
        let errors = read_url(
            "/v1/live?preset=case-1&speed=100&epoch_ms=-1&from=0&interventions.0.impact=2&interventions.0.set.gravity=1&\
             interventions.1.impact=x&interventions.1.kick.theta_dot=900&interventions.2.kick.spin=1&\
             interventions.3.impact=1&clock.0.wall_ms=1&clock.0.run=0&clock.0.speed=0.01&colour=red",
        )
        .unwrap_err();
        let pointers: Vec<_> = errors.iter().map(|(pointer, _)| pointer.as_str()).collect();
        let expected = [
            "/speed",
            "/epoch_ms",
            "/from",
            "/interventions/0/set/gravity",
            "/interventions/1/impact",
            "/interventions/1/kick/theta_dot",
            "/interventions/2/impact",
            "/interventions/2/kick",
            "/interventions/2/kick/spin",
            "/interventions/3",
            "/clock/0/speed",
            "/colour",
        ];
        assert_eq!(pointers, expected, "{errors:?}");
        assert!(errors[3].1.starts_with("gravity cannot be changed while a run is live"));
    }

    #[test]
    fn what_a_change_contradicts_is_told_at_its_intervention() {
        let errors = read_url(
            "/v1/live?preset=case-1&interventions.0.impact=2&interventions.0.set.table.energy_gain=1&\
             interventions.1.impact=1&interventions.1.kick.x_dot=1",
        )
        .unwrap_err();
        assert_eq!(errors[0].0, "/interventions/0/set/table/target_height");
        let point = "/v1/live?preset=point-mass&interventions.0.impact=2&interventions.0.kick.theta_dot=1";
        assert_eq!(read_url(point).unwrap_err()[0].0, "/interventions/0/kick/theta_dot");
    }

    #[test]
    fn a_full_run_still_fits_a_url() {
        let mut live = LiveRun { run: case("case-2"), clock: Clock::new(1_000_000, 1.0) };
        let mut impact = 0;
        while !is_too_long(&live) && impact < limits::LIVE_INTERVENTIONS as u64 {
            impact += 1;
            let _ = live.run.kick(impact, Kick { x_dot: 0.123_456_789_012_345_6, ..Kick::default() });
        }
        assert!(impact > 50, "{impact}");
        for change in 1..100_u64 {
            live.clock.set_speed(1_763_675_170_123 + change * 1000, 0.123_456_789_012_345_6 + change as f64 / 100.0);
        }
        live.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
        assert!(url(&live).len() <= limits::URL_BYTES + 200, "{}", url(&live).len());
    }
}
