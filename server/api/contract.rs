//! The parts of the contract that follow from the code: operations, parameters, responses and schemas of the resources.
//!
//! Requests are described by their declared fields, JSON answers by their types, tables by their columns. The word for each is its doc comment.
//! The unit of a number stands at the end of the first sentence of its word: "Time since the release, s."

mod document;

pub use document::document;
use equipoise_physics::scene::capability::Analysis;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

use crate::api::scene::fields::{choices, live_fields, patch, scene};
use crate::api::scene::presets;
use crate::api::schemas::{ContactMode, complete, component, named_apart, without_null_if_absent};
use crate::api::shared::outcome::outcome_kinds;
use crate::api::shared::refusal::refused_bodies;
use crate::api::shared::stacked::Phase;
use crate::api::shared::table::{ColumnWord, named_lists, row_schema};
use crate::api::shared::write::ProgressLine;
use crate::http::request::fields::{FieldList, Fields, Parameter};
use crate::http::{Format, Problem};

/// Names of the presets.
fn preset_names() -> Value {
    json!({"type": "string", "enum": presets::names(), "description": "Name of a preset; `/v1/scenes` lists them."})
}

/// The contract so far.
#[derive(Debug)]
pub struct Contract {
    schemas: SchemaGenerator,
    own_schemas: Map<String, Value>,
    parameters: Map<String, Value>,
    responses: Map<String, Value>,
    paths: Map<String, Value>,
}

impl Default for Contract {
    fn default() -> Self {
        let settings = SchemaSettings::draft2020_12().for_serialize().with(|settings| {
            settings.definitions_path = "/components/schemas".into();
            settings.meta_schema = None;
        });
        let empty = Map::default;
        Self {
            schemas: settings.into_generator(),
            own_schemas: empty(),
            parameters: empty(),
            responses: empty(),
            paths: empty(),
        }
    }
}

