//! The hits of photons on one surface as a source of samples like any other.

#[cfg(test)]
mod tests;

use crate::density::Density;
use crate::light::hits::{Hits, Record};
use crate::light::reference::{Light, Reference, SurfaceTruth};
use crate::light::scene::{Scene, Shape};
use crate::light::walk::{Power, Walk, WalkError};
use crate::parameter::{Absent, BuildError, Kind, Parameter, Values};
use crate::random::Stream;
use crate::sample::{Exposed, Sample, SampleError, Source};
use crate::space::{Domain, Field};
use rand::Rng;
use std::sync::Arc;

/// What a walk of photons may be told.
pub const WALK: &[Parameter] = &[
    Parameter::optional(
        "power",
        Kind::Choice(&["same", "attenuated"]),
        Absent::Word("same"),
        "what happens at a surface: photons survive with the share of their power that is reflected, or go on with less",
    ),
    Parameter::optional(
        "threshold",
        Kind::Between(0.0, 1.0),
        Absent::Unset,
        "with attenuated power: the share of a photon's first power below which roulette begins; 0.1 if not given",
    ),
    Parameter::optional(
        "kill",
        Kind::Between(0.0, 1.0),
        Absent::Unset,
        "with attenuated power: the probability with which roulette ends a path; 0.5 if not given",
    ),
    Parameter::optional(
        "light",
        Kind::Choice(&["all", "direct", "indirect"]),
        Absent::Word("all"),
        "which hits count: all, the first of each path, or the others",
    ),
    Parameter::optional(
        "score",
        Kind::Choice(&["collision", "survival", "absorption"]),
        Absent::Word("collision"),
        "when a path scores: at each hit, at each that it survives (weighted by 1/albedo), or where it ends (weighted by 1/(1 - albedo))",
    ),
];

/// When a path scores at a surface; each has irradiance for its mean. (See [`discrete`](crate::light::reference::discrete) for their theory.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Score {
    Collision,
    Survival,
    Absorption,
}

/// Emitted paths in, weighted points out: each hit of one surface with the power that arrived there, divided by the number of emitted paths. The truth is
/// the surface's irradiance, all channels together.
pub struct Photons {
    scene: Arc<Scene>,
    surface: usize,
    power: Power,
    light: Light,
    score: Score,
    domain: Domain<2>,
    truth: SurfaceTruth,
}

fn error(parameter: &'static str, what: &str) -> BuildError {
    BuildError {
        parameter,
        what: what.to_owned(),
    }
}

/// What happens to a photon's power, as `values` (see [`WALK`]) say.
///
/// # Errors
/// If the roulette is told how, and there is none.
pub fn power(values: &Values) -> Result<Power, BuildError> {
    let attenuated = values.word("power") == Some("attenuated");
    let told = ["threshold", "kill"]
        .into_iter()
        .find(|name| values.number(name).is_some());
    if let Some(parameter) = told.filter(|_| !attenuated) {
        return Err(error(parameter, "roulette is for power = \"attenuated\""));
    }
    Ok(if attenuated {
        Power::Attenuated {
            threshold: values.number("threshold").unwrap_or(0.1),
            kill: values.number("kill").unwrap_or(0.5),
        }
    } else {
        Power::Same
    })
}

/// Whether every hit counts, as `values` (see [`WALK`]) say: what a picture of all light is made of.
pub fn counts_all(values: &Values) -> bool {
    matches!(values.word("light"), None | Some("all"))
        && matches!(values.word("score"), None | Some("collision"))
}

/// The walk of so many paths that makes one sample of every surface: `random` gives its seed.
///
/// # Errors
/// If their number is not legal.
pub fn walk<'s>(
    scene: &'s Scene,
    power: Power,
    draws: usize,
    random: &mut Stream,
) -> Result<Walk<'s>, WalkError> {
    Walk::new(scene, power, draws as u64, random.next_u64())
}

