//! The scenes that come with the laboratory, and files that are no scenes.
#![allow(clippy::unwrap_used)]

use density_lab::light::scene::{self, Scene, Shape};
use density_lab::light::spectrum::Colour;
use density_lab::light::vector::{Ray, Vector};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes")
}

fn shipped(name: &str) -> Scene {
    match scene::read::scene(&folder().join(name)) {
        Ok(scene) => scene,
        Err(problems) => panic!("{problems}"),
    }
}

#[test]
fn every_shipped_scene_is_a_scene() {
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| Path::new(name).extension() == Some("toml".as_ref()))
        .collect();
    names.sort();
    assert!(names.len() >= 9, "{names:?}");
    for name in names {
        let scene = shipped(&name);
        assert!(!scene.title.is_empty(), "{name} has no title");
        assert_eq!(
            scene.colour == Colour::Spectral,
            name == "cornell-box.toml" || name == "cornell-box-empty.toml",
            "{name}"
        );
    }
}

#[test]
fn the_measured_box_has_its_published_areas() {
    let scene = shipped("cornell-box.toml");
    let area = |name: &str| scene.surface(name).unwrap().1.area();
    assert!((area("light") - 130.0 * 105.0).abs() < 1e-9);
    assert!((area("floor") - 0.5 * (552.8 + 549.6) * 559.2).abs() < 1e-6);
    assert!((area("right_wall") - 559.2 * 548.8).abs() < 1e-6);
    assert_eq!(scene.surfaces().len(), 17);
    // seen from the camera through the open front
    let camera = scene.camera.unwrap();
    let hit = scene
        .hit(&Ray::new(camera.position, camera.direction))
        .unwrap();
    assert_eq!(scene.surfaces()[hit.surface].name, "tall_block_front");
    assert!(hit.front);
}

#[test]
fn rays_find_surfaces_and_their_coordinates() {
    let scene = shipped("cornell-box-rgb.toml");
    let down = Vector::new(0.0, -1.0, 0.0);
    let hit = scene
        .hit(&Ray::new(Vector::new(-0.5, 0.5, 0.8), down))
        .unwrap();
    assert_eq!(scene.surfaces()[hit.surface].name, "floor");
    assert!((hit.u - 0.5).abs() < 1e-12 && (hit.v - 1.8).abs() < 1e-12);
    assert!((hit.distance - 1.5).abs() < 1e-12);
    assert!((hit.normal + down).norm() < 1e-12);
    // from the camera the virtual front is seen through
    let camera = scene.camera.unwrap();
    let ray = Ray::new(camera.position, camera.direction);
    assert!(!scene.hit(&ray).unwrap().front);
    let seen = scene.seen(&ray).unwrap();
    assert!((seen.place - ray.at(seen.distance)).norm() < 1e-12);
    assert_ne!(scene.surfaces()[seen.surface].name, "front_open");
    // the lamp hides the ceiling from the floor
    let floor = Vector::new(0.0, -1.0, 0.0);
    assert!(!scene.visible(floor, Vector::new(0.0, 1.0, 0.0)));
    assert!(scene.visible(floor, Vector::new(0.0, 0.99, 0.0)));
}

#[test]
fn charts_keep_areas_and_come_back() {
    let scene = shipped("cornell-box.toml");
    for surface in scene
        .surfaces()
        .iter()
        .chain(shipped("sphere.toml").surfaces())
    {
        let domain = surface.domain().unwrap();
        assert!(
            (domain.measure() / surface.area() - 1.0).abs() < 1e-12,
            "{}",
            surface.name
        );
        for k in 0..50 {
            let [r, s, t] =
                [0.754_877, 0.569_84, 0.362_1].map(|step| (0.5 + step * f64::from(k)).fract());
            let (part, place) = surface.shape.draw(r, s, t);
            let [u, v] = surface.shape.coordinates(part, place);
            assert!(domain.contains([u, v]), "{} {u} {v}", surface.name);
            assert!(
                (surface.shape.place(part, u, v) - place).norm() < 1e-9,
                "{}",
                surface.name
            );
        }
    }
    assert!(matches!(
        shipped("sphere.toml").surfaces()[0].shape,
        Shape::Sphere(_)
    ));
}

