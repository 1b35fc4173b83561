//! Sensing of a scene's table, with noise and some time before the strike: reads the fields, and says what they ask for.

use super::draft::Draft;
use super::error::FieldError;
use super::fields::{Name, Value};
use super::words::Alternative;
use super::{Scene, Striking};
use crate::map::table::noise::{Noise, NoiseModel};
use crate::map::table::sensing::Prediction;

/// Fields of noise.
pub(crate) const NOISE: [Name; 10] = [
    Name::TimingSd,
    Name::AngleSd,
    Name::XSd,
    Name::XDotSd,
    Name::YDotSd,
    Name::ThetaDotSd,
    Name::RestitutionSd,
    Name::NoiseModel,
    Name::Seed,
    Name::NoiseRun,
];

impl Draft {
    /// Noise with its defaults filled in; None if all standard deviations are 0.
    pub(super) fn noise(&mut self, errors: &mut Vec<FieldError>) -> Option<Noise> {
        let sd = |name| self.number(name).unwrap_or(0.0);
        let noise = Noise {
            timing_sd: sd(Name::TimingSd),
            angle_sd: sd(Name::AngleSd),
            x_sd: sd(Name::XSd),
            x_dot_sd: sd(Name::XDotSd),
            y_dot_sd: sd(Name::YDotSd),
            theta_dot_sd: sd(Name::ThetaDotSd),
            restitution_sd: sd(Name::RestitutionSd),
            ..Noise::NONE
        };
        if noise == Noise::NONE {
            return None;
        }
        self.fill(Name::NoiseModel, Value::Choice(NoiseModel::FIRST.word()));
        let model = self.chosen(Name::NoiseModel, errors);
        let [seed, run] = [Name::Seed, Name::NoiseRun].map(|name| {
            self.fill(name, Value::Integer(0));
            match self.get(name) {
                Some(Value::Integer(number)) => number,
                _ => 0,
            }
        });
        Some(Noise { model, seed, run, ..noise })
    }

    /// Time from sensing to the strike, s, and the use that the table makes of it, with its default filled in if there is a delay.
    pub(super) fn delay(&mut self, errors: &mut Vec<FieldError>) -> (f64, Prediction) {
        let delay = self.number(Name::Delay).unwrap_or(0.0);
        if delay == 0.0 {
            return (0.0, Prediction::None);
        }
        self.fill(Name::Prediction, Value::Choice(Prediction::FIRST.word()));
        (delay, self.chosen(Name::Prediction, errors))
    }

    /// The field that stands for the noise: that of time, or of the angle alone, or else the first one that is not 0.
    pub(super) fn first_error(noise: &Noise) -> Name {
        match (noise.timing_sd, noise.angle_sd) {
            (0.0, 0.0) => further_errors(noise).next().map_or(Name::TimingSd, |(name, ..)| name),
            (0.0, _) => Name::AngleSd,
            _ => Name::TimingSd,
        }
    }

    /// The noise of a table that senses `delay` s before the strike: if it predicts the flight, the errors of velocities grow on the way, and
    /// decay in air that drags the body.
    pub(super) fn sensing_ahead(mut noise: Noise, delay: f64, prediction: Prediction, is_dragged: bool) -> Noise {
        let Noise { x_dot_sd, y_dot_sd, theta_dot_sd, .. } = noise;
        let grows = x_dot_sd != 0.0 || theta_dot_sd != 0.0 || (is_dragged && y_dot_sd != 0.0);
        if prediction == Prediction::Flight && grows {
            noise.horizon = delay;
        }
        noise
    }
}

/// Standard deviations beside those of timing and angle, each with its field, its unit and what it is of.
fn further_errors(noise: &Noise) -> impl Iterator<Item = (Name, f64, &'static str, &'static str)> {
    let Noise { x_sd, x_dot_sd, y_dot_sd, theta_dot_sd, restitution_sd, .. } = *noise;
    [
        (Name::XSd, x_sd, " m", "place"),
        (Name::XDotSd, x_dot_sd, " m/s", "horizontal velocity"),
        (Name::YDotSd, y_dot_sd, " m/s", "vertical velocity"),
        (Name::ThetaDotSd, theta_dot_sd, " rad/s", "angular velocity"),
        (Name::RestitutionSd, restitution_sd, "", "restitution"),
    ]
    .into_iter()
    .filter(|(_, sd, ..)| *sd != 0.0)
}

impl Scene {
    /// Tells whether something errs at random.
    pub fn has_noise(&self) -> bool {
        self.noise.is_some()
    }

    /// The field of noise that asks for more than an exact table, with a sentence.
    pub(super) fn noise_requirement(&self) -> Option<(Name, String)> {
        let noise = self.noise?;
        let Noise { timing_sd, angle_sd, seed, model, .. } = noise;
        let name = Draft::first_error(&noise);
        let further: String = further_errors(&noise).map(|(_, sd, unit, of)| format!(", {sd}{unit} in {of}")).collect();
        let ahead = match noise.horizon {
            0.0 => String::new(),
            horizon => format!(", sensed {horizon} s before the strike and carried on"),
        };
        let detail = format!(
            "the table errs by {timing_sd} s in time and {angle_sd} rad in angle{further}{ahead} (standard deviations; seed {seed}, model `{}`)",
            model.word()
        );
        Some((name, detail))
    }

    /// Tells whether the table moves along its normal.
    pub(super) fn table_moves(&self) -> bool {
        self.steers_energy() || (self.strike == Striking::Compensated && self.assumed_restitution() != 1.0)
    }

    /// Time before a strike of the state by which the table strikes, s; 0 if it senses at once, or predicts the flight.
    pub fn lag(&self) -> f64 {
        self.lag
    }

    /// Tells whether the table moves by velocities that it has sensed some time before the strike.
    pub fn moves_late(&self) -> bool {
        self.lag != 0.0 && self.table_moves()
    }

    /// The delay of a table that does not predict the flight, with a sentence.
    pub(super) fn delay_requirement(&self) -> Option<(Name, String)> {
        let delay = self.lag;
        (delay != 0.0).then(|| {
            let detail = format!(
                "the table takes the state {delay} s before the strike for that at the strike (table.prediction `{}`)",
                Prediction::None.word()
            );
            (Name::Delay, detail)
        })
    }

    /// Tells whether a strike may take energy away by an error of the restitution, or of the speed of a table that moves.
    pub(super) fn errs_in_energy(&self) -> bool {
        self.moves_late()
            || self
                .noise
                .is_some_and(|noise| noise.restitution_sd != 0.0 || (noise.errs_in_velocity() && self.table_moves()))
    }
}
