//! A number for each colour: reflectances and radiances, as three channels or over wavelengths.

/// How a scene knows colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Three independent transports: red, green, blue. Fluxes are those of the channels.
    Rgb,
    /// One transport per wavelength. Fluxes are recorded as CIE 1931 tristimulus values, see [`super::cie`].
    Spectral,
}

/// The wavelengths at which a table gives values, in nm, and the values; straight lines between them.
///
/// Always true: at least two rows, wavelengths finite, positive and increasing, values finite and not negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rows: Vec<[f64; 2]>,
    /// The distance of the wavelengths where it is the same throughout, so that a row is found without a search.
    step: Option<f64>,
}

/// Why rows do not make a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Too few rows.
    #[error("a spectrum needs at least two rows, not {0}")]
    Short(usize),
    /// A wavelength out of order, or not positive.
    #[error("row {row}: the wavelength {value} nm; wavelengths must be positive and increase")]
    Order {
        /// Which row, from 1.
        row: usize,
        /// The wavelength.
        value: f64,
    },
    /// A value that cannot be.
    #[error("row {row}: the value {value}; values must be finite and not negative")]
    Value {
        /// Which row, from 1.
        row: usize,
        /// The value.
        value: f64,
    },
}

impl Table {
    /// A table of `[wavelength in nm, value]`.
    ///
    /// # Errors
    /// If there are fewer than two rows, or one is not legal.
    pub fn new(rows: Vec<[f64; 2]>) -> Result<Self, TableError> {
        if rows.len() < 2 {
            return Err(TableError::Short(rows.len()));
        }
        let mut last = 0.0;
        for (index, &[wavelength, value]) in rows.iter().enumerate() {
            let row = index + 1;
            if !(wavelength > last && wavelength.is_finite()) {
                return Err(TableError::Order {
                    row,
                    value: wavelength,
                });
            }
            if !(value >= 0.0 && value.is_finite()) {
                return Err(TableError::Value { row, value });
            }
            last = wavelength;
        }
        let step = rows[1][0] - rows[0][0];
        let even = rows
            .windows(2)
            .all(|pair| ((pair[1][0] - pair[0][0]) - step).abs() <= 1e-9 * step);
        Ok(Self {
            step: even.then_some(step),
            rows,
        })
    }

    /// The same value between two wavelengths, which must be in order.
    pub(super) fn level(ends: [f64; 2], value: f64) -> Self {
        Self {
            rows: ends.map(|wavelength| [wavelength, value]).to_vec(),
            step: Some(ends[1] - ends[0]),
        }
    }

    /// The rows.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows
    }

    /// The first wavelength and the last.
    pub fn ends(&self) -> [f64; 2] {
        [self.rows[0][0], self.rows[self.rows.len() - 1][0]]
    }

    /// The value at `wavelength`; beyond the ends that of the nearest end. O(1) for even steps, O(log rows) otherwise.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        let last = self.rows.len() - 2;
        let row = match self.step {
            // a negative number becomes 0
            Some(step) => (((wavelength - self.rows[0][0]) / step) as usize).min(last),
            None => self
                .rows
                .partition_point(|row| row[0] <= wavelength)
                .saturating_sub(1)
                .min(last),
        };
        let ([x0, y0], [x1, y1]) = (self.rows[row], self.rows[row + 1]);
        y0 + (y1 - y0) * ((wavelength - x0) / (x1 - x0)).clamp(0.0, 1.0)
    }

    /// The largest value.
    pub fn largest(&self) -> f64 {
        self.rows.iter().fold(0.0, |most, row| most.max(row[1]))
    }

    /// The integral over the wavelengths of the table, exact for the straight lines.
    pub fn integral(&self) -> f64 {
        self.rows
            .windows(2)
            .map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]))
            .sum()
    }
}

/// A number for each colour.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// The same for all.
    Flat(f64),
    /// One for each of red, green and blue.
    Rgb([f64; 3]),
    /// One for each wavelength.
    Table(Table),
}

impl Spectrum {
    /// The numbers for red, green and blue. A table has none: scenes do not mix the two, so its mean stands in for all three.
    #[inline]
    pub fn rgb(&self) -> [f64; 3] {
        match self {
            Self::Flat(value) => [*value; 3],
            Self::Rgb(values) => *values,
            Self::Table(table) => {
                let rows = table.rows();
                [table.integral() / (rows[rows.len() - 1][0] - rows[0][0]); 3]
            }
        }
    }

    /// The number for a wavelength in nm. Three channels have none: scenes do not mix the two, so their mean stands in.
    #[inline]
    pub fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Flat(value) => *value,
            Self::Rgb([r, g, b]) => (r + g + b) / 3.0,
            Self::Table(table) => table.at(wavelength),
        }
    }

    /// The largest of the numbers.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Flat(value) => *value,
            Self::Rgb(values) => values.iter().copied().fold(0.0, f64::max),
            Self::Table(table) => table.largest(),
        }
    }

    /// Whether all numbers are 0.
    pub fn is_black(&self) -> bool {
        self.largest() <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::{Table, TableError};

    #[test]
    fn straight_lines_between_rows_and_level_beyond() {
        let even = Table::new(vec![[400.0, 0.0], [500.0, 8.0], [600.0, 15.6]]).expect("legal");
        let uneven = Table::new(vec![[400.0, 0.0], [500.0, 8.0], [700.0, 18.0]]).expect("legal");
        for table in [&even, &uneven] {
            assert!((table.at(450.0) - 4.0).abs() < 1e-12);
            assert!((table.at(500.0) - 8.0).abs() < 1e-12);
            assert!(table.at(1.0).abs() < 1e-12);
        }
        assert!((uneven.at(600.0) - 13.0).abs() < 1e-12);
        assert!((uneven.at(1e9) - 18.0).abs() < 1e-12);
        assert!((uneven.integral() - (400.0 + 2600.0)).abs() < 1e-9);
    }

    #[test]
    fn rows_are_checked() {
        assert_eq!(Table::new(vec![[1.0, 1.0]]), Err(TableError::Short(1)));
        let disorder = Table::new(vec![[2.0, 1.0], [2.0, 1.0]]).expect_err("not increasing");
        assert!(
            disorder
                .to_string()
                .starts_with("row 2: the wavelength 2 nm")
        );
        assert!(Table::new(vec![[1.0, 1.0], [2.0, -1.0]]).is_err());
        assert!(Table::new(vec![[1.0, 1.0], [2.0, f64::NAN]]).is_err());
        assert!(Table::new(vec![[f64::NAN, 1.0], [2.0, 1.0]]).is_err());
    }
}
