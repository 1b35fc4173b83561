//! One contact of all lanes and the flight after it: the formulas of the bounce as they are, on [`Packs`].
//!
//! It makes the common bounce only, and tells the lanes of which that is not true: their run may end here, the body spins too fast, another
//! vertex may touch the table, or the contact time is not found in few steps. Not here: what becomes of those ([`super::batch_run`]).

use crate::map::body::Body;
use crate::map::bounce::LEAST_FLIGHT;
use crate::map::contact_time::{NewtonStep, guess, guess_from_above, latest_contact};
use crate::map::flight::Flight;
use crate::map::friction::actual_branch;
use crate::map::polygon::ClearRange;
use crate::map::strike::State;
use crate::map::table::actuator_load::{ActuatorLoad, Pose};
use crate::map::table::noise::{Block, ContactErrors, Noise, SensingErrors};
use crate::numbers::dispatch::Vector;
use crate::numbers::lanes::{MOST_LANES, PackMask, Packs};
use crate::numbers::number::{Arithmetic, Mask};
use crate::run::ending::EndingKind;
use crate::run::lanes::model::BatchModel;
use crate::run::orbit::LaneRunState;
use crate::run::rules::{SETTLED_SHARE, SPEED_LIMIT};

/// Most Newton steps of a common bounce: nearly all take one, few two. From below y = 0 a search takes about five.
const STEPS: u32 = 3;
const STEPS_OFF_TABLE: u32 = 10;

/// A contact point that rises faster does so by more than rounding ([`crate::map::strike::Strike::rises`]), at any speed up to the limit,
/// m/s. With friction it is 10 times as much for l = 0, and 1 + l²/ρ² times that for others ([`crate::map::friction::rise_rounding`]).
const SURE_RISE: f64 = 1e-8;
const ROUGH_SURE_RISE: f64 = 10.0 * SURE_RISE;

/// Farthest way of a flight, in body sizes, whose rounding is surely less than [`crate::map::polygon::FLUSH`].
const FARTHEST_WAY: f64 = 1e4;

const _: () = assert!(EndingKind::ALL.len() == 10, "a new kind of ending needs its condition in `Lanes::bounced`");

/// Bodies in the lanes, with the state of their runs.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Lanes<V: Vector> {
    /// Bodies with the same parts in all lanes. Programs, random errors and outlines are beside it.
    pub(super) body: Body<Packs<V>>,
    pub(super) leverage: Packs<V>,
    pub(super) topple_angle: Packs<V>,
    /// Half the length of the table, m.
    pub(super) half_length: Packs<V>,
    /// Just before the coming contact. The first flight is 0 of runs that cannot settle.
    pub(super) run: LaneRunState<Packs<V>>,
    /// Largest |θ| at a contact so far, rad.
    pub(super) max_theta: Packs<V>,
    /// The last flight, s.
    pub(super) flight_time: Packs<V>,
    pub(super) clear: Option<ClearRange<Packs<V>>>,
    pub(super) errors: Option<ErrorLanes<V>>,
    pub(super) has_ends: bool,
    pub(super) limits: Option<ActuatorLoad<Packs<V>>>,
    /// True if strikes or ends depend on the place.
    pub(super) follows_place: bool,
    /// True if a flight may be shorter than the time from sensing to the strike.
    pub(super) may_sense_late: bool,
    /// Not 0 in lanes whose table has planned its motion for the coming contact and should not, or has not and should.
    pub(super) plan_mismatch: Packs<V>,
    /// True if rounding is kept off the energy of runs that cannot settle.
    pub(super) holds_energy: bool,
}

struct Bounced<V: Vector> {
    next: LaneRunState<Packs<V>>,
    flight_time: Packs<V>,
    max_theta: Packs<V>,
    goes_on: PackMask<V>,
}

