//! What the oracle says, and how it is printed.

use crate::cli::output::Output;
use crate::cli::stop::Stop;
use crate::experiment::significant;
use serde::Serialize;

/// What the theory says. Errors are those at `bandwidth`; `amise` is that at `bandwidth` if it was given, or else at `h_amise`.
#[derive(Serialize)]
pub(super) struct Answer {
    pub density: String,
    pub estimator: String,
    pub parameter: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kernel: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constant: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency: Option<f64>,
    pub n: u64,
    pub h_mise: f64,
    pub bandwidth: f64,
    pub mise: f64,
    pub bias2: f64,
    pub variance: f64,
    /// The MISE at `h_mise`, and how many times as large it is at `bandwidth`.
    pub least_mise: f64,
    pub ratio: f64,
    pub h_amise: Option<f64>,
    pub amise: Option<f64>,
    /// Why there is no AMISE.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    pub other_minima: Vec<Minimum>,
}

#[derive(Serialize)]
pub(super) struct Minimum {
    pub h: f64,
    pub mise: f64,
}

/// What the theory says about one place.
#[derive(Serialize)]
pub(super) struct At {
    pub density_name: String,
    pub estimator: String,
    pub parameter: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kernel: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<&'static str>,
    pub n: u64,
    #[serde(rename = "at")]
    pub place: Vec<f64>,
    pub density: f64,
    pub h_mse: f64,
    pub mse: f64,
    pub bias: f64,
    pub variance: f64,
    pub h_amse: Option<f64>,
}

fn number(x: f64) -> String {
    significant(x, 6)
}

/// The estimate in words.
fn kind(estimator: &str, kernel: Option<&str>, symmetry: Option<&str>) -> String {
    match (kernel, symmetry) {
        (Some(kernel), Some(symmetry)) => format!("{symmetry} {kernel} kernel"),
        (Some(kernel), None) => format!("{kernel} kernel"),
        _ => estimator.to_owned(),
    }
}

impl Answer {
    pub(super) fn print(&self, output: &mut Output) -> Result<(), Stop> {
        let Answer { density, n, .. } = self;
        let kind = kind(&self.estimator, self.kernel, self.symmetry);
        writeln!(output, "{density}, {kind}, {n} points")?;
        if self.kernel.is_none() {
            writeln!(output, "h is      {}", self.parameter)?;
        }
        writeln!(output, "h_mise    {}", number(self.h_mise))?;
        if self.bandwidth.to_bits() != self.h_mise.to_bits() {
            let (h, least) = (number(self.bandwidth), number(self.least_mise));
            let what = self.parameter;
            writeln!(output, "  least     {least}\nat {what} {h}:")?;
            writeln!(output, "  ratio     {}", number(self.ratio))?;
        }
        writeln!(output, "mise      {}", number(self.mise))?;
        writeln!(output, "bias2     {}", number(self.bias2))?;
        writeln!(output, "variance  {}", number(self.variance))?;
        for (label, value) in [("h_amise", self.h_amise), ("amise", self.amise)] {
            let value = value.map_or_else(|| "does not exist".to_owned(), number);
            writeln!(output, "{label:8}  {value}")?;
        }
        for Minimum { h, mise } in &self.other_minima {
            let (h, mise) = (number(*h), number(*mise));
            writeln!(output, "other minimum at h {h}, mise {mise}")?;
        }
        Ok(())
    }
}

impl At {
    pub(super) fn print(&self, output: &mut Output) -> Result<(), Stop> {
        let At {
            density_name, n, ..
        } = self;
        let kind = kind(&self.estimator, self.kernel, self.symmetry);
        let place: Vec<String> = self.place.iter().map(|x| number(*x)).collect();
        let place = place.join(", ");
        writeln!(output, "{density_name} at {place}, {kind}, {n} points")?;
        if self.kernel.is_none() {
            writeln!(output, "h is      {}", self.parameter)?;
        }
        for (label, value) in [
            ("density", Some(self.density)),
            ("h_mse", Some(self.h_mse)),
            ("mse", Some(self.mse)),
            ("bias", Some(self.bias)),
            ("variance", Some(self.variance)),
            ("h_amse", self.h_amse),
        ] {
            let value = value.map_or_else(|| "does not exist".to_owned(), number);
            writeln!(output, "{label:8}  {value}")?;
        }
        Ok(())
    }
}