impl Photons {
    /// Hits on the surface at a position in the reference's scene, walked as `values` (see [`WALK`]) say.
    ///
    /// # Errors
    /// If the surface is a mesh, whose points have no pair of coordinates, or the values do not go together.
    pub fn new(
        reference: Arc<Reference>,
        surface: usize,
        values: &Values,
    ) -> Result<Self, BuildError> {
        let scene = reference.scene().clone();
        let power = power(values)?;
        let score = match values.word("score") {
            Some("survival") => Score::Survival,
            Some("absorption") => Score::Absorption,
            _ => Score::Collision,
        };
        if score != Score::Collision && power != Power::Same {
            return Err(error(
                "score",
                "where paths are absorbed is known of photons that keep their power",
            ));
        }
        let light = match values.word("light") {
            Some("direct") => Light::Direct,
            Some("indirect") => Light::Indirect,
            _ => Light::All,
        };
        let mesh = || {
            error(
                "surface",
                "a mesh, whose points have no pair of coordinates",
            )
        };
        Ok(Self {
            domain: scene.surfaces()[surface].domain().ok_or_else(mesh)?.clone(),
            truth: SurfaceTruth::new(reference, surface, light).ok_or_else(mesh)?,
            scene,
            surface,
            power,
            light,
            score,
        })
    }

    /// The hits that count, each with what it scores.
    fn scored(&self, hits: &Hits) -> Option<Result<Sample<2>, SampleError>> {
        let light = self.light;
        let counts = move |record: &Record| match light {
            Light::All => true,
            Light::Direct => record.bounce == 1,
            Light::Indirect => record.bounce > 1,
        };
        if self.score == Score::Collision {
            return hits.sample_of(&self.scene, self.surface, 1.0, counts);
        }
        // the last arrival of a path is where it was absorbed
        let mut last = vec![0u16; hits.paths() as usize];
        for surface in 0..self.scene.surfaces().len() {
            for record in hits.on(surface) {
                let last = &mut last[record.path as usize];
                *last = (*last).max(record.bounce);
            }
        }
        // but for paths that left the scene or met a back, which survived that too
        for &path in hits.astray() {
            last[path as usize] = u16::MAX;
        }
        let ends = |record: &Record| last[record.path as usize] == record.bounce;
        let survival = self.score == Score::Survival;
        let found = hits.sample_of(&self.scene, self.surface, 1.0, |record| {
            counts(record) && ends(record) != survival
        })?;
        let albedo = self.scene.surfaces()[self.surface]
            .material
            .reflectance()
            .rgb();
        Some(found.and_then(|sample| {
            let channels: Vec<Sample<2>> = (0..3).map(|c| sample.channel(c)).collect();
            let weigh = |i: usize| {
                let flux = [0, 1, 2].map(|c: usize| channels[c].weight(i));
                let kept: f64 = (0..3).map(|c| flux[c] * albedo[c]).sum();
                let share = kept / flux.iter().sum::<f64>();
                flux.map(|f| f / if survival { share } else { 1.0 - share })
            };
            let weighed: Vec<[f64; 3]> = (0..sample.len()).map(weigh).collect();
            let channels = (0..3)
                .map(|c| weighed.iter().map(|w| w[c]).collect())
                .collect();
            Sample::with_channels(sample.points().to_vec(), channels, self.domain.clone())
        }))
    }
}

impl Source<2> for Photons {
    /// Points come in paths and with weights: no density generates them independently.
    fn truth(&self) -> Option<&dyn Density<2>> {
        None
    }

    /// So many paths, walked with a seed from the stream.
    fn sample(&self, draws: usize, random: &mut Stream) -> Result<Sample<2>, SampleError> {
        let hits = walk(&self.scene, self.power, draws, random).and_then(|walk| walk.run());
        let (hits, _) = hits.map_err(|error| SampleError::Source(error.to_string()))?;
        self.scored(&hits).unwrap_or(Err(SampleError::Empty))
    }
}

impl Exposed<2> for Photons {
    fn domain(&self) -> &Domain<2> {
        &self.domain
    }

    fn field(&self) -> &dyn Field<2> {
        &self.truth
    }

    fn resolution(&self) -> usize {
        RESOLUTION
    }

    fn frame(&self) -> Option<[[f64; 3]; 3]> {
        let Shape::Planar(planar) = &self.scene.surfaces()[self.surface].shape else {
            return None;
        };
        let [first, second] = planar.axes();
        Some([planar.corners()[0], first, second].map(Into::into))
    }
}

/// Cells of each axis at which the truth is looked up: half a second for the floor of the Cornell box at 32 × 32.
const RESOLUTION: usize = 32;