impl<V: Vector> Lanes<V> {
    /// The bounce of all lanes. Returns, as bits, those left as they were. `PLAIN`: all are [`Body::is_plain_rod`].
    #[inline(always)]
    pub(super) fn bounce<const PLAIN: bool>(&mut self) -> u32 {
        let bounced = self.bounced::<PLAIN>();
        if bounced.goes_on.all() {
            (self.max_theta, self.flight_time) = (bounced.max_theta, bounced.flight_time);
            if PLAIN {
                (self.run.state, self.run.energy) = (bounced.next.state, bounced.next.energy);
            } else {
                // Only what changes with these bodies: to copy all of it takes a tenth of the bounce.
                let LaneRunState { state, clearance, x, energy, first_flight: _, plan, last, last_flight } =
                    bounced.next;
                (self.run.state, self.run.clearance) = (state, clearance);
                if self.holds_energy {
                    self.run.energy = energy;
                }
                if self.follows_place {
                    self.run.x = x;
                }
                if self.limits.is_some() {
                    (self.run.last, self.run.last_flight) = (last, last_flight);
                }
                if let Some(errors) = &mut self.errors {
                    self.run.plan = plan;
                    errors.go_on();
                }
            }
            return 0;
        }
        self.take_common::<PLAIN>(&bounced);
        !bounced.goes_on.bits() & ((1_u64 << Packs::<V>::LANES) - 1) as u32
    }

    #[inline(always)]
    fn take_common<const PLAIN: bool>(&mut self, bounced: &Bounced<V>) {
        let Bounced { next, goes_on, .. } = bounced;
        let mut take = |now: &mut Packs<V>, next: Packs<V>| *now = Packs::select(*goes_on, next, *now);
        take(&mut self.max_theta, bounced.max_theta);
        take(&mut self.flight_time, bounced.flight_time);
        if PLAIN {
            self.run.state.zip(&next.state, &mut take);
            take(&mut self.run.energy, next.energy);
            return;
        }
        self.run.zip(next, &mut take);
        if let Some(errors) = &mut self.errors {
            errors.coming.zip(&errors.next, &mut take);
            errors.count(goes_on.bits());
        }
    }

