//! Estimators as they are written on the command line.

use super::stop::Stop;
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{self, Builds, Entry};
use crate::experiment::{EstimatorSpec, read};
use crate::parameter::{Kind, Unit, Value, listed, nearest};

/// What the text of an estimator is called in messages.
const ORIGIN: &str = "--estimator";

/// An estimator with its checked settings.
pub struct Settings {
    entry: &'static Entry,
    spec: EstimatorSpec,
}

impl Settings {
    /// Reads `KIND = { .. }`, with or without braces around it; `engine` is one more setting.
    ///
    /// # Errors
    /// If it is not a legal estimator.
    pub fn read(text: &str, engine: Option<&str>) -> Result<Self, Stop> {
        let mut spec =
            read::estimator(text, ORIGIN).map_err(|problems| Stop::problems(&problems))?;
        let entry = catalogue::estimator(&spec.kind)
            .ok_or_else(|| Stop::Input(format!("no estimator `{}`", spec.kind)))?;
        if let Some(engine) = engine {
            let parameter = entry
                .parameters
                .iter()
                .find(|parameter| parameter.name == "engine");
            let Some((name, Kind::Choice(engines))) = parameter.map(|p| (p.name, p.kind)) else {
                return Err(Stop::Input(format!(
                    "--engine: the estimator `{}` has no choice of engines",
                    entry.name
                )));
            };
            if !engines.contains(&engine) {
                let guess = nearest(engine, engines.iter().copied())
                    .map(|name| format!(" did you mean `{name}`?"))
                    .unwrap_or_default();
                return Err(Stop::Input(format!(
                    "--engine: no engine \"{}\";{guess} allowed are {}",
                    engine.escape_debug(),
                    listed(engines)
                )));
            }
            spec.values.set(name, Value::Word(engine.to_owned()));
        }
        Ok(Self { entry, spec })
    }

    /// Whether what decides how smooth the estimate is is a length: not so for numbers of neighbours or terms.
    pub fn smooths_by_length(&self) -> bool {
        self.entry.parameters.iter().any(|parameter| {
            Some(parameter.name) == self.entry.smoothing && parameter.unit == Unit::Length
        })
    }

    /// What it is called in a legend.
    pub fn name(&self) -> &str {
        &self.spec.name
    }

    /// Builds it.
    ///
    /// # Errors
    /// If the settings do not go together, or need something that is not known here.
    pub fn build<const D: usize>(&self, context: &Context<D>) -> Result<Box<dyn Estimator<D>>, Stop>
    where
        Entry: Builds<D>,
    {
        self.entry
            .build(&self.spec.values, context)
            .map_err(|error| {
                Stop::Input(format!("{ORIGIN}: `{}`: {}", error.parameter, error.what))
            })
    }
}