impl Contract {
    /// The description of a resource that computes an answer.
    pub fn resource(&mut self, identity: Identity) -> Description<'_> {
        Description {
            contract: self,
            identity,
            request: None,
            tables: Vec::new(),
            end: None,
            others: Vec::new(),
            refused: None,
        }
    }

    /// A GET of a document that follows from the path alone, with its response and schema.
    pub fn document<A: JsonSchema>(&mut self, tag: &str, path: &str, operation: &str, formats: &[Format]) {
        self.part::<A>();
        let name = A::schema_name();
        let format = self.format(&name.to_lowercase(), formats);
        let asked = formats.iter().map(|format| format!("format={}", format.name()));
        let queries: Vec<_> = std::iter::once(String::new()).chain(asked).collect();
        let content = content(&name, formats, &[]);
        self.responses.insert(name.to_string(), json!({"headers": headers(false), "content": content}));
        let not_found = path.contains('{').then_some(("404", "NotFound"));
        let errors: Vec<_> = GET_ERRORS.into_iter().chain(not_found).collect();
        let get = json!({
            "tags": [tag],
            "operationId": operation,
            "parameters": [format],
            "x-queries": queries,
            "responses": responses(&name, &errors),
        });
        self.paths.insert(format!("/v1/{path}"), json!({"get": get}));
    }

    /// The parameter `name` of a path, whose schema has this name too.
    pub fn path_name(&mut self, path: &str, component: &str, schema: &str, example: &str, about: &str) {
        let parameter = json!({
            "name": "name",
            "in": "path",
            "required": true,
            "description": about,
            "schema": reference("schemas", schema),
            "example": example,
        });
        self.parameters.insert(component.to_owned(), parameter);
        self.paths[path]["parameters"] = json!([reference("parameters", component)]);
    }

    /// A GET of gauges by the query of another resource.
    pub fn gauges(&mut self, path: &str, operation: &str, singular: &str, target: Value) {
        let content = content(singular, &GAUGES, &[]);
        self.responses.insert(singular.to_owned(), json!({"headers": headers(false), "content": content}));
        let format = self.format(operation, &GAUGES);
        // A query of the format alone has no target.
        if let Some(format) = self.parameters.get_mut(&component(&format!("{operation}.format"))) {
            format.as_object_mut().and_then(|format| format.shift_remove("example"));
        }
        let mut responses = responses(singular, &GET_ERRORS);
        responses["206"] = reference("responses", &format!("PartOf{singular}"));
        let get = json!({
            "tags": ["Compute"],
            "operationId": operation,
            "parameters": [target, format],
            "responses": responses,
        });
        self.paths.insert(path.to_owned(), json!({"get": get}));
    }

    /// The POST of many requests to one of these resources; lines of the answer are of this type.
    pub fn batches<L: JsonSchema>(&mut self, names: &[&str]) {
        let line = self.schemas.subschema_for::<L>().to_value();
        let headers = header_references(&["equipoise-build", "Vary"]);
        let content =
            json!({"application/x-ndjson": {"schema": {"type": "string", "format": "binary"}, "x-line": line}});
        self.responses.insert("Batch".to_owned(), json!({"headers": headers, "content": content}));
        let resource = json!({
            "name": "resource",
            "in": "path",
            "required": true,
            "description": "Resource that answers each line.",
            "schema": {"type": "string", "enum": names},
            "example": "stability",
        });
        let format = self.format("batches", &[Format::Ndjson]);
        let errors = POST_ERRORS.into_iter().filter(|(_, name)| *name != "Overloaded");
        let errors: Vec<_> = errors.chain([("404", "NotFound")]).collect();
        let post = json!({
            "tags": ["Compute"],
            "operationId": "postBatch",
            "parameters": [resource, format],
            "responses": responses("Batch", &errors),
        });
        self.paths.insert("/v1/batches/{resource}".to_owned(), json!({"post": post}));
    }

    /// The schema of a type that is part of something written by hand.
    pub fn part<A: JsonSchema>(&mut self) {
        self.schemas.subschema_for::<A>();
    }

    /// The schema of a part that is not of a resource.
    pub fn schema(&mut self, name: &str, schema: Value) {
        self.own_schemas.insert(name.to_owned(), schema);
    }

    /// Everything in the contract that follows from the code.
    pub fn finish(mut self) -> Value {
        let shared = [
            ("LiveFields", live_fields()),
            ("OutcomeKind", outcome_kinds()),
            ("PresetName", preset_names()),
            ("QuantityName", presets::quantity_names()),
            ("Scene", scene()),
            ("ScenePatch", patch()),
        ];
        for (name, schema) in shared {
            self.schema(name, schema);
        }
        for (name, schema) in named_lists() {
            self.schema(name, schema);
        }
        for (name, schema) in choices() {
            self.schema(&name, schema);
        }
        self.problems();
        // Words that columns name.
        self.part::<ContactMode>();
        self.part::<Phase>();
        let mut schemas = self.schemas.take_definitions(true);
        schemas.values_mut().for_each(without_null_if_absent);
        schemas.append(&mut self.own_schemas);
        schemas.values_mut().for_each(complete);
        named_apart(&mut schemas);
        json!({
            "paths": self.paths,
            "components": {"parameters": self.parameters, "responses": self.responses, "schemas": schemas},
        })
    }
}

/// Names and formats of a resource.
#[derive(Debug, Clone, Copy)]
pub struct Identity {
    /// Name in paths.
    pub name: &'static str,
    /// Name of one answer, in names of operations and schemas.
    pub singular: &'static str,
    /// True if there is no GET.
    pub post_only: bool,
    /// True if the answer measures a clock, so that it has no ETag.
    pub is_measured: bool,
    /// Formats of the answer.
    pub formats: &'static [Format],
}

/// The description of a resource, as far as it has been given.
#[derive(Debug)]
pub struct Description<'a> {
    contract: &'a mut Contract,
    identity: Identity,
    request: Option<FieldList>,
    tables: Vec<(&'static str, Vec<ColumnWord>)>,
    end: Option<Value>,
    others: Vec<Value>,
    refused: Option<Analysis>,
}