    #[inline(always)]
    fn bounced<const PLAIN: bool>(&mut self) -> Bounced<V> {
        let zero = Packs::from_f64(0.0);
        let (body, run, leverage) = (&self.body, &self.run, &self.leverage);
        let LaneRunState { state, clearance, x, energy, first_flight, plan, last, last_flight } = run;
        let rod = &body.rod;
        let size = state.theta.magnitude();
        let max_theta = Packs::select(self.max_theta.is_less(size), size, self.max_theta);
        let mut strike = if PLAIN {
            rod.strike_with(state, &rod.tilt(state.theta), *leverage)
        } else {
            let errors = match &self.errors {
                Some(errors) => errors.coming,
                None => ContactErrors::none(),
            };
            let seen = body.seen_with(*rod, errors, (x.value, state, *clearance), *plan);
            let tilt = body.tilt_of(x.value, state, &seen);
            body.strike_of(x.value, state, &seen, &tilt, *leverage, actual_branch)
        };
        let mut next = LaneRunState { clearance: zero, ..*run };
        if PLAIN || self.holds_energy {
            // A run that may settle holds no energy: its own energy leaves the strike uncorrected.
            let held = Packs::select(first_flight.is_zero(), *energy, strike.energy);
            next.energy = rod.hold_energy(&mut strike, held);
        }
        let mut sure_rise = Packs::from_f64(SURE_RISE);
        if !PLAIN && body.friction.is_some() {
            let lever_squared = rod.contact_distance * rod.contact_distance * *leverage;
            sure_rise = Packs::from_f64(ROUGH_SURE_RISE) * (Packs::from_f64(1.0) + lever_squared);
        }
        let mut flight = rod.flight(&strike);
        if !PLAIN {
            flight.clearance = *clearance;
        }
        // A run goes on where it surely does not end. Any other run is set apart, and the map itself decides; so a condition may be too cautious here
        // but never too bold. No comparison holds for a value that is not a number.
        let (mut t, mut goes_on) = land(&flight, !PLAIN && self.errors.is_some());
        let mut end = flight.end(t);
        if !PLAIN {
            if let Some(clear) = &self.clear {
                // Where no other vertex comes down before the contact point would, none does before an early strike.
                goes_on = goes_on & stays_clear(clear, [state.theta - strike.alpha, end.theta], &flight, t);
            }
            if let Some(errors) = &mut self.errors {
                let timing = errors.draw(rod.restitution);
                let is_exact = timing.is_zero();
                let (late, least) = (t + timing, Packs::from_f64(LEAST_FLIGHT));
                t = Packs::select(is_exact, t, Packs::select(late.is_less(least), least, late));
                end = flight.end(t);
                if body.is_point {
                    goes_on = goes_on & turned_with_velocity(&mut end);
                }
                if plan.is_some() {
                    let motion = body.plan_with(rod, &errors.next, x.value + end.x_dot * t, &end, t);
                    let (met, is_met) = meet(&motion.relative(&flight, t, &end));
                    goes_on = goes_on & is_met;
                    t = Packs::select(met.is_less(least), least, met);
                    end = flight.end(t);
                    next.clearance = flight.ballistic_gap(t).value;
                    next.plan = Some(motion);
                } else {
                    next.clearance = Packs::select(is_exact, zero, flight.ballistic_gap(t).value);
                }
            }
            goes_on = goes_on & self.plan_mismatch.is_zero();
            if self.may_sense_late {
                let horizon = match &self.errors {
                    Some(errors) => errors.coming.horizon,
                    None => zero,
                };
                goes_on = goes_on & !body.senses_late_in(t, horizon);
            }
            if body.is_point {
                goes_on = goes_on & turned_with_velocity(&mut end);
            }
            if let Some(limits) = &self.limits {
                let pose = Pose { alpha: strike.alpha, velocity: strike.table_velocity };
                goes_on = goes_on & pose.most_load(last, *last_flight).is_within(limits);
                (next.last, next.last_flight) = (pose, t);
            }
            if self.has_ends {
                let place = x.value + rod.contact_distance * strike.sin_cos_theta.0;
                goes_on = goes_on & place.magnitude().is_at_most(self.half_length);
            }
            if self.follows_place {
                next.x.add(end.x_dot * t);
            }
        }
        let fast = Packs::from_f64(0.5 * SPEED_LIMIT);
        let is_slow = strike.after.x_dot.magnitude().is_at_most(fast) & strike.after.y_dot.magnitude().is_at_most(fast);
        let is_long_enough = (Packs::from_f64(SETTLED_SHARE) * *first_flight).is_at_most(t);
        let goes_on = size.is_less(self.topple_angle)
            & strike.push.is_less(zero)
            & sure_rise.is_less(strike.contact_rise)
            & is_long_enough
            & is_slow
            & goes_on;
        next.state = end;
        Bounced { next, flight_time: t, max_theta, goes_on }
    }
}

/// Time at which the contact point comes down to y = 0, s, and where it is certain, as [`crate::map::contact_time::first_contact`] and
/// [`crate::map::contact_time::first_descent`] find it. `is_off_table` says that the flight may start off y = 0.
#[inline(always)]
fn land<V: Vector>(flight: &Flight<Packs<V>>, is_off_table: bool) -> (Packs<V>, PackMask<V>) {
    let (zero, quarter) = (Packs::from_f64(0.0), Packs::from_f64(0.25));
    let mut t = guess(flight);
    let is_below = flight.clearance.is_less(zero);
    if is_off_table {
        let above = Packs::select(flight.clearance.is_zero(), t, guess_from_above(flight));
        t = Packs::select(is_below, latest_contact(flight), above);
    }
    let mut is_certain = flight.bulge().is_at_most(flight.gravity);
    // Set by the first step.
    let mut is_found = is_certain;
    let steps = if is_off_table { STEPS_OFF_TABLE } else { STEPS };
    let mut step = 0;
    loop {
        let gap = flight.ballistic_gap(t);
        let newton = NewtonStep::new(flight, t, &gap);
        let is_refined = newton.left_out.is_at_most(newton.negligible);
        let better = Packs::select(is_refined, newton.refined, t + newton.newton);
        is_certain = is_certain & gap.slope.is_less(zero);
        if step == 0 {
            let mut is_close = (quarter * t * gap.slope).is_less(gap.value);
            if is_off_table {
                // From below the search starts right of the last root.
                is_close = (is_below & gap.value.is_at_most(zero) & zero.is_less(t)) | (!is_below & is_close);
            }
            is_certain = is_certain & is_close;
            (t, is_found) = (better, is_refined);
        } else {
            let turns_back = !is_refined & zero.is_at_most(newton.newton);
            t = Packs::select(is_found | turns_back, t, better);
            is_found = is_found | is_refined | turns_back;
        }
        step += 1;
        if step == steps || (is_found | !is_certain).all() {
            return (t, is_found & is_certain);
        }
    }
}

