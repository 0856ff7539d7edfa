//! Kernels whose constants are not those of their values.

use super::Fault;
use crate::kernel::{Form, Gaussian, Kernel};
use std::sync::Arc;

/// A Gaussian with factors.
#[derive(Clone, Copy)]
struct Spoilt {
    value: f64,
    roughness: f64,
    first_moment: f64,
}

const RIGHT: Spoilt = Spoilt {
    value: 1.0,
    roughness: 1.0,
    first_moment: 1.0,
};

impl Kernel for Spoilt {
    fn value(self, u: f64) -> f64 {
        self.value * Gaussian.value(u)
    }

    fn of_square(self, square: f64) -> f64 {
        self.value * Gaussian.of_square(square)
    }

    fn reach(self) -> f64 {
        Gaussian.reach()
    }

    fn roughness(self) -> f64 {
        self.roughness * Gaussian.roughness()
    }

    fn variance(self) -> f64 {
        Gaussian.variance()
    }

    fn partial_moment(self, order: u32, below: f64) -> f64 {
        let times = if order == 1 { self.first_moment } else { 1.0 };
        times * Gaussian.partial_moment(order, below)
    }

    fn form(self) -> Form {
        Form::Gaussian
    }
}

/// A constant typed wrong.
pub const ROUGHNESS_OFF: Fault = Fault {
    name: "kernel-constant",
    summary: "R(K) is 1 % too large",
    caught_by: "kernel-constants",
    plant: |subjects| {
        subjects.kernel = Arc::new(Spoilt {
            roughness: 1.01,
            ..RIGHT
        });
    },
};

/// A normalising constant typed wrong.
pub const TOO_HIGH: Fault = Fault {
    name: "kernel-mass",
    summary: "the kernel has mass 1.01",
    caught_by: "kernel-constants",
    plant: |subjects| {
        subjects.kernel = Arc::new(Spoilt {
            value: 1.01,
            ..RIGHT
        });
    },
};

/// What local linear correction needs.
pub const MOMENT_SIGN: Fault = Fault {
    name: "moment-sign",
    summary: "the first partial moment of the kernel has the wrong sign",
    caught_by: "kernel-constants",
    plant: |subjects| {
        subjects.kernel = Arc::new(Spoilt {
            first_moment: -1.0,
            ..RIGHT
        });
    },
};