impl Description<'_> {
    /// The request is of these fields.
    pub fn request<R: Fields>(&mut self) -> &mut Self {
        let mut list = FieldList::default();
        R::describe_fields(&mut list);
        self.request = Some(list);
        self
    }

    /// The answer in JSON is of this type.
    pub fn answer<A: JsonSchema>(&mut self) -> &mut Self {
        self.contract.part::<A>();
        self
    }

    /// A table has these columns; `rows` says what a row is. A second table is of other answers.
    pub fn table(&mut self, rows: &'static str, columns: impl IntoIterator<Item = ColumnWord>) -> &mut Self {
        self.tables.push((rows, columns.into_iter().collect()));
        self
    }

    /// The last line of NDJSON is of this type.
    pub fn end<E: JsonSchema>(&mut self) -> &mut Self {
        self.end = Some(self.contract.schemas.subschema_for::<E>().to_value());
        self
    }

    /// The last line of NDJSON has these members of the answer.
    pub fn end_of<A: JsonSchema>(&mut self, members: &[&str]) -> &mut Self {
        let mut end = A::json_schema(&mut self.contract.schemas).to_value();
        end["description"] = json!("The last line of NDJSON.");
        if let Some(properties) = end["properties"].as_object_mut() {
            properties.retain(|name, _| members.contains(&name.as_str()));
            // The answer says what they mean.
            for member in properties.values_mut().filter_map(Value::as_object_mut) {
                member.shift_remove("description");
            }
        }
        if let Some(required) = end["required"].as_array_mut() {
            required.retain(|name| members.iter().any(|member| name == member));
        }
        let name = format!("{}End", self.identity.singular);
        self.end = Some(reference("schemas", &name));
        self.schema(&name, end)
    }

    /// NDJSON may have lines of this type besides, as with `format=progress`.
    pub fn line<L: JsonSchema>(&mut self) -> &mut Self {
        self.others.push(self.contract.schemas.subschema_for::<L>().to_value());
        self
    }

    /// With `format=progress`, lines report the progress; the last one has the answer and these pictures.
    pub fn progress(&mut self, pictures: &[&str]) -> &mut Self {
        let drawn: Map<_, _> = pictures.iter().map(|name| ((*name).to_owned(), json!({"type": "string"}))).collect();
        let pictures = json!({
            "type": "object",
            "description": "Pictures as SVG.",
            "required": pictures,
            "properties": drawn,
        });
        let end = json!({
            "type": "object",
            "description": "The last line with `format=progress`. Without it the answer is incomplete.",
            "required": ["end", "pictures"],
            "properties": {"end": reference("schemas", self.identity.singular), "pictures": pictures},
        });
        let name = format!("{}ProgressEnd", self.identity.singular);
        self.line::<ProgressLine>().others.push(reference("schemas", &name));
        self.contract.schema(&name, end);
        self
    }

    /// A schema has a name of its own.
    pub fn schema(&mut self, name: &str, schema: Value) -> &mut Self {
        self.contract.schema(name, schema);
        self
    }

    /// The operation refuses bodies that an analysis does not take.
    pub fn refuses(&mut self, analysis: Analysis) -> &mut Self {
        self.refused = Some(analysis);
        self
    }

    /// Adds operations, parameters, response and schemas.
    pub fn finish(self) {
        let Self { contract, identity, request, tables, end, others, refused } = self;
        let Identity { name, singular, post_only, is_measured, formats } = identity;
        let Some(request) = request else { return };
        let own = if post_only { Vec::new() } else { contract.parameters(name, &request) };
        let form = vec![contract.format(name, formats)];
        let has_lines = formats.contains(&Format::Ndjson);
        let query: Vec<_> = own.iter().chain(&form).cloned().collect();
        let mut body = request.into_schema();
        body["description"] = json!("At least one of `preset` and `scene`.");
        contract.own_schemas.insert(format!("{singular}Request"), body);

        contract.responses.insert(
            singular.to_owned(),
            json!({"headers": headers(is_measured), "content": content(singular, formats, &tables)}),
        );
        if has_lines {
            contract.lines(singular, &tables, end, others);
        }

        let mut item = Map::new();
        if !post_only {
            let mut get = operation("get", singular, &query, refused);
            // A measurement has no ETag, so that there is no part of it and no copy.
            let of_etag = |status: &str| matches!(status, "206" | "304" | "416");
            let errors = GET_ERRORS.into_iter().filter(|(status, _)| !(is_measured && of_etag(status)));
            get["responses"] = responses(singular, &errors.collect::<Vec<_>>());
            item.insert("get".to_owned(), get);
        }
        let mut post = operation("post", singular, &form, refused);
        post["requestBody"] = json!({
            "required": true,
            "content": {"application/json": {"schema": reference("schemas", &format!("{singular}Request"))}},
        });
        post["responses"] = responses(singular, &POST_ERRORS);
        item.insert("post".to_owned(), post);
        contract.paths.insert(format!("/v1/{name}"), Value::Object(item));
    }
}

