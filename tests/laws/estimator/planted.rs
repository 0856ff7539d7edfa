//! Estimators that are wrong on purpose: how they are made.

use super::subject::Subject;
use density_lab::estimator::{Context, Estimate, Estimator, FitError, Laws};
use density_lab::experiment::catalogue::{Builds, Entry, estimator};
use density_lab::parameter::{Value, Values};
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Evaluation, Field, Point, Targets};
use std::sync::Arc;

/// Makes a new sample or estimate out of a good one.
pub type Prepare<const D: usize> = Arc<dyn Fn(&Sample<D>) -> Sample<D> + Send + Sync>;
pub type Spoil<const D: usize> = Arc<dyn Fn(Point<D>, f64) -> f64 + Send + Sync>;

/// A good estimator spoilt.
pub struct Spoilt<const D: usize> {
    pub good: Box<dyn Estimator<D>>,
    pub laws: Laws,
    /// Done to the sample first.
    pub prepare: Option<Prepare<D>>,
    /// Done to each value: (x, f̂(x)) ↦ value.
    pub spoil: Option<Spoil<D>>,
    /// Only where many targets are asked for at once.
    pub only_many: bool,
    /// Refuse nothing and drop the channels.
    pub deaf_to_channels: bool,
}

impl<const D: usize> Spoilt<D> {
    /// Not spoilt yet.
    pub fn new(good: Box<dyn Estimator<D>>) -> Self {
        Self {
            laws: good.laws(),
            good,
            prepare: None,
            spoil: None,
            only_many: false,
            deaf_to_channels: false,
        }
    }
}

struct SpoiltField<const D: usize> {
    good: Estimate<D>,
    spoil: Option<Spoil<D>>,
    only_many: bool,
}

impl<const D: usize> SpoiltField<D> {
    fn spoilt(&self, x: Point<D>, value: f64) -> f64 {
        self.spoil.as_ref().map_or(value, |spoil| spoil(x, value))
    }
}

impl<const D: usize> Field<D> for SpoiltField<D> {
    fn domain(&self) -> &Domain<D> {
        self.good.domain()
    }

    fn at(&self, x: Point<D>) -> f64 {
        let value = self.good.at(x);
        if self.only_many {
            value
        } else {
            self.spoilt(x, value)
        }
    }

    fn evaluate(&self, targets: Targets<'_, D>) -> Evaluation {
        Evaluation {
            values: targets
                .places()
                .map(|x| self.spoilt(x, self.good.at(x)))
                .collect(),
            ..Evaluation::default()
        }
    }
}

impl<const D: usize> Estimator<D> for Spoilt<D> {
    fn laws(&self) -> Laws {
        self.laws
    }

    fn fit(&self, sample: &Sample<D>) -> Result<Estimate<D>, FitError> {
        let prepared = self
            .prepare
            .as_ref()
            .map_or_else(|| sample.clone(), |prepare| prepare(sample));
        let good = self.good.fit(&prepared)?;
        let (smoothing, bandwidth) = (good.smoothing, good.bandwidth.clone());
        let spoilt = |good, spoil: Option<Spoil<D>>| -> Arc<dyn Field<D>> {
            Arc::new(SpoiltField {
                good,
                spoil,
                only_many: false,
            })
        };
        let channels = if self.deaf_to_channels {
            // half of the total each, whatever their weights
            let half = spoilt(
                self.good.fit(&prepared)?,
                Some(Arc::new(|_, value| 0.5 * value)),
            );
            vec![half; sample.channels()]
        } else {
            (0..sample.channels())
                .map(|c| -> Result<Arc<dyn Field<D>>, FitError> {
                    let channel = sample.channel(c);
                    if channel.mass() > 0.0 {
                        return Ok(Arc::new(self.good.fit(&channel)?));
                    }
                    Ok(spoilt(
                        self.good.fit(&prepared)?,
                        Some(Arc::new(|_, _| 0.0)),
                    ))
                })
                .collect::<Result<_, _>>()?
        };
        let field = SpoiltField {
            good,
            spoil: self.spoil.clone(),
            only_many: self.only_many,
        };
        let mut estimate = Estimate::new(Arc::new(field)).with_channels(channels);
        estimate.smoothing = smoothing;
        estimate.bandwidth = bandwidth;
        Ok(estimate)
    }
}

