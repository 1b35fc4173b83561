//! Reads the energy feedback of a scene: its measure, its law, its gain and its target heights.

use super::draft::Draft;
use super::error::{FieldError, FieldErrorKind};
use super::fields::{Name, Value};
use super::words::Alternative;
use super::{Scene, Striking};
use crate::map::strike::{EnergyFeedback, EnergyLaw, EnergyMeasure};
use crate::map::table::program::HeightProgram;

/// Energy feedback of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EnergySteering {
    /// κ_E, s²/m²; 0 where one strike does it all.
    pub(super) gain: f64,
    pub(super) feedback: EnergyFeedback,
    /// y*, m, of the first strike; `None` where nothing steers the energy.
    pub(super) target_height: Option<f64>,
    /// Heights of all strikes, where they differ.
    pub(super) program: Option<HeightProgram>,
}

impl Draft {
    /// The energy feedback with all contradictions to the table's strike and among its own fields.
    pub(super) fn energy_steering(&self, strike: Striking, errors: &mut Vec<FieldError>) -> EnergySteering {
        let gain = self.required(Name::EnergyGain, errors);
        let feedback = self.energy_feedback();
        let one_strike = feedback == EnergyFeedback::OneStrike;
        let mut refuse = |name, detail: String| errors.push(FieldError::new(name, detail));
        if one_strike {
            if gain != 0.0 {
                let detail = "energy_gain belongs to energy_law `proportional`; energy_law says `one_strike`, which has no gain: \
                              leave one of them out";
                refuse(Name::EnergyGain, detail.to_owned());
            }
            if self.word(Name::EnergyMeasure) == Some(EnergyMeasure::Vertical) {
                let detail = "energy_measure is `vertical` and energy_law `one_strike` brings the total energy to its target; say \
                              `total`, or leave one of them out";
                refuse(Name::EnergyMeasure, detail.to_owned());
            }
            if strike == Striking::Still {
                let detail = "energy_law `one_strike` moves the table and strike says `still`; leave one of them out";
                refuse(Name::EnergyLaw, detail.to_owned());
            }
        } else if gain != 0.0 && strike == Striking::Still {
            let detail = "energy_gain moves the table and strike says `still`; leave one of them out".to_owned();
            refuse(Name::EnergyGain, detail);
        }
        let (height, program) = (self.number(Name::TargetHeight), self.program());
        if let (Some(height), Some(_)) = (height, program) {
            let detail =
                format!("target_height ({height} m) and program both say where to steer; leave one of them out");
            errors.push(FieldError { path: Name::Program.row().path, detail, kind: FieldErrorKind::TwoTargets });
        }
        let steers = one_strike || gain != 0.0;
        let first = height.or(program.map(|program| program.at(1)));
        if steers && first.is_none() {
            let law =
                if one_strike { "energy_law `one_strike`".to_owned() } else { format!("energy_gain {gain} s²/m²") };
            let limits = Name::TargetHeight.row().limits();
            let detail = format!("target_height is missing: {law} needs the height it steers to; {limits}");
            errors.push(FieldError::new(Name::TargetHeight, detail));
        }
        let varied = program.filter(|program| program.heights().iter().any(|height| *height != program.at(1)));
        EnergySteering { gain, feedback, target_height: first.filter(|_| steers), program: varied.filter(|_| steers) }
    }

    /// The energy feedback by its law and its measure, which has no effect without a gain.
    pub(crate) fn energy_feedback(&self) -> EnergyFeedback {
        match (self.word(Name::EnergyLaw), self.word(Name::EnergyMeasure)) {
            (Some(EnergyLaw::OneStrike), _) => EnergyFeedback::OneStrike,
            (None | Some(EnergyLaw::Proportional), None | Some(EnergyMeasure::Vertical)) => EnergyFeedback::Vertical,
            (None | Some(EnergyLaw::Proportional), Some(EnergyMeasure::Total)) => EnergyFeedback::Total,
        }
    }

    fn program(&self) -> Option<HeightProgram> {
        match self.get(Name::Program) {
            Some(Value::Numbers(program)) => Some(program),
            _ => None,
        }
    }

    /// The alternative that a field names by its word, if it has a value.
    fn word<T: Alternative>(&self, name: Name) -> Option<T> {
        match self.get(name) {
            Some(Value::Choice(word)) => T::from_word(word),
            _ => None,
        }
    }
}

/// A sentence that says why the strikes of a scene depend on the energy.
pub(super) fn energy_reason(scene: &Scene) -> String {
    let gain = scene.energy_gain;
    match scene.energy_feedback {
        EnergyFeedback::Vertical => {
            format!("energy_gain is {gain} s²/m², so the table's speed depends on the energy (eq. 28)")
        }
        EnergyFeedback::Total => format!(
            "energy_gain is {gain} s²/m² and energy_measure `total`, so the table's speed depends on the energy, sideways motion and \
             spin included"
        ),
        EnergyFeedback::OneStrike => {
            "energy_law is `one_strike`, so the table's speed depends on the energy, and each strike brings it to the target".to_owned()
        }
    }
}
