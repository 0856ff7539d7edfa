//! `lab oracle`

use super::argument;
use super::notes::Notes;
use super::output::{Output, Shortest};
use super::sample::known;
use super::stop::Stop;
use crate::experiment::significant;
use crate::kernel::Shape;
use crate::parameter::nearest;
use crate::theory::KernelError;
use clap::Args;
use serde::Serialize;

/// The best bandwidth for a known density, and what it costs in error
///
/// Exact, without simulation: the mean integrated squared error (MISE) of the kernel estimate over all samples of N points, its two parts, the
/// bandwidth where it is least, every other local minimum, and the same of its leading terms for large N (AMISE). With --bandwidth the
/// errors are those at that bandwidth.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab oracle --density normal --kernel gaussian --n 100
  lab oracle --density bimodal --kernel epanechnikov --n 1e4 --json
  lab oracle --density bimodal --n 200 --bandwidth 0.1         how much worse is 0.1 than the best?
  lab oracle --density 'beta = { a = 2, b = 3 }' --n 1000")]
pub struct Oracle {
    /// A density by name (lab list densities), or with its parameters as in an experiment file
    #[arg(long, value_name = "DENSITY")]
    density: String,

    /// A kernel by name (lab list kernels)
    #[arg(long, value_name = "NAME", default_value = "gaussian")]
    kernel: String,

    /// How many points the samples have
    #[arg(long, value_name = "N", value_parser = argument::count)]
    n: u64,

    /// Another bandwidth than the best
    #[arg(long, value_name = "H", value_parser = argument::positive, allow_hyphen_values = true)]
    bandwidth: Option<f64>,

    /// As JSON
    #[arg(long)]
    json: bool,
}

/// What the theory says. Errors are those at `bandwidth`; `amise` is that at `bandwidth` if it was given, or else at `h_amise`.
#[derive(Serialize)]
struct Answer {
    density: String,
    kernel: &'static str,
    n: u64,
    h_mise: f64,
    bandwidth: f64,
    mise: f64,
    bias2: f64,
    variance: f64,
    /// The MISE at `h_mise`, and how many times as large it is at `bandwidth`.
    least_mise: f64,
    ratio: f64,
    h_amise: Option<f64>,
    amise: Option<f64>,
    /// Why there is no AMISE.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
    other_minima: Vec<Minimum>,
}

#[derive(Serialize)]
struct Minimum {
    h: f64,
    mise: f64,
}

impl Oracle {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let answer = self.answer()?;
        let mut output = Output::open(None)?;
        if self.json {
            output.json(&answer)?;
        } else {
            print(&mut output, &answer)?;
        }
        output.finish()?;
        if let (Some(reason), false) = (&answer.reason, self.json) {
            notes.say(reason);
        }
        Ok(())
    }

    fn answer(&self) -> Result<Answer, Stop> {
        let density = known(&self.density)?.line().ok_or_else(|| {
            Stop::Input(format!(
                "--density: \"{}\" is a density of the plane; the oracle knows those on a line",
                self.density
            ))
        })?;
        let shape = Shape::named(&self.kernel).ok_or_else(|| {
            let guess = nearest(&self.kernel, Shape::NAMES)
                .map(|name| format!("; did you mean \"{name}\"?"))
                .unwrap_or_default();
            Stop::Input(format!(
                "--kernel: no kernel \"{}\"{guess}\nallowed are {}",
                self.kernel.escape_debug(),
                Shape::NAMES.join(", ")
            ))
        })?;
        let draws = self.n as f64;
        let errors = KernelError::new(&*density, shape);
        let oracle = errors.oracle(draws);
        let h_mise = oracle.optimum.at;
        let bandwidth = self.bandwidth.unwrap_or(h_mise);
        let at = match self.bandwidth {
            Some(h) => errors.at(h, draws),
            None => oracle.optimum.error,
        };
        let least_mise = oracle.optimum.error.mise();
        let (asymptotic, reason) = match oracle.asymptotic {
            Ok(asymptotic) => (Some(asymptotic), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        let answer = Answer {
            density: self.density.clone(),
            kernel: shape.name(),
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
            other_minima: oracle
                .optimum
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
                "the error at --bandwidth {} with --n {} is beyond what numbers can hold",
                Shortest(bandwidth),
                self.n
            )))
        }
    }
}

fn print(output: &mut Output, answer: &Answer) -> Result<(), Stop> {
    let number = |x: f64| significant(x, 6);
    let Answer {
        density, kernel, n, ..
    } = answer;
    writeln!(output, "{density}, {kernel} kernel, {n} points")?;
    writeln!(output, "h_mise    {}", number(answer.h_mise))?;
    if answer.bandwidth.to_bits() != answer.h_mise.to_bits() {
        let (h, least) = (number(answer.bandwidth), number(answer.least_mise));
        writeln!(output, "  least     {least}\nat bandwidth {h}:")?;
        writeln!(output, "  ratio     {}", number(answer.ratio))?;
    }
    writeln!(output, "mise      {}", number(answer.mise))?;
    writeln!(output, "bias2     {}", number(answer.bias2))?;
    writeln!(output, "variance  {}", number(answer.variance))?;
    for (label, value) in [("h_amise", answer.h_amise), ("amise", answer.amise)] {
        let value = value.map_or_else(|| "does not exist".to_owned(), number);
        writeln!(output, "{label:8}  {value}")?;
    }
    for Minimum { h, mise } in &answer.other_minima {
        writeln!(
            output,
            "other minimum at h {}, mise {}",
            number(*h),
            number(*mise)
        )?;
    }
    Ok(())
}
