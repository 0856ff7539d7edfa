//! The photon walk of `lab` on one thread, for `photons.py`: paths, segments and seconds of processor time as JSON.

use density_lab::light::ledger::Ledger;
use density_lab::light::scene::read;
use density_lab::light::walk::{BLOCK, Power, Walk};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;
use std::path::Path;

fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().expect("a scene file");
    let blocks: u64 = arguments
        .next()
        .expect("how many blocks of paths")
        .parse()
        .expect("a number");
    let scene = match read::scene(Path::new(&scene)) {
        Ok(scene) => scene,
        Err(problems) => panic!("{problems}"),
    };
    let walk = Walk::new(&scene, Power::Same, blocks * BLOCK, 1).expect("a walk");
    // as the peers do, once without being timed
    black_box(walk.trace(0));
    let mut ledger = Ledger::default();
    let start = seconds();
    for block in 0..blocks {
        let trace = walk.trace(block);
        ledger.add(&trace.ledger);
        black_box(&trace.records);
    }
    println!(
        "{{\"paths\": {}, \"segments\": {}, \"hits\": {}, \"seconds\": {}}}",
        ledger.paths,
        ledger.segments,
        ledger.hits,
        seconds() - start
    );
}
