//! The schema says what the reader takes.

use super::with;
use density_lab::experiment::{catalogue, read, schema};
use std::fs;
use std::path::{Path, PathBuf};

/// Every experiment that comes with the program.
fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    found.sort();
    found
}

#[test]
fn shipped_experiments_are_sound_and_obey_the_schema() {
    let schema = schema::json_schema();
    for path in shipped() {
        read::experiment(&path).unwrap_or_else(|problems| panic!("{problems}"));
        let document: toml::Value = toml::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        obeys(&document, &schema).unwrap_or_else(|fault| panic!("{}: {fault}", path.display()));
    }
    let document: toml::Value = toml::from_str(&with(&[])).unwrap();
    obeys(&document, &schema).unwrap();
}

#[test]
fn the_schema_refuses_what_it_can_express_and_explains_what_it_takes() {
    let schema = schema::json_schema();
    for (line, changed) in [
        (1, ""),
        (2, "seed = -1"),
        (2, "sed = 7"),
        (4, "draws = 0"),
        (4, "draws = 1.5"),
        (6, "grid = { low = 0 }"),
        (3, "source = { density = \"bimodl\" }"),
        (9, "kernel = { bandwidth = 0 }"),
        (9, "kernel = { bandwith = 0.3 }"),
        (9, "kernel = { bandwidth = \"silvermann\" }"),
        (9, "kernel = { bandwidth = 0.3 }\nhistogram = { width = 1 }"),
        (17, "curves = { show = [\"truht\"] }"),
        (19, "mise = { of = \"wide\", belo = \"narrow\" }"),
        (19, ""),
    ] {
        let document: toml::Value = toml::from_str(&with(&[(line, changed)])).unwrap();
        assert!(obeys(&document, &schema).is_err(), "{changed}");
    }
    let estimators = &schema["properties"]["estimator"]["items"]["properties"];
    for entry in catalogue::ESTIMATORS {
        for parameter in entry.parameters {
            let help = &estimators[entry.name]["properties"][parameter.name]["description"];
            assert_eq!(help, parameter.help, "{} {}", entry.name, parameter.name);
        }
    }
}

/// Whether `value` has the form that `schema` describes, as far as our schemas use the language.
fn obeys(value: &toml::Value, schema: &serde_json::Value) -> Result<(), String> {
    let fault = |what: &str| Err(format!("{value} {what}"));
    for (keyword, wanted) in schema.as_object().unwrap() {
        let number = value
            .as_float()
            .or_else(|| value.as_integer().map(|i| i as f64));
        let limit = wanted.as_f64();
        let sound = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" => true,
            "type" => match wanted.as_str().unwrap() {
                "object" => value.is_table(),
                "array" => value.is_array(),
                "string" => value.is_str(),
                "boolean" => value.is_bool(),
                "integer" => value.is_integer(),
                "number" => number.is_some(),
                other => panic!("type {other}"),
            },
            "enum" => wanted
                .as_array()
                .unwrap()
                .iter()
                .any(|word| word.as_str() == value.as_str() && value.is_str()),
            "minimum" => number.is_none_or(|x| x >= limit.unwrap()),
            "maximum" => number.is_none_or(|x| x <= limit.unwrap()),
            "exclusiveMinimum" => number.is_none_or(|x| x > limit.unwrap()),
            "exclusiveMaximum" => number.is_none_or(|x| x < limit.unwrap()),
            "minLength" => value
                .as_str()
                .is_none_or(|s| s.chars().count() as f64 >= limit.unwrap()),
            "maxLength" => value
                .as_str()
                .is_none_or(|s| s.chars().count() as f64 <= limit.unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|a| a.len() as f64 >= limit.unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|a| a.len() as f64 <= limit.unwrap()),
            "uniqueItems" => value
                .as_array()
                .is_none_or(|a| a.iter().enumerate().all(|(i, x)| !a[..i].contains(x))),
            "items" => {
                for item in value.as_array().into_iter().flatten() {
                    obeys(item, wanted)?;
                }
                true
            }
            "properties" => {
                for (key, item) in value.as_table().into_iter().flatten() {
                    if let Some(schema) = wanted.get(key) {
                        obeys(item, schema).map_err(|fault| format!("{key}: {fault}"))?;
                    }
                }
                true
            }
            "additionalProperties" => {
                assert_eq!(wanted.as_bool(), Some(false));
                let known = schema["properties"].as_object().unwrap();
                value
                    .as_table()
                    .is_none_or(|table| table.keys().all(|key| known.contains_key(key)))
            }
            "required" => value.as_table().is_none_or(|table| {
                wanted
                    .as_array()
                    .unwrap()
                    .iter()
                    .all(|key| table.contains_key(key.as_str().unwrap()))
            }),
            "anyOf" => wanted
                .as_array()
                .unwrap()
                .iter()
                .any(|one| obeys(value, one).is_ok()),
            "oneOf" => {
                wanted
                    .as_array()
                    .unwrap()
                    .iter()
                    .filter(|one| obeys(value, one).is_ok())
                    .count()
                    == 1
            }
            other => panic!("the keyword {other} is not checked"),
        };
        if !sound {
            return fault(&format!("against {keyword}"));
        }
    }
    Ok(())
}
