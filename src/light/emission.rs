//! Surfaces that shine.

use super::cie::{self, VISIBLE};
use super::spectrum::{Spectrum, Table};
use std::f64::consts::PI;

/// Diffuse emission: the same radiance in all directions on the front of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Power per area and solid angle; over wavelengths also per nm.
    pub radiance: Spectrum,
}

impl Emission {
    /// Power per area of each of red, green and blue: π × radiance.
    pub fn exitance(&self) -> [f64; 3] {
        self.radiance.rgb().map(|radiance| PI * radiance)
    }

    /// Power per area over all wavelengths: π ∫ radiance; a flat spectrum shines where something is seen.
    pub fn spectral_exitance(&self) -> f64 {
        PI * self.table().integral()
    }

    /// X, Y and Z of the power per area, over wavelengths.
    pub fn tristimulus(&self) -> [f64; 3] {
        self.bands().fold([0.0; 3], |sum, (wavelength, width)| {
            let power = PI * self.table().at(wavelength) * width;
            let colour = cie::tristimulus(wavelength);
            [0, 1, 2].map(|axis| sum[axis] + colour[axis] * power)
        })
    }

    /// The [bands] in which it shines.
    fn bands(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        bands(self.table().ends())
    }

    /// The radiance over wavelengths.
    pub fn table(&self) -> Table {
        match &self.radiance {
            Spectrum::Table(table) => table.clone(),
            other => Table::level(VISIBLE, other.at(VISIBLE[0])),
        }
    }
}

/// Width of a band in nm, at most: colour matching functions are integrated to 0.1 % so. [CIE 15:2018, 7.2.2.2]
const BAND: f64 = 10.0;

/// Equal bands between two wavelengths, as their middles and widths: sums over them stand for integrals. The one way to cut a range of wavelengths.
pub fn bands([low, high]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
    let count = ((high - low) / BAND).ceil().max(1.0) as usize;
    let width = (high - low) / count as f64;
    (0..count).map(move |band| ((band as f64 + 0.5).mul_add(width, low), width))
}

/// Draws wavelengths with density proportional to a table.
#[derive(Clone, Debug)]
pub struct Wavelengths {
    table: Table,
    /// The integral up to each row.
    cumulative: Vec<f64>,
}

impl Wavelengths {
    /// A drawer of wavelengths of a table that is not black.
    pub fn new(table: Table) -> Self {
        let mut sum = 0.0;
        let mut cumulative = vec![0.0];
        for pair in table.rows().windows(2) {
            sum += 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]);
            cumulative.push(sum);
        }
        Self { table, cumulative }
    }

    /// The wavelength below which a share `u` of the power lies: the inverse of a piecewise quadratic. O(log rows).
    pub fn at(&self, u: f64) -> f64 {
        let rows = self.table.rows();
        let wanted = u * self.cumulative[rows.len() - 1];
        let row = self
            .cumulative
            .partition_point(|&sum| sum <= wanted)
            .clamp(1, rows.len() - 1)
            - 1;
        let ([x0, y0], [x1, y1]) = (rows[row], rows[row + 1]);
        let width = x1 - x0;
        let rest = (wanted - self.cumulative[row]).max(0.0);
        // y0 t + (y1 − y0) t² / (2 width) = rest, by the root without cancellation
        let root = (y0 * y0 + 2.0 * rest * (y1 - y0) / width).max(0.0).sqrt();
        let share = if y0 + root > 0.0 {
            2.0 * rest / (y0 + root)
        } else {
            0.0
        };
        x0 + share.clamp(0.0, width)
    }
}

#[cfg(test)]
mod tests {
    use super::Wavelengths;
    use crate::light::spectrum::Table;

    #[test]
    fn wavelengths_invert_the_integral() {
        let rows = vec![[400.0, 0.0], [500.0, 8.0], [600.0, 15.6], [700.0, 0.0]];
        let table = Table::new(rows).expect("legal");
        let drawer = Wavelengths::new(table.clone());
        for k in 0..=1000 {
            let u = f64::from(k) / 1000.0;
            let wavelength = drawer.at(u);
            // the integral up to there, finely
            let steps = 20_000;
            let step = (wavelength - 400.0) / f64::from(steps);
            let below: f64 = (0..steps)
                .map(|i| table.at(400.0 + (f64::from(i) + 0.5) * step) * step)
                .sum();
            assert!(
                (below / table.integral() - u).abs() < 1e-6,
                "{u} {wavelength}"
            );
        }
    }
}
