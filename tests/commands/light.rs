//! `lab irradiance` and `lab render`

use crate::support::Bench;
use std::fs;

fn scene(name: &str) -> String {
    format!("{}/data/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

const SQUARES: &str = "histogram = { width = 0.5 }";

#[test]
fn a_ceiling_receives_what_the_floor_sends() {
    let bench = Bench::new();
    let cube = scene("floor-cube.toml");
    let arguments = |photons: &'static str, surface: &'static str| {
        [
            "irradiance",
            &cube,
            "--photons",
            photons,
            "--surface",
            surface,
            "--estimator",
            SQUARES,
            "--cells",
            "2x2",
        ]
        .map(str::to_owned)
    };
    let run = |photons, surface| {
        let arguments = arguments(photons, surface);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        bench.run(&arguments)
    };
    let outcome = run("20000", "ceiling").succeeds();
    let mut lines = outcome.stdout.lines();
    assert_eq!(
        lines.next(),
        Some("i,j,u,v,irradiance_r,irradiance_g,irradiance_b")
    );
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 4);
    assert_eq!(rows[1][..4], [0.0, 1.0, 0.25, 0.75]);
    let mean = rows.iter().map(|row| row[5]).sum::<f64>() / 4.0;
    // π watts, of which the form factor arrives; 4 standard errors of 4000 hits
    let exact = 0.199_825 * std::f64::consts::PI;
    assert!((mean / exact - 1.0).abs() < 0.06, "{mean} {exact}");
    // nothing arrives on the lamp of a room with black walls
    let dark = run("2000", "floor").succeeds();
    assert!(dark.stdout.ends_with("1,1,0.75,0.75,0,0,0\n"));
    run("2000", "cieling")
        .ends_with(2)
        .says("did you mean `ceiling`?");
    run("0", "ceiling").ends_with(2).says("--photons");
}

#[test]
fn irradiance_that_cannot_be_is_told() {
    let bench = Bench::new();
    let cube = scene("floor-cube.toml");
    let run = |estimator: &str, cells: &str, scene: &str| {
        bench.run(&[
            "irradiance",
            scene,
            "--photons",
            "1000",
            "--surface",
            "ceiling",
            "--estimator",
            estimator,
            "--cells",
            cells,
        ])
    };
    run("histogram = { width = -1 }", "2x2", &cube)
        .ends_with(2)
        .says("width");
    run("histogam = { width = 1 }", "2x2", &cube)
        .ends_with(2)
        .says("did you mean `histogram`?");
    run(SQUARES, "0x2", &cube).ends_with(2).says("--cells");
    run(SQUARES, "2", &cube).ends_with(2).says("--cells");
    run(SQUARES, "99999999x99999999", &cube)
        .ends_with(2)
        .says("--cells");
    run(SQUARES, "2x2", "nowhere.toml").says("nowhere.toml");
}

/// The mean colour of the left and of the right quarter of a picture.
fn sides(file: &[u8]) -> [[f64; 3]; 2] {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let about = reader.next_frame(&mut bytes).unwrap();
    let (width, height) = (about.width as usize, about.height as usize);
    let mean = |from: usize, to: usize| {
        let mut sum = [0.0; 3];
        for row in height / 4..3 * height / 4 {
            for column in from..to {
                for c in 0..3 {
                    sum[c] += f64::from(bytes[3 * (row * width + column) + c]);
                }
            }
        }
        sum
    };
    [mean(0, width / 5), mean(width - width / 5, width)]
}

/// By every kind of light, and by wavelength too, the left wall is red and the right one green (less so in the warm light of the measured lamp).
#[test]
fn the_left_wall_is_red_and_the_right_one_green() {
    let bench = Bench::new();
    let (rgb, spectral) = (
        scene("cornell-box-rgb.toml"),
        scene("cornell-box-empty.toml"),
    );
    let in_scene = |file: &str, width: &str| {
        let estimator = format!("histogram = {{ width = {width} }}");
        let arguments = [
            "render",
            file,
            "--photons",
            "20000",
            "--estimator",
            &estimator,
            "--size",
            "20x20",
            "--rays",
            "1",
            "-o",
            "box.png",
        ];
        bench.run(&arguments).succeeds().prints_nothing();
        sides(&fs::read(bench.path("box.png")).unwrap())
    };
    let paths = || {
        let arguments = [
            "render",
            &rgb,
            "--paths",
            "8",
            "--size",
            "20x20",
            "--rays",
            "1",
            "-o",
            "paths.png",
        ];
        bench.run(&arguments).succeeds();
        sides(&fs::read(bench.path("paths.png")).unwrap())
    };
    for [left, right] in [in_scene(&rgb, "0.5"), in_scene(&spectral, "140"), paths()] {
        assert!(left[0] > 1.5 * left[1], "{left:?}");
        assert!(right[1] > 1.1 * right[0], "{right:?}");
    }
}

/// Every picture and every map of errors is on the page, with the size of the errors: the estimator that smooths too much has the larger.
#[test]
fn a_page_compares_pictures() {
    let bench = Bench::new();
    let rgb = scene("cornell-box-rgb.toml");
    let arguments = [
        "render",
        &rgb,
        "--photons",
        "20000",
        "--estimator",
        "histogram = { width = 0.25 }",
        "--estimator",
        "histogram = { width = 2.0 }",
        "--paths",
        "32",
        "--size",
        "24x24",
        "--rays",
        "1",
        "-o",
        "box.html",
    ];
    bench.run(&arguments).succeeds().prints_nothing();
    let page = bench.text("box.html");
    assert_eq!(page.matches("<svg").count(), 2);
    // three pictures, two maps and their scale of colours
    assert_eq!(page.matches("data:image/png").count(), 6);
    assert!(page.contains("traced, 32 paths a place"));
    assert!(page.contains("lab render"));
    let error = |name: &str| {
        let (_, table) = page.split_once("<tbody>").expect("a table");
        let (_, row) = table.split_once(name).expect("a row of the table");
        let (_, row) = row.split_once("<td").expect("a cell");
        let number: String = row
            .chars()
            .skip_while(|c| !c.is_ascii_digit())
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        number.parse::<f64>().unwrap()
    };
    assert!(error("2: histogram") > 1.2 * error("1: histogram"));
}

#[test]
fn pictures_that_cannot_be_are_told() {
    let bench = Bench::new();
    let (rgb, spectral) = (scene("cornell-box-rgb.toml"), scene("cornell-box.toml"));
    let cube = scene("floor-cube.toml");
    let run = |arguments: &[&str]| bench.run(&[&["render"], arguments].concat());
    run(&[&rgb, "-o", "x.png"]).ends_with(2).says("--estimator");
    run(&[&rgb, "--paths", "1", "-o", "x.jpg"])
        .ends_with(2)
        .says("end in .png or .exr");
    run(&[&rgb, "--estimator", SQUARES, "-o", "x.png"])
        .ends_with(2)
        .says("--photons");
    for two in [
        &["--paths", "1", "--reference"][..],
        &["--paths", "1", "--photons", "10", "--estimator", SQUARES],
        &[
            "--photons",
            "10",
            "--estimator",
            SQUARES,
            "--estimator",
            SQUARES,
        ],
    ] {
        let arguments = [&[&rgb[..]], two, &["-o", "x.png"]].concat();
        run(&arguments)
            .ends_with(2)
            .says("one picture has one light");
    }
    run(&[&rgb, "--paths", "1", "-o", "x.html"])
        .ends_with(2)
        .says("at least one --estimator");
    run(&[&cube, "--paths", "1", "-o", "x.png"])
        .ends_with(2)
        .says("has no camera");
    for light in [&["--paths", "1"][..], &["--reference"]] {
        let arguments = [&[&spectral[..]], light, &["--size", "4x4", "-o", "x.png"]].concat();
        run(&arguments).ends_with(2).says("colour by wavelength");
    }
    run(&[
        &rgb,
        "--paths",
        "1",
        "--size",
        "999999x999999",
        "-o",
        "x.png",
    ])
    .ends_with(2)
    .says("--size");
    let arguments = [
        "render", &rgb, "--paths", "1", "--size", "4x4", "-o", "x.exr",
    ];
    bench.run(&arguments).succeeds();
    assert_eq!(
        fs::read(bench.path("x.exr")).unwrap()[..4],
        [0x76, 0x2f, 0x31, 0x01]
    );
}
