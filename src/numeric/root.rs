//! Roots of a function of one variable.

/// The place between `low` and `high` where `f` changes sign, by bisection to the last bit; `None` if it does not change sign.
///
/// Cost: at most about 1100 evaluations, commonly 60. Chosen over faster schemes because it cannot fail.
pub fn root(f: impl Fn(f64) -> f64, low: f64, high: f64) -> Option<f64> {
    let (mut a, mut b) = (low, high);
    let (fa, fb) = (f(a), f(b));
    if fa == 0.0 {
        return Some(a);
    }
    if fb == 0.0 {
        return Some(b);
    }
    if fa.is_nan() || fb.is_nan() || (fa > 0.0) == (fb > 0.0) {
        return None;
    }
    loop {
        let middle = a + 0.5 * (b - a);
        if middle <= a.min(b) || middle >= a.max(b) {
            return Some(middle);
        }
        if (f(middle) > 0.0) == (fa > 0.0) {
            a = middle;
        } else {
            b = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::root;

    #[test]
    fn finds_the_square_root_of_two() {
        let found = root(|x| x * x - 2.0, 0.0, 2.0).expect("changes sign");
        assert!((found - std::f64::consts::SQRT_2).abs() < 1e-15);
        assert_eq!(root(|x| x * x + 1.0, 0.0, 2.0), None);
    }
}