/// What is wrong with `text`, as it is told.
fn told(text: &str) -> String {
    match scene::read::scene_text(text, Path::new("room.toml")) {
        Ok(_) => panic!("this was read as a scene:\n{text}"),
        Err(problems) => problems.to_string(),
    }
}

const GOOD: &str = "\
[material.white]
lambertian = { reflectance = 0.8 }

[[surface]]
name = \"floor\"
material = \"white\"
quad = { origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }
emission = { radiance = 1.0 }
";

/// What is changed, into what, at which line the fault is told, and what is told.
const FAULTS: &[[&str; 4]] = &[
    ["u = [1, 0, 0]", "u = [0, 0, 0]", ":7:", "enclose no area"],
    ["u = [1, 0, 0]", "u = [0, 0, 2]", ":7:", "enclose no area"],
    ["u = [1, 0, 0]", "u = [nan, 0, 0]", ":7:", "finite"],
    ["u = [1, 0, 0]", "u = [1, 0]", ":7:", "three numbers"],
    [
        "reflectance = 0.8",
        "reflectance = 1.2",
        ":2:",
        "from 0 to 1",
    ],
    [
        "reflectance = 0.8",
        "reflectance = nan",
        ":2:",
        "from 0 to 1",
    ],
    [
        "reflectance = 0.8",
        "reflectance = [0.1, 0.2]",
        ":2:",
        "2 numbers",
    ],
    [
        "reflectance = 0.8",
        "reflectance = { file = \"nowhere.csv\", column = \"white\" }",
        ":2:",
        "nowhere.csv",
    ],
    [
        "reflectance",
        "reflectence",
        ":2:",
        "did you mean `reflectance`",
    ],
    [
        "lambertian",
        "lambertain",
        ":2:",
        "did you mean `lambertian`",
    ],
    [
        "material = \"white\"",
        "material = \"whit\"",
        ":6:",
        "did you mean `white`",
    ],
    ["emission = { radiance = 1.0 }", "", "", "no surface emits"],
    ["radiance = 1.0", "radiance = 0.0", "", "no surface emits"],
    [
        "radiance = 1.0",
        "radiance = -1.0",
        ":8:",
        "`radiance` must be",
    ],
    [
        "radiance = 1.0",
        "radiance = inf",
        ":8:",
        "`radiance` must be",
    ],
    [
        "quad = { origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }",
        "quad = { corners = [[0,0,0],[1,0,0],[1,1,0],[0,1,0.1]] }",
        ":7:",
        "two triangles",
    ],
    [
        "quad = { origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }",
        "quad = { corners = [[0,0,0],[1,0,0],[0.1,0.1,0],[0,1,0]] }",
        ":7:",
        "points inward",
    ],
    [
        "quad = { origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }",
        "mesh = { file = \"nowhere.obj\" }",
        ":7:",
        "nowhere.obj",
    ],
    [
        "quad = { origin = [0, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }",
        "sphere = { centre = [0, 0, 0], radius = 0 }",
        ":7:",
        "above 0",
    ],
    ["name = \"floor\"", "", ":4:", "needs `name`"],
    [
        "emission = {",
        "facing = [1, 0, 0]\nemission = {",
        ":8:",
        "lies in the plane",
    ],
];

#[test]
fn faults_are_told_with_their_place() {
    assert!(scene::read::scene_text(GOOD, Path::new("room.toml")).is_ok());
    for [what, fault, place, message] in FAULTS {
        assert!(GOOD.contains(*what), "{what}");
        let told = told(&GOOD.replacen(*what, fault, 1));
        assert!(
            told.contains(&format!("room.toml{place}")),
            "{fault}:\n{told}"
        );
        assert!(told.contains(*message), "{fault}:\n{told}");
    }
    assert!(told("").contains("`surface`"));
    let twice = format!("{GOOD}{}", &GOOD[GOOD.find("[[").unwrap()..]);
    assert!(told(&twice).contains("already"));
}
