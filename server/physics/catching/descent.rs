//! Strikes of a catch, contact by contact, up to the lasting contact or the reason for which there is none.

use super::guidance::{Catcher, Guidance};
use super::outcome::{CatchOutcome, CatchStrike, Escape, Fall};
use super::settings::MOST_STRIKES;
use crate::body::{Arrival, Body, NoContact, PreImpact};
use crate::bounce::strike::Strike;
use crate::contact::StrikeBefore;
use crate::run::rules::{Rules, SPEED_LIMIT, speed_squared};
use crate::table::actuator_load::{ActuatorLoad, Pose};

/// A coming contact and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComingContact {
    /// Time of the run, s.
    pub t: f64,
    /// The contact.
    pub coming: PreImpact,
    /// The table at the strike before, and the flight since then, s, if there was one.
    pub before: Option<(Pose, f64)>,
}

/// Beginning of a lasting contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touchdown {
    /// The contact, and its time.
    pub(super) at: ComingContact,
    /// Vertical velocity of the contact point, m/s.
    pub(super) speed: f64,
    /// The strike before the contact, or with which it begins.
    pub(super) before: Option<StrikeBefore>,
}

/// Strikes of an attempt.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    pub(super) strikes: Vec<CatchStrike>,
    /// Height ratio that the first strike aimed for.
    pub(super) aimed: Option<f64>,
    pub(super) load: ActuatorLoad,
    /// True if the table moved from one strike to another.
    pub(super) moves: bool,
}

/// End of the strikes of an attempt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum DescentEnd {
    /// The lasting contact begins.
    Touchdown(Touchdown),
    /// It ends without one.
    Ended(CatchOutcome),
    /// The caller stopped it.
    Stopped,
}

impl Descent {
    /// Strikes from a coming contact on, until the contact point rises by less than `hold_speed`, m/s.
    pub(super) fn go_down(
        &mut self,
        body: &Body,
        (rules, hold_speed): (&Rules, f64),
        catcher: &mut Catcher<'_>,
        mut now: ComingContact,
    ) -> DescentEnd {
        for _ in 0..MOST_STRIKES {
            if !(catcher.go_on)() {
                return DescentEnd::Stopped;
            }
            let ComingContact { t, coming, before: last } = now;
            let theta = coming.state.theta;
            if theta.abs() >= rules.topple_angle {
                return fell(t, Fall::Toppled { theta, limit: rules.topple_angle });
            }
            match catcher.guidance {
                Guidance::Strike { ratio } => {
                    self.aimed.get_or_insert(ratio);
                }
                Guidance::Touch => {
                    let speed = body.rod.contact_speed(&coming.state);
                    let before = last.map(|(pose, time)| StrikeBefore { alpha: pose.alpha, time });
                    return DescentEnd::Touchdown(Touchdown { at: now, speed, before });
                }
                Guidance::GiveUp(escape) => return escaped(t, escape),
            }
            let strike = body.strike(&coming);
            if let Some(touch) = body.touches(&coming, &strike) {
                return fell(t, Fall::OtherVertex(touch));
            }
            let pose = Pose::of(&strike);
            let load = pose.load(last);
            self.moves |= last.is_some();
            self.load = self.load.or(load);
            if let Some(violation) = rules.limits.as_ref().and_then(|limits| limits.exceeded(&load)) {
                return DescentEnd::Ended(CatchOutcome::BeyondLimits { t, violation });
            }
            if strike.push >= 0.0 {
                return escaped(t, Escape::Separating(strike.approach));
            }
            self.strikes.push(record(body, &now, strike));
            let after = strike.after;
            let squared = speed_squared(after.x_dot, after.y_dot, body.rod.contact_distance * after.theta_dot);
            if squared.is_nan() || squared > SPEED_LIMIT * SPEED_LIMIT {
                return escaped(t, Escape::Diverged(squared.sqrt()));
            }
            let stay = DescentEnd::Touchdown(Touchdown {
                at: ComingContact { coming: PreImpact { state: after, plan: None, ..coming }, ..now },
                speed: strike.contact_rise,
                before: Some(StrikeBefore { alpha: strike.alpha, time: 0.0 }),
            });
            if strike.contact_rise < hold_speed {
                return stay;
            }
            match body.fly_to(&coming, &strike, Some(catcher)) {
                Ok(arrival) => {
                    if let Some(strike) = self.strikes.last_mut() {
                        strike.flight_time = Some(arrival.t);
                    }
                    now = ComingContact { before: Some((pose, arrival.t)), ..now.after(&arrival) };
                }
                // It does not come up to y = 0: the table follows it from here.
                Err(NoContact::Sinking) => return stay,
                Err(NoContact::Missed) => return escaped(t, Escape::Missed),
                Err(NoContact::TooManyPieces) => return escaped(t, Escape::Diverged(squared.sqrt())),
                Err(NoContact::OtherVertex(touch)) => return fell(t + touch.t, Fall::OtherVertex(touch)),
            }
        }
        escaped(now.t, Escape::TooManyStrikes(MOST_STRIKES))
    }
}

impl ComingContact {
    /// The contact that ends the flight after this one.
    pub(super) fn after(&self, arrival: &Arrival) -> Self {
        let Arrival { t, state, clearance, plan, .. } = *arrival;
        let PreImpact { n, x, .. } = self.coming;
        Self {
            t: self.t + t,
            coming: PreImpact { n: n + 1, x: x + state.x_dot * t, state, clearance, plan },
            before: None,
        }
    }
}

fn fell(t: f64, fall: Fall) -> DescentEnd {
    DescentEnd::Ended(CatchOutcome::Fell { t, fall })
}

fn escaped(t: f64, escape: Escape) -> DescentEnd {
    DescentEnd::Ended(CatchOutcome::NotCaught { t, escape })
}

fn record(body: &Body, now: &ComingContact, strike: Strike) -> CatchStrike {
    let ComingContact { t, coming: PreImpact { n, x, state, clearance, .. }, .. } = *now;
    CatchStrike { n, t, x, state, clearance, contact_speed: body.rod.contact_speed(&state), strike, flight_time: None }
}
