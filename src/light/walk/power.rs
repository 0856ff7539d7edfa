//! What happens to the power of a photon at a surface.
// code compiled for wide registers must end up inside the function that `pulp` compiles for them
#![allow(clippy::inline_always)]

use super::carried::Carried;

/// What happens to the power of a photon at a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Power {
    /// Always the same: the photon survives with the share of its power that is reflected.
    #[default]
    Same,
    /// Attenuated: the photon goes on with what is reflected. Once that is below `threshold` of its first power it is killed with
    /// probability `kill`, or goes on with its power divided by 1 − `kill` (Russian roulette).
    Attenuated {
        /// As a share of the first power.
        threshold: f64,
        /// From 0 to below 1.
        kill: f64,
    },
}

/// What becomes of a photon.
#[derive(Clone, Copy)]
pub(super) struct Fate<L> {
    pub(super) goes_on: bool,
    /// With what, if it goes on.
    pub(super) light: L,
    /// What the surface absorbed.
    pub(super) absorbed: f64,
    /// What roulette took away, or gave where this is negative.
    pub(super) roulette: f64,
}

impl Power {
    /// The fate of `light`, of which `reflected` is left, by a number uniform from 0 to 1. `first` is the power with which photons leave their lamp.
    /// Without branches where the power stays the same: whether a photon survives cannot be guessed.
    #[inline(always)]
    pub(super) fn decide<L: Carried>(
        self,
        light: L,
        reflected: L,
        first: f64,
        chance: f64,
    ) -> Fate<L> {
        let (before, after) = (light.power(), reflected.power());
        match self {
            Self::Same => {
                let goes_on = chance * before < after;
                let light = reflected.scaled(before / after);
                // rounding is booked as it happens
                let kept = if goes_on { light.power() } else { 0.0 };
                Fate {
                    goes_on,
                    light,
                    absorbed: before - kept,
                    roulette: 0.0,
                }
            }
            Self::Attenuated { threshold, kill } => {
                let safe = after >= threshold * first;
                let goes_on = after > 0.0 && (safe || chance >= kill);
                let light = if safe {
                    reflected
                } else {
                    reflected.scaled((1.0 - kill).recip())
                };
                let kept = if goes_on { light.power() } else { 0.0 };
                Fate {
                    goes_on,
                    light,
                    absorbed: before - after,
                    roulette: after - kept,
                }
            }
        }
    }
}
