//! Normal forms of random scenes against their return maps: the growth of a swing, and the quantities that it moves.

use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random::Random;
use equipoise_physics::analysis::repeating::{ON_CIRCLE, RepeatingBounce, find, of_scene};
use equipoise_physics::analysis::return_map::{ReturnMap, Vector, X, X_DOT, Y_DOT};
use equipoise_physics::analysis::swing::SwingForm;
use nalgebra::{Complex, DVector};

/// Bounces over which a swing is followed.
const BOUNCES: usize = 4_000;

/// Bounces at each end over which its amplitude is averaged.
const WINDOW: usize = 400;

/// Growth that is aimed at, of the logarithm of the amplitude.
const GROWTH: f64 = 0.08;

/// Growth below which the parts of second order hide it.
const LEAST: f64 = 0.01;

/// Distance of λ, λ², λ³ and λ⁴ from 1.
const RESONANT: f64 = 0.1;

/// Way, m, that a swing may take the place, where strikes depend on it.
const FARTHEST: f64 = 1e-3;

/// Share of the bounce speed that a kept quantity is moved by at most.
const MOVED: f64 = 0.003;

/// Swings that are tried at most, rad.
const WIDEST: f64 = 0.01;

/// A swing with its normal form.
struct Case {
    map: ReturnMap,
    bounce: RepeatingBounce,
    form: SwingForm,
}

/// What a swing does over its bounces.
struct Course {
    /// Change of the logarithm of its amplitude from the first window to the last.
    growth: f64,
    /// Change of each kept quantity.
    shifts: Vec<f64>,
}

impl Case {
    /// `None` where a random scene has no pair on the unit circle, or one without a form.
    fn draw(random: &mut Random) -> Option<(Self, Mix)> {
        let mix = Mix::draw(random, Swing::Calm, &all_but(&RANDOM));
        let (map, mut bounce) = of_scene(&mix.scene.with_tilt_law()).ok()?;
        // A drift moves the place, and with it the coefficients where strikes depend on it.
        if map.components().contains(&X) && !bounce.neutral.is_empty() {
            let mut still = bounce.at;
            still[X_DOT] = 0.0;
            bounce = find(&map, &still, &still).ok().filter(|found| found.at[X_DOT] == 0.0)?;
        }
        let pair = |value: &Complex<f64>| value.im > 0.0 && (value.norm_sqr() - 1.0).abs() < 2.0 * ON_CIRCLE;
        let values = bounce.eigenvalues_beside()?;
        let others = values.iter().filter(|value| value.norm_sqr() > (1.0 - 1e-3_f64).powi(2)).count();
        let eigenvalue = values.into_iter().find(pair)?;
        let form = SwingForm::new(&map, &bounce, eigenvalue).ok().filter(|_| others == 2)?;
        // Near a strong resonance the terms of higher order are large.
        let near = |order: i32| (eigenvalue.powi(order) - Complex::new(1.0, 0.0)).norm_sqr() < RESONANT * RESONANT;
        if (1..=4).any(near) || eigenvalue.re.abs() > 1.0 - RESONANT {
            return None;
        }
        Some((Self { map, bounce, form }, mix))
    }

    /// |w|² of a swing that grows or dies out by [`GROWTH`], rad².
    fn size(&self) -> f64 {
        let bounces = BOUNCES as f64;
        let speed = self.bounce.at[Y_DOT].abs();
        let least = self.form.shifts.iter().map(|shift| shift.abs() * bounces).fold(0.0, f64::max);
        let growth = GROWTH / (bounces * self.form.growth.abs() + 0.5 * bounces * bounces * self.form.pumped().abs());
        growth.min(MOVED * speed / least)
    }

