//! Estimators as they are written on the command line.

use super::stop::Stop;
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{self, ESTIMATORS, Entry};
use crate::parameter::{Absent, Kind, Value, Values, nearest};

/// An estimator with its checked settings.
pub struct Settings {
    entry: &'static Entry,
    values: Values,
}

impl Settings {
    /// Builds it.
    ///
    /// # Errors
    /// If the settings do not go together, or need something that is not known here.
    pub fn build(&self, context: &Context) -> Result<Box<dyn Estimator<1>>, Stop> {
        (self.entry.build)(&self.values, context)
            .map_err(|error| wrong(&format!("`{}`: {error}", error.parameter)))
    }
}

fn wrong(what: &str) -> Stop {
    Stop::Input(format!("--estimator: {what}"))
}

fn unknown<'a>(what: &str, name: &str, allowed: impl Iterator<Item = &'a str> + Clone) -> Stop {
    let guess = nearest(name, allowed.clone())
        .map(|other| format!("; did you mean `{other}`?"))
        .unwrap_or_default();
    let allowed: Vec<&str> = allowed.collect();
    wrong(&format!(
        "no {what} `{}`{guess}\nallowed are {}",
        name.escape_debug(),
        allowed.join(", ")
    ))
}

/// Reads `KIND = { .. }`, with or without braces around it; `engine` is one more setting.
///
/// # Errors
/// If it is not a legal estimator.
pub fn read(text: &str, engine: Option<&str>) -> Result<Settings, Stop> {
    let inner = text.trim();
    let document = if inner.starts_with('{') {
        format!("estimator = {inner}")
    } else {
        format!("[estimator]\n{inner}")
    };
    let table: toml::Table = toml::from_str(&document)
        .map_err(|error| wrong(&format!("not TOML: {}", error.message())))?;
    let kinds = table.get("estimator").and_then(toml::Value::as_table);
    let Some((name, given)) = kinds
        .filter(|kinds| kinds.len() == 1)
        .and_then(|kinds| kinds.iter().next())
    else {
        return Err(wrong(
            "one estimator is wanted, such as 'kernel = { bandwidth = 0.3 }'",
        ));
    };
    let entry = catalogue::estimator(name)
        .ok_or_else(|| unknown("estimator", name, ESTIMATORS.iter().map(|entry| entry.name)))?;
    let given = given
        .as_table()
        .ok_or_else(|| wrong(&format!("`{name}` wants a table, such as {{ .. }}")))?;
    let mut values = Values::defaults(entry.parameters);
    let mut given = given.clone();
    if let Some(engine) = engine {
        given.insert("engine".to_owned(), engine.into());
    }
    for (key, value) in &given {
        let names = entry.parameters.iter().map(|parameter| parameter.name);
        let Some(parameter) = entry
            .parameters
            .iter()
            .find(|parameter| parameter.name == key)
        else {
            return Err(unknown(&format!("setting of `{name}` named"), key, names));
        };
        let value = checked(parameter.kind, value)
            .map_err(|allowed| wrong(&format!("`{key}` = {value}: allowed is {allowed}")))?;
        values.set(parameter.name, value);
    }
    for parameter in entry.parameters {
        if parameter.absent == Absent::Required && values.get(parameter.name).is_none() {
            return Err(wrong(&format!("`{name}` needs `{}`", parameter.name)));
        }
    }
    Ok(Settings { entry, values })
}

fn checked(kind: Kind, value: &toml::Value) -> Result<Value, String> {
    let number = value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
        .filter(|x| x.is_finite());
    let word = |words: &[&str]| match value.as_str() {
        Some(word) if words.contains(&word) => Ok(Value::Word(word.to_owned())),
        _ => Err(words.join(", ")),
    };
    match kind {
        Kind::Real => number
            .map(Value::Number)
            .ok_or("a finite number".to_owned()),
        Kind::Positive => number
            .filter(|x| *x > 0.0)
            .map(Value::Number)
            .ok_or("a finite number above 0".to_owned()),
        Kind::Fraction => number
            .filter(|x| (0.0..=1.0).contains(x))
            .map(Value::Number)
            .ok_or("a number from 0 to 1".to_owned()),
        Kind::Count { least, most } => value
            .as_integer()
            .and_then(|n| u64::try_from(n).ok())
            .filter(|n| (least..=most).contains(n))
            .map(Value::Count)
            .ok_or(format!("a whole number from {least} to {most}")),
        Kind::Choice(words) => word(words),
        Kind::PositiveOr(words) => match number.filter(|x| *x > 0.0) {
            Some(x) => Ok(Value::Number(x)),
            None => word(words).map_err(|words| format!("a finite number above 0, or {words}")),
        },
        Kind::Flag => value
            .as_bool()
            .map(Value::Flag)
            .ok_or("true or false".to_owned()),
        Kind::Between(..) | Kind::Choices(_) | Kind::Text | Kind::Texts | Kind::Rows(_) => {
            Err("not possible here".to_owned())
        }
    }
}
