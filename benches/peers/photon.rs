//! The photon walk of `lab` on one thread, for `photons.py`: paths, segments and seconds as JSON.

use density_lab::light::ledger::Ledger;
use density_lab::light::scene::read;
use density_lab::light::walk::{BLOCK, Power, Walk};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

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
    let mut ledger = Ledger::default();
    let start = Instant::now();
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
        start.elapsed().as_secs_f64()
    );
}
