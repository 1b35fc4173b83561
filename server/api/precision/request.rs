//! The request for `precision`: the methods that are compared.

use equipoise_physics::scene::Scene;

use crate::api::resource::ResourceRequest;
use crate::api::scene::read_scene;
use crate::comparison::{ComparedMethod, METHODS, most_points};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::scalar;
use crate::limits;
use crate::limits::Limits;

/// A request for the comparison.
#[derive(Debug, Clone)]
pub struct PrecisionRequest {
    /// The scene.
    pub scene: Scene,
    /// Number of contacts.
    pub impacts: u64,
    /// The methods.
    pub methods: Vec<ComparedMethod>,
    /// The cost along the picture.
    pub axis: CostAxis,
}

/// The cost that is drawn along the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostAxis {
    /// Clock time.
    Time,
    /// Evaluations of motion and gap.
    Evaluations,
    /// Steps. Steps of different methods are different work, so no point is better than another by them.
    Steps,
}

impl CostAxis {
    /// All axes, by their names in requests.
    pub const ALL: [(&'static str, Self); 3] =
        [("time", Self::Time), ("evaluations", Self::Evaluations), ("steps", Self::Steps)];
}

impl ResourceRequest for PrecisionRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let scene = read_scene(reader);
        let before = reader.errors().len();
        let impacts = reader.integer("impacts", 1..=limits::PRECISION_IMPACTS).unwrap_or(100);
        let axis = reader.choice("axis", &CostAxis::ALL);
        let known = METHODS.map(|method| (method.name, method));
        let mut asked = Vec::new();
        let names = reader.array("methods", METHODS.len());
        for (index, name) in names.unwrap_or_default().iter().enumerate() {
            match scalar::choice(name, &known) {
                Ok(method) => asked.push(method),
                Err(error) => {
                    let pointer = format!("{}/{index}", reader.pointer_to("methods"));
                    reader.errors().push(pointer, format!("methods {index} {error}"));
                }
            }
        }
        if names.is_some_and(<[_]>::is_empty) {
            reader.refuse("methods", "methods is empty; leave it out for all of them");
        }
        if reader.errors().len() > before {
            return None;
        }
        let wanted = |method: &ComparedMethod| names.is_none() || asked.contains(method);
        let methods = METHODS.into_iter().filter(wanted).collect();
        Some(Self { scene: scene?, impacts, methods, axis: axis.unwrap_or(CostAxis::Time) })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        // The clock runs for the same time at each point.
        let price = Price::bounces(limits::PRECISION_PRICE).times(most_points(&self.methods));
        price.within(&limits.of_work())
    }
}
