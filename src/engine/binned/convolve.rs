//! Convolution of node masses with a kernel, at every so many nodes.

use crate::numeric::{forward_transform, inverse_transform};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Products taken side by side in vector registers.
const WIDTH: usize = 16;

/// Expected time on one thread; the constants are counts of operations, still to be measured.
pub(super) fn nanoseconds(nodes: usize, margin: usize, outputs: usize) -> f64 {
    direct_cost(margin, outputs).min(transform_cost(nodes))
}

fn direct_cost(margin: usize, outputs: usize) -> f64 {
    outputs as f64 * (20.0 + 0.15 * (2 * margin + 1) as f64)
}

fn transform_cost(nodes: usize) -> f64 {
    let length = transform_length(nodes) as f64;
    3_000.0 + 1.6 * length * length.log2()
}

/// The least length 2ᵏ or 3·2ᵏ that holds all nodes.
fn transform_length(nodes: usize) -> usize {
    let power = nodes.next_power_of_two().max(4);
    if power / 4 * 3 >= nodes {
        power / 4 * 3
    } else {
        power
    }
}

/// Σᵢ mass[margin + j·stride + i] · kernel[|i|] over |i| ≤ margin, for j = 0 .. `outputs`, where margin = `kernel.len() - 1`.
///
/// `mass` must reach `margin` beyond the last output, so that nothing wraps round in a transform of its length.
pub(super) fn convolve(mass: &[f64], kernel: &[f64], stride: usize, outputs: usize) -> Vec<f64> {
    let margin = kernel.len() - 1;
    if direct_cost(margin, outputs) <= transform_cost(mass.len()) {
        directly(mass, kernel, stride, outputs)
    } else {
        by_transform(mass, kernel, stride, outputs)
    }
}

fn directly(mass: &[f64], kernel: &[f64], stride: usize, outputs: usize) -> Vec<f64> {
    let both: Vec<f64> = kernel[1..].iter().rev().chain(kernel).copied().collect();
    (0..outputs)
        .into_par_iter()
        .with_min_len(32)
        .map(|j| {
            Arch::new().dispatch(Dot {
                mass: &mass[j * stride..][..both.len()],
                kernel: &both,
            })
        })
        .collect()
}

struct Dot<'a> {
    mass: &'a [f64],
    kernel: &'a [f64],
}

impl WithSimd for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let mut lanes = [0.0; WIDTH];
        let (mass, kernel) = (
            self.mass.chunks_exact(WIDTH),
            self.kernel.chunks_exact(WIDTH),
        );
        let rest = mass
            .remainder()
            .iter()
            .zip(kernel.remainder())
            .map(|(m, k)| m * k)
            .sum::<f64>();
        for (mass, kernel) in mass.zip(kernel) {
            for i in 0..WIDTH {
                lanes[i] += mass[i] * kernel[i];
            }
        }
        lanes.iter().sum::<f64>() + rest
    }
}

fn by_transform(mass: &[f64], kernel: &[f64], stride: usize, outputs: usize) -> Vec<f64> {
    let length = transform_length(mass.len());
    let margin = kernel.len() - 1;
    let (forward, inverse) = (forward_transform(length), inverse_transform(length));
    let mut values = vec![0.0; length];
    values[..mass.len()].copy_from_slice(mass);
    let mut circle = vec![0.0; length];
    for (i, value) in kernel.iter().enumerate() {
        circle[i] = *value;
        circle[(length - i) % length] = *value;
    }
    let (mut spectrum, mut response) = (forward.make_output_vec(), forward.make_output_vec());
    forward
        .process(&mut values, &mut spectrum)
        .expect("the buffers are of the planned length");
    forward
        .process(&mut circle, &mut response)
        .expect("the buffers are of the planned length");
    let scale = (length as f64).recip();
    for (s, r) in spectrum.iter_mut().zip(&response) {
        // the kernel is even, so its transform is real
        *s *= r.re * scale;
    }
    // the inverse insists that these are real, which the transform of real numbers makes them up to rounding
    for end in [0, length / 2] {
        spectrum[end].im = 0.0;
    }
    inverse
        .process(&mut spectrum, &mut values)
        .expect("the ends of the spectrum are real");
    (0..outputs).map(|j| values[margin + j * stride]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transform_and_products_are_the_same_sum() {
        for (margin, stride, outputs) in
            [(3, 1, 1), (40, 3, 17), (7, 2, 300), (1, 1, 2), (500, 1, 40)]
        {
            let kernel: Vec<f64> = (0..=margin).map(|i| (-0.1 * i as f64).exp()).collect();
            let nodes = 2 * margin + 1 + (outputs - 1) * stride;
            let mass: Vec<f64> = (0..nodes).map(|i| (i as f64 * 0.618).fract()).collect();
            let expected: Vec<f64> = (0..outputs)
                .map(|j| {
                    (0..=2 * margin)
                        .map(|i| mass[i + j * stride] * kernel[i.abs_diff(margin)])
                        .sum()
                })
                .collect();
            for got in [
                directly(&mass, &kernel, stride, outputs),
                by_transform(&mass, &kernel, stride, outputs),
            ] {
                for (g, e) in got.iter().zip(&expected) {
                    assert!(
                        (g - e).abs() < 1e-11 * e,
                        "{margin} {stride} {outputs}: {g} {e}"
                    );
                }
            }
        }
    }
}
