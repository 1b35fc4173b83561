//! Help on the subcommands from the contract: summary, description and fields of each resource.

use clap::Command;
use serde_json::Value;

use crate::api::ops::contract::WRITTEN;

/// The last words of the help on a subcommand.
const NOTE: &str =
    "Names of a scene's fields may begin with `scene.`. The limits of `serve` hold, by its variables and flags.";

/// The contract as a document.
pub(super) struct Contract(Value);

impl Contract {
    pub(super) fn read() -> Self {
        Self(serde_json::from_slice(WRITTEN).unwrap_or_default())
    }

    /// Adds what the contract says of a resource to its subcommand.
    pub(super) fn explain(&self, command: Command, name: &str) -> Command {
        let item = &self.0["paths"][format!("/v1/{name}")];
        let operation = item.get("get").unwrap_or(&item["post"]);
        let text = |name: &str| unwrapped(operation[name].as_str().unwrap_or_default());
        let fields = match item.get("get") {
            Some(get) => {
                let parameters = get["parameters"].as_array().into_iter().flatten();
                parameters.map(|parameter| self.resolve(parameter)).filter_map(parameter_line).collect()
            }
            None => {
                let body = &item["post"]["requestBody"]["content"]["application/json"]["schema"];
                let own = self.resolve(body)["properties"].as_object().into_iter().flatten();
                let own = own.filter(|(name, _)| *name != "preset" && *name != "scene").map(property_line);
                let parameters = self.0["components"]["parameters"].as_object().into_iter().flatten();
                let is_of_scene = |name: &Value| name.as_str().is_some_and(|name| name.starts_with("scene."));
                let scene =
                    parameters.map(|(_, parameter)| parameter).filter(|parameter| is_of_scene(&parameter["name"]));
                own.chain(scene.filter_map(parameter_line)).collect::<String>()
            }
        };
        let about = format!("{}\n\n{}", text("summary"), text("description"));
        command.about(text("summary")).long_about(about).after_long_help(format!("Fields:\n{fields}\n{NOTE}"))
    }

    /// The part that a reference names, or the part itself.
    fn resolve<'a>(&'a self, part: &'a Value) -> &'a Value {
        let pointer = part["$ref"].as_str().and_then(|reference| reference.strip_prefix('#'));
        pointer.and_then(|pointer| self.0.pointer(pointer)).unwrap_or(part)
    }
}

/// Prose with each paragraph and item on one line, which the terminal wraps.
fn unwrapped(prose: &str) -> String {
    let paragraphs = prose.trim().replace("\n\n", "\0").replace("\n- ", "\u{1}").replace('\n', " ");
    paragraphs.replace('\0', "\n\n").replace('\u{1}', "\n- ")
}

/// A parameter of a query: name, kind, range, default and word.
fn parameter_line(parameter: &Value) -> Option<String> {
    let name = parameter["name"].as_str()?;
    // Flags of their own.
    if name == "preset" || name == "format" {
        return None;
    }
    let name = name.strip_prefix("scene.").unwrap_or(name);
    Some(line(name, &parameter["schema"], parameter["description"].as_str()))
}

fn property_line((name, schema): (&String, &Value)) -> String {
    line(name, schema, schema["description"].as_str())
}

fn line(name: &str, schema: &Value, about: Option<&str>) -> String {
    let mut facts: Vec<String> = Vec::new();
    if let Some(words) = schema["enum"].as_array() {
        let words: Vec<_> = words.iter().filter_map(Value::as_str).collect();
        facts.push(words.join(", "));
    }
    let unit = schema["x-unit"].as_str().filter(|unit| *unit != "1").map(|unit| format!(" {unit}")).unwrap_or_default();
    if let (Some(least), Some(most)) = (schema["minimum"].as_f64(), schema["maximum"].as_f64()) {
        facts.push(format!("{least} to {most}{unit}"));
    }
    if let Some(default) = schema.get("default").or(schema.get("x-default")) {
        let number = default.as_f64().map_or_else(|| default.to_string(), |number| number.to_string());
        let default = default.as_str().map_or(number, str::to_owned);
        facts.push(format!("default {default}"));
    }
    let facts = if facts.is_empty() { String::new() } else { format!(" [{}]", facts.join("; ")) };
    format!("  {name}{facts}\n          {}\n", about.unwrap_or_default().replace('\n', " ").trim())
}
