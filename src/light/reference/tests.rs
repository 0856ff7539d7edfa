//! The parts of the reference against each other and against closed forms.

use super::cover::cover;
use super::form_factor::{parallel, perpendicular};
use super::{Lamps, Measured, PathTracer, Radiosity, Reference, form_factors, patches};
use crate::light::emission::Emission;
use crate::light::material::{Lambertian, Material};
use crate::light::scene::{Planar, Scene, Shape, Surface};
use crate::light::spectrum::{Colour, Spectrum};
use crate::light::vector::Vector;
use crate::random;
use crate::space::Grid;
use std::sync::Arc;

fn quad(name: &str, corners: [[f64; 3]; 4], rho: [f64; 3], radiance: f64) -> Surface {
    let corners = corners.map(Vector::from);
    Surface {
        name: name.to_owned(),
        shape: Shape::Planar(Planar::new(&corners, None).expect("a quad")),
        material: Arc::new(Material::Lambertian(Lambertian {
            reflectance: Spectrum::Rgb(rho),
        })),
        emission: (radiance > 0.0).then_some(Emission {
            radiance: Spectrum::Flat(radiance),
        }),
    }
}

/// The unit cube seen from inside: floor at z = 0, ceiling at z = 1.
fn cube(rho: [f64; 3], floor: f64, others: f64) -> Vec<Surface> {
    let faces = [
        (
            "floor",
            [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
        ),
        (
            "ceiling",
            [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]],
        ),
        (
            "west",
            [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
        ),
        (
            "east",
            [[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]],
        ),
        (
            "south",
            [[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]],
        ),
        (
            "north",
            [[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]],
        ),
    ];
    let face = |(name, corners)| {
        quad(
            name,
            corners,
            rho,
            if name == "floor" { floor } else { others },
        )
    };
    faces.into_iter().map(face).collect()
}

fn scene(surfaces: Vec<Surface>) -> Arc<Scene> {
    Arc::new(Scene::new(surfaces, Colour::Rgb, false).expect("a scene"))
}

/// A cube with a small lamp near the ceiling and a shelf that throws a shadow.
fn shelf() -> Arc<Scene> {
    let mut surfaces = cube([0.7, 0.4, 0.1], 0.0, 0.0);
    surfaces.push(quad(
        "lamp",
        [
            [0.4, 0.4, 0.98],
            [0.4, 0.6, 0.98],
            [0.6, 0.6, 0.98],
            [0.6, 0.4, 0.98],
        ],
        [0.5; 3],
        10.0,
    ));
    let up = [
        [0.5, 0.3, 0.4],
        [0.9, 0.3, 0.4],
        [0.9, 0.7, 0.4],
        [0.5, 0.7, 0.4],
    ];
    let mut down = up;
    down.reverse();
    surfaces.push(quad("shelf above", up, [0.6; 3], 0.0));
    surfaces.push(quad(
        "shelf below",
        down.map(|[x, y, z]| [x, y, z - 0.01]),
        [0.6; 3],
        0.0,
    ));
    scene(surfaces)
}

#[test]
fn form_factors_of_a_cube_are_those_of_the_books() {
    let cube = scene(cube([0.5; 3], 1.0, 0.0));
    let patches = patches(&cube, 0.25);
    assert_eq!(patches.len(), 96);
    let factors = form_factors(&cube, &patches);
    let between = |from: usize, to: usize| {
        let rows = (0..96).filter(|&i| patches[i].surface == from);
        let sum: f64 = rows
            .map(|i| {
                let row = factors.row(i).iter().zip(&patches);
                row.filter(|(_, p)| p.surface == to)
                    .map(|(f, _)| f)
                    .sum::<f64>()
            })
            .sum();
        sum / 16.0
    };
    let (opposite, beside) = (parallel(1.0, 1.0, 1.0), perpendicular(1.0, 1.0, 1.0));
    for (to, exact) in [
        (0, 0.0),
        (1, opposite),
        (2, beside),
        (3, beside),
        (4, beside),
        (5, beside),
    ] {
        let found = between(0, to);
        assert!(
            (found - exact).abs() < 1e-3 * exact.max(0.1),
            "to {to}: {found} {exact}"
        );
    }
    for i in 0..96 {
        let sum: f64 = factors.row(i).iter().sum();
        assert!((sum - 1.0).abs() < 4e-3, "row {i} sums to {sum}");
        // reciprocity between equal areas
        for j in 0..96 {
            assert!((factors.row(i)[j] - factors.row(j)[i]).abs() < 1e-15);
        }
    }
}

#[test]
fn a_furnace_is_evenly_lit() {
    let rho = [0.0, 0.5, 0.8];
    let furnace = scene(cube(rho, 1.0, 1.0));
    let solved = Radiosity::solve(&furnace, 216).expect("a room");
    let pi = std::f64::consts::PI;
    for place in [[0.5, 0.5, 0.0], [0.03, 0.9, 0.0], [0.25, 0.01, 0.0]] {
        let found = solved
            .irradiance(Vector::from(place), Vector::z())
            .irradiance;
        for c in 0..3 {
            // E = B, since all that is seen has the same radiosity B = M/(1 - ρ)
            let exact = pi / (1.0 - rho[c]);
            assert!(
                (found[c] / exact - 1.0).abs() < 3e-3,
                "{place:?} {c}: {} {exact}",
                found[c]
            );
        }
    }
}

/// Over wavelengths: a furnace that emits 1 W per nm, area and solid angle has B(λ) = π/(1 − ρ) at each, and ∫ȳ = 1 in the units of the record.
#[test]
fn a_furnace_over_wavelengths_is_white() {
    let mut grey = cube([0.5; 3], 1.0, 1.0);
    for surface in &mut grey {
        surface.material = Arc::new(Material::Lambertian(Lambertian {
            reflectance: Spectrum::Flat(0.5),
        }));
    }
    let furnace = Arc::new(Scene::new(grey, Colour::Spectral, false).expect("a scene"));
    let solved = Radiosity::solve(&furnace, 96).expect("a room");
    let found = solved.irradiance(Vector::new(0.3, 0.6, 0.0), Vector::z());
    for value in found.irradiance {
        let exact = std::f64::consts::TAU;
        assert!((value / exact - 1.0).abs() < 3e-3, "{found:?}");
    }
}

#[test]
fn without_reflection_only_the_lamps_light_in_closed_form() {
    let mut dark = cube([0.0; 3], 0.0, 0.0);
    dark[1] = quad(
        "ceiling",
        [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]],
        [0.0; 3],
        1.0,
    );
    let dark = scene(dark);
    let solved = Radiosity::solve(&dark, 96).expect("a room");
    let lamps = Lamps::of(&dark);
    let mut random = random::stream(1, "test", 0);
    let tracer = PathTracer::new(&dark).expect("three channels");
    for place in [[0.5, 0.5, 0.0], [0.1, 0.8, 0.0]].map(Vector::from) {
        let closed = lamps.irradiance(&dark, place, Vector::z())[0];
        let gathered = solved.irradiance(place, Vector::z()).irradiance[0];
        assert!(
            (gathered / closed - 1.0).abs() < 1e-3,
            "{gathered} {closed}"
        );
        let draw = || tracer.irradiance(place, Vector::z(), Some(0), &mut random);
        let traced = Measured::of(4000, draw);
        let off = (traced.mean[0] - closed).abs() / traced.error[0];
        assert!(off < 4.0, "{traced:?} {closed}");
    }
}

