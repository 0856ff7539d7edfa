//! Which figures a run draws.

use crate::support::Bench;

fn experiment(sources: &str, estimators: &[&str]) -> String {
    let estimators = estimators
        .iter()
        .map(|name| format!("[[estimator]]\nname = \"{name}\"\nhistogram = {{ width = 0.5 }}\n"));
    format!(
        "question = \"?\"\nseed = 1\nsource = {{ density = {sources} }}\ndraws = 50\nreplicates = 4\ngrid = {{ low = -3, high = 3, cells = 24 }}\n{}[[figure]]\nerrors = {{ measure = \"mise\" }}\n",
        estimators.collect::<String>()
    )
}

/// Sources are beside each other in one figure where one estimator is compared on them, and have one each where several estimators are.
#[test]
fn one_estimator_on_several_sources_is_one_figure_of_errors() {
    for (sources, estimators, figures) in [
        ("[\"normal\", \"bimodal\"]", &["a"][..], 1),
        ("[\"normal\", \"bimodal\"]", &["a", "b"][..], 2),
        ("\"normal\"", &["a"][..], 1),
    ] {
        let bench = Bench::new().with("x.toml", experiment(sources, estimators));
        bench
            .run(&["run", "x.toml", "--out", "o", "--quiet"])
            .succeeds();
        let drawn: Vec<String> = std::fs::read_dir(bench.path("o/figures"))
            .expect("a folder of figures")
            .map(|file| std::fs::read_to_string(file.expect("a file").path()).expect("text"))
            .collect();
        assert_eq!(drawn.len(), figures, "{sources} {estimators:?}");
        if sources.starts_with('[') && estimators.len() == 1 {
            assert!(drawn[0].contains("normal") && drawn[0].contains("bimodal"));
        }
    }
}

/// An experiment about hits on the floor of a shipped scene, with a picture of these settings.
fn pictured(scene: &str, walk: &str, camera: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    let file = folder.join(scene).display().to_string();
    let estimators = ["fine = 0.25", "coarse = 2.0", "many = 0"].map(|told| {
        let (name, width) = told.split_once(" = ").expect("two parts");
        let estimator = if name == "many" {
            "nearest-neighbour = { k = 1500 }".to_owned()
        } else {
            format!("histogram = {{ width = {width} }}")
        };
        format!("[[estimator]]\nname = \"{name}\"\n{estimator}\n")
    });
    format!(
        "question = \"?\"\nseed = 1\nsource = {{ scene = {{ file = {file:?}{walk} }}, surface = [\"floor\"] }}\ndraws = 20000\nreplicates = 2\ngrid = {{ low = [0, 0], high = [2, 2], cells = [4, 4] }}\n{}[[figure]]\ntitle = \"Room\"\ncamera = {{ {camera} }}\n",
        estimators.concat()
    )
}

/// A picture of each estimator beside the one by paths and a map of what is wrong with each, named with its error; who cannot be fitted to the hits on a small surface is
/// said to be missing.
#[test]
fn a_camera_shows_each_estimator_and_what_is_wrong_with_it() {
    let text = pictured(
        "cornell-box-rgb.toml",
        "",
        "width = 24, height = 20, rays = 1, paths = 16",
    );
    let bench = Bench::new().with("x.toml", text);
    bench
        .run(&["run", "x.toml", "--out", "o", "--quiet"])
        .succeeds();
    let pictures = bench.text("o/figures/01-room.svg");
    let wrong = bench.text("o/figures/02-room-errors.svg");
    assert_eq!(pictures.matches("data:image/png").count(), 3);
    assert!(pictures.contains("traced, 16 paths a place"));
    let error = |name: &str| {
        let (_, rest) = wrong
            .split_once(&format!(">{name}: "))
            .expect("its title over a map");
        let (number, _) = rest.split_once(" %").expect("per cent");
        number.parse::<f64>().expect("a number")
    };
    let [fine, coarse] = ["fine", "coarse"].map(error);
    assert!(
        fine > 1.0 && fine < 40.0 && coarse > 1.2 * fine,
        "{fine} {coarse}"
    );
    let report = bench.text("o/report.html");
    assert!(report.contains("“many” is not shown"), "{report}");
    assert!(report.contains("20000 photons"));
}

#[test]
fn cameras_that_show_nothing_are_refused() {
    for (scene, walk, camera, says) in [
        ("floor-cube.toml", "", "", "has no camera"),
        ("cornell-box.toml", "", "paths = 4", "colour by wavelength"),
        (
            "cornell-box-rgb.toml",
            ", light = \"direct\"",
            "",
            "not every hit",
        ),
        ("cornell-box-rgb.toml", "", "width = 5000", "1 to 4096"),
        (
            "cornell-box-rgb.toml",
            "",
            "paths = 4, reference = true",
            "one of `paths` and `reference`",
        ),
        (
            "cornell-box-rgb.toml",
            "",
            "width = 4096, height = 4096, rays = 16",
            "too large",
        ),
    ] {
        let bench = Bench::new().with("x.toml", pictured(scene, walk, camera));
        bench
            .run(&["check", "x.toml"])
            .ends_with(2)
            .says(says)
            .says("x.toml:");
    }
    let text = experiment("\"normal-2d\"", &["a"]);
    let text = text.replace("errors = { measure = \"mise\" }", "camera = {}");
    let text = text.replace("grid = { low = -3, high = 3, cells = 24 }\n", "");
    let bench = Bench::new().with("x.toml", text);
    bench
        .run(&["check", "x.toml"])
        .ends_with(2)
        .says("photons in a scene");
}

/// In a white furnace every pixel is as bright as every other: with one bin a wall and two million photons a picture is right to a fifth of a per cent, and half a per cent more or
/// less of the light that walls return would be seen.
#[test]
fn a_camera_in_a_furnace_sees_it_as_bright_as_it_is() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
    let furnace = std::fs::read_to_string(folder.join("furnace.toml")).expect("a shipped scene");
    let camera = "[camera]\nposition = [0.5, 0.5, 0.9]\ndirection = [0.1, 0.2, -1.0]\nup = [0.0, 1.0, 0.0]\nfield-of-view = 80.0\n";
    let text = "question = \"?\"\nseed = 3\nsource = { scene = \"room.toml\", surface = \"floor\" }\ndraws = 2000000\nreplicates = 2\n[[estimator]]\nname = \"walls\"\nhistogram = { width = 1.0 }\n[[figure]]\ntitle = \"Room\"\ncamera = { width = 16, height = 16, rays = 1, reference = true }\n";
    let bench = Bench::new()
        .with("room.toml", format!("{furnace}\n{camera}"))
        .with("x.toml", text);
    bench
        .run(&["run", "x.toml", "--out", "o", "--quiet"])
        .succeeds();
    let wrong = bench.text("o/figures/02-room-errors.svg");
    let (_, rest) = wrong.split_once(">walls: ").expect("its title over a map");
    let (number, _) = rest.split_once(" %").expect("per cent");
    let error: f64 = number.parse().expect("a number");
    assert!(error < 0.2, "{error}");
}
