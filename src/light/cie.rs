//! From wavelengths to colours: the CIE 1931 standard observer (2 degrees) and linear sRGB.
//!
//! A flux of Φ watts at wavelength λ is recorded as the tristimulus values X = Φ x̄(λ) / ∫ȳ, Y and Z likewise, which are not negative, so that
//! they are weights like any others; ∫ȳ = 106.857 nm. With this constant, a spectrum of S watts per nm at every wavelength has Y = S. Estimates,
//! which are linear in the weights, are turned into linear sRGB afterwards: a single wavelength lies outside of that triangle and has a
//! negative channel, a sum over many seldom has.

use super::spectrum::Table;
use std::sync::LazyLock;

/// The wavelengths that are seen, in nm.
pub const VISIBLE: [f64; 2] = [360.0, 830.0];

struct Observer {
    functions: [Table; 3],
    integral: f64,
}

static OBSERVER: LazyLock<Observer> = LazyLock::new(|| {
    let text = include_str!("../../data/cie_1931/cie_1931_2deg_1nm.csv");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| {
            line.split(',')
                .map(|cell| cell.trim().parse().expect("the table holds numbers"))
                .collect()
        })
        .collect();
    let functions = [1, 2, 3].map(|column| {
        Table::new(rows.iter().map(|row| [row[0], row[column]]).collect())
            .expect("the table is one of a spectrum")
    });
    Observer {
        integral: rows.iter().map(|row| row[2]).sum(),
        functions,
    }
});

/// X, Y and Z of one watt at `wavelength` in nm; 0 for what is not seen.
pub fn tristimulus(wavelength: f64) -> [f64; 3] {
    let seen = (VISIBLE[0]..=VISIBLE[1]).contains(&wavelength);
    let scale = if seen { OBSERVER.integral.recip() } else { 0.0 };
    [0, 1, 2].map(|axis| OBSERVER.functions[axis].at(wavelength) * scale)
}

/// Linear sRGB from X, Y and Z. [IEC 61966-2-1:1999]
pub fn linear_srgb([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_625_5 * x - 1.537_208 * y - 0.498_628_6 * z,
        -0.968_930_7 * x + 1.875_756_1 * y + 0.041_517_5 * z,
        0.055_710_1 * x - 0.204_021_1 * y + 1.056_995_9 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::{linear_srgb, tristimulus};

    #[test]
    fn a_flat_spectrum_has_its_height_as_luminance() {
        let sum = (360..=830).fold([0.0; 3], |sum, wavelength| {
            let value = tristimulus(f64::from(wavelength));
            [0, 1, 2].map(|axis| sum[axis] + value[axis])
        });
        assert!((sum[1] - 1.0).abs() < 1e-12);
        // equal energy: X and Z as well, to the precision of the standard
        assert!((sum[0] - 1.0).abs() < 1e-3 && (sum[2] - 1.0).abs() < 1e-3);
        assert!(tristimulus(200.0).iter().all(|&value| value <= 0.0));
    }

    #[test]
    fn the_white_of_srgb_is_white() {
        let white = linear_srgb([0.950_5, 1.0, 1.089]);
        assert!(
            white.iter().all(|channel| (channel - 1.0).abs() < 1e-3),
            "{white:?}"
        );
    }
}
