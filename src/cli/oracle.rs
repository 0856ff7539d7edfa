//! `lab oracle`

mod answer;

use self::answer::{Answer, At, Minimum};
use super::argument;
use super::estimator::Settings;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::sample::known;
use super::stop::Stop;
use crate::density::{Density, Truth};
use crate::estimator::{Context, Estimator};
use crate::experiment::catalogue::{self, Builds, Entry};
use crate::kernel::{Kernel, Shape, Symmetry};
use crate::parameter::{Kind, nearest};
use crate::space::Point;
use crate::theory::{Asymptotic, Family, NoAsymptotics};
use clap::Args;
use std::sync::Arc;

/// The best bandwidth for a known density, and what it costs in error
///
/// Exact, without simulation: the mean integrated squared error (MISE) of the kernel estimate over all samples of N points, its two parts, the
/// bandwidth where it is least, every other local minimum, and the same of its leading terms for large N (AMISE). With --bandwidth the
/// errors are those at that bandwidth. Histograms and their relatives, nearest neighbours, orthogonal series and adaptive kernels are asked for by --estimator: then h stands
/// for the width of a bin, for k or for the number of terms. The widths of adaptive kernels follow a fixed pilot: the density itself, or what a pilot estimate has for its mean. With --at the answer is about one place: the bandwidth or k of least mean squared error there.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab oracle --density normal --kernel gaussian --n 100
  lab oracle --density bimodal --kernel epanechnikov --n 1e4 --json
  lab oracle --density bimodal --n 200 --bandwidth 0.1         how much worse is 0.1 than the best?
  lab oracle --density 'beta = { a = 2, b = 3 }' --n 1000
  lab oracle --density normal-2d --kernel epanechnikov --symmetry radial --n 1000
  lab oracle --density bimodal --estimator histogram --n 1000
  lab oracle --density normal-2d --estimator 'histogram = { angle = 30 }' --n 1000
  lab oracle --density bimodal --estimator 'abramson = { pilot = \"truth\" }' --n 1000
  lab oracle --density bimodal --estimator nearest-neighbour --n 1000
  lab oracle --density bimodal --estimator 'cosine-series = { low = -4, high = 4 }' --n 1000
  lab oracle --density bimodal --n 1000 --at 1                  which bandwidth is best at x = 1?

Keys of --json:
  parameter                      what h is: bandwidth, width, k or terms
  h_mise, mise, bias2, variance  the best h, and the errors there or at --bandwidth
  least_mise, ratio              the MISE at h_mise, and that at --bandwidth over it
  h_amise, amise                 the same by the leading terms; null where there are none, with the reason
  other_minima                   every other local minimum, as h and mise
  kernel, symmetry, constant, efficiency
                                 the kernel, and what it contributes to the least AMISE: C(K) = (k2^2 R(K)^4)^(1/5) on a line, (k2 R(K))^(2/3) in the plane
  at, density                    the place of --at, and the density there
  h_mse, mse, bias               the h of least mean squared error there, that error and E f^ - f
  h_amse                         the same h by the leading terms; null where the curvature vanishes")]
pub struct Oracle {
    /// A density by name (lab list densities), or with its parameters as in an experiment file
    #[arg(long, value_name = "DENSITY")]
    density: String,

    /// A kernel by name (lab list kernels)
    #[arg(long, value_name = "NAME", default_value = "gaussian")]
    kernel: String,

    /// In the plane: a kernel of each axis (product) or one of the distance (radial) [default: radial]
    #[arg(long, value_name = "NAME")]
    symmetry: Option<String>,

    /// Another estimator than the kernel estimate: a name (lab list estimators), or as in an experiment file
    #[arg(long, short, value_name = "NAME", conflicts_with_all = ["kernel", "symmetry"])]
    estimator: Option<String>,

    /// How many points the samples have
    #[arg(long, value_name = "N", value_parser = argument::count)]
    n: u64,

    /// Another bandwidth than the best
    #[arg(long, value_name = "H", value_parser = argument::positive, allow_hyphen_values = true)]
    bandwidth: Option<f64>,

