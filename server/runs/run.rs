//! A run as a value: a scene and its interventions determine every contact.
//!
//! `interventions` reads and writes it, `playback` computes it.

use std::f64::consts::PI;
use std::sync::Arc;

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::map::body::Kick;
use equipoise_physics::run::lasting_contact::work_of_rest;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::{FieldError, Name, Scene, Value};

use crate::api::computed::catches::request::whole_catch_price;
use crate::api::scene::explain;
use crate::limits;

/// Largest component of a kick in each direction, m/s; the same as of a release.
pub const KICK_SPEED: f64 = 100.0;

/// Largest kick of the angular velocity, rad/s; the same as of a release.
pub const KICK_SPIN: f64 = 200.0;

/// A change of a run at one impact.
#[derive(Debug, Clone, PartialEq)]
pub struct Intervention {
    /// Number of the impact.
    pub impact: u64,
    /// Fields in force from the strike of this impact on, each once, in the order of the table of fields.
    pub set: Vec<(Name, Value)>,
    /// Velocities added just after this impact.
    pub kick: Option<Kick>,
    /// Catch that begins with this impact.
    pub catch: Option<CatchSettings>,
    /// Throw at this impact. After a catch without strikes from the same impact, the throw of the body that is held.
    pub throw: Option<ThrowOrder>,
}

/// A throw under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThrowOrder {
    /// Apex that it aims at.
    pub apex: ThrowTarget,
    /// Earliest time, s, of the throw of a body that is held; as soon as it is held by default.
    pub t: Option<f64>,
}

/// A run. Equal runs have equal impacts. Cheap to clone: clones share their scenes.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    scene: Arc<Scene>,
    interventions: Vec<Intervention>,
    /// The scene with all interventions in force.
    last: Arc<Scene>,
    /// Time for which the run goes on in contact after its bounces, s.
    hold: f64,
}

impl Run {
    /// A run without interventions.
    pub fn new(scene: Scene) -> Self {
        let scene = Arc::new(scene);
        Self { scene: scene.clone(), interventions: Vec::new(), last: scene, hold: 0.0 }
    }

    /// The same run, which goes on in contact for `hold` s after its bounces have ended.
    #[must_use]
    pub fn holding(self, hold: f64) -> Self {
        Self { hold, ..self }
    }

    /// Time for which the run goes on in contact after its bounces, s; 0 if it ends with them.
    pub fn hold(&self) -> f64 {
        self.hold
    }

    /// The scene at the release.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// At most one entry for each impact, in the order of impacts.
    pub fn interventions(&self) -> &[Intervention] {
        &self.interventions
    }

    /// The intervention at this impact, if there is one.
    pub fn at(&self, impact: u64) -> Option<&Intervention> {
        let found = self.interventions.binary_search_by_key(&impact, |intervention| intervention.impact).ok()?;
        Some(&self.interventions[found])
    }

    /// Sets fields from an impact on. Other fields set at the same impact stay.
    ///
    /// # Errors
    /// The fields that cannot be set, by path. The run is then unchanged.
    pub fn set(&mut self, impact: u64, changes: &[(Name, Value)]) -> Result<(), Vec<FieldError>> {
        let is_last = self.interventions.last().is_none_or(|last| last.impact <= impact);
        let mut changed = self.clone();
        let set = &mut changed.entry(impact).map_err(|detail| vec![FieldError::at("", detail)])?.set;
        for (name, value) in changes {
            set.retain(|(known, _)| known != name && Some(*known) != name.other_way());
            set.push((*name, *value));
        }
        set.sort_by_key(|(name, _)| *name as usize);
        changed.last = Arc::new(if is_last { with(&self.last, changes)? } else { changed.scene_at(u64::MAX)? });
        *self = changed;
        Ok(())
    }

    /// The scene in force from an impact on, until the next intervention.
    fn scene_at(&self, impact: u64) -> Result<Scene, Vec<FieldError>> {
        let before = self.interventions.iter().take_while(|intervention| intervention.impact <= impact);
        before
            .filter(|intervention| !intervention.set.is_empty())
            .try_fold(*self.scene, |scene, intervention| with(&scene, &intervention.set))
    }

