//! The Cornell box with blocks in three colours: photons against paths, and against the balance of light.

use crate::cells::Cells;
use crate::judge::{LEVEL, Mean, holm, two_sided};
use crate::{Report, scene, scene_with};
use density_lab::light::reference::Reference;
use density_lab::light::scene::Scene;
use density_lab::light::walk::Power;
use density_lab::space::Grid;

const ACROSS: usize = 32;
/// How far from traced paths the balance of light may be: the walls, and the faces of blocks.
const MARGINS: [f64; 2] = [0.005, 0.02];

/// The least p-values after Holm: the means of all surfaces and channels, and all cells of them.
fn apart(scene: &Scene, photons: &Cells, paths: &Cells) -> [f64; 2] {
    let (mut means, mut cells) = (Vec::new(), Vec::new());
    for surface in 0..scene.surfaces().len() {
        for c in 0..3 {
            let off = photons.surface(surface, c).off(paths.surface(surface, c));
            means.push(two_sided(off));
            cells.push(photons.agree_with(paths, surface, c));
        }
    }
    [holm(&means).0, holm(&cells).0]
}

pub fn blocks(report: &mut Report) {
    let scene = scene("cornell-box-rgb.toml");
    let count = report.paths(1e7);
    let photons = Cells::photons(&scene, Power::Same, count, ACROSS, 4);
    let paths = Cells::paths(&scene, ACROSS, (1000.0 * report.scale).max(80.0) as usize);
    let balance = balance(report, &scene, &photons, &paths);
    let [means, cells] = apart(&scene, &photons, &paths);
    let all = 3 * scene.surfaces().len();
    report.say(
        &format!("box with blocks, N = {count}: means of {all} surfaces and channels by photons and by paths"),
        &format!("least p after Holm {means:.3}"),
        means >= LEVEL,
    );
    report.say(
        &format!("box with blocks: {ACROSS} x {ACROSS} cells of {all} surfaces and channels"),
        &format!("least p after Holm {cells:.3}"),
        cells >= LEVEL,
    );
    report.say(
        "box with blocks: means by the balance of light, within 0.5 % of paths on walls, 2 % on blocks",
        &format!("least p after Holm {balance:.3}"),
        balance >= LEVEL,
    );
    // what would be wrong
    let white = "reflectance = [0.885809, 0.698859, 0.666422]";
    let whiter = scene_with(
        "cornell-box-rgb.toml",
        white,
        "reflectance = [0.894667, 0.705848, 0.673086]",
    );
    let spoilt = Cells::photons(&whiter, Power::Same, count, ACROSS, 4);
    let [means, _] = apart(&whiter, &spoilt, &paths);
    report.catches(
        "box with blocks, white that reflects 1 % more: means",
        means,
    );
    let brighter = photons.spoilt(|_, _| 1.01);
    let [means, _] = apart(&scene, &brighter, &paths);
    report.catches("box with blocks, 1 % more light: means", means);
    let tilted = photons.spoilt(|i, _| if i < ACROSS / 2 { 1.02 } else { 0.98 });
    let [_, cells] = apart(&scene, &tilted, &paths);
    report.catches(
        "box with blocks, halves of surfaces 2 % brighter and darker: cells",
        cells,
    );
}

/// Prints all means, and returns the least p-value of the balance after Holm.
fn balance(report: &Report, scene: &std::sync::Arc<Scene>, photons: &Cells, paths: &Cells) -> f64 {
    let reference = Reference::new(scene.clone());
    reference.solved();
    let mut family = Vec::new();
    report.line(
        "surface      channel  photons             paths               off/se   cells p  balance/paths",
    );
    for (surface, described) in scene.surfaces().iter().enumerate() {
        let high = described.domain().expect("flat").high();
        let grid = Grid::new([0.0; 2], high, [ACROSS; 2]).expect("cells");
        let solved = reference.cell_means(surface, &grid, 1);
        let block = described.name.starts_with("small") || described.name.starts_with("large");
        for c in 0..3 {
            let (found, by_paths) = (photons.surface(surface, c), paths.surface(surface, c));
            let balance = solved.iter().map(|s| s[c]).sum::<f64>() / solved.len() as f64;
            family.push(by_paths.beyond(balance, MARGINS[usize::from(block)]));
            report.line(&format!(
                "{:<12} {}        {:.5} ± {:.5}   {:.5} ± {:.5}   {:+.2}   {:.3}   {:.5}",
                described.name,
                ["r", "g", "b"][c],
                found.value,
                found.error,
                by_paths.value,
                by_paths.error,
                found.off(by_paths),
                photons.agree_with(paths, surface, c),
                balance / by_paths.value,
            ));
        }
    }
    holm(&family).0
}