/// Time at which the contact point comes down to a table that has planned its motion, s, in the flight as seen from there, and where it is
/// certain, as [`crate::map::contact_time::first_descent`] finds it.
#[inline(always)]
fn meet<V: Vector>(flight: &Flight<Packs<V>>) -> (Packs<V>, PackMask<V>) {
    let zero = Packs::from_f64(0.0);
    let State { y_dot, theta_dot, .. } = flight.start;
    let (t, is_found) = land(flight, true);
    let rise = y_dot + flight.contact_distance * theta_dot * flight.sin_cos_theta.0;
    let starts_well = zero.is_less(flight.clearance) | zero.is_less(rise);
    let end = latest_contact(flight);
    let ends_below = zero.is_less(end) & flight.ballistic_gap(end).value.is_at_most(zero);
    (t, is_found & starts_well & ends_below & zero.is_less(flight.gravity))
}

/// Turns a point mass to the angle of its velocity, rad, as [`crate::map::body::Body::point_state`]; where it comes down.
#[inline(always)]
fn turned_with_velocity<V: Vector>(end: &mut State<Packs<V>>) -> PackMask<V> {
    end.theta = Packs::angle_of(end.x_dot, -end.y_dot);
    end.theta_dot = Packs::from_f64(0.0);
    end.y_dot.is_less(end.theta_dot)
}

/// Tells where no other vertex is below the table at a contact at an angle β from its normal, and none comes down in the flight that ends at
/// `t` and θ, as [`crate::map::polygon::Outline::below_table`] and [`crate::map::polygon::Outline::first_touch`] find out.
#[inline(always)]
fn stays_clear<V: Vector>(
    clear: &ClearRange<Packs<V>>,
    [beta, theta]: [Packs<V>; 2],
    flight: &Flight<Packs<V>>,
    t: Packs<V>,
) -> PackMask<V> {
    let State { y_dot, theta_dot, .. } = flight.start;
    clear.contains(beta)
        & clear.contains(theta)
        & (clear.reach * theta_dot * theta_dot).is_at_most(flight.gravity)
        & (y_dot.magnitude() * t).is_at_most(Packs::from_f64(FARTHEST_WAY) * clear.size)
}

/// Random errors of tables that strike at the wrong time ([`crate::map::table::noise::NoiseModel::Strike`]).
#[derive(Clone, Debug)]
pub(super) struct ErrorLanes<V: Vector> {
    timing_sd: Packs<V>,
    angle_sd: Packs<V>,
    /// Standard deviations of the other errors, as in [`Noise`].
    sensing_sds: SensingErrors<Packs<V>>,
    restitution_sd: Packs<V>,
    seed: [u64; MOST_LANES],
    run: [u64; MOST_LANES],
    n: [u64; MOST_LANES],
    /// Errors at the coming contact, and at the one after it.
    coming: ContactErrors<Packs<V>>,
    next: ContactErrors<Packs<V>>,
}

impl<V: Vector> ErrorLanes<V> {
    pub(super) fn exact(model: BatchModel) -> Self {
        let zero = Packs::from_f64(0.0);
        let sensing = SensingErrors { x: zero, x_dot: zero, y_dot: zero, theta_dot: zero };
        let errors = ContactErrors {
            angle: zero,
            sensing: model.errs_in_state.then_some(sensing),
            horizon: zero,
            restitution: model.scatters.then_some(zero),
        };
        Self {
            timing_sd: zero,
            angle_sd: zero,
            sensing_sds: sensing,
            restitution_sd: zero,
            seed: [0; MOST_LANES],
            run: [0; MOST_LANES],
            n: [1; MOST_LANES],
            coming: errors,
            next: errors,
        }
    }

