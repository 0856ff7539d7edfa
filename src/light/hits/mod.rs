//! Where photons arrived: weighted points on surfaces.
//!
//! A hit is flux *before* absorption, so that the density of hits over a surface, weighted by their flux, is irradiance. Weights are Φ/N where N
//! counts **emitted** paths, never hits. Coordinates and fluxes are kept in single precision, 36 bytes a hit.

#[cfg(feature = "parquet")]
mod columns;
mod file;
mod record;
mod spool;

#[cfg(feature = "parquet")]
pub use columns::Columns;
pub use file::{Format, HitsError, read};
pub use record::{Record, folded};
pub use spool::{Piece, Spool};

use super::cie;
use super::scene::{Scene, Shape};
use super::spectrum::Colour;
use crate::sample::{Sample, SampleError};

/// The hits of a walk, by surface, within a surface in the order of paths.
#[derive(Clone, Debug, Default)]
pub struct Hits {
    surfaces: Vec<Vec<Record>>,
    paths: u64,
    astray: Vec<u32>,
}

impl Hits {
    /// No hits yet, on so many surfaces, of a walk of so many paths.
    pub fn new(surfaces: usize, paths: u64) -> Self {
        Self {
            surfaces: vec![Vec::new(); surfaces],
            paths,
            astray: Vec::new(),
        }
    }

    /// Sorts further hits to their surfaces.
    pub fn extend(&mut self, records: &[Record]) {
        for record in records {
            self.surfaces[record.surface as usize].push(*record);
        }
    }

    /// Remembers paths that ended on no front.
    pub fn lose(&mut self, paths: &[u32]) {
        self.astray.extend_from_slice(paths);
    }

    /// The paths that ended on no front, but left the scene or met a back: their last hit is one that they survived.
    pub fn astray(&self) -> &[u32] {
        &self.astray
    }

    /// Makes room for `factor` times the hits that there are.
    pub fn reserve(&mut self, factor: f64) {
        for records in &mut self.surfaces {
            let wanted = records.len() as f64 * factor;
            records.reserve_exact(wanted as usize);
        }
    }

    /// The emitted paths N.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// The hits on a surface.
    pub fn on(&self, surface: usize) -> &[Record] {
        &self.surfaces[surface]
    }

    /// How many hits there are.
    pub fn len(&self) -> usize {
        self.surfaces.iter().map(Vec::len).sum()
    }

    /// Whether nothing was hit.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The hits on a surface of `scene` as a sample over its chart, one channel for each of the scene's [`Colour`]: red, green, blue, or X, Y, Z.
    /// Its density is irradiance. `None` for a mesh, which has no chart.
    ///
    /// # Errors
    /// If there are no hits, or none carries light.
    pub fn sample(&self, scene: &Scene, surface: usize) -> Option<Result<Sample<2>, SampleError>> {
        self.sample_of(scene, surface, 1.0, |_| true)
    }

    /// The same of the hits that `keep` picks, their flux times `factor`: direct light by `bounce == 1`, a half by `path % 2 == 0` and factor 2.
    ///
    /// # Errors
    /// As [`Hits::sample`].
    pub fn sample_of(
        &self,
        scene: &Scene,
        surface: usize,
        factor: f64,
        keep: impl Fn(&Record) -> bool,
    ) -> Option<Result<Sample<2>, SampleError>> {
        let shape = &scene.surfaces()[surface].shape;
        let domain = shape.domain()?.clone();
        let mut points = Vec::new();
        let mut channels = vec![Vec::new(); 3];
        for record in self.surfaces[surface].iter().filter(|record| keep(record)) {
            points.push(inside(shape, record));
            for (channel, flux) in channels.iter_mut().zip(record.flux) {
                channel.push(f64::from(flux) * factor);
            }
        }
        Some(Sample::with_channels(points, channels, domain))
    }
}

/// The coordinates of a hit; single precision may have put them beside the chart.
pub fn inside(shape: &Shape, record: &Record) -> [f64; 2] {
    let [u, v] = [f64::from(record.u), f64::from(record.v)];
    match shape {
        Shape::Planar(planar) => planar.inside([u, v]),
        Shape::Sphere(_) => {
            let high = shape.domain().map_or([u, v], crate::space::Domain::high);
            [u.clamp(0.0, high[0]), v.clamp(0.0, high[1])]
        }
        Shape::Mesh(_) => [u, v],
    }
}

/// The flux of a hit as red, green and blue, whatever the colour of the scene.
pub fn linear_rgb(colour: Colour, flux: [f32; 3]) -> [f64; 3] {
    let flux = flux.map(f64::from);
    match colour {
        Colour::Rgb => flux,
        Colour::Spectral => cie::linear_srgb(flux),
    }
}