/// Two methods that share nothing but rays: full shadow, penumbra, under the shelf and on it.
#[test]
fn the_balance_of_light_is_what_paths_find() {
    let shelf = shelf();
    let reference = Reference::new(shelf.clone());
    let tracer = PathTracer::new(&shelf).expect("three channels");
    let mut worst: f64 = 0.0;
    for (surface, chart) in [
        (0, [0.2, 0.5]),
        (0, [0.75, 0.5]),
        (0, [0.42, 0.5]),
        (7, [0.2, 0.2]),
        (8, [0.2, 0.2]),
        (3, [0.3, 0.3]),
    ] {
        let shape = &shelf.surfaces()[surface].shape;
        let place = shape.place(0, chart[0], chart[1]);
        let normal = shape.normal(0, place);
        let mut random = random::stream(2, "test", surface as u64);
        let own = shelf.primitive(surface, 0);
        let draw = || tracer.irradiance(place, normal, own, &mut random);
        let traced = Measured::of(30_000, draw);
        let solved = reference.irradiance(surface, chart);
        for c in 0..3 {
            // the balance may be off by half a per cent
            let room = traced.error[c].hypot(5e-3 * solved[c]);
            worst = worst.max((traced.mean[c] - solved[c]).abs() / room);
        }
    }
    assert!(worst < 4.0, "{worst} standard errors");
}

