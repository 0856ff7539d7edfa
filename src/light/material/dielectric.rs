//! Glass and water.

use super::mirror::mirrored;
use super::{Scattered, Spectrum, Vector};
use rand::{Rng, RngExt};

/// Nothing is absorbed.
pub(super) static CLEAR: Spectrum = Spectrum::Flat(1.0);

/// A clear body: its surface reflects a share of the light that Fresnel's equations give and refracts the rest. The front is outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    /// The refractive index of the inside, relative to the outside.
    pub index: f64,
}

/// The share of unpolarised light that is reflected where light passes to a medium of relative `index`, and the cosine on the other side;
/// 1 and 0 for total reflection. `cos` is the cosine of the angle of incidence, not negative. [Fresnel 1823; Snell]
pub fn fresnel(cos: f64, index: f64) -> (f64, f64) {
    let sin2 = (1.0 - cos * cos).max(0.0) / (index * index);
    if sin2 >= 1.0 {
        return (1.0, 0.0);
    }
    let through = (1.0 - sin2).sqrt();
    let perpendicular = (cos - index * through) / (cos + index * through);
    let parallel = (index * cos - through) / (index * cos + through);
    (
        0.5 * (perpendicular * perpendicular + parallel * parallel),
        through,
    )
}

impl Dielectric {
    #[inline]
    pub(super) fn scatter(
        &self,
        incoming: Vector,
        normal: Vector,
        front: bool,
        random: &mut impl Rng,
    ) -> Scattered {
        let (facing, index) = if front {
            (normal, self.index)
        } else {
            (-normal, 1.0 / self.index)
        };
        let cos = (-incoming.dot(&facing)).max(0.0);
        let (reflected, through) = fresnel(cos, index);
        let direction = if random.random::<f64>() < reflected {
            mirrored(incoming, facing)
        } else {
            (incoming / index + facing * (cos / index - through)).normalize()
        };
        Scattered {
            direction,
            factor: 1.0,
        }
    }
}
