//! The sources of an experiment, opened.

use super::RunError;
use crate::density::{Density, Truth};
use crate::experiment::catalogue::{Builds, Entry};
use crate::experiment::{GridSpec, Limits, PathSpec, SourceSpec, catalogue};
use crate::light::photons::Photons;
use crate::light::reference::Reference;
use crate::light::scene::read;
use crate::parameter::Values;
use crate::sample::{Clustered, Exposed, Sample, Source, file};
use crate::space::{Domain, Field, Grid, GridError, Point};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where samples come from.
pub(super) enum Opened<const D: usize> {
    Density(Arc<dyn Density<D>>),
    /// A density whose points come in paths.
    Paths(Arc<dyn Density<D>>, Arc<dyn Source<D>>),
    /// Points whose truth is no density.
    Exposed(Arc<dyn Exposed<D>>),
    Data(Sample<D>),
}

impl<const D: usize> Opened<D> {
    pub(super) fn domain(&self) -> &Domain<D> {
        match self {
            Self::Density(density) | Self::Paths(density, _) => density.domain(),
            Self::Exposed(source) => source.domain(),
            Self::Data(sample) => sample.domain(),
        }
    }

    pub(super) fn density(&self) -> Option<&Arc<dyn Density<D>>> {
        match self {
            Self::Density(density) | Self::Paths(density, _) => Some(density),
            Self::Exposed(_) | Self::Data(_) => None,
        }
    }

    pub(super) fn field(&self) -> Option<&dyn Field<D>> {
        match self {
            Self::Density(density) | Self::Paths(density, _) => Some(&**density),
            Self::Exposed(source) => Some(source.field()),
            Self::Data(_) => None,
        }
    }
}

/// The truth about each scene that sources share.
pub(super) type Rooms = BTreeMap<PathBuf, Arc<Reference>>;

/// Photon hits on a surface.
fn photons(
    path: &Path,
    surface: &str,
    values: &Values,
    rooms: &mut Rooms,
) -> Result<Photons, RunError> {
    let reference = if let Some(known) = rooms.get(path) {
        known.clone()
    } else {
        let scene = read::scene(path).map_err(|problems| RunError::Input(problems.to_string()))?;
        let reference = Arc::new(Reference::new(Arc::new(scene)));
        rooms.insert(path.to_owned(), reference.clone());
        reference
    };
    let told = |what: &str| RunError::Input(format!("{}: {what}", path.display()));
    let Some((position, _)) = reference.scene().surface(surface) else {
        return Err(told(&format!("there is no surface \"{surface}\"")));
    };
    Photons::new(reference, position, values).map_err(|error| told(&error.to_string()))
}

/// Opens a source.
///
/// # Errors
/// If it cannot be read or built.
pub(super) fn open<const D: usize>(
    spec: &SourceSpec,
    rooms: &mut Rooms,
) -> Result<Opened<D>, RunError>
where
    Entry: Builds<D>,
{
    match spec {
        SourceSpec::Density {
            kind,
            values,
            paths,
            ..
        } => {
            let built = catalogue::density(kind, values)
                .map_err(|error| RunError::Input(error.to_string()))?;
            if let Some(told) = paths {
                return clustered(built, *told);
            }
            let density = Entry::truth(built).ok_or_else(|| {
                RunError::Input(format!("the density {kind} does not have {D} dimensions"))
            })?;
            Ok(Opened::Density(density))
        }
        SourceSpec::Scene {
            path,
            surface,
            values,
            ..
        } => {
            let photons = Arc::new(photons(path, surface, values, rooms)?);
            let place = || RunError::Input("hits on a surface have two coordinates".to_owned());
            Entry::exposed(photons)
                .map(Opened::Exposed)
                .ok_or_else(place)
        }
        SourceSpec::File {
            path,
            columns,
            weight,
            domain,
            ..
        } => {
            let wrong = || RunError::Input(format!("{} columns for {D} axes", columns.len()));
            let named: Vec<file::Column> = columns.iter().map(|c| file::Column::Named(c)).collect();
            let request = file::Request {
                columns: named.try_into().map_err(|_| wrong())?,
                weight: weight.as_deref(),
                domain: Limits::domain(domain.as_ref()).map_err(RunError::Input)?,
            };
            file::read(path, &request)
                .map(Opened::Data)
                .map_err(|error| RunError::Input(error.to_string()))
        }
    }
}

/// A density whose points come in paths.
fn clustered<const D: usize>(centres: Truth, told: PathSpec) -> Result<Opened<D>, RunError>
where
    Entry: Builds<D>,
{
    let unfit = || RunError::Input("`paths` needs a mixture of normals on a line".to_owned());
    let line = centres.line().ok_or_else(unfit)?;
    let parts = line.normal_components().ok_or_else(unfit)?;
    let source = Clustered::new(parts, told.hits, told.spread)
        .map_err(|error| RunError::Input(error.to_string()))?;
    let density = Entry::truth(Truth::Line(Arc::new(source.density().clone())));
    let source = Entry::clustered(source);
    let (density, source) = density.zip(source).ok_or_else(unfit)?;
    Ok(Opened::Paths(density, source))
}

/// Cells over all but 10⁻⁴ of the mass at each end, widened by a fifth of that on both sides so that what an estimator lays beyond shows; a
/// polygon's own box, beyond which nothing counts.
pub(super) fn default_grid<const D: usize>(source: &Opened<D>) -> Result<Grid<D>, GridError> {
    let domain = source.domain();
    let most = GridSpec::default_cells(D);
    let cells = match source {
        Opened::Exposed(source) => [source.resolution().min(most); D],
        _ => [most; D],
    };
    if domain.outline().is_some() || matches!(source, Opened::Exposed(_)) {
        return Grid::new(domain.low(), domain.high(), cells);
    }
    let (mut low, mut high) = match source {
        Opened::Density(density) | Opened::Paths(density, _) => density.bulk(1e-4),
        Opened::Exposed(_) => (domain.low(), domain.high()),
        Opened::Data(sample) => extent(sample),
    };
    for axis in 0..D {
        let margin = 0.2 * (high[axis] - low[axis]);
        (low[axis], high[axis]) = (low[axis] - margin, high[axis] + margin);
    }
    Grid::new(low, high, cells)
}

/// The least box around all points with a weight; data all at one place still deserve a picture.
fn extent<const D: usize>(sample: &Sample<D>) -> (Point<D>, Point<D>) {
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for (i, point) in sample.points().iter().enumerate() {
        if sample.weight(i) > 0.0 {
            for axis in 0..D {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
    }
    for axis in 0..D {
        if high[axis] <= low[axis] {
            let spread = 0.5 * low[axis].abs().max(1.0);
            (low[axis], high[axis]) = (low[axis] - spread, high[axis] + spread);
        }
    }
    (low, high)
}