impl Contract {
    /// The query parameters of an operation: references to them.
    pub fn parameters(&mut self, name: &str, fields: &FieldList) -> Vec<Value> {
        let mut own = Vec::new();
        for Parameter { name: path, schema, about, example, required } in &fields.parameters {
            let is_shared = path == "preset" || path.starts_with("scene.");
            let key = component(&if is_shared { path.clone() } else { format!("{name}.{path}") });
            let mut parameter = json!({"name": path, "in": "query"});
            if *required {
                parameter["required"] = json!(true);
            }
            parameter["description"] = json!(about);
            parameter["schema"] = schema.clone();
            if schema["type"] == "object" {
                (parameter["style"], parameter["explode"]) = (json!("deepObject"), json!(true));
            }
            if let Some(example) = example {
                parameter["example"] = example.clone();
            }
            own.push(reference("parameters", &key));
            self.parameters.insert(key, parameter);
        }
        own
    }

    /// Schemas of the messages of an enum that is tagged by `type`: references to them. A title stands in for the type.
    pub fn messages<M: JsonSchema>(&mut self, prefix: &str) -> Vec<Value> {
        let Value::Array(variants) = M::json_schema(&mut self.schemas).to_value()["oneOf"].take() else {
            return Vec::new();
        };
        let message = |mut schema: Value| {
            without_null_if_absent(&mut schema);
            let title = schema.as_object_mut().and_then(|schema| schema.shift_remove("title"));
            let kind = title.unwrap_or_else(|| schema["properties"]["type"]["const"].clone());
            let name = component(&format!("{prefix}.{}", kind.as_str().unwrap_or_default()));
            let reference = reference("schemas", &name);
            self.own_schemas.insert(name, schema);
            reference
        };
        variants.into_iter().map(message).collect()
    }

    /// Adds the parts of a path that follow from the code.
    pub fn path(&mut self, path: &str, item: Value) {
        self.paths.insert(path.to_owned(), item);
    }

    /// The schemas of the lines of NDJSON, each with a name of its own: generators make names of nameless ones that meet.
    fn lines(&mut self, singular: &str, tables: &[(&str, Vec<ColumnWord>)], end: Option<Value>, others: Vec<Value>) {
        let mut all = Vec::new();
        for (number, (rows, columns)) in tables.iter().enumerate() {
            let name = format!("{singular}Row{}", if number == 0 { String::new() } else { (number + 1).to_string() });
            all.push(reference("schemas", &name));
            self.own_schemas.insert(name, row_schema(rows, columns));
        }
        all.extend(others);
        if let Some(end) = end {
            let name = format!("{singular}LastLine");
            all.push(reference("schemas", &name));
            let last = json!({
                "type": "object",
                "description": "The last line. Without it the answer is incomplete.",
                "additionalProperties": false,
                "required": ["end"],
                "properties": {"end": end},
            });
            self.own_schemas.insert(name, last);
        }
        self.own_schemas.insert(format!("{singular}Line"), json!({"oneOf": all}));
    }

