//! Casters against a definition of their own: every triangle by the algorithm of Möller and Trumbore (1997), one after the other.

use super::{Caster, Found};
use crate::light::scene::Facet;
use crate::light::vector::{Ray, Vector};
use crate::random::stream;
use rand::RngExt;

/// Where the ray meets one facet: by Cramer's rule, without any of the forms of `facets`.
fn meets(facet: &Facet, ray: &Ray) -> Option<f64> {
    let across = ray.direction.cross(&facet.second);
    let determinant = facet.first.dot(&across);
    let from = ray.origin - facet.origin;
    let s = from.dot(&across) / determinant;
    let over = from.cross(&facet.first);
    let t = ray.direction.dot(&over) / determinant;
    let distance = facet.second.dot(&over) / determinant;
    let inside = s >= 0.0
        && t >= 0.0
        && if facet.triangle {
            s + t <= 1.0
        } else {
            s <= 1.0 && t <= 1.0
        };
    (inside && distance > 0.0 && distance.is_finite()).then_some(distance)
}

fn one_by_one(facets: &[Facet], ray: &Ray) -> Option<Found> {
    let mut found: Option<Found> = None;
    for (index, facet) in facets.iter().enumerate() {
        let primitive = index as u32;
        if ray.leaving != Some(primitive)
            && let Some(distance) = meets(facet, ray)
            && found.is_none_or(|found| distance < found.distance)
        {
            found = Some(Found {
                primitive,
                distance,
            });
        }
    }
    found
}

/// `count` facets of all sizes at random places, some of them far from the others.
fn clutter(count: usize, seed: u64) -> Vec<Facet> {
    let mut random = stream(seed, "clutter", 0);
    let mut vector = |scale: f64| Vector::from_fn(|_, _| scale * (random.random::<f64>() - 0.5));
    (0..count)
        .map(|k| {
            let size = 10.0_f64.powi(-((k % 4) as i32));
            let far = if k % 50 == 49 { 100.0 } else { 2.0 };
            Facet {
                origin: vector(far),
                first: vector(size),
                second: vector(size),
                triangle: k % 3 != 0,
            }
        })
        .collect()
}

#[test]
fn every_caster_finds_what_is_nearest() {
    for (count, seed) in [(1, 1), (7, 2), (8, 3), (17, 4), (60, 5), (900, 6)] {
        let facets = clutter(count, seed);
        let casters = [
            Caster::new(&facets, Vec::new()),
            Caster::exhaustive(&facets, Vec::new()),
        ];
        let mut random = stream(seed, "rays", 0);
        let (mut met, mut differ) = (0, 0);
        for k in 0..4000 {
            let mut vector = || Vector::from_fn(|_, _| 3.0 * (random.random::<f64>() - 0.5));
            let mut ray = Ray::new(vector(), vector().normalize());
            if k % 3 == 0 {
                // along an axis: infinite reciprocals
                ray.direction = Vector::ith(k % 2, if k % 6 == 0 { 1.0 } else { -1.0 });
            }
            if k % 2 == 0 {
                let number = k % count;
                ray.origin = facets[number].place(0.3, 0.3);
                ray.leaving = Some(number as u32);
            }
            let expected = one_by_one(&facets, &ray);
            met += usize::from(expected.is_some());
            for caster in &casters {
                let found = caster.nearest(&ray, f64::INFINITY);
                let same = match (expected, found) {
                    (None, None) => true,
                    (Some(a), Some(b)) => {
                        a.primitive == b.primitive
                            && (a.distance - b.distance).abs() < 1e-9 * (1.0 + a.distance)
                    }
                    _ => false,
                };
                differ += usize::from(!same);
                if let Some(found) = found {
                    // a limit leaves out what lies beyond it
                    assert_eq!(caster.nearest(&ray, found.distance * (1.0 - 1e-9)), None);
                }
            }
        }
        assert!(met > 0);
        assert_eq!(differ, 0, "{count} facets");
    }
}

#[test]
fn the_tree_of_equal_facets_is_no_endless_one() {
    let facet = clutter(2, 9)[1];
    let facets = vec![facet; 200];
    let caster = Caster::new(&facets, Vec::new());
    let towards = facet.place(0.2, 0.2);
    let ray = Ray::new(towards + facet.normal(), -facet.normal());
    let found = caster.nearest(&ray, f64::INFINITY).expect("a hit");
    assert!((found.distance - 1.0).abs() < 1e-9);
}

#[test]
fn no_ray_slips_through_a_seam() {
    // a closed surface of 2 × 20 × 20 triangles, shot at its vertices and edges from inside
    let steps = 20;
    let corner = |i: i32, j: i32| {
        let (theta, phi) = (
            std::f64::consts::PI * f64::from(i) / f64::from(steps),
            std::f64::consts::TAU * f64::from(j % steps) / f64::from(steps),
        );
        Vector::new(
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        )
    };
    let mut facets = Vec::new();
    for i in 0..steps {
        for j in 0..steps {
            let corners = [
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ];
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                let (first, second) = (corners[b] - corners[a], corners[c] - corners[a]);
                if first.cross(&second).norm() > 1e-9 {
                    facets.push(Facet {
                        origin: corners[a],
                        first,
                        second,
                        triangle: true,
                    });
                }
            }
        }
    }
    let caster = Caster::new(&facets, Vec::new());
    let origin = Vector::new(0.1, -0.2, 0.05);
    for i in 1..steps {
        for j in 0..steps {
            for share in [0.0, 0.25, 0.5] {
                for target in [
                    corner(i, j).lerp(&corner(i, j + 1), share),
                    corner(i, j).lerp(&corner(i - 1, j), share),
                ] {
                    let ray = Ray::new(origin, (target - origin).normalize());
                    let found = caster
                        .nearest(&ray, f64::INFINITY)
                        .expect("the surface is closed");
                    assert!((found.distance - (target - origin).norm()).abs() < 1e-9);
                }
            }
        }
    }
}