    /// Kicks the body just after an impact. Kicks at one impact add up.
    ///
    /// # Errors
    /// The sum is too large, or there are too many interventions. The run is then unchanged.
    pub fn kick(&mut self, impact: u64, kick: Kick) -> Result<(), String> {
        let before = self.at(impact).and_then(|intervention| intervention.kick).unwrap_or_default();
        let sum = Kick {
            x_dot: before.x_dot + kick.x_dot,
            y_dot: before.y_dot + kick.y_dot,
            theta_dot: before.theta_dot + kick.theta_dot,
        };
        for (name, value, most, unit) in [
            ("x_dot", sum.x_dot, KICK_SPEED, "m/s"),
            ("y_dot", sum.y_dot, KICK_SPEED, "m/s"),
            ("theta_dot", sum.theta_dot, KICK_SPIN, "rad/s"),
        ] {
            if value.abs() > most {
                return Err(format!(
                    "the kicks at impact {impact} add up to a {name} of {value}; it must be from -{most} to {most} {unit}"
                ));
            }
        }
        self.entry(impact)?.kick = Some(sum);
        Ok(())
    }

    /// Catches the body from an impact on, in place of a throw there.
    ///
    /// # Errors
    /// There are too many interventions. The run is then unchanged.
    pub fn catch(&mut self, impact: u64, settings: CatchSettings) -> Result<(), String> {
        let entry = self.entry(impact)?;
        (entry.catch, entry.throw) = (Some(settings), None);
        Ok(())
    }

    /// Throws the body at an impact. A throw without a time replaces a catch there.
    ///
    /// # Errors
    /// There are too many interventions. The run is then unchanged.
    pub fn throw(&mut self, impact: u64, order: ThrowOrder) -> Result<(), String> {
        let entry = self.entry(impact)?;
        entry.throw = Some(order);
        if order.t.is_none() {
            entry.catch = None;
        }
        Ok(())
    }

    /// Price of the catches and throws of the run and of its contacts after the bounces, in bounces, besides those that it makes.
    pub fn guidance_price(&self) -> u64 {
        let (mut price, mut catch) = (0_u64, None);
        let mut scene = self.scene.clone();
        // A run has a contact after its bounces, and another one after the bounces of each throw.
        let mut held = self.hold_price(&scene);
        let mut holds = 0_u64;
        for intervention in &self.interventions {
            if !intervention.set.is_empty() {
                // `set` has built each of these scenes before, so this does not fail.
                scene = with(&scene, &intervention.set).map_or(scene, Arc::new);
                held = held.max(self.hold_price(&scene));
            }
            // A change or a kick during a catch is caught anew.
            catch = intervention.catch.or(catch);
            price = price.saturating_add(catch.map_or(0, |settings| whole_catch_price(&scene, &settings)));
            if intervention.throw.is_some() {
                price = price.saturating_add(THROW_PRICE);
                holds += 1;
            }
        }
        price.saturating_add((1 + holds).saturating_mul(held))
    }

    /// Price of a contact after the bounces, in bounces, with this scene in force.
    fn hold_price(&self, scene: &Scene) -> u64 {
        if self.hold > 0.0 { hold_price(scene, self.hold) } else { 0 }
    }

    /// The run released again: fields set up to impact `reached` are in force from the start; no other intervention is kept.
    pub fn restarted(&self, reached: u64) -> Self {
        // `set` has built each of these scenes before, so this does not fail.
        Self::new(self.scene_at(reached).unwrap_or(*self.last)).holding(self.hold)
    }

    fn entry(&mut self, impact: u64) -> Result<&mut Intervention, String> {
        let place = match self.interventions.binary_search_by_key(&impact, |intervention| intervention.impact) {
            Ok(place) => place,
            Err(place) => {
                let most = limits::LIVE_INTERVENTIONS;
                if self.interventions.len() >= most {
                    let hint = "restart keeps what was set";
                    return Err(format!("this run has {most} interventions, which is the limit; {hint}"));
                }
                self.interventions
                    .insert(place, Intervention { impact, set: Vec::new(), kick: None, catch: None, throw: None });
                place
            }
        };
        Ok(&mut self.interventions[place])
    }
}

/// The scene with some fields changed.
fn with(scene: &Scene, changes: &[(Name, Value)]) -> Result<Scene, Vec<FieldError>> {
    let mut draft = scene.draft();
    let mut errors: Vec<_> = changes.iter().filter_map(|(name, value)| draft.replace(*name, *value).err()).collect();
    let other_way = |(name, _): &(Name, Value)| {
        let other = name.other_way()?;
        changes.iter().any(|(name, _)| *name == other).then_some((name.row(), other.row()))
    };
    if let Some((one, other)) = changes.iter().find_map(other_way) {
        errors.push(FieldError::at(
            one.path,
            format!("{} and {} say the same thing; set one of them", one.key(), other.key()),
        ));
    }
    if errors.is_empty() { draft.build().map_err(explain) } else { Err(errors) }
}

/// Price of the search for a throw: with friction a few thousand strikes.
pub const THROW_PRICE: u64 = 20_000;

/// Price of a contact of `hold` s after the bounces of a run of this scene.
pub fn hold_price(scene: &Scene, hold: f64) -> u64 {
    limits::HOLD_SAMPLES * limits::HOLD_SAMPLE_PRICE + limits::CONTACT_WORK_PRICE * work_of_rest(scene, hold)
}