/// The irradiance at places on surfaces, by balance, in per cent of what paths find: the mean of the three channels, and its standard error.
fn off(room: &Arc<Scene>, patches: usize, places: &[(usize, [f64; 2])]) -> Vec<[f64; 2]> {
    let solved = Radiosity::solve(room, patches).expect("a room");
    let tracer = PathTracer::new(room).expect("three channels");
    let at = |&(surface, chart): &(usize, [f64; 2])| {
        let shape = &room.surfaces()[surface].shape;
        let place = shape.place(0, chart[0], chart[1]);
        let (normal, own) = (shape.normal(0, place), room.primitive(surface, 0));
        let mut random = random::stream(3, "test", surface as u64);
        let traced = Measured::of(PATHS, || {
            let light = tracer.irradiance(place, normal, own, &mut random);
            [light.iter().sum::<f64>() / 3.0, 0.0, 0.0]
        });
        let found = solved.irradiance(place, normal).irradiance;
        let found = found.iter().sum::<f64>() / 3.0;
        [
            found / traced.mean[0] - 1.0,
            traced.error[0] / traced.mean[0],
        ]
        .map(|v| 100.0 * v)
    };
    places.iter().map(at).collect()
}

const PATHS: usize = 20_000;

/// A lamp of a half by a half in the middle of a room, black on the back that the ceiling and the walls look at: what they send there is lost, and is not what
/// quadrature has missed. Patches as coarse as these leave a few per cent; rows that are made to sum to 1 would give back the tenths that are lost.
#[test]
fn light_that_goes_to_a_back_is_lost() {
    let mut surfaces = cube([0.8; 3], 0.0, 0.0);
    let corners = [
        [0.25, 0.25, 0.5],
        [0.25, 0.75, 0.5],
        [0.75, 0.75, 0.5],
        [0.75, 0.25, 0.5],
    ];
    surfaces.push(quad("lamp", corners, [0.5; 3], 1.0));
    let room = scene(surfaces);
    for [off, error] in off(&room, 384, &[(1, [0.1, 0.5]), (2, [0.5, 0.9])]) {
        assert!(off.abs() < 4.0 * error + 5.0, "{off} % ± {error} %");
    }
}

/// A panel over five eighths of the floor, far above it and all but touching it: only then are the patches under it covered, one column of them in half.
#[test]
fn what_hangs_above_a_patch_does_not_stand_on_it() {
    let floor = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    let panel = |z| [[0., 0., z], [0.625, 0., z], [0.625, 1., z], [0., 1., z]];
    for (height, free) in [(0.6, [1.0; 4]), (1e-4, [0.0, 0.0, 0.5, 1.0])] {
        let surfaces = vec![
            quad("floor", floor, [0.8; 3], 0.0),
            quad("panel", panel(height), [0.8; 3], 1.0),
        ];
        let open = Scene::new(surfaces, Colour::Rgb, true).expect("a scene");
        let floor = patches(&open, 0.25).into_iter().filter(|p| p.surface == 0);
        for patch in floor {
            let column = (4.0 * patch.centre().x) as usize;
            let found = cover(&open, &patch);
            assert_eq!(found.free.to_bits(), f64::to_bits(free[column]), "{height}");
            assert!(!found.enclosed || found.free <= 0.0);
        }
    }
}

#[test]
fn means_of_cells_are_means() {
    let shelf = shelf();
    let reference = Reference::new(shelf);
    let coarse = Grid::new([0.0; 2], [1.0; 2], [2, 2]).expect("a grid");
    let fine = Grid::new([0.0; 2], [1.0; 2], [4, 4]).expect("a grid");
    let (coarse, fine) = (
        reference.cell_means(1, &coarse, 4),
        reference.cell_means(1, &fine, 2),
    );
    for c in 0..3 {
        let mean =
            |values: &[[f64; 3]]| values.iter().map(|v| v[c]).sum::<f64>() / values.len() as f64;
        assert!((mean(&coarse) - mean(&fine)).abs() < 1e-12);
    }
}

#[test]
fn what_radiosity_is_not_for_is_told() {
    let mut surfaces = cube([0.5; 3], 1.0, 0.0);
    surfaces[2].material = Arc::new(Material::Mirror(crate::light::material::Mirror {
        reflectance: Spectrum::Flat(0.9),
    }));
    let glossy = scene(surfaces);
    let told = Radiosity::solve(&glossy, 96).err().expect("a mirror");
    assert_eq!(
        told.to_string(),
        "radiosity needs diffuse surfaces, and \"west\" is not"
    );
    // and paths take over: the mirror doubles nothing, it only turns light round
    let reference = Reference::new(glossy);
    assert!(reference.solved().is_none());
    assert!(reference.irradiance(1, [0.5, 0.5])[0] > 0.0);
}
