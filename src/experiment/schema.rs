//! The form of experiment files as a JSON Schema, for editors that complete and explain while one types.
//!
//! Made from the same declarations that files are read by, so that the two cannot differ: what the schema takes and the reader does not are only
//! the things a schema cannot say (names that must exist, combinations that make no sense).

use super::Measure;
use super::catalogue;
use super::read::{figure, form, grid, region, scene, source, stop, sweep, uncertainty, whole};
use crate::density;
use crate::light::photons::WALK;
use crate::parameter::{Absent, Kind, Parameter};
use serde_json::{Map, Value, json};

const NAME: &[Parameter] = &[Parameter::optional(
    "name",
    Kind::Text,
    Absent::Unset,
    "what it is called in tables, legends and claims; made from the settings by default",
)];

/// The JSON Schema (draft 2020-12) of an experiment file.
pub fn json_schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Experiment of density-lab",
        "description": "A question about density estimators, and what the run must show.",
        "type": "object",
        "additionalProperties": false,
        "required": ["question", "source", "estimator"],
        "properties": top(),
    })
}

/// The keys of the top level; their help is that of the reader.
fn top() -> Value {
    let draws = json!({ "type": "integer", "minimum": 1, "maximum": super::read::DRAWS });
    let mut properties = Map::new();
    for &(key, help) in whole::KEYS {
        let schema = match key {
            "question" => json!({ "type": "string", "minLength": 1, "maxLength": 2000 }),
            "notes" => json!({ "type": "string", "maxLength": 100_000 }),
            "seed" => json!({ "type": "integer", "minimum": 0, "maximum": i64::MAX }),
            "source" => source_schema(),
            "interval" => json!({ "type": "number", "minimum": 0.5, "maximum": 0.9999 }),
            "draws" => json!({ "anyOf": [
                draws,
                { "type": "array", "minItems": 1, "uniqueItems": true, "items": draws },
            ] }),
            "replicates" => {
                json!({ "type": "integer", "minimum": 1, "maximum": super::read::REPLICATES })
            }
            "grid" => grid_schema(),
            "stop" => table(stop::STOP),
            "region" => json!({
                "type": "array",
                "maxItems": super::read::REGIONS,
                "items": table(region::REGION),
            }),
            "estimator" => {
                json!({ "type": "array", "minItems": 1, "items": estimator_schema() })
            }
            "figure" => json!({
                "type": "array",
                "maxItems": super::read::FIGURES,
                "items": tagged(
                    figure::COMMON,
                    figure::FORMS
                        .iter()
                        .map(|form| (form.name, table(form.parameters), form.summary.to_owned())),
                ),
            }),
            "uncertainty" => json!({
                "type": "array",
                "maxItems": 20,
                "items": tagged(
                    uncertainty::COMMON,
                    uncertainty::FORMS
                        .iter()
                        .map(|(name, parameters, help)| (*name, table(parameters), (*help).to_owned())),
                ),
            }),
            "claim" => {
                json!({ "type": "array", "maxItems": super::read::CLAIMS, "items": claim_schema() })
            }
            other => unreachable!("`{other}` is not a key of the reader"),
        };
        properties.insert(key.to_owned(), described(schema, help));
    }
    Value::Object(properties)
}

fn estimator_schema() -> Value {
    let kinds = catalogue::ESTIMATORS.iter().map(|entry| {
        (
            entry.name,
            table(entry.parameters),
            format!("{}. {}. {}", entry.summary, entry.cost, entry.reference),
        )
    });
    tagged(NAME, kinds)
}

fn claim_schema() -> Value {
    let measures = Measure::ALL.into_iter().map(|measure| {
        let mut forms: Vec<&form::Form> = form::ANY.iter().collect();
        if measure == Measure::Modes {
            forms.extend(form::MODES);
        }
        let forms: Vec<Value> = forms.iter().map(|form| table(form.parameters)).collect();
        let help = format!("a statement about `{}`", measure.name());
        (measure.name(), json!({ "anyOf": forms }), help)
    });
    let others = [
        (
            "best",
            table(form::BEST),
            "where the best of a sweep lies".to_owned(),
        ),
        (
            "oracle",
            table(form::ORACLE),
            "a figure of the theory alone".to_owned(),
        ),
        (
            "regret",
            table(form::REGRET),
            "the median error relative to another estimator's on the same samples".to_owned(),
        ),
        (
            "uncertainty",
            table(uncertainty::CLAIM),
            "what an estimate of the error gives".to_owned(),
        ),
        (
            "slope",
            table(form::SLOPE),
            "how fast an error falls as samples grow".to_owned(),
        ),
        (
            "coverage",
            table(form::COVERAGE),
            "how often the interval at a place holds what it is about".to_owned(),
        ),
        (
            "everywhere",
            table(form::AGREES),
            "whether the mean estimate is the exact one at every place".to_owned(),
        ),
    ];
    tagged(form::COMMON, measures.chain(others))
}

/// A number on a line, a number for each axis or one for both in the plane.
fn grid_schema() -> Value {
    let mut schema = table(grid::GRID);
    for parameter in grid::GRID {
        let one = schema["properties"][parameter.name].clone();
        let help = one["description"].clone();
        schema["properties"][parameter.name] = json!({
            "description": help,
            "anyOf": [one, { "type": "array", "minItems": 2, "maxItems": 2, "items": one }],
        });
    }
    schema
}

