//! `lab`'s engines of the plane, asked what `plane.py` asks its peers: `peers-plane DATA KERNEL SYMMETRY H ENGINE TOLERANCE ANSWER`.
//!
//! DATA holds pairs of doubles, ANSWER receives the densities on the grid. Prints CPU and wall seconds of the estimation alone, on one thread unless RAYON_NUM_THREADS says otherwise, and the engine.

use density_lab::engine::{PLANE, Planned};
use density_lab::kernel::{Bandwidth, KernelSum, Shape, Symmetry};
use density_lab::sample::Sample;
use density_lab::space::{Domain, Field, Grid, Point, Targets};
use std::error::Error;
use std::time::Instant;

/// The question of `plane.py`.
const CELLS: usize = 256;

/// CPU seconds of this process.
fn cpu() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [data, kernel, symmetry, h, engine, tolerance, answer] = words.as_slice() else {
        return Err("DATA KERNEL SYMMETRY H ENGINE TOLERANCE ANSWER".into());
    };
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build_global()?;
    }
    let bytes = std::fs::read(data)?;
    let points: Vec<Point<2>> = bytes
        .as_chunks::<16>()
        .0
        .iter()
        .map(|pair| {
            let number = |from: usize| {
                let mut eight = [0; 8];
                eight.copy_from_slice(&pair[from..from + 8]);
                f64::from_le_bytes(eight)
            };
            [number(0), number(8)]
        })
        .collect();
    let sample = Sample::equal(points, Domain::whole())?;
    let grid = Grid::new([-4.0; 2], [4.0; 2], [CELLS; 2])?;
    let shape = Shape::named(kernel).ok_or("no such kernel")?;
    let symmetry = Symmetry::named(symmetry).ok_or("no such symmetry")?;
    let (h, tolerance): (f64, f64) = (h.parse()?, tolerance.parse()?);
    let forced = (engine != "auto").then_some(engine.as_str());
    let (start, busy) = (Instant::now(), cpu());
    let sum = KernelSum::new(sample, shape, Bandwidth::Fixed([h; 2]))?.with_symmetry(symmetry);
    let evaluation = Planned::new(PLANE, sum, tolerance, forced)?.evaluate(Targets::Grid(&grid));
    let (wall, busy) = (start.elapsed().as_secs_f64(), cpu() - busy);
    let bytes: Vec<u8> = evaluation
        .values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    std::fs::write(answer, bytes)?;
    println!("{busy} {wall} {}", evaluation.engine.unwrap_or("?"));
    Ok(())
}