/// Both schemes of power: cell by cell, and the means of all surfaces.
pub fn schemes(report: &mut Report) {
    let scene = scene("cornell-box-rgb.toml");
    let paths = report.paths(2e6);
    let attenuated = Power::Attenuated {
        threshold: 0.1,
        kill: 0.5,
    };
    let same = Cells::photons(&scene, Power::Same, paths, 8, 5);
    let other = Cells::photons(&scene, attenuated, paths, 8, 6);
    let [means, cells] = apart(&scene, &same, &other);
    let all = 3 * scene.surfaces().len();
    let single = |other: &Cells| {
        let mut p = Vec::new();
        for surface in 0..scene.surfaces().len() {
            for cell in 0..64 {
                for c in 0..3 {
                    let of = |cells: &Cells| -> Mean { cells.cell(surface, cell, c) };
                    p.push(two_sided(of(&same).off(of(other))));
                }
            }
        }
        holm(&p)
    };
    let (least, holds) = single(&other);
    report.say(
        &format!(
            "both schemes of power, N = {paths} each: {} cells and channels",
            64 * all
        ),
        &format!("least p after Holm {least:.3}"),
        holds,
    );
    report.say(
        &format!(
            "both schemes of power: means, and cells together, of {all} surfaces and channels"
        ),
        &format!("least p after Holm {means:.3}, {cells:.3}"),
        means >= LEVEL && cells >= LEVEL,
    );
    let [means, _] = apart(&scene, &same, &other.spoilt(|_, _| 1.02));
    report.catches("both schemes, 2 % more light in one: means", means);
}

/// Over wavelengths paths are not traced: X, Y and Z of what photons leave on each surface against the balance of light in every band.
pub fn spectral(report: &mut Report) {
    let scene = scene("cornell-box.toml");
    let count = report.paths(4e6);
    let photons = Cells::photons(&scene, Power::Same, count, 8, 7);
    let reference = Reference::new(scene.clone());
    reference.solved();
    let (mut family, mut spoilt) = (Vec::new(), Vec::new());
    report.line("surface               channel  photons             balance/photons");
    for (surface, described) in scene.surfaces().iter().enumerate() {
        let high = described.domain().expect("flat").high();
        let grid = Grid::new([0.0; 2], high, [64; 2]).expect("cells");
        let solved = reference.cell_means(surface, &grid, 1);
        // where the chart is no rectangle, cells beside it do not count
        let domain = described.domain().expect("flat");
        let inside = |&cell: &usize| domain.contains(grid.centre(cell));
        let count = (0..solved.len()).filter(inside).count() as f64;
        let block = described.name.contains("block");
        for c in 0..3 {
            let found = photons.surface(surface, c);
            let balance = solved.iter().map(|s| s[c]).sum::<f64>() / count;
            if found.value <= 0.0 && balance <= 0.0 {
                continue;
            }
            let margin = MARGINS[usize::from(block)];
            family.push(found.beyond(balance, margin));
            spoilt.push(found.beyond(balance * (1.02 + margin), margin));
            report.line(&format!(
                "{:<21} {}        {:.4} ± {:.4}   {:.5}",
                described.name,
                ["X", "Y", "Z"][c],
                found.value,
                found.error,
                balance / found.value,
            ));
        }
    }
    let (least, holds) = holm(&family);
    report.say(
        &format!("box over wavelengths, N = {count}: X, Y and Z of surfaces within 0.5 % of the balance, 2 % on blocks"),
        &format!("least p after Holm {least:.3}"),
        holds,
    );
    report.catches(
        "box over wavelengths, 2 % more than is allowed",
        holm(&spoilt).0,
    );
}
