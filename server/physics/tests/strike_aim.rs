//! Strikes of a table that aims: the chosen ratio of heights, by the exact strike of every law of restitution.

use crate::support::random;
use equipoise_physics::catching::aim::Aim;
use equipoise_physics::catching::plan::believed_body;
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{ContactMode, Rod, State};
use random::Random;

#[test]
fn a_strike_reaches_the_ratio_that_was_aimed_for() {
    let mut random = Random::new(1);
    let (mut held, mut slid) = (0, 0);
    for _ in 0..2000 {
        let mut rod = Rod::lossless(random.between(0.05, 0.5), random.between(0.02, 0.5), 0.0);
        rod.restitution = random.between(0.0, 1.0);
        let coefficient = if random.between(0.0, 1.0) < 0.3 { 0.0 } else { random.between(0.0, 1.0) };
        let state = State {
            theta: random.between(-0.6, 0.6),
            x_dot: random.between(-1.0, 1.0),
            y_dot: random.between(-3.0, -1.0),
            theta_dot: random.between(-2.0, 2.0),
        };
        let (alpha, ratio) = (random.between(-0.3, 0.3), random.between(0.0, 1.3));
        let aim = Aim::new(&believed_body(rod, coefficient), &state, alpha);
        let impulse = aim.impulse_for(ratio);
        if impulse <= 0.0 || rod.contact_speed(&state) >= 0.0 {
            continue;
        }
        for law in [RestitutionLaw::Poisson, RestitutionLaw::Newton, RestitutionLaw::Stronge] {
            let friction = (coefficient > 0.0).then_some(Friction { coefficient, law, slide: Slide::Matched });
            let body = Body { friction, ..Body::plain(rod) };
            let strike = body.strike(&PreImpact { plan: Some(aim.motion(impulse)), ..PreImpact::at(1, 0.0, state) });
            let wanted = -ratio * rod.contact_speed(&state);
            assert!((strike.contact_rise - wanted).abs() < 1e-13 * (1.0 + impulse), "{body:?} {strike:?} {wanted}");
            assert!((strike.impulse_normal - impulse).abs() < 1e-13 * (1.0 + impulse), "{strike:?} {impulse}");
            held += i32::from(strike.mode == ContactMode::Stick);
            slid += i32::from(strike.mode == ContactMode::SlideThrough);
        }
    }
    assert!(held > 500 && slid > 500, "{held} {slid}");
}