    /// Responses without an answer: problems, parts, and answers to a HEAD.
    fn problems(&mut self) {
        self.part::<Problem>();
        let problem = json!({"application/problem+json": {"schema": reference("schemas", "Problem")}});
        for (name, header) in PROBLEMS {
            let headers = header_references(&[&["equipoise-build"], header].concat());
            self.responses.insert(name.to_owned(), json!({"headers": headers, "content": problem}));
        }
        let mut of_part = headers(false);
        of_part["Content-Range"] = reference("headers", "Content-Range");
        let all = Format::ALL.into_iter().filter(|format| *format != Format::Events);
        let media = |format: Format| (format.media_type().split(';').next().unwrap_or_default().to_owned(), json!({}));
        let content = [
            ("PartialContent", all.map(media).collect::<Map<_, _>>()),
            ("PartOfProbe", Map::from_iter(GAUGES.map(media))),
        ];
        for (name, content) in content {
            self.responses.insert(name.to_owned(), json!({"headers": of_part, "content": content}));
        }
        for (name, headers) in [
            ("NotModified", header_references(&["equipoise-build", "ETag"])),
            ("Head", headers(false)),
            ("HeadOfPrecision", headers(true)),
            ("HeadOfUnauthorized", header_references(&["equipoise-build", "WWW-Authenticate"])),
            ("HeadOfOverloaded", header_references(&["equipoise-build", "Retry-After"])),
        ] {
            self.responses.insert(name.to_owned(), json!({"headers": headers}));
        }
    }

    /// The parameter `format` of a resource.
    fn format(&mut self, name: &str, formats: &[Format]) -> Value {
        let names: Vec<_> = formats.iter().map(|format| format.name()).collect();
        let mut about = "Format of the answer; outranks `Accept`.".to_owned();
        if formats.contains(&Format::Progress) {
            about += " With `progress`, lines report how much of the work is done, and the last line has the JSON answer and its pictures.";
        }
        let parameter = json!({
            "name": "format",
            "in": "query",
            "description": about,
            "schema": {"type": "string", "enum": names, "default": names.first()},
            "example": names.get(1).or(names.first()),
        });
        let key = component(&format!("{name}.format"));
        self.parameters.insert(key.clone(), parameter);
        reference("parameters", &key)
    }
}

/// Errors of a GET and of a POST, and the names of their responses.
const GET_ERRORS: [(&str, &str); 9] = [
    ("206", "PartialContent"),
    ("304", "NotModified"),
    ("400", "BadRequest"),
    ("403", "CrossSite"),
    ("406", "NotAcceptable"),
    ("414", "TooLong"),
    ("416", "RangeNotSatisfiable"),
    ("422", "Unprocessable"),
    ("503", "Overloaded"),
];
const POST_ERRORS: [(&str, &str); 9] = [
    ("400", "BadRequest"),
    ("403", "CrossSite"),
    ("405", "MethodNotAllowed"),
    ("406", "NotAcceptable"),
    ("408", "TooSlow"),
    ("413", "TooLarge"),
    ("415", "UnsupportedMediaType"),
    ("422", "Unprocessable"),
    ("503", "Overloaded"),
];

/// Errors that other operations may have too.
const EVERY_ERROR: [(&str, &str); 2] = [("401", "Unauthorized"), ("421", "Misdirected")];

/// Formats of gauges.
const GAUGES: [Format; 2] = [Format::OpenMetrics, Format::Prometheus];

/// Responses with a problem, and their headers besides the build.
const PROBLEMS: [(&str, &[&str]); 14] = [
    ("RangeNotSatisfiable", &["Content-Range"]),
    ("Unauthorized", &["WWW-Authenticate"]),
    ("MethodNotAllowed", &["Allow"]),
    ("Overloaded", &["Retry-After"]),
    ("CrossSite", &[]),
    ("Misdirected", &[]),
    ("BadRequest", &[]),
    ("NotFound", &[]),
    ("NotAcceptable", &[]),
    ("TooSlow", &[]),
    ("TooLong", &[]),
    ("TooLarge", &[]),
    ("UnsupportedMediaType", &[]),
    ("Unprocessable", &[]),
];