    /// Puts the errors of a run after so many contacts into a lane.
    pub(super) fn put(&mut self, lane: usize, noise: Option<Noise>, restitution: f64, contacts: u64) {
        let noise = noise.unwrap_or(Noise::NONE);
        let Noise { x_sd, x_dot_sd, y_dot_sd, theta_dot_sd, restitution_sd, horizon, .. } = noise;
        self.timing_sd.put(lane, noise.timing_sd);
        self.angle_sd.put(lane, noise.angle_sd);
        let mut put = |packs: &mut Packs<V>, number: f64| packs.put(lane, number);
        let sds = SensingErrors { x: x_sd, x_dot: x_dot_sd, y_dot: y_dot_sd, theta_dot: theta_dot_sd };
        self.sensing_sds.zip(&sds, &mut put);
        self.restitution_sd.put(lane, restitution_sd);
        (self.seed[lane], self.run[lane], self.n[lane]) = (noise.seed, noise.run, contacts + 1);
        let errors: ContactErrors = noise.errors(contacts + 1, restitution);
        let (sensing, restitution) = (errors.sensing.unwrap_or_default(), errors.restitution.unwrap_or(restitution));
        let errors = ContactErrors { sensing: Some(sensing), restitution: Some(restitution), ..errors };
        self.coming.zip(&errors, &mut put);
        self.next.horizon.put(lane, horizon);
    }

    /// Draws the errors of the contacts after the coming ones, and returns those of their times, s.
    #[inline(always)]
    fn draw(&mut self, restitution: Packs<V>) -> Packs<V> {
        let zero = Packs::from_f64(0.0);
        let (timing, angle) = self.pair(Block::TimeAndAngle, self.timing_sd, self.angle_sd);
        self.next.angle = angle;
        if self.next.sensing.is_some() {
            let SensingErrors { x, x_dot, y_dot, theta_dot } = self.sensing_sds;
            let (x, x_dot) = self.pair(Block::Along, x, x_dot);
            let (y_dot, theta_dot) = self.pair(Block::Falling, y_dot, theta_dot);
            self.next.sensing = Some(SensingErrors { x, x_dot, y_dot, theta_dot });
        }
        if self.next.restitution.is_some() {
            let one = Packs::from_f64(1.0);
            let (error, _) = self.pair(Block::Restitution, self.restitution_sd, zero);
            let drawn = restitution + error;
            let drawn = Packs::select(drawn.is_less(zero), zero, Packs::select(one.is_less(drawn), one, drawn));
            self.next.restitution = Some(Packs::select(self.restitution_sd.is_zero(), restitution, drawn));
        }
        timing
    }

    /// Two errors of the contacts after the coming ones, with these standard deviations; 0 without one.
    #[inline(always)]
    fn pair(&self, block: Block, mut one_sd: Packs<V>, mut other_sd: Packs<V>) -> (Packs<V>, Packs<V>) {
        let zero = Packs::from_f64(0.0);
        let (is_exact, is_other_exact) = (one_sd.is_zero(), other_sd.is_zero());
        let (ones, others) = (one_sd.lanes_mut(), other_sd.lanes_mut());
        for lane in 0..Packs::<V>::LANES {
            let noise = Noise { seed: self.seed[lane], run: self.run[lane], ..Noise::NONE };
            let [one, other] = noise.pair(self.n[lane] + 1, block);
            (ones[lane], others[lane]) = (ones[lane] * one, others[lane] * other);
        }
        (Packs::select(is_exact, zero, one_sd), Packs::select(is_other_exact, zero, other_sd))
    }

    #[inline(always)]
    fn go_on(&mut self) {
        self.coming = self.next;
        self.count(u32::MAX);
    }

    #[inline(always)]
    fn count(&mut self, lanes: u32) {
        for lane in 0..Packs::<V>::LANES {
            self.n[lane] += u64::from(lanes >> lane & 1);
        }
    }
}
