//! Estimators that are wrong on purpose, each with the law that must catch it.

use super::cases::Subject;
use density_lab::estimator::Context;
use density_lab::estimator::{Estimate, Estimator, FitError, Laws};
use density_lab::experiment::catalogue::{Builds, estimator};
use density_lab::parameter::{Value, Values};
use density_lab::sample::{Sample, Weights};
use density_lab::space::{Domain, Evaluation, Field, Point, Targets};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Makes a new sample or estimate out of a good one.
type Prepare = Arc<dyn Fn(&Sample<1>) -> Sample<1> + Send + Sync>;
type Spoil = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// A good estimator spoilt.
struct Spoilt {
    good: Box<dyn Estimator<1>>,
    laws: Laws,
    /// Done to the sample first.
    prepare: Option<Prepare>,
    /// Done to each value: (x, f̂(x)) ↦ value.
    spoil: Option<Spoil>,
    /// Only where many targets are asked for at once.
    only_many: bool,
    /// Refuse nothing and drop the channels.
    deaf_to_channels: bool,
}

struct SpoiltField {
    good: Estimate<1>,
    spoil: Option<Spoil>,
    only_many: bool,
}

impl SpoiltField {
    fn spoilt(&self, x: f64, value: f64) -> f64 {
        self.spoil.as_ref().map_or(value, |spoil| spoil(x, value))
    }
}

impl Field<1> for SpoiltField {
    fn domain(&self) -> &Domain<1> {
        self.good.domain()
    }

    fn at(&self, x: Point<1>) -> f64 {
        let value = self.good.at(x);
        if self.only_many {
            value
        } else {
            self.spoilt(x[0], value)
        }
    }

    fn evaluate(&self, targets: Targets<'_, 1>) -> Evaluation {
        Evaluation {
            values: targets
                .places()
                .map(|x| self.spoilt(x[0], self.good.at(x)))
                .collect(),
            ..Evaluation::default()
        }
    }
}

impl Estimator<1> for Spoilt {
    fn laws(&self) -> Laws {
        self.laws
    }

