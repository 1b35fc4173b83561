//! The reason why a valid request has no answer, and words on what an analysis needs of a scene: for refusals, notes and a paragraph of the
//! contract, from the table of the physics.

use equipoise_physics::scene::capability::{Analysis, CAPABILITIES, Lack, Need};
use equipoise_physics::scene::{Name, Scene, field};

use crate::compute::Cancelled;
use crate::http::{Problem, Reader};

/// The reason why there is no answer.
#[derive(Debug)]
pub enum Refusal {
    /// The client has gone.
    Cancelled,
    /// A field of the request does not allow it: JSON pointer and sentence.
    At(&'static str, String),
}

impl From<Cancelled> for Refusal {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<(&'static str, String)> for Refusal {
    fn from((pointer, detail): (&'static str, String)) -> Self {
        Self::At(pointer, detail)
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Cancelled => Cancelled.into(),
            Refusal::At(pointer, detail) => Problem::invalid_at(pointer, detail),
        }
    }
}

/// An analysis in a sentence.
fn named(analysis: Analysis) -> &'static str {
    match analysis {
        Analysis::LinearRun => "the method `linear` of `trajectories`",
        Analysis::LinearSolution => "the linear solution in `precision`",
        Analysis::JacobianAtFixedPoint => "`jacobians` at the fixed point",
        Analysis::SymmetricOrbit => "the family `symmetric` of `periodic-orbits`",
        Analysis::LinearMap => "`regions` of `residue` and `spectral_radius`",
        Analysis::Basin => "a basin",
        Analysis::Controller => "`controllers`",
        Analysis::Catch => "a catch",
        Analysis::Throw => "a throw",
        Analysis::LastingContact => "`hold`, the contact after the bounces,",
        Analysis::Simulation => "a general method of `precision`",
        Analysis::PenaltySimulation => "the method of springs and dampers",
    }
}

/// A need in a sentence.
fn needed(need: Need) -> &'static str {
    match need {
        Need::Angle => "a body with an angle of its own",
        Need::RepeatingBounce => "a bounce that repeats",
        Need::PlainRod => "a table that tilts by κθ without anything else that changes bounces",
        Need::NoEndings => "no limits, ends or vertices, which it does not look at",
        Need::VerticalEnergy => "a table that steers the vertical energy or none",
        Need::PresentState => "a table that strikes by the state at the strike",
        Need::NoDragging => "a table that does not drag the contact along as it turns",
        Need::NoTurning => "a table that does not act by its turning",
        Need::NoAir => "flights without air",
        Need::NoFriction => "a contact without friction",
    }
}

/// The sentence on a need that a scene does not meet.
pub fn sentence(scene: &Scene, analysis: Analysis, Lack { need, path }: Lack) -> String {
    let value = field(path).and_then(|row| scene.value(row.name));
    let given = value.map_or_else(|| "given".to_owned(), |value| value.to_string());
    format!("{path} is {given}, and {} needs {}", named(analysis), needed(need))
}

/// A sentence on the first need of an analysis that a scene does not meet, if there is one.
pub fn lacking(scene: &Scene, analysis: Analysis) -> Option<String> {
    analysis.lack(scene).map(|lack| sentence(scene, analysis, lack))
}

/// Refuses a scene that does not meet the needs of an analysis, at the field. Returns true if it did.
pub fn refuse_lacking(reader: &mut Reader<'_, '_>, scene: &Scene, analysis: Analysis) -> bool {
    let Some(lack) = analysis.lack(scene) else { return false };
    let pointer = format!("{}/{}", reader.pointer_to("scene"), lack.path.replace('.', "/"));
    reader.errors().push(pointer, sentence(scene, analysis, lack));
    true
}

/// A note that an analysis is of the scene without its noise, if it has some.
pub fn noiseless(scene: &Scene, analysis: &str) -> Option<String> {
    let name = scene.noise_field()?;
    let value = scene.number(name).unwrap_or_default();
    Some(format!("{} is {value}, and {analysis} is of the map without random errors", name.row().path))
}

/// The lines of the contract on what is not derived.
pub fn exceptions() -> String {
    let line = |(analysis, needs): &(Analysis, &[Need])| {
        let needs: Vec<_> = needs.iter().map(|need| needed(*need)).collect();
        format!("- {} needs {}.\n", capitalized(named(*analysis)), needs.join("; "))
    };
    CAPABILITIES.iter().map(line).collect()
}

/// Paths of the fields for which an analysis refuses a scene by what it needs of the body.
pub fn refused_bodies(analysis: Analysis) -> Vec<&'static str> {
    let of_angle = |need: &&Need| **need == Need::Angle;
    analysis.needs().iter().filter(of_angle).map(|_| Name::PointMass.row().path).collect()
}

fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
