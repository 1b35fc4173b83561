//! The next strike of a live run as the server foresees it, so that a client can draw the table on its way there.

use schemars::JsonSchema;
use serde::Serialize;

use crate::api::scene::EnergyTarget;
use crate::compute::Cancelled;
use crate::runs::playback::Playback;
use crate::runs::run::Run;

/// The next strike as the server foresees it, with everything that has been set so far. A client draws the table on its way there. The run can end
/// at that contact without a strike. Null after the end, and while the table holds the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "LiveNextStrike")]
pub struct NextStrike {
    /// Number of the impact.
    n: u64,
    /// Run time since the release, s.
    t: f64,
    /// Horizontal position of the contact point, m.
    x: f64,
    /// Height of the contact point, m. 0 unless the table strikes early or late.
    y: f64,
    /// Angle of the table, rad.
    alpha: f64,
    /// Null if it is too large for a double.
    table_velocity: Option<TableVelocity>,
    target: Option<EnergyTarget>,
}

/// Velocity of the table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct TableVelocity {
    /// Horizontal velocity, m/s.
    pub x: f64,
    /// Vertical velocity, m/s.
    pub y: f64,
}

impl NextStrike {
    /// The strike that a run comes to next. None after its end.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn of(playback: &mut Playback, run: &Run, go_on: &mut dyn FnMut() -> bool) -> Result<Option<Self>, Cancelled> {
        let Some(t) = playback.next_t() else { return Ok(None) };
        let Some((coming, strike, scene)) = playback.foresee(run, go_on)? else { return Ok(None) };
        let (x, y) = strike.table_velocity;
        Ok(Some(Self {
            n: coming.n,
            t,
            x: coming.x + playback.body().rod.contact_distance * strike.sin_cos_theta.0,
            y: coming.clearance,
            alpha: strike.alpha,
            // + 0.0 turns −0, the velocity of a table at rest, into 0.
            table_velocity: (x.is_finite() && y.is_finite()).then_some(TableVelocity { x: x + 0.0, y: y + 0.0 }),
            target: EnergyTarget::of(&scene, coming.n),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::run::tests::case;
    use equipoise_physics::catching::settings::{CatchSettings, Strategy};
    use equipoise_physics::map::body::Kick;
    use equipoise_physics::scene::{Name, Value};

    /// The next strike, with nobody to stop it.
    fn next_strike(playback: &mut Playback, run: &Run) -> Option<NextStrike> {
        NextStrike::of(playback, run, &mut || true).unwrap()
    }

    /// Compares each foreseen strike with the contact that comes.
    fn follow(run: &Run, impacts: u64) {
        let mut playback = Playback::new(run, impacts);
        while let Some(next) = next_strike(&mut playback, run) {
            let (contact, _) = playback.next_impact(run, &mut || true).unwrap().unwrap();
            assert_eq!((next.n, next.t.to_bits()), (contact.n, contact.t.to_bits()));
            assert_eq!((next.y, next.alpha.to_bits()), (contact.clearance, contact.alpha.to_bits()), "at {}", next.n);
            let foot = contact.x + playback.body().rod.contact_distance * contact.state.theta.sin();
            assert!((next.x - foot).abs() <= 1e-12, "{next:?}");
            let velocity = next.table_velocity.unwrap();
            if let Some(strike) = contact.strike {
                assert_eq!((velocity.x, velocity.y), strike.table_velocity);
            }
            assert_eq!(next.target, EnergyTarget::of(playback.scene(), next.n));
        }
    }

    #[test]
    fn every_strike_comes_as_it_was_foreseen() {
        for preset in crate::api::scene::presets::all() {
            follow(&case(preset.name), 300);
        }
    }

    #[test]
    fn strikes_of_a_catch_come_as_they_were_foreseen() {
        let mut run = case("case-1");
        run.catch(3, CatchSettings { strategy: Some(Strategy::BounceDown), ..CatchSettings::default() }).unwrap();
        run.kick(5, Kick { theta_dot: 0.2, ..Kick::default() }).unwrap();
        run.set(6, &[(Name::Restitution, Value::Number(0.9))]).unwrap();
        follow(&run, 300);
    }

    #[test]
    fn a_change_is_foreseen_once_it_is_known() {
        let mut run = case("case-4");
        let before = next_strike(&mut Playback::new(&run, 100), &run).unwrap();
        run.set(1, &[(Name::TiltGain, Value::Number(1.3)), (Name::TargetHeight, Value::Number(0.4))]).unwrap();
        let after = next_strike(&mut Playback::new(&run, 100), &run).unwrap();
        assert!((after.alpha - 1.3 / 1.1 * before.alpha).abs() < 1e-15);
        assert_ne!((after.target, after.table_velocity), (before.target, before.table_velocity));
        follow(&run, 100);
    }

    #[test]
    fn the_table_makes_up_the_loss() {
        // Eq. (25) for a rod that falls upright: with e = 1/2 the table comes up with a third of the speed that it meets.
        let mut run = case("case-4");
        let zero = [(Name::EnergyGain, Value::Number(0.0))];
        run.set(1, &zero).unwrap();
        let mut playback = Playback::new(&run, 100);
        let next = next_strike(&mut playback, &run).unwrap();
        let (contact, _) = playback.next_impact(&run, &mut || true).unwrap().unwrap();
        let (sin, cos) = next.alpha.sin_cos();
        let beta = contact.state.theta - contact.alpha;
        let state = contact.state;
        let normal =
            cos * state.y_dot - sin * state.x_dot + playback.body().rod.contact_distance * state.theta_dot * beta.sin();
        let velocity = next.table_velocity.unwrap();
        assert!((velocity.y * cos - velocity.x * sin + normal / 3.0).abs() < 1e-12);
        assert!((velocity.y * sin + velocity.x * cos).abs() < 1e-12);
        assert_eq!(next.target, None);
    }
}