/// One bounce, and one more for each turn of the body in the following flight, up to a limit. The search for the next contact goes
/// turn by turn, but examines only a few turns.
pub fn impact_price(contact: &Contact) -> u64 {
    let spin = contact.strike.map_or(0.0, |strike| strike.after.theta_dot.abs());
    let turns = spin * contact.flight_time.unwrap_or_default() / (2.0 * PI);
    1 + (turns as u64).min(limits::SPINNING_PRICE)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::api::scene::presets;

    pub(crate) fn case(name: &str) -> Run {
        Run::new(presets::find(name).unwrap().draft().build().unwrap())
    }

    #[test]
    fn what_happens_at_one_impact_is_one_intervention() {
        let mut run = case("case-1");
        run.set(3, &[(Name::TiltGain, Value::Number(1.2)), (Name::Restitution, Value::Number(0.9))]).unwrap();
        run.set(3, &[(Name::TiltGain, Value::Number(1.3))]).unwrap();
        run.kick(3, Kick { theta_dot: 0.5, ..Kick::default() }).unwrap();
        run.kick(3, Kick { theta_dot: 0.25, ..Kick::default() }).unwrap();
        assert_eq!(run.interventions().len(), 1);
        let at = run.at(3).unwrap();
        assert_eq!(at.set, [(Name::Restitution, Value::Number(0.9)), (Name::TiltGain, Value::Number(1.3))]);
        assert_eq!(at.kick.unwrap().theta_dot, 0.75);
        run.kick(2, Kick::default()).unwrap();
        assert_eq!(run.interventions()[0].impact, 2);
    }

    #[test]
    fn catches_and_holds_have_a_price() {
        let (mut run, catch) = (case("case-1"), CatchSettings::default());
        run.kick(2, Kick::default()).unwrap();
        assert_eq!(run.guidance_price(), 0);
        let hold = hold_price(run.scene(), 1.0);
        assert_eq!(run.clone().holding(1.0).guidance_price(), hold);
        run.catch(3, catch).unwrap();
        run.kick(4, Kick::default()).unwrap();
        let caught = whole_catch_price(run.scene(), &catch);
        assert_eq!(run.guidance_price(), 2 * caught);
        let order = ThrowOrder { apex: ThrowTarget { height: 0.3, theta: 0.0 }, t: Some(2.0) };
        run.throw(4, order).unwrap();
        assert_eq!(run.holding(1.0).guidance_price(), THROW_PRICE + 2 * (caught + hold));
    }

    #[test]
    fn an_earlier_change_must_go_with_the_later_ones() {
        let mut run = case("case-1");
        let target = (Name::TargetHeight, Value::Number(0.2));
        run.set(5, &[(Name::EnergyGain, Value::Number(0.1)), target]).unwrap();
        let errors = run.set(2, &[(Name::Strike, Value::Choice("still"))]).unwrap_err();
        assert_eq!(errors[0].path, "table.energy_gain");
        run.set(2, &[(Name::TiltGain, Value::Number(1.2))]).unwrap();
        assert_eq!(run.restarted(9).scene().value(Name::TiltGain), Some(Value::Number(1.2)));
    }

    #[test]
    fn what_is_refused_leaves_the_run_as_it_was() {
        let mut run = case("case-1");
        let before = run.clone();
        let errors = run.set(1, &[(Name::EnergyGain, Value::Number(0.1))]).unwrap_err();
        assert_eq!(errors[0].path, "table.target_height");
        assert!(run.kick(1, Kick { x_dot: 101.0, ..Kick::default() }).unwrap_err().contains("-100 to 100 m/s"));
        assert_eq!(run, before);
    }

    #[test]
    fn interventions_are_bounded_and_a_restart_keeps_what_was_set() {
        let mut run = case("case-1");
        for impact in 1..=limits::LIVE_INTERVENTIONS as u64 {
            run.set(impact, &[(Name::TiltGain, Value::Number(1.0 + impact as f64 / 1000.0))]).unwrap();
        }
        let over = limits::LIVE_INTERVENTIONS as u64 + 1;
        assert!(run.kick(over, Kick::default()).unwrap_err().contains("which is the limit"));
        let early = run.restarted(10);
        assert_eq!(early.scene().value(Name::TiltGain), Some(Value::Number(1.01)));
        let again = run.holding(1.5).restarted(u64::MAX);
        assert_eq!(again.hold(), 1.5);
        assert_eq!(again.interventions().len(), 0);
        assert_eq!(again.scene().value(Name::TiltGain), Some(Value::Number(1.1)));
    }
}