    /// By the slow equations of the normal form, in steps of one bounce.
    fn predicted(&self, size: f64) -> Course {
        let (mut square, mut moved) = (size, vec![0.0; self.form.shifts.len()]);
        let mut logarithms = Vec::new();
        for _ in 0..BOUNCES {
            logarithms.push(0.5 * square.ln());
            let pushed: f64 = moved.iter().zip(&self.form.growths).map(|(moved, growth)| moved * growth).sum();
            for (moved, shift) in moved.iter_mut().zip(&self.form.shifts) {
                *moved += shift * square;
            }
            square *= (2.0 * (self.form.growth * square + pushed)).exp();
        }
        Course { growth: between_ends(&logarithms), shifts: moved }
    }

    /// By the map, from w = √size or i√size; `None` if the map ends or the place moves.
    fn followed(&self, size: f64, turned: bool) -> Option<Course> {
        let w = if turned { Complex::new(0.0, size.sqrt()) } else { Complex::new(size.sqrt(), 0.0) };
        let start = self.map.moved(&self.bounce.at, &self.form.right.map(|part| 2.0 * (w * part).re));
        let mut at = start;
        let mut logarithms = Vec::new();
        for _ in 0..BOUNCES {
            logarithms.push(self.form.amplitude(&self.map, &self.bounce, &at).ln());
            at = self.map.image(&at)?;
        }
        let moved = |vector: &Vector| -> DVector<f64> { self.map.reduced(vector) };
        let change = moved(&at) - moved(&start);
        if self.map.components().contains(&X) && (at[X] - start[X]).abs() > FARTHEST {
            return None;
        }
        let shifts = self.bounce.neutral.iter().map(|neutral| neutral.left.dot(&change)).collect();
        Some(Course { growth: between_ends(&logarithms), shifts })
    }
}

fn between_ends(logarithms: &[f64]) -> f64 {
    let mean = |window: &[f64]| window.iter().sum::<f64>() / window.len() as f64;
    mean(&logarithms[logarithms.len() - WINDOW..]) - mean(&logarithms[..WINDOW])
}

/// The mean over two starts a quarter of a swing apart, whose parts of second order are opposite. `CASES` and `SEED` of the environment give
/// other scenes.
#[test]
fn swings_grow_and_move_kept_quantities_as_their_normal_forms_say() {
    let number = |name, or| std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(or);
    let (cases, seed) = (number("CASES", 40), number("SEED", 77));
    let mut random = Random::new(seed);
    let (mut tried, mut ended, mut growing, mut moving, mut wrong) = (0, 0, 0, 0, Vec::new());
    while tried < cases {
        let Some((case, mix)) = Case::draw(&mut random) else { continue };
        let size = case.size();
        let said = case.predicted(size);
        let counts = said.growth.abs() > LEAST;
        if size.sqrt() > WIDEST || !(counts || said.shifts.iter().any(|shift| *shift != 0.0)) {
            continue;
        }
        let [Some(one), Some(other)] = [false, true].map(|turned| case.followed(size, turned)) else {
            ended += 1;
            continue;
        };
        tried += 1;
        let courses = [one, other];
        let mean = |of: &dyn Fn(&Course) -> f64| 0.5 * (of(&courses[0]) + of(&courses[1]));
        let grown = mean(&|course| course.growth);
        growing += usize::from(counts);
        if counts && (grown - said.growth).abs() > 0.1 * said.growth.abs() {
            wrong.push(format!(
                "{:?}: growth {grown}, {} said, |w| {}, {:?}",
                mix.features,
                said.growth,
                size.sqrt(),
                case.form
            ));
        }
        for (index, shift) in said.shifts.iter().enumerate().filter(|(_, shift)| **shift != 0.0) {
            let moved = mean(&|course| course.shifts[index]);
            moving += 1;
            if (moved - shift).abs() > 0.1 * shift.abs() {
                wrong.push(format!("{:?}: shift {moved}, {shift} said, {:?}", mix.features, case.form));
            }
        }
    }
    for line in &wrong {
        eprintln!("{line}");
    }
    eprintln!("{growing} swings, {moving} kept quantities");
    assert!(ended <= cases, "{ended} swings end or move their place, beside {cases} that do not");
    assert!(wrong.is_empty(), "{} of {tried} swings do not go as their normal forms say", wrong.len());
}
