//! Surfaces cut into small flat patches.

use super::contour::seen;
use crate::light::scene::{Facet, Scene};
use crate::light::vector::Vector;

/// A small flat piece of a surface: a parallelogram, or a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// The surface, by its number in the scene.
    pub surface: usize,
    /// Its number as a primitive, which rays that leave it do not meet.
    pub primitive: u32,
    /// The piece.
    pub facet: Facet,
    /// The direction in which its front looks.
    pub normal: Vector,
    /// Its area.
    pub area: f64,
}

impl Patch {
    fn new(surface: usize, primitive: u32, facet: Facet) -> Self {
        Self {
            surface,
            primitive,
            normal: facet.normal(),
            area: facet.area(),
            facet,
        }
    }

    /// The middle.
    pub fn centre(&self) -> Vector {
        let share = if self.facet.triangle { 1.0 / 3.0 } else { 0.5 };
        self.facet.origin + (self.facet.first + self.facet.second) * share
    }

    /// The longest edge.
    pub fn size(&self) -> f64 {
        self.facet.first.norm().max(self.facet.second.norm())
    }

    /// Where a function is to be taken so that its mean over the patch is the mean of its values: two Gauss points an axis on a parallelogram,
    /// three points on a triangle. \[Strang & Fix 1973\]
    pub fn nodes(&self) -> Vec<Vector> {
        let Facet {
            origin,
            first,
            second,
            triangle,
        } = self.facet;
        let (low, high) = if triangle {
            (1.0 / 6.0, 2.0 / 3.0)
        } else {
            (0.5 - 0.5 / 3_f64.sqrt(), 0.5 + 0.5 / 3_f64.sqrt())
        };
        let mut shares = vec![(low, low), (high, low), (low, high)];
        if !triangle {
            shares.push((high, high));
        }
        shares
            .into_iter()
            .map(|(s, t)| origin + first * s + second * t)
            .collect()
    }

    /// What a small surface elsewhere receives of this patch's light if nothing stands between (see [`seen`]); 0 behind the front, and from a place
    /// in the plane of the patch: a place on the patch itself must not take it for all that there is to see because rounding has put it above.
    pub fn seen_from(&self, place: Vector, normal: Vector) -> f64 {
        const FLAT: f64 = 1e-9;
        if (place - self.facet.origin).dot(&self.normal) <= FLAT * self.size() {
            return 0.0;
        }
        let Facet {
            origin,
            first,
            second,
            triangle,
        } = self.facet;
        if triangle {
            seen(place, normal, &[origin, origin + first, origin + second])
        } else {
            let far = origin + first + second;
            seen(
                place,
                normal,
                &[origin, origin + first, far, origin + second],
            )
        }
    }

    /// Four parts of equal area and the patch's own shape.
    pub fn quarters(&self) -> [Self; 4] {
        let (a, b) = (self.facet.first * 0.5, self.facet.second * 0.5);
        let part = |origin: Vector, first: Vector, second: Vector| Self {
            facet: Facet {
                origin,
                first,
                second,
                triangle: self.facet.triangle,
            },
            area: 0.25 * self.area,
            ..*self
        };
        let corner = self.facet.origin;
        let last = if self.facet.triangle {
            // the middle one, upside down
            part(corner + a + b, -a, -b)
        } else {
            part(corner + a + b, a, b)
        };
        [
            part(corner, a, b),
            part(corner + a, a, b),
            part(corner + b, a, b),
            last,
        ]
    }
}

/// All flat surfaces of `scene` in patches with no edge longer than `size`, those of a surface one after another. A surface that is not flat has none.
pub fn patches(scene: &Scene, size: f64) -> Vec<Patch> {
    let mut found = Vec::new();
    for (surface, described) in scene.surfaces().iter().enumerate() {
        for (part, facet) in described.shape.facets().iter().enumerate() {
            let Some(primitive) = scene.primitive(surface, part) else {
                continue;
            };
            cut(facet, size, &mut |facet| {
                found.push(Patch::new(surface, primitive, facet));
            });
        }
    }
    found
}

fn cut(facet: &Facet, size: f64, found: &mut dyn FnMut(Facet)) {
    let Facet {
        origin,
        first,
        second,
        triangle,
    } = *facet;
    let parts = |edge: f64| (edge / size).ceil().max(1.0) as usize;
    if !triangle {
        let (m, n) = (parts(first.norm()), parts(second.norm()));
        let (a, b) = (first / m as f64, second / n as f64);
        for i in 0..m {
            for j in 0..n {
                found(Facet {
                    origin: origin + a * i as f64 + b * j as f64,
                    first: a,
                    second: b,
                    triangle,
                });
            }
        }
        return;
    }
    let n = parts(first.norm().max(second.norm()).max((first - second).norm()));
    let (a, b) = (first / n as f64, second / n as f64);
    for i in 0..n {
        for j in 0..n - i {
            let corner = origin + a * i as f64 + b * j as f64;
            found(Facet {
                origin: corner,
                first: a,
                second: b,
                triangle,
            });
            if i + j + 1 < n {
                found(Facet {
                    origin: corner + a + b,
                    first: -a,
                    second: -b,
                    triangle,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Facet, Patch, Vector};

    /// Planes that are not along the axes, so that places in them are off by rounding, to either side.
    #[test]
    fn a_patch_is_not_seen_from_itself() {
        for step in 0..400 {
            let angle = 0.0157 * f64::from(step);
            let first = Vector::new(angle.cos(), 0.1, angle.sin());
            let second = Vector::new(-0.3, 1.0, 0.2 * angle);
            let facet = Facet {
                origin: Vector::new(0.3, -0.7, 0.11),
                first,
                second,
                triangle: false,
            };
            let patch = Patch::new(0, 0, facet);
            let place = facet.origin + first * 0.37 + second * 0.61;
            assert!(patch.seen_from(place, patch.normal) <= 0.0, "{step}");
            // but from just above a surface turned to it, it is nearly all
            let above = place + patch.normal * 1e-4;
            assert!(patch.seen_from(above, -patch.normal) > 0.99, "{step}");
        }
    }
}