    fn fit(&self, sample: &Sample<1>) -> Result<Estimate<1>, FitError> {
        let prepared = self
            .prepare
            .as_ref()
            .map_or_else(|| sample.clone(), |prepare| prepare(sample));
        let good = self.good.fit(&prepared)?;
        let smoothing = good.smoothing;
        let channels = if self.deaf_to_channels {
            // half of the total each, whatever their weights
            let half: Arc<dyn Field<1>> = Arc::new(SpoiltField {
                good: self.good.fit(&prepared)?,
                spoil: Some(Arc::new(|_, value| 0.5 * value)),
                only_many: false,
            });
            vec![half; sample.channels()]
        } else {
            (0..sample.channels())
                .map(|c| -> Result<Arc<dyn Field<1>>, FitError> {
                    let channel = sample.channel(c);
                    if channel.mass() > 0.0 {
                        return Ok(Arc::new(self.good.fit(&channel)?));
                    }
                    Ok(Arc::new(SpoiltField {
                        good: self.good.fit(&prepared)?,
                        spoil: Some(Arc::new(|_, _| 0.0)),
                        only_many: false,
                    }))
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
        Ok(estimate)
    }
}

/// A kernel estimator with the Gaussian and the bandwidth `h`.
fn kernel(h: f64) -> Box<dyn Estimator<1>> {
    let entry = estimator("kernel").unwrap();
    let mut values = Values::defaults(entry.parameters);
    values.set("bandwidth", Value::Number(h));
    entry
        .build(
            &values,
            &Context {
                truth: None,
                draws: 20,
            },
        )
        .unwrap()
}

fn histogram(width: f64, origin: f64) -> Box<dyn Estimator<1>> {
    let entry = estimator("histogram").unwrap();
    let mut values = Values::defaults(entry.parameters);
    values.set("width", Value::Number(width));
    values.set("origin", Value::Number(origin));
    entry
        .build(
            &values,
            &Context {
                truth: None,
                draws: 20,
            },
        )
        .unwrap()
}

fn good(scale: f64) -> Spoilt {
    let good = kernel(0.4 * scale);
    Spoilt {
        laws: good.laws(),
        good,
        prepare: None,
        spoil: None,
        only_many: false,
        deaf_to_channels: false,
    }
}

fn plant(name: &str, make: impl Fn(f64, f64) -> Spoilt + Send + Sync + 'static) -> Subject {
    Subject::new(
        name.to_owned(),
        Box::new(move |scale, shift| Box::new(make(scale, shift))),
    )
}

fn values_spoilt(
    name: &str,
    spoil: impl Fn(f64, f64, f64, f64) -> f64 + Clone + Send + Sync + 'static,
) -> Subject {
    plant(name, move |scale, shift| {
        let spoil = spoil.clone();
        Spoilt {
            spoil: Some(Arc::new(move |x, value| {
                spoil((x - shift) / scale, value, scale, shift)
            })),
            ..good(scale)
        }
    })
}

fn sample_spoilt(
    name: &str,
    prepare: impl Fn(&[f64], &[f64]) -> (Vec<f64>, Vec<f64>) + Clone + Send + Sync + 'static,
) -> Subject {
    plant(name, move |scale, _| {
        let prepare = prepare.clone();
        Spoilt {
            prepare: Some(Arc::new(move |sample| {
                let weights: Vec<f64> = (0..sample.len()).map(|i| sample.weight(i)).collect();
                let (points, weights) = prepare(sample.coordinates(), &weights);
                let points = points.into_iter().map(|x| [x]).collect();
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
fn modest(name: &str, forget: impl Fn(&mut Laws) + Send + Sync + 'static) -> Subject {
    plant(name, move |scale, _| {
        let mut spoilt = good(scale);
        forget(&mut spoilt.laws);
        spoilt
    })
}

/// A promise that a good estimator of the catalogue does not keep.
fn boastful(
    name: &str,
    make: impl Fn(f64, f64) -> Box<dyn Estimator<1>> + Send + Sync + 'static,
    boast: impl Fn(&mut Laws) + Send + Sync + 'static,
) -> Subject {
    plant(name, move |scale, shift| {
        let good = make(scale, shift);
        let mut laws = good.laws();
        boast(&mut laws);
        Spoilt {
            laws,
            good,
            prepare: None,
            spoil: None,
            only_many: false,
            deaf_to_channels: false,
        }
    })
}

fn silverman() -> Box<dyn Estimator<1>> {
    let entry = estimator("kernel").unwrap();
    let mut values = Values::defaults(entry.parameters);
    values.set("bandwidth", Value::Word("silverman".to_owned()));
    entry
        .build(
            &values,
            &Context {
                truth: None,
                draws: 20,
            },
        )
        .unwrap()
}

/// Every planted violation with the name of the law that must catch it.
#[expect(clippy::too_many_lines, reason = "a list")]
pub fn all() -> Vec<(Subject, &'static str)> {
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    let bump = |z: f64| (-0.5 * z * z).exp();
    vec![
        // broken promises
        (
            values_spoilt("loses one percent of the mass", |_, v, _, _| 0.99 * v),
            "mass",
        ),
        (
            values_spoilt(
                "gains one percent of the mass far from the data",
                move |x, v, scale, _| {
                    v + 0.01 * bump(x - 5.0) / (2.0 * std::f64::consts::PI).sqrt() / scale
                },
            ),
            "mass",
        ),
        (
            values_spoilt(
                "dips a thousandth of the peak below zero",
                move |x, v, scale, _| v - 1e-3 * bump((x - 4.0) / 0.5) / scale,
            ),
            "sign",
        ),
        (
            values_spoilt("is minus the least number in the tails", |_, v, _, _| {
                if v < 1e-12 { -f64::MIN_POSITIVE } else { v }
            }),
            "sign",
        ),
        (
            boastful(
                "a width from the data, called linear",
                |_, _| silverman(),
                |laws| laws.linear = true,
            ),
            "union",
        ),
        (
            sample_spoilt("bends weights", |x, w| {
                let total: f64 = w.iter().sum();
                (
                    x.to_vec(),
                    w.iter().map(|w| w * (1.0 + 0.01 * w / total)).collect(),
                )
            }),
            "union",
        ),
        (
            values_spoilt(
                "jumps by one percent",
                |x, v, _, _| if x > 0.3 { 1.01 * v } else { v },
            ),
            "continuity",
        ),
        (
            boastful(
                "a histogram, called continuous",
                |scale, shift| histogram(0.37 * scale, shift),
                |laws| laws.continuous = true,
            ),
            "continuity",
        ),
        (
            values_spoilt("never gives the same last bit", |_, v, _, _| {
                let odd = COUNTER.fetch_add(1, Ordering::Relaxed) % 2;
                f64::from_bits(v.to_bits() + u64::from(odd))
            }),
            "determinism",
        ),
        (
            plant("does not stretch its width", |_, _| good(1.0)),
            "scale",
        ),
        (
            boastful(
                "does not stretch its origin",
                |scale, _| histogram(0.37 * scale, 0.111),
                |_| (),
            ),
            "scale",
        ),
        (
            boastful(
                "does not move its origin",
                |scale, _| histogram(0.37 * scale, 0.0),
                |_| (),
            ),
            "translation",
        ),
        (
            plant("loses digits far from zero", |scale, _| Spoilt {
                prepare: Some(Arc::new(|sample: &Sample<1>| {
                    // as if kept in single precision
                    let points = sample
                        .coordinates()
                        .iter()
                        .map(|&x| [f64::from(x as f32)])
                        .collect();
                    Sample::new(points, sample.weights().clone(), sample.domain().clone()).unwrap()
                })),
                ..good(scale)
            }),
            "translation",
        ),
        (
            boastful(
                "a width from the effective size, called repeatable",
                |_, _| silverman(),
                |laws| laws.repeatable = true,
            ),
            "repetition",
        ),
        (
            sample_spoilt("ignores weights", |x, w| {
                let total: f64 = w.iter().sum();
                (x.to_vec(), vec![total / x.len() as f64; x.len()])
            }),
            "repetition",
        ),
        // laws that need no promise
        (
            sample_spoilt("gives the first point one percent more", |x, w| {
                let mut w = w.to_vec();
                w[0] *= 1.01;
                (x.to_vec(), w)
            }),
            "order",
        ),
        (
            sample_spoilt("drops the last point", |x, w| {
                let n = (x.len() - 1).max(1);
                (x[..n].to_vec(), w[..n].to_vec())
            }),
            "order",
        ),
        (
            sample_spoilt("sees points of weight zero", |x, w| {
                let total: f64 = w.iter().sum();
                (
                    x.to_vec(),
                    w.iter()
                        .map(|w| 0.99 * w + 0.01 * total / x.len() as f64)
                        .collect(),
                )
            }),
            "zero weights",
        ),
        (
            sample_spoilt("forces the mass to one", |x, w| {
                let total: f64 = w.iter().sum();
                (x.to_vec(), w.iter().map(|w| w / total).collect())
            }),
            "weight unit",
        ),
        (
            values_spoilt("adds a constant of its own unit", |x, v, _, _| {
                if x.abs() < 4.0 { v + 1e-6 } else { v }
            }),
            "weight unit",
        ),
        (
            plant("gives every channel half of the total", |scale, _| Spoilt {
                deaf_to_channels: true,
                ..good(scale)
            }),
            "channels",
        ),
        (
            plant("smooths each channel by itself", |_, _| Spoilt {
                laws: silverman().laws(),
                good: silverman(),
                ..good(1.0)
            }),
            "channels",
        ),
        (
            sample_spoilt("drops ties", |x, w| {
                let (mut points, mut weights) = (Vec::new(), Vec::new());
                for (x, w) in x.iter().zip(w) {
                    if !points.contains(x) {
                        points.push(*x);
                        weights.push(*w);
                    }
                }
                (points, weights)
            }),
            "one place",
        ),
        (
            plant("is not a number where all points are one", |scale, _| {
                Spoilt {
                    prepare: None,
                    spoil: Some(Arc::new(
                        move |_, v| if v * scale > 0.95 { f64::NAN } else { v },
                    )),
                    ..good(scale)
                }
            }),
            "one place",
        ),
        (
            plant(
                "is off by a millionth when many targets are asked for",
                |scale, _| Spoilt {
                    spoil: Some(Arc::new(|_, v| v * (1.0 + 1e-6))),
                    only_many: true,
                    ..good(scale)
                },
            ),
            "many targets",
        ),
        (
            values_spoilt("is not a number far away", |x, v, _, _| {
                if x.abs() > 1e200 { x * x * v } else { v }
            }),
            "far targets",
        ),
        (
            values_spoilt("never quite ends", |_, v, scale, _| v + 1e-9 / scale),
            "far targets",
        ),
        // promises forgotten
        (
            modest("keeps mass, unsaid", |laws| laws.mass_conserving = false),
            "mass",
        ),
        (
            modest("is never negative, unsaid", |laws| {
                laws.non_negative = false;
            }),
            "sign",
        ),
        (
            modest("is linear, unsaid", |laws| laws.linear = false),
            "union",
        ),
        (
            modest("is continuous, unsaid", |laws| laws.continuous = false),
            "continuity",
        ),
        (
            modest("is deterministic, unsaid", |laws| {
                laws.deterministic = false;
            }),
            "determinism",
        ),
        (
            modest("follows scale, unsaid", |laws| {
                laws.scale_equivariant = false;
            }),
            "scale",
        ),
        (
            modest("follows translation, unsaid", |laws| {
                laws.translation_equivariant = false;
            }),
            "translation",
        ),
        (
            modest("repeats, unsaid", |laws| laws.repeatable = false),
            "repetition",
        ),
    ]
}
