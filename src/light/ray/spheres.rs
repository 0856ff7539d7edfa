//! Spheres, one after the other: O(spheres) a ray.

use super::Found;
use crate::light::scene::Sphere;
use crate::light::vector::Ray;

/// The nearest sphere before `limit`; the first has number `first`.
#[inline]
pub(super) fn nearest(spheres: &[Sphere], first: u32, ray: &Ray, limit: f64) -> Option<Found> {
    let mut found = None;
    let mut limit = limit;
    for (index, sphere) in spheres.iter().enumerate() {
        let primitive = first + index as u32;
        if let Some(distance) = distance(sphere, ray, ray.leaving == Some(primitive))
            && distance < limit
        {
            limit = distance;
            found = Some(Found {
                primitive,
                distance,
            });
        }
    }
    found
}

/// Where the ray meets the sphere in front of it. From a place on the sphere itself one of the two roots is 0 and is known not to count.
#[inline]
fn distance(sphere: &Sphere, ray: &Ray, leaving: bool) -> Option<f64> {
    let from = ray.origin - sphere.centre();
    let along = from.dot(&ray.direction);
    if leaving {
        return (along < 0.0).then_some(-2.0 * along);
    }
    // the distance of the line from the centre, without the cancellation of b² − 4ac
    let nearest = from - ray.direction * along;
    let radius = sphere.radius();
    let square = radius * radius - nearest.norm_squared();
    if square <= 0.0 {
        return None;
    }
    let half = square.sqrt();
    // the root without cancellation, and the other by Vieta
    let far = if along <= 0.0 {
        -along + half
    } else {
        -along - half
    };
    let other = (from.norm_squared() - radius * radius) / far;
    let (near, far) = if far < other {
        (far, other)
    } else {
        (other, far)
    };
    if near > 0.0 {
        Some(near)
    } else {
        (far > 0.0).then_some(far)
    }
}

#[cfg(test)]
mod tests {
    use super::nearest;
    use crate::light::scene::Sphere;
    use crate::light::vector::{Ray, Vector};

    #[test]
    fn from_outside_inside_and_the_sphere_itself() {
        let sphere = [Sphere::new(Vector::new(0.0, 0.0, 3.0), 1.0, false).expect("a sphere")];
        let z = Vector::new(0.0, 0.0, 1.0);
        let at = |origin, direction, leaving| {
            let ray = Ray {
                origin,
                direction,
                leaving,
            };
            nearest(&sphere, 7, &ray, f64::INFINITY).map(|found| found.distance)
        };
        let close = |found: Option<f64>, expected: f64| {
            assert!(
                (found.expect("a hit") - expected).abs() < 1e-14,
                "{found:?}"
            );
        };
        close(at(Vector::zeros(), z, None), 2.0);
        close(at(Vector::new(0.0, 0.0, 3.0), z, None), 1.0);
        close(at(Vector::new(0.0, 0.0, 2.0), z, Some(7)), 2.0);
        assert_eq!(at(Vector::new(0.0, 0.0, 4.0), z, Some(7)), None);
        assert_eq!(at(Vector::new(0.0, 0.0, 5.0), z, None), None);
        assert_eq!(at(Vector::new(0.0, 1.5, 0.0), z, None), None);
    }
}
