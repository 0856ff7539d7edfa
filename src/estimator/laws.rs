//! What an estimator promises of its estimates.

use serde::Serialize;

/// What an estimator promises of every estimate it makes. The law suite tests each promise, and fails what is kept but
/// not promised just as what is promised but not kept.
///
/// Promises hold on the line, in the plane and on boxes with walls, for the settings of the estimator at hand; on other polygons as far as the treatment of
/// walls says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[expect(
    clippy::struct_excessive_bools,
    reason = "a list of independent promises"
)]
pub struct Laws {
    /// Integrates to the mass of the sample (over the whole line or plane, not only the domain: what an estimator lays beyond walls that it
    /// does not see is not lost, but in the wrong place).
    pub mass_conserving: bool,
    /// Never below zero.
    pub non_negative: bool,
    /// The estimate of a union is the weighted mean of the estimates, settings held fixed.
    pub linear: bool,
    /// Points spread evenly between walls, ever more finely, give an even estimate, at the walls as well as between them. Of an estimator
    /// that is linear in the data that is to say: E f̂ = f for a uniform density, whatever the size of the sample.
    pub reproduces_constants: bool,
    /// Points whose density between walls is a linear function, ever more finely, give that function, at the walls as well as between them. Of
    /// an estimator that is linear in the data that is to say: E f̂ = f for a linear density.
    pub reproduces_linear: bool,
    /// Continuous in the target, inside the domain.
    pub continuous: bool,
    /// The same sample gives the same estimate, bit for bit.
    pub deterministic: bool,
    /// Multiplying all data by a and the targets likewise divides the estimate by a^D, if widths are chosen from the data or scaled along.
    pub scale_equivariant: bool,
    /// Moving data and targets alike changes nothing, if origins move along.
    pub translation_equivariant: bool,
    /// A point of weight 2w counts as two points of weight w at its place. Not so where a width is chosen from the effective size, which
    /// is smaller for the one heavy point.
    pub repeatable: bool,
}

impl Laws {
    /// The names in tables and lists, in the order of [`Laws::all`].
    pub const NAMES: [&'static str; 10] = [
        "mass-conserving",
        "non-negative",
        "linear",
        "reproduces-constants",
        "reproduces-linear",
        "continuous",
        "deterministic",
        "scale-equivariant",
        "translation-equivariant",
        "repeatable",
    ];

    /// Each promise, in the order of [`Laws::NAMES`].
    pub fn all(&self) -> [bool; 10] {
        [
            self.mass_conserving,
            self.non_negative,
            self.linear,
            self.reproduces_constants,
            self.reproduces_linear,
            self.continuous,
            self.deterministic,
            self.scale_equivariant,
            self.translation_equivariant,
            self.repeatable,
        ]
    }
}
