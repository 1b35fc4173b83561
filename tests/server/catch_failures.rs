//! The laws of the failure gallery that do not catch.

use crate::failures::{case, number, says};
use crate::support::Server;

#[tokio::test]
async fn a_low_target_slows_the_bounces_as_two_over_a_g_t() {
    let case = case("low-target").await;
    assert_eq!(case["truth"]["text"], "goes on");
    let (gravity, a) = (9.81, 0.4);
    // Upright, a strike turns the contact speed v into v − av³, and the flight after it takes 2v/G.
    let mut speed = (2.0 * gravity * (0.2 - 0.4 / 3.0_f64)).sqrt();
    let mut t = speed / gravity;
    let run = Server::start().get(case["ask"].as_str().unwrap()).await.expect(200).json();
    let column = |name: &str| run["impacts"][name].as_array().unwrap().clone();
    let (times, speeds) = (column("t"), column("contact_velocity"));
    assert_eq!(times.len(), 5000);
    for (computed, found) in times.iter().zip(&speeds) {
        assert!((number(computed) / t - 1.0).abs() < 1e-12, "{computed} {t}");
        assert!((number(found) / -speed - 1.0).abs() < 1e-11, "{found} {speed}");
        speed -= a * speed.powi(3);
        t += 2.0 * speed / gravity;
    }
    let asymptotic = -number(&speeds[4999]) * a * gravity * number(&times[4999]) / 2.0;
    assert!((0.95..1.0).contains(&asymptotic), "{asymptotic}");
    // Every geometric tail ends before the run has slowed down, the earlier one first.
    let tails = ["first two", "1000 and 1001"].map(|method| number(&says(&case, method)["value"]));
    assert!(tails[0] < tails[1] && tails[1] < number(&says(&case, "run of")["value"]), "{tails:?}");
}

#[tokio::test]
async fn the_gain_of_the_contact_overshoots_at_the_first_strike() {
    let server = Server::start();
    let case = case("contact-gain").await;
    assert_eq!(case["truth"]["text"], "falls");
    let gain = ["x", "theta", "x_dot", "theta_dot"].map(|name| number(&case["scene"]["table"]["feedback"][name]));
    let (l, rho_squared, gravity, ratio) = (0.4 / 3.0, 2.0 / 225.0, 9.81, 0.7);
    let tilt = |s: [f64; 4]| -gain.iter().zip(s).map(|(gain, s)| gain * s).sum::<f64>();
    // Strike of the impulse (1 + r)v, then a flight of 2rv/G: by power iteration.
    let growth = |speed: f64| {
        let (impulse, flight) = ((1.0 + ratio) * speed, 2.0 * ratio * speed / gravity);
        let mut s = [0.0, 1.0, 0.0, 0.0];
        let mut growth = 0.0;
        for _ in 0..100 {
            let alpha = tilt(s);
            let x_dot = s[2] - impulse * alpha;
            let theta_dot = s[3] + impulse * l / rho_squared * (s[1] - alpha);
            s = [s[0] + flight * x_dot, s[1] + flight * theta_dot, x_dot, theta_dot];
            growth = s.iter().map(|s| s * s).sum::<f64>().sqrt();
            s = s.map(|s| s / growth);
        }
        growth
    };
    assert!((growth(1.5) - 21.9).abs() < 0.05, "{}", growth(1.5));
    assert!((number(&says(&case, "derivative")["value"]) / growth(1.5) - 1.0).abs() < 1e-9);
    assert!(growth(0.005) < 1.0, "near the contact the gain is right");
    // The contact itself, by small steps: the same gain brings the rod to rest.
    let mut s = [0.0, 0.01, 0.0, 0.0];
    let step = 1e-4;
    for _ in 0..100_000 {
        let alpha = tilt(s);
        let [x, theta, x_dot, theta_dot] = s;
        let (x_dot, theta_dot) =
            (x_dot - step * gravity * alpha, theta_dot + step * gravity * l / rho_squared * (theta - alpha));
        s = [x + step * x_dot, theta + step * theta_dot, x_dot, theta_dot];
    }
    assert!(s.iter().all(|s| s.abs() < 1e-5), "{s:?}");
    let decay = number(&says(&case, "motion in contact")["value"]);
    assert!((decay + 1.104).abs() < 1e-3, "{decay}");
    let run = server.get(case["ask"].as_str().unwrap()).await.expect(200).json();
    assert_ne!(run["outcome"]["kind"], "settled", "{run}");
}

#[tokio::test]
async fn the_swing_after_the_bounces_comes_back_to_its_angle() {
    let case = case("settled-swing").await;
    assert_eq!(case["truth"]["text"], "swings");
    let settled = number(&says(&case, "bounces that die out")["value"]);
    assert!((settled - 0.8278).abs() < 1e-4, "{settled}");
    let begin = number(&says(&case, "forces")["value"]);
    assert!((begin + 0.11361).abs() < 1e-5, "{begin}");
    // A body at rest on a table at κθ, by small steps: N keeps the contact point at its height.
    let (l, rho_squared, gravity, kappa) = (0.4 / 3.0, 2.0 / 225.0, 9.81, 1.1);
    let turn = |theta: f64, spin: f64| {
        let (alpha, beta) = (kappa * theta, theta - kappa * theta);
        let push =
            (gravity - l * spin * spin * theta.cos()) / (alpha.cos() + l * l / rho_squared * beta.sin() * theta.sin());
        push * l / rho_squared * beta.sin()
    };
    let (mut theta, mut spin, mut most) = (begin, 0.0_f64, 0.0_f64);
    let step = 1e-4;
    for _ in 0..100_000 {
        // Leapfrog: it keeps the reversibility of the motion.
        let middle = theta + 0.5 * step * spin;
        spin += step * turn(middle, spin);
        theta = middle + 0.5 * step * spin;
        most = most.max(theta);
    }
    assert!((most / -begin - 1.0).abs() < 1e-3, "it turns at {most} rad on the other side");
    let late = number(&says(&case, "motion in contact")["value"]);
    assert!((late / most - 1.0).abs() < 5e-3, "{late} {most}");
}
