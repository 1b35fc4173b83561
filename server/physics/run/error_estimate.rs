//! Error bound of a run in doubles, or with 31 digits, against the exact one, contact by contact.

use crate::map::table::noise::NoiseModel;
use crate::numbers::double_double;
use crate::numbers::number::Number;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::carried_errors::{Bounce, CarriedErrors, ROUNDING, lands_plainly, rounded_parameters};
use crate::run::ending::Ending;
use crate::run::orbit::{Contact, Orbit, run};
use crate::scene::Scene;

/// The error of a run just before its coming contact, carried along beside its orbit.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "one for each run, on the stack")]
pub enum ErrorEstimate {
    /// A plain rod with few rounded parameters.
    Held(CarriedErrors<5, 8>),
    /// A plain rod whose energy is not held, with a rounded parameter more.
    Rod(CarriedErrors<4, 8>),
    /// A body whose table strikes by angle and velocities alone, just at the end of ballistic flights.
    Angle(CarriedErrors<5, 8>),
    /// A body with ballistic flights whose strikes depend on the place, or that has more rounded parameters.
    Place(CarriedErrors<6, 16>),
    /// A body in air, without an angle or with noise, whose table strikes by angle and velocities alone.
    AnyAngle(CarriedErrors<5, 8>),
    /// Any body.
    Any(CarriedErrors<10, 16>),
}

/// Does the same with the errors of any body.
macro_rules! of_any {
    ($estimate:expr, $errors:ident => $work:expr) => {
        match $estimate {
            Self::Held($errors) => $work,
            Self::Rod($errors) => $work,
            Self::Angle($errors) => $work,
            Self::Place($errors) => $work,
            Self::AnyAngle($errors) => $work,
            Self::Any($errors) => $work,
        }
    };
}

impl ErrorEstimate {
    /// The error estimate of the run of a scene in doubles, just before its first contact at `first` (s after release).
    pub fn of_scene(scene: &Scene, first: f64) -> Self {
        Self::new(scene, first, ROUNDING)
    }

    /// The same of [`crate::run::orbit::ExtendedOrbit`].
    pub fn of_extended_run(scene: &Scene, first: f64) -> Self {
        Self::new(scene, first, double_double::ROUNDING)
    }

    fn new(scene: &Scene, first: f64, unit: f64) -> Self {
        let (body, parameters) = (scene.model(), rounded_parameters(scene));
        let acts_in_time = body.lag != 0.0
            || body
                .noise
                .is_some_and(|noise| noise.timing_sd != 0.0 || noise.model == NoiseModel::Plan || noise.horizon != 0.0);
        let is_small = !body.depends_on_place() && parameters <= CarriedErrors::<5, 8>::PARAMETERS;
        if !lands_plainly(&body) {
            if is_small && !acts_in_time {
                Self::AnyAngle(CarriedErrors::new::<false>(scene, first, unit))
            } else {
                Self::Any(CarriedErrors::new::<false>(scene, first, unit))
            }
        } else if body.is_plain_rod() && is_small {
            Self::Held(CarriedErrors::new::<true>(scene, first, unit))
        } else if body.is_plain_rod() && !scene.rules().holds_energy && parameters <= CarriedErrors::<4, 8>::PARAMETERS
        {
            Self::Rod(CarriedErrors::new::<true>(scene, first, unit))
        } else if is_small {
            Self::Angle(CarriedErrors::new::<true>(scene, first, unit))
        } else {
            Self::Place(CarriedErrors::new::<true>(scene, first, unit))
        }
    }

    /// Bound on the largest of |ρδθ| (m), |δẋ|, |δẏ| and |ρδθ̇| (m/s) just before the coming contact; infinite once nothing is
    /// known any more. Of a point mass, on that of |δẋ| and |δẏ|.
    pub fn bound(&self) -> f64 {
        of_any!(self, errors => errors.bound())
    }

    /// Goes on over a contact of the run and the flight after it; over one without a flight it does nothing.
    pub fn pass<N: Number>(&mut self, contact: &Contact<N>) {
        if let Some(contact) = &Bounce::of(contact) {
            self.pass_bounce(contact);
        }
    }

    /// Not generic and never inlined, so that its large frame is compiled here alone.
    #[inline(never)]
    fn pass_bounce(&mut self, contact: &Bounce) {
        match self {
            Self::Held(errors) => errors.pass_ballistic::<true>(contact),
            Self::Rod(errors) => errors.pass_ballistic::<true>(contact),
            Self::Angle(errors) => errors.pass_ballistic::<false>(contact),
            Self::Place(errors) => errors.pass_ballistic::<false>(contact),
            Self::AnyAngle(errors) => errors.pass(contact),
            Self::Any(errors) => errors.pass(contact),
        }
    }
}

/// [`crate::run::orbit::run`] with the bound at each contact, as [`ErrorEstimate::bound`].
pub fn run_with_bounds(
    scene: &Scene,
    orbit: &Orbit,
    impacts: u64,
    mut visit: impl FnMut(&Contact, f64) -> bool,
) -> Option<Ending> {
    let mut estimate = ErrorEstimate::of_scene(scene, orbit.t());
    run(&mut { *orbit }, impacts, |contact| {
        let bound = estimate.bound();
        estimate.pass(contact);
        visit(contact, bound)
    })
}

/// The last contact, of the first `impacts`, up to which the map in doubles is within `tolerance` of the exact run (m/s,
/// as [`ErrorEstimate::bound`]). `None` if it is over all of them, or to the end of the run.
///
/// `go_on` is asked now and then; a `false` gives none too.
pub fn predictable_impacts(
    scene: &Scene,
    impacts: u64,
    tolerance: f64,
    mut go_on: impl FnMut() -> bool,
) -> Option<u64> {
    let mut last = None;
    run_with_bounds(scene, &scene.orbit().ok()?, impacts, |contact, bound| {
        if bound > tolerance {
            last = Some(contact.n - 1);
        }
        last.is_none() && (!contact.n.is_multiple_of(CHECK_INTERVAL) || go_on())
    });
    last
}
