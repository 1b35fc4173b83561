//! Kicks and changes of the table within a run: what follows is the run that would start from there.

use equipoise_physics::map::body::{Body, Kick, Release};
use equipoise_physics::map::strike::Rod;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;

const CASE_1: Rod = Rod::lossless(0.4 / 3.0, 0.094, 1.1);

const HOLDING: Rules =
    Rules { topple_angle: 1.5, settles: false, holds_energy: true, limits: None, half_length: f64::INFINITY };

fn at_contact_20() -> Orbit {
    let state = equipoise_physics::map::strike::State { theta: 0.05, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 };
    let mut orbit = Orbit::new(Body::plain(CASE_1), HOLDING, &Release { x: 0.0, height: 0.2, state }).unwrap();
    for _ in 1..20 {
        orbit.advance();
    }
    orbit
}

fn assert_same_run(mut orbit: Orbit, mut anew: Orbit) {
    for _ in 0..100 {
        let (contact, expected) = (orbit.advance(), anew.advance());
        assert_eq!((contact.state, contact.flight_time), (expected.state, expected.flight_time));
        assert_eq!(contact.ending, None);
    }
}

#[test]
fn a_kick_adds_to_the_velocities_after_the_strike() {
    let (mut plain, mut kicked) = (at_contact_20(), at_contact_20());
    let kick = Kick { x_dot: 0.01, y_dot: 0.2, theta_dot: -0.3 };
    let (before, after) = (plain.advance(), kicked.advance_kicked(kick));
    let (plain, struck) = (before.strike.unwrap(), after.strike.unwrap());
    assert_eq!(before.state, after.state);
    assert_eq!(struck.after.x_dot, plain.after.x_dot + 0.01);
    assert_eq!(struck.after.theta_dot, plain.after.theta_dot - 0.3);
    let rise = struck.after.y_dot + CASE_1.contact_distance * struck.after.theta_dot * struck.sin_cos_theta.0;
    assert!((struck.contact_rise - rise).abs() < 1e-15);
    assert!(after.flight_time > before.flight_time);
    // The energy that is held from here on is that with the kick.
    assert_same_run(kicked, Orbit::at(Body::plain(CASE_1), HOLDING, *kicked.state()));
}

#[test]
fn no_kick_is_no_kick() {
    let (mut plain, mut kicked) = (at_contact_20(), at_contact_20());
    let (plain, kicked) = (plain.advance(), kicked.advance_kicked(Kick::default()));
    assert_eq!(plain, kicked);
}

#[test]
fn a_kick_downwards_can_end_the_run() {
    let contact = at_contact_20().advance_kicked(Kick { y_dot: -5.0, ..Kick::default() });
    assert!(matches!(contact.ending, Some(Ending::Sinking { contact_rise }) if contact_rise < 0.0));
}

#[test]
fn another_table_is_in_force_from_the_coming_contact_on() {
    let mut orbit = at_contact_20();
    let (t, state) = (orbit.t(), *orbit.state());
    let table = Rod { tilt_gain: 1.2, ..CASE_1 };
    orbit.replace(Body::plain(table), HOLDING);
    assert_eq!((orbit.t(), *orbit.state(), orbit.contacts()), (t, state, 19));
    assert_same_run(orbit, Orbit::at(Body::plain(table), HOLDING, state));
}

#[test]
fn a_run_that_begins_to_lose_energy_settles() {
    let mut orbit = at_contact_20();
    let still = Rod { restitution: 0.5, tilt_gain: 0.0, strike_gain: 1.5, ..CASE_1 };
    orbit.replace(
        Body::plain(still),
        Rules { topple_angle: 1.5, settles: true, holds_energy: false, limits: None, half_length: f64::INFINITY },
    );
    let ending = (0..10_000).find_map(|_| orbit.advance().ending);
    assert!(matches!(ending, Some(Ending::Settled { .. } | Ending::Toppled { .. })), "{ending:?}");
}
