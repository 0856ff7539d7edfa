//! The natural logarithm in few enough steps, and without a branch, that compilers put several numbers side by side.
//!
//! # References
//! Freely Distributable LIBM 1993 (Sun Microsystems), e_log.c: the series of its minimax polynomial in s² with s = f/(2 + f).

/// ln 2 in two parts: the first has so few digits that its multiples by exponents are exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Lg1 .. Lg7.
const SERIES: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// The bits of √½, cut off.
const ROOT_HALF: u64 = 0x3fe6_a09e_0000_0000;

/// ln x within one unit in the last place for ordinary positive x; -∞ at 0, not a number below. The same bits in vector registers and one at a time.
#[inline(always)]
pub(super) fn logarithm(x: f64) -> f64 {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const MANTISSA: u64 = (1 << 52) - 1;
    /// Numbers below are made larger by this power of two.
    const TINY: (f64, f64) = (18_014_398_509_481_984.0, 54.0);
    let tiny = x < f64::MIN_POSITIVE;
    let scaled = if tiny { x * TINY.0 } else { x };
    // x = 2ᵏ (1 + f) with 1 + f between √½ and √2
    let bits = scaled.to_bits().wrapping_add(ONE - ROOT_HALF);
    // a whole number in the last places of a large one is a number without a conversion
    let biased = f64::from_bits(0x4330_0000_0000_0000 | (bits >> 52)) - 4_503_599_627_370_496.0;
    let k = biased - 1023.0 - if tiny { TINY.1 } else { 0.0 };
    let f = f64::from_bits((bits & MANTISSA) + ROOT_HALF) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let [g1, g2, g3, g4, g5, g6, g7] = SERIES;
    let odd = z * w.mul_add(w.mul_add(w.mul_add(g7, g5), g3), g1);
    let even = w * w.mul_add(w.mul_add(g6, g4), g2);
    let rest = s.mul_add(half_square + (odd + even), k * LN_2[1]);
    let value = k.mul_add(LN_2[0], f - (half_square - rest));
    if x > 0.0 && x < f64::INFINITY {
        value
    } else if x < 0.0 {
        f64::NAN
    } else {
        // 0 and what is not finite
        if x > 0.0 { x } else { x - f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::logarithm;

    #[test]
    fn it_is_the_logarithm_that_others_know() {
        let mut worst = 0.0_f64;
        for i in 1..200_000 {
            let x = f64::from(i) * 0.618_033_988_75;
            for x in [x, x.recip(), x * 1e-5, x * 1e-300, 1.0 + x * 1e-7] {
                let known = x.ln();
                worst = worst.max((logarithm(x) - known).abs() / known.abs().max(1e-300));
            }
        }
        assert!(worst <= 4.5e-16, "{worst:e}");
        for x in [5e-324, 1e-310, f64::MIN_POSITIVE, f64::MAX, 1.0] {
            assert!((logarithm(x) - x.ln()).abs() <= 1e-13, "{x:e}");
        }
    }

    #[test]
    fn where_there_is_none_it_says_so() {
        assert!(logarithm(0.0) == f64::NEG_INFINITY && logarithm(-0.0) == f64::NEG_INFINITY);
        assert!(logarithm(f64::INFINITY) == f64::INFINITY);
        assert!(logarithm(-1.0).is_nan() && logarithm(f64::NAN).is_nan());
        assert!(logarithm(f64::NEG_INFINITY).is_nan() && logarithm(-1e-320).is_nan());
    }
}
