//! Rooms whose light is known on paper.

use crate::cells::Cells;
use crate::judge::{LEVEL, Mean, holm, two_sided};
use crate::{Report, scene, scene_with};
use density_lab::light::scene::Scene;
use density_lab::light::walk::{Power, Walk};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::TAU;

pub fn cube(report: &mut Report) {
    let scene = scene("floor-cube.toml");
    let paths = report.paths(1e6);
    let walk = Walk::new(&scene, Power::Same, paths, 1).expect("legal");
    let (hits, ledger) = walk.run().expect("closed");
    let imbalance = ledger.imbalance().abs();
    report.say(
        "ledger of the cube",
        &format!("{imbalance:.1e} (at most 1e-9)"),
        imbalance < 1e-9,
    );
    for (index, surface) in scene.surfaces().iter().enumerate() {
        let factor = match surface.name.as_str() {
            "floor" => 0.0,
            "ceiling" => 0.199_825,
            _ => 0.200_044,
        };
        let first = hits.on(index).iter().filter(|r| r.bounce == 1).count();
        let share = first as f64 / paths as f64;
        let error = (factor * (1.0 - factor) / paths as f64).sqrt();
        report.say(
            &format!("first hits on {}, N = {paths}", surface.name),
            &format!("{share:.6} (must be {factor:.6} within 4 x {error:.6})"),
            (share - factor).abs() <= 4.0 * error,
        );
    }
}

/// Cells of all walls against (B − E)/ρ, and the mean of all walls.
fn white(cells: &Cells, scene: &Scene, channel: usize) -> [f64; 2] {
    let p: Vec<f64> = (0..scene.surfaces().len())
        .map(|surface| cells.agree(surface, channel, |_, _| TAU))
        .collect();
    let (least, _) = holm(&p);
    let off = cells.everything(channel).off(Mean::exactly(TAU));
    [least, two_sided(off)]
}

pub fn furnace(report: &mut Report) {
    let right = scene("furnace.toml");
    let paths = report.paths(4e6);
    let cells = Cells::photons(&right, Power::Same, paths, 8, 2);
    let [chi, mean] = white(&cells, &right, 1);
    report.say(
        &format!("furnace, 6 x 64 cells, N = {paths}: differences from B - E over rho"),
        &format!("least p after Holm {chi:.3}"),
        chi >= LEVEL,
    );
    let all = cells.everything(1);
    report.say(
        "furnace, mean B - E over rho",
        &format!(
            "{:.6} ± {:.6} (must be {TAU:.6}; p = {mean:.3})",
            all.value, all.error
        ),
        mean >= LEVEL,
    );
    // what would be wrong
    let brighter = scene_with("furnace.toml", "reflectance = 0.5", "reflectance = 0.505");
    let spoilt = Cells::photons(&brighter, Power::Same, paths, 8, 2);
    let [chi, mean] = white(&spoilt, &brighter, 1);
    report.catches(
        "furnace, walls that reflect 1 % more: differences of cells",
        chi,
    );
    report.catches("furnace, walls that reflect 1 % more: the mean", mean);
    let tilted = cells.spoilt(|i, _| if i < 4 { 1.01 } else { 0.99 });
    let [chi, _] = white(&tilted, &right, 1);
    report.catches(
        "furnace, halves of walls 1 % brighter and darker: differences of cells",
        chi,
    );
}

pub fn sphere(report: &mut Report) {
    let scene = scene("sphere.toml");
    let paths = report.paths(1e6);
    let walk = Walk::new(&scene, Power::Same, paths, 3).expect("legal");
    let (hits, _) = walk.run().expect("closed");
    let high = scene.surfaces()[0].domain().expect("a chart").high();
    let mut counts = vec![0.0; 1024];
    let (mut second, mut later) = (0.0, 0.0);
    for record in hits.on(0).iter().filter(|r| r.bounce > 1) {
        later += 1.0;
        if record.bounce == 2 {
            let cell = |x: f32, high: f64| ((f64::from(x) / high * 32.0) as usize).min(31);
            counts[cell(record.u, high[0]) * 32 + cell(record.v, high[1])] += 1.0;
            second += 1.0;
        }
    }
    let expected = second / 1024.0;
    let statistic: f64 = counts
        .iter()
        .map(|c: &f64| (c - expected).powi(2) / expected)
        .sum();
    let p = ChiSquared::new(1023.0).expect("cells").sf(statistic);
    report.say(
        &format!("sphere, second hits uniform on 32 x 32 cells of equal area, N = {paths}"),
        &format!("chi-squared {statistic:.0} of 1023, p = {p:.3}"),
        p > 0.001,
    );
    // rho = 0.8: later hits have mean rho/(1 - rho) = 4 and variance rho/(1 - rho)^2 = 20 a path
    let mean = later / paths as f64;
    let off = (mean - 4.0) / (20.0 / paths as f64).sqrt();
    report.say(
        "sphere, reflected irradiance over that of Phi rho/(4 pi R^2 (1 - rho))",
        &format!("{:.5} ({off:+.2} standard errors)", mean / 4.0),
        off.abs() <= 3.0,
    );
}
