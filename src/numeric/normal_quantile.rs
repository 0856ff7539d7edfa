//! The inverse of the normal distribution function, one number at a time or many at a time in vector registers.
//!
//! Samples are drawn by inversion, a thousand numbers for each of a million samples, so that this function is the price of an experiment; the one of statrs, which judges it in the
//! tests, costs five times as much a number.
//!
//! # References
//! Wichura 1988, Algorithm AS 241: the percentage points of the normal distribution, Applied Statistics 37 (routine PPND16); `logarithm.rs`.

use super::logarithm::logarithm;
use pulp::{Arch, Simd, WithSimd};

/// A quotient of polynomials, coefficients in rising order.
struct Rational {
    numerator: [f64; 8],
    denominator: [f64; 8],
}

/// |p - ½| up to which the first quotient serves, in (0.425² - (p - ½)²).
const MIDDLE: f64 = 0.425;

/// About the middle.
const CENTRE: Rational = Rational {
    numerator: [
        3.387_132_872_796_366_6,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_4e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_6e3,
    ],
    denominator: [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_545e3,
    ],
};

/// In r - 1.6 with r = √(-ln p) ≤ 5.
const TAIL: Rational = Rational {
    numerator: [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    denominator: [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
};

/// In r - 5 beyond.
const FAR: Rational = Rational {
    numerator: [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    denominator: [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
};

impl Rational {
    /// Multiplications and additions are fused everywhere, also where it takes a detour, so that every machine gives the same bits.
    #[inline(always)]
    fn at(&self, x: f64) -> f64 {
        let (mut above, mut below) = (self.numerator[7], self.denominator[7]);
        for k in (0..7).rev() {
            above = above.mul_add(x, self.numerator[k]);
            below = below.mul_add(x, self.denominator[k]);
        }
        above / below
    }
}

/// Φ⁻¹(p) in the middle, with q = p - ½.
#[inline(always)]
fn centre(q: f64) -> f64 {
    q * CENTRE.at(MIDDLE * MIDDLE - q * q)
}

/// -Φ⁻¹(p) in a tail of probability p, with r = √(-ln p).
#[inline(always)]
fn tail(r: f64) -> f64 {
    if r <= 5.0 {
        TAIL.at(r - 1.6)
    } else if r < f64::INFINITY {
        FAR.at(r - 5.0)
    } else {
        r
    }
}

/// Φ⁻¹(p) for 0 ≤ p ≤ 1, within 4e-15 of itself in the lower tail; infinite at 0 and 1, not a number elsewhere. For p near 1 use -Φ⁻¹(1 - p) with an exact 1 - p.
pub fn normal_quantile(p: f64) -> f64 {
    Arch::new().dispatch(One(p))
}

/// [`normal_quantile`] of each of many numbers, in place, to the bit; some 2 to 3 ns a number.
pub fn normal_quantiles(numbers: &mut [f64]) {
    Arch::new().dispatch(Many(numbers));
}

struct One(f64);

impl WithSimd for One {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self(p) = self;
        let q = p - 0.5;
        if q.abs() <= MIDDLE {
            return centre(q);
        }
        let smaller = if p < 0.5 { p } else { 1.0 - p };
        tail((-logarithm(smaller)).sqrt()).copysign(q)
    }
}

/// Numbers treated together: the lists of their tails stay in the first-level cache.
const CHUNK: usize = 256;

/// A share of a tail at which nothing is special: lists are filled up with it.
const ORDINARY: f64 = 0.05;

/// Shares of a tail from here on are not [`FAR`] out: √(-ln p) ≤ 5 with some room.
const NEAR: f64 = 2e-11;

struct Many<'a>(&'a mut [f64]);

impl WithSimd for Many<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        const LANES: usize = 8;
        let mut away = [0.0; CHUNK];
        let mut beyond = [0u32; CHUNK];
        let mut places = [0u8; CHUNK];
        let mut tails = [0.0; CHUNK];
        for chunk in self.0.chunks_mut(CHUNK) {
            let away = &mut away[..chunk.len()];
            for ((q, beyond), p) in away.iter_mut().zip(&mut beyond).zip(&*chunk) {
                *q = p - 0.5;
                // what is no number belongs there
                *beyond = u32::from(q.abs() > MIDDLE) | u32::from(q.is_nan());
            }
            // three in twenty are in the tails: a list of them, without a branch
            let mut many = 0;
            for (i, beyond) in beyond[..chunk.len()].iter().enumerate() {
                places[many as usize & (CHUNK - 1)] = i as u8;
                many += beyond;
            }
            let many = many as usize;
            let places = &places[..many];
            for (tail, &place) in tails.iter_mut().zip(places) {
                let p = chunk[usize::from(place)];
                let other = 1.0 - p;
                *tail = if p < 0.5 { p } else { other };
            }
            for (z, q) in chunk.iter_mut().zip(&*away) {
                *z = centre(*q);
            }
            let whole = many.next_multiple_of(LANES);
            tails[many..whole].fill(ORDINARY);
            let tails = &mut tails[..whole];
            let least = tails
                .iter()
                .fold(1.0, |least, &p| if p < least { p } else { least });
            if least >= NEAR {
                for tail in &mut *tails {
                    *tail = TAIL.at((-logarithm(*tail)).sqrt() - 1.6);
                }
            } else {
                for z in &mut *tails {
                    *z = tail((-logarithm(*z)).sqrt());
                }
            }
            for (&place, &tail) in places.iter().zip(&*tails) {
                let i = usize::from(place);
                chunk[i] = tail.copysign(away[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::SQRT_2;

    /// The judge.
    fn known(p: f64) -> f64 {
        -SQRT_2 * statrs::function::erf::erfc_inv(2.0 * p)
    }

    #[test]
    fn it_is_the_inverse_that_others_know() {
        for i in 1..20_000 {
            let p = f64::from(i) / 20_000.0;
            let (found, known) = (normal_quantile(p), known(p));
            assert!(
                (found - known).abs() <= 2e-15 * known.abs().max(1e-2),
                "{p}"
            );
        }
        for exponent in 1..300 {
            let p = 10f64.powi(-exponent);
            let (found, known) = (normal_quantile(p), known(p));
            assert!((found / known - 1.0).abs() < 4e-15, "{p}: {found} {known}");
        }
    }

    #[test]
    fn many_are_each_to_the_bit() {
        let numbers: Vec<f64> = (0..3001)
            .map(|i| (f64::from(i) * 0.618_033_988_75).fract().powi(1 + i % 40))
            .chain([0.0, 1.0, 0.5, f64::NAN, -1.0, 2.0, 1e-320, 1.0 - 1e-16])
            .collect();
        for length in [0, 1, 255, 256, 257, numbers.len()] {
            let mut many = numbers[..length].to_vec();
            normal_quantiles(&mut many);
            for (z, p) in many.iter().zip(&numbers) {
                let one = normal_quantile(*p);
                assert!(
                    z.to_bits() == one.to_bits() || z.is_nan() && one.is_nan(),
                    "{p}"
                );
            }
        }
        assert!(normal_quantile(-1.0).is_nan() && normal_quantile(f64::NAN).is_nan());
    }
}