    /// What is best at one place, instead of over all
    #[arg(long, value_name = "X[,Y]", value_parser = argument::place, allow_hyphen_values = true, conflicts_with = "bandwidth")]
    at: Option<argument::Each<f64>>,

    /// As JSON
    #[arg(long)]
    json: bool,
}

/// What is known of one kind of estimate, and the words for it.
struct Asked {
    family: Family,
    kernel: Option<(Shape, Symmetry)>,
    estimator: String,
}

impl Oracle {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let density = known(&self.density)?;
        let plane = matches!(density, Truth::Plane(_));
        let asked = self.asked(&density)?;
        if plane
            && self.symmetry.is_none()
            && asked
                .kernel
                .is_some_and(|(shape, _)| shape != Shape::Gaussian)
        {
            notes.say("the kernel is a function of the distance; --symmetry product is one for each axis, as kernel estimators take if they are not told");
        }
        let mut output = Output::open(None)?;
        let reason = if let Some(argument::Each(place)) = &self.at {
            let at = match &density {
                Truth::Line(line) => {
                    let place = <[f64; 1]>::try_from(&place[..]).map_err(|_| axes(1))?;
                    self.local::<1>(&**line, &asked, place)?
                }
                Truth::Plane(truth) => {
                    let place = <[f64; 2]>::try_from(&place[..]).map_err(|_| axes(2))?;
                    self.local::<2>(&**truth, &asked, place)?
                }
            };
            if self.json {
                output.json(&at)?;
            } else {
                at.print(&mut output)?;
            }
            None
        } else {
            let answer = self.answer(&density, &asked)?;
            if self.json {
                output.json(&answer)?;
            } else {
                answer.print(&mut output)?;
            }
            answer.reason
        };
        output.finish()?;
        if !asked.family.is_of_estimates() {
            notes.say("the pilot is what a pilot estimate has for its mean; the noise of one that is made from the same points is not counted");
        }
        if let (Some(reason), false) = (&reason, self.json) {
            notes.say(reason);
        }
        Ok(())
    }

    /// The kernel and its symmetry, or the family of `--estimator`.
    fn asked(&self, density: &Truth) -> Result<Asked, Stop> {
        if let Some(text) = &self.estimator {
            let settings = settings(text)?;
            let family = match density {
                Truth::Line(line) => family::<1>(&settings, line.clone(), self.n)?,
                Truth::Plane(plane) => family::<2>(&settings, plane.clone(), self.n)?,
            };
            return Ok(Asked {
                family,
                kernel: None,
                estimator: text.clone(),
            });
        }
        let shape = named(
            "--kernel",
            "kernel",
            &self.kernel,
            &Shape::NAMES,
            Shape::named,
        )?;
        let symmetry = match &self.symmetry {
            None => Symmetry::Radial,
            Some(name) => named(
                "--symmetry",
                "symmetry",
                name,
                &Symmetry::NAMES,
                Symmetry::named,
            )?,
        };
        let family = match symmetry {
            Symmetry::Product => Family::Kernel(shape),
            Symmetry::Radial => Family::RadialKernel(shape),
        };
        Ok(Asked {
            family,
            kernel: Some((shape, symmetry)),
            estimator: "kernel".to_owned(),
        })
    }

    fn answer(&self, density: &Truth, asked: &Asked) -> Result<Answer, Stop> {
        let draws = self.n as f64;
        let unknown = || {
            Stop::Input(format!(
                "the exact error of \"{}\" is not known for \"{}\": in the plane it is for kernels (adaptive ones but for the uniform kernel, with a smoothed pilot where it has a closed form), histograms and neighbours and for normal mixtures and products; a series needs an interval, so give its `low` and `high`",
                asked.estimator, self.density
            ))
        };
        if asked.family.parameter() == "k" && self.n < 4 {
            return Err(Stop::Input(
                "--n: neighbours need 4 points or more".to_owned(),
            ));
        }
        let errors = match density {
            Truth::Line(line) => asked.family.errors(&**line),
            Truth::Plane(plane) => asked.family.errors_in_plane(&**plane),
        };
        let errors = errors.ok_or_else(unknown)?;
        let asymptotic: Result<Asymptotic, NoAsymptotics> = match density {
            Truth::Line(line) => asked.family.asymptotic(&**line, draws),
            Truth::Plane(plane) => asked.family.asymptotic_in_plane(&**plane, draws),
        };
        let optimum = errors.optimum(draws);
        let h_mise = optimum.at;
        let bandwidth = self.bandwidth.unwrap_or(h_mise);
        let at = match self.bandwidth {
            Some(h) => errors.at(h, draws).ok_or_else(|| {
                Stop::Input(format!(
                    "--bandwidth {}: {} is a whole number from {}",
                    Shortest(h),
                    asked.family.parameter(),
                    if asked.family.parameter() == "k" {
                        "3 to --n"
                    } else {
                        "1 to 300"
                    }
                ))
            })?,
            None => optimum.error,
        };
        let least_mise = optimum.error.mise();
        let (asymptotic, reason) = match asymptotic {
            Ok(asymptotic) => (Some(asymptotic), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        let plane = matches!(density, Truth::Plane(_));
        let answer = Answer {
            density: self.density.clone(),
            estimator: asked.estimator.clone(),
            parameter: asked.family.parameter(),
            kernel: asked.kernel.map(|(shape, _)| shape.name()),
            symmetry: asked
                .kernel
                .filter(|_| plane)
                .map(|(_, symmetry)| symmetry.name()),
            constant: asked.kernel.map(|kernel| contribution(kernel, plane).0),
            efficiency: asked.kernel.map(|kernel| contribution(kernel, plane).1),
            n: self.n,
            h_mise,
            bandwidth,
            mise: at.mise(),
            bias2: at.squared_bias,
            variance: at.variance,
            least_mise,
            ratio: at.mise() / least_mise,
            h_amise: asymptotic.map(|a| a.best()),
            amise: asymptotic.map(|a| a.at(self.bandwidth.unwrap_or(a.best())).mise()),
            reason,
            other_minima: optimum
                .others
                .iter()
                .map(|other| Minimum {
                    h: other.at,
                    mise: other.value,
                })
                .collect(),
        };
        let numbers = [
            answer.h_mise,
            answer.mise,
            answer.bias2,
            answer.variance,
            answer.ratio,
        ];
        let held = |x: &f64| x.is_finite();
        if numbers.iter().all(held) && answer.amise.iter().all(held) && answer.mise > 0.0 {
            Ok(answer)
        } else {
            Err(Stop::Input(format!(
                "no exact error at --bandwidth {} with --n {}: it is beyond what numbers can hold, or the bandwidth is too narrow for the theory of this estimator (that of adaptive kernels begins at a ten-thousandth of the density's range)",
                Shortest(bandwidth),
                self.n
            )))
        }
    }

    /// What is best at one place.
    fn local<const D: usize>(
        &self,
        truth: &dyn Density<D>,
        asked: &Asked,
        place: Point<D>,
    ) -> Result<At, Stop> {
        let f = truth.at(place);
        if f <= 0.0 {
            return Err(Stop::Input(format!(
                "--at: the density is 0 at {}, where the best estimate is nothing at all",
                place.map(|x| x.to_string()).join(",")
            )));
        }
        let local = (asked.family)
            .best_at(truth, self.n as f64, place)
            .filter(|local| local.error().is_finite())
            .ok_or_else(|| {
                Stop::Input(format!(
                    "--at: the best {} at a place is known for kernel estimates and for nearest neighbours (of 4 points or more), not for \"{}\"",
                    asked.family.parameter(),
                    asked.estimator
                ))
            })?;
        Ok(At {
            density_name: self.density.clone(),
            estimator: asked.estimator.clone(),
            parameter: asked.family.parameter(),
            kernel: asked.kernel.map(|(shape, _)| shape.name()),
            symmetry: asked
                .kernel
                .filter(|_| D == 2)
                .map(|(_, symmetry)| symmetry.name()),
            n: self.n,
            place: place.to_vec(),
            density: f,
            h_mse: local.at,
            mse: local.error(),
            bias: local.bias,
            variance: local.variance,
            h_amse: Some(local.asymptotic).filter(|h| h.is_finite()),
        })
    }
}

fn axes(axes: usize) -> Stop {
    Stop::Input(format!(
        "--at: the density has {axes} ax{}; give X{}",
        if axes == 1 { "is" } else { "es" },
        if axes == 1 { "" } else { ",Y" }
    ))
}

/// What a kernel contributes to the least AMISE, and its efficiency.
fn contribution((shape, symmetry): (Shape, Symmetry), plane: bool) -> (f64, f64) {
    if plane {
        let product = symmetry.variance::<2>(shape) * symmetry.roughness::<2>(shape);
        (product.powf(2.0 / 3.0), symmetry.efficiency::<2>(shape))
    } else {
        (shape.constant(), shape.efficiency())
    }
}

/// The thing of that name.
fn named<T>(
    option: &str,
    what: &str,
    name: &str,
    names: &'static [&'static str],
    find: impl Fn(&str) -> Option<T>,
) -> Result<T, Stop> {
    find(name).ok_or_else(|| {
        let guess = nearest(name, names.iter().copied())
            .map(|name| format!("; did you mean \"{name}\"?"))
            .unwrap_or_default();
        Stop::Input(format!(
            "{option}: no {what} \"{}\"{guess}\nallowed are {}",
            name.escape_debug(),
            names.join(", ")
        ))
    })
}

