//! Casters against a definition of their own: every triangle by the algorithm of Möller and Trumbore (1997), one after the other.

use super::{Caster, Found, Rays, TOGETHER};
use crate::light::scene::{Facet, Sphere};
use crate::light::vector::{Ray, Vector};
use crate::random::stream;
use pulp::{Arch, Simd, WithSimd};
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

/// Rectangles in boxes, turned and not, among slanting pieces.
fn furniture(seed: u64) -> Vec<Facet> {
    let mut random = stream(seed, "furniture", 0);
    let mut facets = clutter(9, seed);
    for turn in 0..4 {
        let mut vector =
            |scale: f64| Vector::from_fn(|_, _| scale * (random.random::<f64>() - 0.5));
        let corner = vector(2.0);
        let (a, b) = (vector(1.0), vector(1.0));
        let (a, b) = if turn == 0 {
            (Vector::x(), Vector::y())
        } else {
            (a, b - a * (a.dot(&b) / a.norm_squared()))
        };
        let c = a.cross(&b);
        let sides = [(a, b), (b, c), (c, a)];
        for (side, across) in sides.into_iter().zip([c, a, b]) {
            for origin in [corner, corner + across] {
                facets.push(Facet {
                    origin,
                    first: side.0,
                    second: side.1,
                    triangle: false,
                });
            }
        }
    }
    facets
}

struct Together<'t>(&'t Caster, &'t mut Rays, usize);

impl WithSimd for Together<'_> {
    type Output = ();

    fn with_simd<S: Simd>(self, simd: S) {
        self.0.nearest_of(simd, self.1, self.2);
    }
}

#[test]
fn rays_together_meet_what_each_meets_alone() {
    let sphere = Sphere::new(Vector::new(0.2, -0.1, 0.4), 0.3, false).expect("a sphere");
    for seed in 0..6 {
        let facets = furniture(seed);
        let spheres = vec![sphere.clone(); (seed % 2) as usize];
        let caster = Caster::new(&facets, spheres.clone());
        let judge = Caster::exhaustive(&facets, spheres);
        let mut random = stream(seed, "rays", 0);
        let count = TOGETHER - 3;
        let mut rays = Box::new(Rays::default());
        for at in 0..count {
            let mut vector = || Vector::from_fn(|_, _| 3.0 * (random.random::<f64>() - 0.5));
            let mut ray = Ray::new(vector(), vector().normalize());
            if at % 3 == 0 {
                ray.direction = Vector::ith(at % 2, if at % 6 == 0 { 1.0 } else { -1.0 });
            }
            if at % 2 == 0 {
                let number = at % facets.len();
                ray.origin = facets[number].place(0.4, 0.2);
                ray.leaving = Some(number as u32);
            }
            rays.set(at, &ray);
            assert_eq!(rays.ray(at), ray);
        }
        for arch in [Arch::new(), Arch::Scalar] {
            arch.dispatch(Together(&caster, &mut rays, count));
            let mut met = 0;
            for at in 0..count {
                let alone = caster.nearest(&rays.ray(at), f64::INFINITY);
                let bits =
                    |found: Option<Found>| found.map(|f| (f.primitive, f.distance.to_bits()));
                assert_eq!(bits(rays.found(at)), bits(alone), "{at}");
                // and that is what trying each facet finds
                let judged = judge.nearest(&rays.ray(at), f64::INFINITY);
                match (alone, judged) {
                    (Some(a), Some(b)) => {
                        met += 1;
                        assert!((a.distance - b.distance).abs() < 1e-9, "{at}: {a:?} {b:?}");
                        assert_eq!(a.primitive, b.primitive, "{at}");
                    }
                    (None, None) => {}
                    _ => panic!("{at}: {alone:?} {judged:?}"),
                }
            }
            assert!(met > count / 5, "{met}");
        }
    }
}

/// Everything is there twice or thrice, in another order: the first is met, by whoever looks and in lanes of any width.
#[test]
fn of_facets_in_one_place_the_first_is_met() {
    for (count, seed) in [(3, 1), (9, 2), (15, 3), (40, 4), (300, 5)] {
        let once = clutter(count, seed);
        let twice = once.iter().chain(once.iter().rev()).chain(&once);
        let facets: Vec<Facet> = twice.copied().collect();
        let casters = [
            Caster::new(&facets, Vec::new()),
            Caster::exhaustive(&facets, Vec::new()),
        ];
        let single = Caster::new(&once, Vec::new());
        let mut random = stream(seed, "twins", 0);
        let mut rays = Box::new(Rays::default());
        let mut met = 0;
        for at in 0..TOGETHER {
            let mut vector = || Vector::from_fn(|_, _| 3.0 * (random.random::<f64>() - 0.5));
            let target = once[at % count].place(0.2, 0.3);
            let origin = vector();
            rays.set(at, &Ray::new(origin, (target - origin).normalize()));
        }
        for arch in [Arch::new(), Arch::Scalar] {
            arch.dispatch(Together(&casters[0], &mut rays, TOGETHER));
            for at in 0..TOGETHER {
                let ray = rays.ray(at);
                let number = |found: Option<Found>| found.map(|found| found.primitive);
                let expected = number(single.nearest(&ray, f64::INFINITY));
                met += usize::from(expected.is_some());
                assert_eq!(number(rays.found(at)), expected, "{count} {at}");
                for caster in &casters {
                    let found = caster.nearest(&ray, f64::INFINITY);
                    assert_eq!(number(found), expected, "{count} {at}");
                }
            }
        }
        assert!(met > TOGETHER);
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
fn no_ray_slips_through_the_edges_of_a_turned_box() {
    let (a, b) = (Vector::new(1.1, 0.3, -0.2), Vector::new(-0.3, 1.1, 0.0));
    let b = b - a * (a.dot(&b) / a.norm_squared());
    let c = a.cross(&b);
    let corner = Vector::new(-7.0, 3.0, 11.0);
    let mut facets = Vec::new();
    for (first, second, across) in [(a, b, c), (b, c, a), (c, a, b)] {
        for origin in [corner, corner + across] {
            facets.push(Facet {
                origin,
                first,
                second,
                triangle: false,
            });
        }
    }
    let caster = Caster::new(&facets, Vec::new());
    let origin = corner + a * 0.3 + b * 0.6 + c * 0.45;
    for i in 0..=60 {
        let share = f64::from(i) / 60.0;
        for (along, one, two) in [(a, b, c), (b, c, a), (c, a, b)] {
            for (s, t) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
                let target = corner + along * share + one * s + two * t;
                let ray = Ray::new(origin, (target - origin).normalize());
                let found = caster.nearest(&ray, f64::INFINITY).expect("it is closed");
                assert!((found.distance - (target - origin).norm()).abs() < 1e-9);
            }
        }
    }
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
