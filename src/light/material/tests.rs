//! Directions against their densities.

use super::{Dielectric, Lambertian, Material, Phong, fresnel};
use crate::light::chance;
use crate::light::spectrum::Spectrum;
use crate::light::vector::{Frame, Vector};
use crate::random::stream;
use std::f64::consts::{PI, TAU};

const DRAWS: usize = 40_000;
/// Of each test; there are six.
const LEVEL: f64 = 1e-3;

fn normal() -> Vector {
    Vector::new(0.3, -0.5, 0.8).normalize()
}

/// The azimuth about an axis, as a share of a turn.
fn turn(direction: Vector, axis: Vector) -> f64 {
    let frame = Frame::about(axis);
    let angle = direction
        .dot(&frame.bitangent)
        .atan2(direction.dot(&frame.tangent));
    (angle / TAU).rem_euclid(1.0)
}

fn drawn(material: &Material, incoming: Vector) -> Vec<(Vector, f64)> {
    let mut random = stream(7, "scatter", 0);
    (0..DRAWS)
        .map(|_| {
            let scattered = material.scatter(incoming, normal(), true, &mut random);
            assert!((scattered.direction.norm() - 1.0).abs() < 1e-12);
            (scattered.direction, scattered.factor)
        })
        .collect()
}

#[test]
fn diffuse_light_follows_the_cosine() {
    let material = Material::Lambertian(Lambertian {
        reflectance: Spectrum::Flat(0.5),
    });
    let directions = drawn(&material, -normal());
    let cosines: Vec<f64> = directions.iter().map(|(d, _)| d.dot(&normal())).collect();
    let mean = cosines.iter().sum::<f64>() / DRAWS as f64;
    // E cos = 2/3 with variance 1/18
    assert!((mean - 2.0 / 3.0).abs() < 3.3 * (1.0 / 18.0 / DRAWS as f64).sqrt());
    let squares: Vec<f64> = cosines.iter().map(|cos| cos * cos).collect();
    assert!(chance::uniform(squares) > LEVEL);
    let turns: Vec<f64> = directions.iter().map(|(d, _)| turn(*d, normal())).collect();
    assert!(chance::uniform(turns) > LEVEL);
    // a planted fault of 5 % in the exponent is seen with this many draws
    let wrong: Vec<f64> = cosines.iter().map(|cos| cos.powf(2.1)).collect();
    assert!(chance::uniform(wrong) < LEVEL);
}

#[test]
fn a_lobe_follows_its_power_of_the_cosine_and_keeps_its_energy() {
    let exponent = 20.0;
    let phong = Material::Phong(Phong {
        reflectance: Spectrum::Flat(0.9),
        exponent,
    });
    let incoming = (normal() * -1.0 + Frame::about(normal()).tangent * 0.7).normalize();
    let mirrored = incoming - normal() * (2.0 * incoming.dot(&normal()));
    let directions = drawn(&phong, incoming);
    let heights: Vec<f64> = directions
        .iter()
        .map(|(d, _)| d.dot(&mirrored).clamp(0.0, 1.0).powf(exponent + 1.0))
        .collect();
    assert!(chance::uniform(heights) > LEVEL);
    let turns: Vec<f64> = directions.iter().map(|(d, _)| turn(*d, mirrored)).collect();
    assert!(chance::uniform(turns) > LEVEL);
    // the share that is reflected: the integral of f cos θ by the midpoint rule over the hemisphere
    let (rings, sectors) = (400, 400);
    let frame = Frame::about(normal());
    let mut albedo = 0.0;
    for i in 0..rings {
        let u = (f64::from(i) + 0.5) / f64::from(rings);
        for j in 0..sectors {
            let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(sectors)).sin_cos();
            let d = frame.direction([u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()]);
            albedo += d.dot(&mirrored).max(0.0).powf(exponent);
        }
    }
    albedo *= (exponent + 2.0) / TAU * PI / f64::from(rings * sectors);
    let factors: Vec<f64> = directions.iter().map(|(_, factor)| *factor).collect();
    let mean = factors.iter().sum::<f64>() / DRAWS as f64;
    let variance = factors.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / DRAWS as f64;
    assert!((mean - albedo).abs() < 3.3 * (variance / DRAWS as f64).sqrt());
    assert!(albedo <= 1.0 && albedo > 0.5, "{albedo}");
    let most = factors.iter().copied().fold(0.0, f64::max);
    assert!(most <= (exponent + 2.0) / (exponent + 1.0));
}

#[test]
fn glass_obeys_fresnel_and_snell() {
    // (n − 1)²/(n + 1)² head-on; nothing of the parallel half at Brewster's angle; all beyond the critical angle
    assert!((fresnel(1.0, 1.5).0 - 0.04).abs() < 1e-12);
    let brewster = 1.5_f64.atan();
    let (reflected, through) = fresnel(brewster.cos(), 1.5);
    let perpendicular = (brewster.cos() - 1.5 * through) / (brewster.cos() + 1.5 * through);
    assert!((reflected - 0.5 * perpendicular * perpendicular).abs() < 1e-12);
    assert!((fresnel(0.5, 1.0 / 1.5).0 - 1.0).abs() < 1e-12);
    let glass = Material::Dielectric(Dielectric { index: 1.5 });
    let cos = 0.3;
    let tangent = Frame::about(normal()).tangent;
    let sine = (1.0_f64 - cos * cos).sqrt();
    let incoming = tangent * sine - normal() * cos;
    let share = fresnel(cos, 1.5).0;
    let mut mirrored = 0.0;
    for (direction, factor) in drawn(&glass, incoming) {
        assert!((factor - 1.0).abs() < 1e-15);
        let along = direction.dot(&tangent);
        if direction.dot(&normal()) > 0.0 {
            mirrored += 1.0;
            assert!((along - sine).abs() < 1e-12);
        } else {
            assert!((along - sine / 1.5).abs() < 1e-12);
        }
    }
    let n = DRAWS as f64;
    let p = chance::counts(&[mirrored, n - mirrored], &[n * share, n * (1.0 - share)]);
    assert!(p > LEVEL, "{mirrored} of {n}, expected {share}");
    // and from inside, back the same way
    let mut random = stream(8, "scatter", 0);
    let inside = tangent * (sine / 1.5) + normal() * (1.0 - sine * sine / 2.25).sqrt();
    let out = std::iter::repeat_with(|| glass.scatter(inside, normal(), false, &mut random))
        .take(100)
        .find(|scattered| scattered.direction.dot(&normal()) > 0.0)
        .expect("some light comes out");
    assert!((out.direction.dot(&tangent) - sine).abs() < 1e-12);
}