fn header_references(names: &[&str]) -> Value {
    Value::Object(names.iter().map(|name| ((*name).to_owned(), reference("headers", name))).collect())
}

/// A reference to a part of the contract.
pub fn reference(kind: &str, name: &str) -> Value {
    json!({"$ref": format!("#/components/{kind}/{name}")})
}

/// Headers of an answer.
fn headers(is_measured: bool) -> Value {
    let names: &[(&str, &str)] = match is_measured {
        true => &[("equipoise-build", ""), ("Vary", ""), ("Cache-Control", "No-Store")],
        false => &[("equipoise-build", ""), ("ETag", ""), ("Vary", ""), ("Cache-Control", ""), ("Accept-Ranges", "")],
    };
    let header = |(name, other): &(&str, &'static str)| {
        let component = if other.is_empty() { name } else { other };
        ((*name).to_owned(), reference("headers", component))
    };
    Value::Object(names.iter().map(header).collect())
}

/// An operation without its responses.
fn operation(method: &str, singular: &str, parameters: &[Value], refused: Option<Analysis>) -> Value {
    let mut operation = json!({"tags": ["Compute"], "operationId": format!("{method}{singular}")});
    if let Some(analysis) = refused {
        operation["x-refuses"] = json!(refused_bodies(analysis));
    }
    operation["parameters"] = json!(parameters);
    operation
}

fn responses(singular: &str, errors: &[(&str, &str)]) -> Value {
    let answer = [("200", singular)];
    let all = answer.iter().chain(errors).map(|(status, name)| ((*status).to_owned(), reference("responses", name)));
    Value::Object(all.collect())
}

/// References to the problems of these statuses.
pub fn errors(statuses: &[&str]) -> Value {
    let all = GET_ERRORS.iter().chain(&POST_ERRORS).chain(&EVERY_ERROR).filter(|(status, _)| statuses.contains(status));
    Value::Object(all.map(|(status, name)| ((*status).to_owned(), reference("responses", name))).collect())
}

/// The media types of an answer.
fn content(singular: &str, formats: &[Format], tables: &[(&str, Vec<ColumnWord>)]) -> Value {
    let mut content = Map::new();
    for format in formats {
        let media = match format {
            Format::Json => json!({"schema": reference("schemas", singular)}),
            Format::Csv => json!({"schema": {"type": "string", "description": csv(tables)}}),
            Format::Ndjson | Format::Progress => json!({
                "schema": {"type": "string", "description": "One JSON object for each row of CSV, names without units, then {\"end\": …}."},
                "x-line": reference("schemas", &format!("{singular}Line")),
            }),
            Format::Arrow => json!({
                "schema": {"contentMediaType": format.media_type(), "description": "Columns of CSV, names without units."},
            }),
            Format::Svg => json!({"schema": {"type": "string"}}),
            Format::OpenMetrics | Format::Prometheus => json!({"schema": {"type": "string"}}),
            Format::Png => json!({}),
            Format::Events => continue,
        };
        let media_type = format.media_type().split(';').next().unwrap_or_default();
        content.insert(media_type.to_owned(), media);
    }
    Value::Object(content)
}

/// The prose on a table as CSV.
fn csv(tables: &[(&str, Vec<ColumnWord>)]) -> String {
    let tables = tables.iter().map(|(rows, columns)| {
        let names = columns.iter().map(|column| match column.only {
            "" => column.csv_name(),
            only => format!("{} (only {only})", column.csv_name()),
        });
        format!(" {rows} Columns: {}.", names.collect::<Vec<_>>().join(", "))
    });
    format!("RFC 4180; units end the names, and a cell is empty where there is no value.{}", tables.collect::<String>())
}
