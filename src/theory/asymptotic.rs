//! The leading terms of the error as samples grow, where the density is smooth enough to have them.

use super::Integrated;
use crate::numeric::root;

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
    /// The leading term of an adaptive estimate is not one of the whole line.
    #[error(
        "the asymptotic error does not exist: the bias of an adaptive estimate begins with h⁴ (1/f)'''', which grows beyond all bounds where the density falls, and the clip that tames the widths there bends it"
    )]
    Adaptive,
    /// No leading terms are known for what is asked about.
    #[error("leading terms for large samples are not known for this kind of estimate")]
    Unknown,
}

/// AMISE(h) = c₂ h² + c₄ h⁴ + v / hᵈ in d dimensions, and where it is least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymptotic {
    /// c₂: what bins add to the integrated squared bias.
    second: f64,
    /// c₄: what smoothing adds to it.
    fourth: f64,
    /// v: the integrated variance times hᵈ.
    variance: f64,
    /// d.
    dimensions: i32,
}

/// `roughness`, or why it is of no use.
fn finite(roughness: f64, otherwise: NoAsymptotics) -> Result<f64, NoAsymptotics> {
    if roughness.is_finite() {
        Ok(roughness)
    } else {
        Err(otherwise)
    }
}

impl Asymptotic {
    /// h⁴ k₂² R(f'')/4 + R(K)/(n h). [Silverman 1986, eq. 3.20]
    pub(super) fn of_kernel(
        variance_of_kernel: f64,
        roughness_of_kernel: f64,
        curvature: f64,
        draws: f64,
    ) -> Result<Self, NoAsymptotics> {
        let curvature = finite(curvature, NoAsymptotics::Curvature)?;
        Ok(Self {
            second: 0.0,
            fourth: 0.25 * variance_of_kernel.powi(2) * curvature,
            variance: roughness_of_kernel / draws,
            dimensions: 1,
        })
    }

    /// h⁴ μ₂² R(Δf)/4 + R(K)/(n h²) in the plane, the bandwidth being the same on both axes. [Wand & Jones 1995, section 4.3]
    pub(super) fn of_plane_kernel(
        variance_of_kernel: f64,
        roughness_of_kernel: f64,
        curvature: f64,
        draws: f64,
    ) -> Result<Self, NoAsymptotics> {
        Ok(Self {
            dimensions: 2,
            ..Self::of_kernel(variance_of_kernel, roughness_of_kernel, curvature, draws)?
        })
    }

    /// h² R(f')/12 + 1/(n h). [Freedman & Diaconis 1981; Scott 1992, section 3.3]
    pub(super) fn of_histogram(slope: f64, draws: f64) -> Result<Self, NoAsymptotics> {
        Ok(Self {
            second: finite(slope, NoAsymptotics::Slope)? / 12.0,
            fourth: 0.0,
            variance: 1.0 / draws,
            dimensions: 1,
        })
    }

    /// h² ∫|∇f|²/12 + 1/(n h²) for square bins in the plane. [Scott 1992, section 3.4]
    pub(super) fn of_plane_histogram(slope: f64, draws: f64) -> Result<Self, NoAsymptotics> {
        Ok(Self {
            dimensions: 2,
            ..Self::of_histogram(slope, draws)?
        })
    }

    /// h² R(f')/(12 m²) + h⁴ (1 - 2/m² + 3/(5m⁴)) R(f'')/144 + 2 (1 + 1/(2m²))/(3 n h) for m ≥ 2 shifts. [Scott 1985; Scott 1992, section 5.1]
    pub(super) fn of_shifted_histogram(
        slope: f64,
        curvature: f64,
        shifts: f64,
        draws: f64,
    ) -> Result<Self, NoAsymptotics> {
        let per = shifts.powi(-2);
        let smoothing = 1.0 - 2.0 * per + 0.6 * per * per;
        Ok(Self {
            second: per * finite(slope, NoAsymptotics::Slope)? / 12.0,
            fourth: smoothing * finite(curvature, NoAsymptotics::Curvature)? / 144.0,
            variance: 2.0 * (1.0 + 0.5 * per) / (3.0 * draws),
            dimensions: 1,
        })
    }

    /// 49 h⁴ R(f'')/2880 + 2/(3 n h). [Scott 1992, section 4.1]
    pub(super) fn of_polygon(curvature: f64, draws: f64) -> Result<Self, NoAsymptotics> {
        Ok(Self {
            second: 0.0,
            fourth: 49.0 * finite(curvature, NoAsymptotics::Curvature)? / 2880.0,
            variance: 2.0 / (3.0 * draws),
            dimensions: 1,
        })
    }

    /// Bias and variance at bandwidth or width `h`.
    pub fn at(&self, h: f64) -> Integrated {
        Integrated {
            squared_bias: self.second * h.powi(2) + self.fourth * h.powi(4),
            variance: self.variance / h.powi(self.dimensions),
        }
    }

    /// Where their sum is least: 2 c₂ h³ + 4 c₄ h⁵ = v.
    pub fn best(&self) -> f64 {
        if self.dimensions != 1 {
            let d = f64::from(self.dimensions);
            if self.fourth == 0.0 {
                // bins: 2 c₂ h²⁺ᵈ = d v
                return (0.5 * d * self.variance / self.second).powf(1.0 / (2.0 + d));
            }
            // kernels, whose c₂ is 0: 4 c₄ h⁴⁺ᵈ = d v
            return (0.25 * d * self.variance / self.fourth).powf(1.0 / (4.0 + d));
        }
        let alone = [
            (0.5 * self.variance / self.second).cbrt(),
            (0.25 * self.variance / self.fourth).powf(0.2),
        ];
        // either alone would do if the other were 0; both together need less
        let most = alone[0].min(alone[1]);
        if self.second == 0.0 || self.fourth == 0.0 {
            return most;
        }
        let excess =
            |h: f64| 2.0 * self.second * h.powi(3) + 4.0 * self.fourth * h.powi(5) - self.variance;
        root(excess, 0.0, most).unwrap_or(most)
    }
}