/// The estimator, its smoothing set to anything where only the name is given: it is what is looked for.
fn settings(text: &str) -> Result<Settings, Stop> {
    let (name, table) = text.trim().split_once('=').unwrap_or((text.trim(), ""));
    let Some(entry) = catalogue::estimator(name.trim()) else {
        return Settings::read(text, None);
    };
    let smoothing = entry.smoothing.and_then(|name| {
        let parameter = entry.parameters.iter().find(|known| known.name == name)?;
        let least = match parameter.kind {
            Kind::Count { least, .. } | Kind::CountOr { least, .. } => least.to_string(),
            _ => "1.0".to_owned(),
        };
        Some(format!("{name} = {least}"))
    });
    let (Some(name), Some(smoothing)) = (entry.smoothing, smoothing) else {
        let bare = format!("{} = {{}}", entry.name);
        return Settings::read(if table.is_empty() { &bare } else { text }, None);
    };
    if table.is_empty() {
        return Settings::read(&format!("{} = {{ {smoothing} }}", entry.name), None);
    }
    // at the end, so that what is wrong is located where it is
    let given = table.split(['{', ',']).any(|part| {
        let key = part.trim_start().strip_prefix(name);
        key.is_some_and(|rest| rest.trim_start().starts_with('='))
    });
    match text.trim_end().strip_suffix('}') {
        Some(open) if !given => {
            let told = open.trim_end();
            let comma = if told.ends_with(['{', ',']) { "" } else { "," };
            Settings::read(&format!("{told}{comma} {smoothing} }}"), None)
        }
        _ => Settings::read(text, None),
    }
}

/// All that the estimator is but for its smoothing.
fn family<const D: usize>(
    settings: &Settings,
    truth: Arc<dyn Density<D>>,
    draws: u64,
) -> Result<Family, Stop>
where
    Entry: Builds<D>,
{
    let context = Context::<D> {
        truth: Some(truth),
        draws: draws as usize,
    };
    let estimator: Box<dyn Estimator<D>> = settings.build(&context)?;
    estimator.family().ok_or_else(|| {
        Stop::Input(format!(
            "--estimator: theory does not know the best setting of \"{}\"; it does for kernel (without a boundary), histogram (in the plane of square bins), shifted-histogram, frequency-polygon, nearest-neighbour, the series, and abramson whose pilot is \"truth\", \"tied\" or a number",
            settings.name()
        ))
    })
}
