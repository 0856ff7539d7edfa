//! The leading terms of the error as samples grow, where the density is smooth enough to have them.

use super::Integrated;

/// Why there are no leading terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoAsymptotics {
    /// R(f'') is infinite: a kernel estimate converges at a slower rate.
    #[error(
        "the asymptotic error does not exist, because R(f'') is infinite: the density or its slope jumps somewhere (at a wall, say), and there the bias falls more slowly than h²"
    )]
    Curvature,
    /// R(f') is infinite: a histogram converges at a slower rate.
    #[error(
        "the asymptotic error does not exist, because R(f') is infinite: the density jumps somewhere (at a wall, say), and there the bias falls more slowly than the width"
    )]
    Slope,
}

/// AMISE(h) = c hᵖ + v / h, and where it is least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymptotic {
    /// c: the integrated squared bias over hᵖ.
    bias: f64,
    /// v: the integrated variance times h.
    variance: f64,
    /// p: 4 for kernels, 2 for histograms.
    power: i32,
}

impl Asymptotic {
    /// h⁴ k₂² R(f'')/4 + R(K)/(n h). [Silverman 1986, eq. 3.20]
    pub(super) fn of_kernel(
        variance_of_kernel: f64,
        roughness_of_kernel: f64,
        curvature: f64,
        draws: f64,
    ) -> Result<Self, NoAsymptotics> {
        if !curvature.is_finite() {
            return Err(NoAsymptotics::Curvature);
        }
        Ok(Self {
            bias: 0.25 * variance_of_kernel.powi(2) * curvature,
            variance: roughness_of_kernel / draws,
            power: 4,
        })
    }

    /// h² R(f')/12 + 1/(n h). [Scott 1992, eq. 3.29; Freedman & Diaconis 1981]
    pub(super) fn of_histogram(slope: f64, draws: f64) -> Result<Self, NoAsymptotics> {
        if !slope.is_finite() {
            return Err(NoAsymptotics::Slope);
        }
        Ok(Self {
            bias: slope / 12.0,
            variance: 1.0 / draws,
            power: 2,
        })
    }

    /// The two terms at bandwidth or width `h`.
    pub fn at(&self, h: f64) -> Integrated {
        Integrated {
            squared_bias: self.bias * h.powi(self.power),
            variance: self.variance / h,
        }
    }

    /// Where their sum is least: (v / (p c))^(1/(p+1)).
    pub fn best(&self) -> f64 {
        let p = f64::from(self.power);
        (self.variance / (p * self.bias)).powf(1.0 / (p + 1.0))
    }
}
