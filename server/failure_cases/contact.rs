//! The root that is always there: a contact ends at t = 0 of its own flight, and the search for the next one finds it again.

use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot};
use crate::failure_cases::case::{FailureCase, Findings, MethodClaim};
use crate::failure_cases::scenes::{built, rod, rod_of};
use equipoise_physics::map::flight::Flight;
use equipoise_physics::scene::{Name, Scene, Value};

/// A rod that chatters as it topples over a table that stands still.
pub(crate) const TRIVIAL_ROOT: FailureCase = FailureCase {
    name: "trivial-root",
    title: "The contact just left is found again",
    method: "Newton's iteration on the gap, or a search that starts a little later",
    why: "After a strike the gap between tip and table is 0 at t = 0, so the equation for the next contact always has a root that is \
          none. Newton's iteration finds it whenever the flight is short. The usual remedy, to start the search a millisecond \
          later, passes over every flight that is shorter than that: here the rod chatters as it topples over, the next contact \
          comes sooner, and the search finds the tip below the table already, on its way through. Dividing t out of the \
          equation analytically leaves the true root alone, however near.",
    impacts: 30,
    ask: ("trajectories", "bounces=30"),
    price: 500,
    scene: || {
        let mut draft = rod(&[(Name::TiltGain, 0.0), (Name::Restitution, 0.5), (Name::Theta, 0.05)]);
        draft.set(Name::Strike, Some(Value::Choice("still"))).expect("a test builds every case");
        built(draft)
    },
    find: |scene, impacts| {
        let Short { contact, flight, flight_time, arrives, .. } = short(scene, impacts);
        let newton = newton(&flight);
        let late = search(&flight);
        let verdict = |t: Option<f64>| match t {
            None => "no contact",
            Some(t) if (t - flight_time).abs() <= 1e-9 * flight_time => "next contact",
            Some(t) if t <= 1e-3 * flight_time => "contact just left",
            Some(_) => "a later contact",
        };
        let says = |method, t: Option<f64>, detail| MethodClaim {
            method,
            verdict: verdict(t),
            value: t,
            unit: Some("s"),
            detail,
        };
        let below = flight.gap(NUDGE).value;
        let says = vec![
            says(
                "Newton's iteration on the gap from t = 1 µs",
                newton,
                "it falls back onto the root at t = 0".to_owned(),
            ),
            says(
                "search for a change of sign from t = 1 ms",
                late,
                format!("the tip is {:.2e} m below the table at its first look", -below),
            ),
            says(
                "the gap with t divided out",
                Some(flight_time),
                format!(
                    "the tip comes down at {:.3e} m/s, and the gap there is {:.1e} m",
                    -arrives,
                    flight.gap(flight_time).value
                ),
            ),
        ];
        let detail = format!(
            "the flight after contact {contact} takes {flight_time:.6e} s; before it the gap is open, at half of it by {:.2e} m, and after \
             it the gap would be negative",
            flight.gap(0.5 * flight_time).value
        );
        Findings { truth: "next contact", detail, says }
    },
    picture: |scene, impacts| {
        let Short { contact, flight, flight_time, .. } = short(scene, impacts);
        let gap = |t: f64| (1e3 * t, 1e6 * flight.gap(t).value);
        let line = (0..=200).map(|n| gap(0.006 * f64::from(n) * NUDGE)).collect();
        let curve = |label, style, points| Curve { label, style, points };
        let depth = 1.1 * gap(1.2 * NUDGE).1;
        Chart {
            title: TRIVIAL_ROOT.title,
            subtitle: format!("the gap between tip and table after contact {contact}"),
            caption: format!(
                "Newton's iteration from the left gives t = 0; a search from 1 ms on starts below the table. The next contact is at \
                 {:.4} ms.",
                1e3 * flight_time
            ),
            plots: vec![Plot {
                x: ChartAxis::new("time after the contact", "t", "ms"),
                y: ChartAxis::new("gap", "g", "µm"),
                curves: vec![
                    curve("start of the search", CurveStyle::Limit, vec![(1e3 * NUDGE, depth), (1e3 * NUDGE, -depth)]),
                    curve("the gap", CurveStyle::Truth, line),
                    curve("found, or looked at first", CurveStyle::WrongRings, vec![(0.0, 0.0), gap(NUDGE)]),
                    curve("next contact", CurveStyle::TruthDots, vec![(1e3 * flight_time, 0.0)]),
                ],
            }],
        }
    },
};

/// Delay of the search and step of its grid, s.
const NUDGE: f64 = 1e-3;

/// A flight that is shorter than the nudge.
struct Short {
    /// After which contact.
    contact: u64,
    flight: Flight,
    flight_time: f64,
    /// ẏ_c at its end, m/s.
    arrives: f64,
}

/// The first of them in a run.
fn short(scene: &Scene, impacts: u64) -> Short {
    let rod = rod_of(scene);
    let mut orbit = scene.orbit().expect("a test builds every case");
    let mut next = || {
        let contact = orbit.advance();
        let (strike, flight_time) = (contact.strike?, contact.flight_time?);
        let arrives = rod.contact_speed(orbit.state());
        Some(Short { contact: contact.n, flight: rod.flight(&strike), flight_time, arrives })
    };
    let found = (0..impacts).map_while(|_| next()).find(|short| short.flight_time < NUDGE);
    found.expect("a test computes every case")
}

/// Newton's iteration on the gap as it is.
fn newton(flight: &Flight) -> Option<f64> {
    let mut t = 1e-6;
    for _ in 0..100 {
        let gap = flight.gap(t);
        let next = t - gap.value / gap.slope;
        if next == t {
            break;
        }
        t = next;
    }
    Some(t.max(0.0))
}

/// The first change of sign from + to − on a grid that starts at the nudge, up to a second.
fn search(flight: &Flight) -> Option<f64> {
    let is_open = |index: &u32| flight.gap(f64::from(*index) * NUDGE).value > 0.0;
    (1..1000).find(|index| is_open(index) && !is_open(&(index + 1))).map(|index| f64::from(index) * NUDGE)
}