fn source_schema() -> Value {
    let alone: Vec<&str> = density::entries()
        .filter(|entry| entry.stands_alone())
        .flat_map(|entry| entry.names.iter().copied())
        .collect();
    let kinds = density::entries().flat_map(|entry| {
        entry
            .names
            .iter()
            .map(|name| (*name, table(entry.parameters), entry.summary.to_owned()))
    });
    let one = json!({ "anyOf": [{ "enum": alone }, tagged(source::NAME, kinds)] });
    let mut file = table(source::FILE);
    let pair =
        json!({ "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number" } });
    file["properties"]["domain"] = json!({
        "description": source::DOMAIN,
        "anyOf": [
            pair,
            { "type": "array", "minItems": 2, "maxItems": 2, "items": pair },
            {
                "type": "object",
                "additionalProperties": false,
                "required": ["vertices"],
                "properties": { "vertices": { "type": "array", "minItems": 3, "items": pair } },
            },
        ],
    });
    json!({ "anyOf": [
        {
            "type": "object",
            "additionalProperties": false,
            "required": ["density"],
            "properties": {
                "density": described(
                    json!({ "anyOf": [one, { "type": "array", "minItems": 1, "items": one }] }),
                    "a known density by name, one with its parameters, or a list of them",
                ),
                "paths": described(table(source::PATHS), source::PATHS_HELP),
            },
        },
        file,
        scenes(),
    ] })
}

/// Photon hits: a path or a table, or a list of them, beside the surfaces.
fn scenes() -> Value {
    let mut told = WALK.to_vec();
    told.insert(0, scene::FILE);
    told.extend(NAME);
    let one = json!({ "anyOf": [{ "type": "string" }, table(&told)] });
    let mut schema = table(&[scene::SURFACE]);
    schema["properties"]["scene"] = described(
        json!({ "anyOf": [one, { "type": "array", "minItems": 1, "items": one }] }),
        "a scene by the path of its file, one with how photons walk in it, or a list of them",
    );
    schema["required"] = json!(["scene", "surface"]);
    schema
}

/// A table with keys of its own and exactly one of `kinds`.
fn tagged<'k>(own: &[Parameter], kinds: impl Iterator<Item = (&'k str, Value, String)>) -> Value {
    let kinds: Vec<_> = kinds.collect();
    let choices: Vec<Value> = kinds
        .iter()
        .map(|(name, ..)| json!({ "required": [name] }))
        .collect();
    let mut schema = table(own);
    for (name, kind, help) in kinds {
        schema["properties"][name] = described(kind, &help);
    }
    schema["oneOf"] = Value::Array(choices);
    schema
}

/// A table with these keys and no others.
fn table(parameters: &[Parameter]) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for parameter in parameters {
        properties.insert(parameter.name.to_owned(), property(parameter));
        if parameter.absent == Absent::Required {
            required.push(parameter.name);
        }
    }
    json!({
        "type": "object",
        "additionalProperties": false,
        "required": required,
        "properties": properties,
    })
}

fn property(parameter: &Parameter) -> Value {
    let one = kind(parameter.kind);
    let mut schema = if parameter.sweeps {
        let each = kind(parameter.kind.numeric());
        json!({ "anyOf": [
            one,
            { "type": "array", "minItems": 1, "uniqueItems": true, "items": each },
            table(sweep::RANGE),
        ] })
    } else {
        one
    };
    match parameter.absent {
        Absent::Number(x) if x.fract() == 0.0 && x.abs() < 1e15 => {
            schema["default"] = json!(x as i64);
        }
        Absent::Number(x) => schema["default"] = json!(x),
        Absent::Word(word) => schema["default"] = json!(word),
        Absent::Flag(flag) => schema["default"] = json!(flag),
        Absent::Required | Absent::Unset => {}
    }
    described(schema, parameter.help)
}

fn kind(kind: Kind) -> Value {
    match kind {
        Kind::Real => json!({ "type": "number" }),
        Kind::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Kind::Fraction => json!({ "type": "number", "minimum": 0, "maximum": 1 }),
        Kind::Between(low, high) => {
            json!({ "type": "number", "exclusiveMinimum": low, "exclusiveMaximum": high })
        }
        Kind::Range(least, most) => {
            json!({ "type": "number", "minimum": least, "maximum": most })
        }
        Kind::Count { least, most } => {
            json!({ "type": "integer", "minimum": least, "maximum": most })
        }
        Kind::Choice(words) => json!({ "enum": words }),
        Kind::Choices(words) => json!({ "type": "array", "items": { "enum": words } }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Texts => json!({ "anyOf": [
            { "type": "string" },
            { "type": "array", "minItems": 1, "items": { "type": "string" } },
        ] }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::PositiveOr(words) => json!({ "anyOf": [
            { "type": "number", "exclusiveMinimum": 0 },
            { "enum": words },
        ] }),
        Kind::CountOr { least, most, words } => json!({ "anyOf": [
            { "type": "integer", "minimum": least, "maximum": most },
            { "enum": words },
        ] }),
        Kind::Rows(parameters) => {
            json!({ "type": "array", "minItems": 1, "items": table(parameters) })
        }
    }
}

fn described(mut schema: Value, help: &str) -> Value {
    schema["description"] = json!(help);
    schema
}