/// One of the catalogue with these settings.
fn built<const D: usize>(name: &str, set: &[(&'static str, Value)]) -> Box<dyn Estimator<D>>
where
    Entry: Builds<D>,
{
    let entry = estimator(name).unwrap();
    let mut values = Values::defaults(entry.parameters);
    for (name, value) in set {
        values.set(name, value.clone());
    }
    let context = Context {
        truth: None,
        draws: 20,
    };
    Builds::<D>::build(entry, &values, &context).unwrap()
}

fn word(word: &str) -> Value {
    Value::Word(word.to_owned())
}

/// A kernel estimator with the Gaussian, the bandwidth `h` and a treatment of walls.
pub fn kernel<const D: usize>(h: f64, boundary: &str) -> Box<dyn Estimator<D>>
where
    Entry: Builds<D>,
{
    built(
        "kernel",
        &[
            ("bandwidth", Value::Number(h)),
            ("boundary", word(boundary)),
        ],
    )
}

pub fn histogram<const D: usize>(width: f64, origin: f64) -> Box<dyn Estimator<D>>
where
    Entry: Builds<D>,
{
    built(
        "histogram",
        &[
            ("width", Value::Number(width)),
            ("origin", Value::Number(origin)),
        ],
    )
}

/// With a width chosen from the data.
pub fn silverman<const D: usize>() -> Box<dyn Estimator<D>>
where
    Entry: Builds<D>,
{
    built("kernel", &[("bandwidth", word("silverman"))])
}

pub fn good<const D: usize>(scale: f64) -> Spoilt<D>
where
    Entry: Builds<D>,
{
    Spoilt::new(kernel(0.4 * scale, "ignore"))
}

pub fn plant<const D: usize>(
    name: &str,
    make: impl Fn(f64, f64) -> Spoilt<D> + Send + Sync + 'static,
) -> Subject<D> {
    Subject::new(
        name.to_owned(),
        Box::new(move |scale, shift| Box::new(make(scale, shift))),
    )
}

/// What becomes of a value: of the place in the unit of the data, the value times the cube of that unit, and back.
pub fn values_spoilt<const D: usize>(
    name: &str,
    boundary: &'static str,
    spoil: impl Fn(Point<D>, f64) -> f64 + Clone + Send + Sync + 'static,
) -> Subject<D>
where
    Entry: Builds<D>,
{
    plant(name, move |scale, shift| {
        let spoil = spoil.clone();
        let unit = scale.powi(D as i32);
        Spoilt {
            spoil: Some(Arc::new(move |x: Point<D>, value| {
                spoil(x.map(|x| (x - shift) / scale), value * unit) / unit
            })),
            ..Spoilt::new(kernel(0.4 * scale, boundary))
        }
    })
}

pub fn sample_spoilt<const D: usize>(
    name: &str,
    prepare: impl Fn(&[Point<D>], &[f64]) -> (Vec<Point<D>>, Vec<f64>) + Clone + Send + Sync + 'static,
) -> Subject<D>
where
    Entry: Builds<D>,
{
    plant(name, move |scale, _| {
        let prepare = prepare.clone();
        Spoilt {
            prepare: Some(Arc::new(move |sample| {
                let weights: Vec<f64> = (0..sample.len()).map(|i| sample.weight(i)).collect();
                let (points, weights) = prepare(sample.points(), &weights);
                Sample::new(
                    points,
                    Weights::Each(weights.into()),
                    sample.domain().clone(),
                )
                .unwrap()
            })),
            ..good(scale)
        }
    })
}

/// Declares one law less than it keeps.
pub fn modest<const D: usize>(
    name: &str,
    boundary: &'static str,
    forget: impl Fn(&mut Laws) + Send + Sync + 'static,
) -> Subject<D>
where
    Entry: Builds<D>,
{
    plant(name, move |scale, _| {
        let mut spoilt = Spoilt::new(kernel(0.4 * scale, boundary));
        forget(&mut spoilt.laws);
        spoilt
    })
}

/// A promise that a good estimator of the catalogue does not keep.
pub fn boastful<const D: usize>(
    name: &str,
    make: impl Fn(f64, f64) -> Box<dyn Estimator<D>> + Send + Sync + 'static,
    boast: impl Fn(&mut Laws) + Send + Sync + 'static,
) -> Subject<D> {
    plant(name, move |scale, shift| {
        let mut spoilt = Spoilt::new(make(scale, shift));
        boast(&mut spoilt.laws);
        spoilt
    })
}
