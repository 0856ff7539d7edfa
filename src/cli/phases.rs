//! Where the time goes: wall and processor seconds of each phase of a command.

use rustix::time::{ClockId, clock_gettime};
use std::time::Instant;

/// One finished phase.
struct Phase {
    name: &'static str,
    wall: f64,
    processor: f64,
}

/// The phases so far.
#[derive(Default)]
pub struct Phases(Vec<Phase>);

impl Phases {
    /// Does `work` as the phase `name`.
    pub fn time<T>(&mut self, name: &'static str, work: impl FnOnce() -> T) -> T {
        let (wall, processor) = (Instant::now(), processor_seconds());
        let result = work();
        self.0.push(Phase {
            name,
            wall: wall.elapsed().as_secs_f64(),
            processor: processor_seconds() - processor,
        });
        result
    }

    /// One line a phase: `phase read wall 0.012345 cpu 0.011876`.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        self.0.iter().map(
            |Phase {
                 name,
                 wall,
                 processor,
             }| format!("phase {name} wall {wall:.6} cpu {processor:.6}"),
        )
    }
}

/// Seconds that all threads of this process together have computed.
fn processor_seconds() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_nsec as f64 * 1e-9 + time.tv_sec as f64
}
