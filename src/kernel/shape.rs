//! The kernels by name.

use super::{
    Biweight, Cosine, Epanechnikov, Form, Gaussian, Kernel, Triangular, Triweight, Uniform,
};
use std::fmt;

/// A kernel chosen at run time. It is a [`Kernel`] itself; [`Shape::apply`] leaves the choice behind for inner loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// [`Epanechnikov`].
    Epanechnikov,
    /// [`Biweight`].
    Biweight,
    /// [`Triweight`].
    Triweight,
    /// [`Triangular`].
    Triangular,
    /// [`Cosine`].
    Cosine,
    /// [`Gaussian`].
    Gaussian,
    /// [`Uniform`].
    Uniform,
}

/// A computation that is compiled once per kernel; see [`Shape::apply`].
pub trait Use {
    /// What it yields.
    type Output;
    /// The computation with a kernel known to the compiler.
    fn with<K: Kernel>(self, kernel: K) -> Self::Output;
}

macro_rules! forward {
    ($shape:expr, $kernel:ident => $body:expr) => {
        match $shape {
            Shape::Epanechnikov => {
                let $kernel = Epanechnikov;
                $body
            }
            Shape::Biweight => {
                let $kernel = Biweight;
                $body
            }
            Shape::Triweight => {
                let $kernel = Triweight;
                $body
            }
            Shape::Triangular => {
                let $kernel = Triangular;
                $body
            }
            Shape::Cosine => {
                let $kernel = Cosine;
                $body
            }
            Shape::Gaussian => {
                let $kernel = Gaussian;
                $body
            }
            Shape::Uniform => {
                let $kernel = Uniform;
                $body
            }
        }
    };
}

impl Shape {
    /// All kernels, the most efficient first but the Gaussian and the uniform last.
    pub const ALL: [Self; 7] = [
        Self::Epanechnikov,
        Self::Cosine,
        Self::Biweight,
        Self::Triweight,
        Self::Triangular,
        Self::Gaussian,
        Self::Uniform,
    ];

    /// The names in the order of [`Shape::ALL`], for lists of allowed values.
    pub const NAMES: [&'static str; 7] = [
        "epanechnikov",
        "cosine",
        "biweight",
        "triweight",
        "triangular",
        "gaussian",
        "uniform",
    ];

    /// The name in files, tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Self::Epanechnikov => "epanechnikov",
            Self::Biweight => "biweight",
            Self::Triweight => "triweight",
            Self::Triangular => "triangular",
            Self::Cosine => "cosine",
            Self::Gaussian => "gaussian",
            Self::Uniform => "uniform",
        }
    }

    /// The kernel of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// Runs `computation` with the kernel known to the compiler: the choice is made once, outside the loops.
    pub fn apply<U: Use>(self, computation: U) -> U::Output {
        forward!(self, kernel => computation.with(kernel))
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Kernel for Shape {
    fn value(self, u: f64) -> f64 {
        forward!(self, kernel => kernel.value(u))
    }

    fn of_square(self, square: f64) -> f64 {
        forward!(self, kernel => kernel.of_square(square))
    }

    fn reach(self) -> f64 {
        forward!(self, kernel => kernel.reach())
    }

    fn roughness(self) -> f64 {
        forward!(self, kernel => kernel.roughness())
    }

    fn variance(self) -> f64 {
        forward!(self, kernel => kernel.variance())
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        forward!(self, kernel => kernel.partial_moment(order, below))
    }

    fn form(self) -> Form {
        forward!(self, kernel => kernel.form())
    }
}

#[cfg(test)]
mod tests {
    use super::Shape;

    #[test]
    fn names_lead_back() {
        for (shape, name) in Shape::ALL.into_iter().zip(Shape::NAMES) {
            assert_eq!(shape.name(), name);
            assert_eq!(Shape::named(name), Some(shape));
        }
        assert_eq!(Shape::named("quartic"), None);
    }
}
