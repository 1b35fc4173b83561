//! The request for `precision`: the methods that are compared.

use equipoise_physics::scene::Scene;
use serde_json::json;

use crate::api::resource::ResourceRequest;
use crate::api::scene::spec::SceneSpec;
use crate::comparison::{ComparedMethod, METHODS, most_points};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, FieldList, FieldSpec, Fields, choice, whole};
use crate::http::request::scalar;
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;

request_fields! {
    /// A request for the comparison.
    #[derive(Debug, Clone)]
    pub struct PrecisionRequest {
        /// The scene.
        pub scene: Scene = SceneSpec,
        /// Impacts of every run.
        pub bounces: u64 = whole(1..=limits::PRECISION_BOUNCES).or(100),
        /// Measure of cost along the axis of the picture.
        pub axis: CostAxis = choice(&CostAxis::ALL).or(CostAxis::Time),
        /// The methods to run; by default all. Answers keep their own order.
        pub methods: Vec<ComparedMethod> = Methods,
    }
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

/// Some of the methods, in their own order; all by default.
#[derive(Debug, Clone, Copy)]
struct Methods;

impl FieldSpec<Vec<ComparedMethod>> for Methods {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Vec<ComparedMethod>> {
        if !reader.has(name) {
            return Some(METHODS.into());
        }
        let names = reader.array(name, METHODS.len())?;
        if names.is_empty() {
            reader.refuse(name, format!("{name} is empty; leave it out for all of them"));
        }
        let known = METHODS.map(|method| (method.name, method));
        let mut asked = Vec::new();
        for (index, word) in names.iter().enumerate() {
            match scalar::choice(word, &known) {
                Ok(method) => asked.push(method),
                Err(error) => {
                    let pointer = format!("{}/{index}", reader.pointer_to(name));
                    reader.errors().push(pointer, format!("{name} {index} {error}"));
                }
            }
        }
        Some(METHODS.into_iter().filter(|method| asked.contains(method)).collect())
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let word = json!({"$ref": "#/components/schemas/PrecisionMethod"});
        list.property(name, about, &json!({"type": "array", "minItems": 1, "maxItems": METHODS.len(), "items": word}));
        for index in 0..METHODS.len() {
            list.parameter(&format!("{name}.{index}"), "A method to run. Indices have no gaps.", word.clone(), None);
        }
    }
}

impl ResourceRequest for PrecisionRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        Self::read_fields(reader)
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        // The clock runs for the same time at each point.
        let price = Price::bounces(limits::PRECISION_PRICE).times(most_points(&self.methods));
        price.within(&limits.of_work())
    }
}
