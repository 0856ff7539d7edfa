//! `lab trace`

use super::argument;
use super::interrupt;
use super::notes::Notes;
use super::output::Output;
use super::run::Bar;
use super::stop::Stop;
use crate::experiment::program;
use crate::experiment::run::Progress;
use crate::light::hits::{Format, Piece, Spool};
use crate::light::ledger::Ledger;
use crate::light::scene::{Scene, read};
use crate::light::walk::{Power, Walk};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Trace photons through a scene and write where they arrive
///
/// Every arrival at the front of a surface is a row, with the flux before absorption. Fluxes are shares of the lamps' power by the number of
/// photons, so that their sum over a piece of a surface, divided by its area, is the irradiance there. A long trace that is interrupted goes on where it was
/// when the same command is given again.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  lab trace data/scenes/cornell-box-rgb.toml --photons 1e5 -o hits.csv
  lab trace data/scenes/cornell-box.toml --photons 1e7 --seed 7 -o hits.npy
  lab trace data/scenes/furnace.toml --photons 1000 --power attenuated | head

Columns of a .csv: surface,u,v,x,y,z,flux_r,flux_g,flux_b,bounce. A .npy holds the numbers of surface and path and the direction of arrival too, and so does a .parquet.")]
pub struct Trace {
    /// The scene file; - is the standard input
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,

    /// How many photons leave the lamps
    #[arg(long, value_name = "N", value_parser = argument::count)]
    photons: u64,

    /// The seed of the random streams
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// What happens to a photon's power at a surface
    #[arg(long, value_enum, default_value = "same")]
    power: Scheme,

    /// Where to: a .csv file, an .npy array, or a .parquet file if lab is built with the feature parquet [default: CSV on stdout]
    #[arg(short, long, value_name = "HITS")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Scheme {
    /// It survives whole with the share that is reflected
    Same,
    /// It goes on with what is reflected; below a tenth, one half of them end and the other half double
    Attenuated,
}

impl Trace {
    pub fn run(&self, notes: Notes) -> Result<(), Stop> {
        let scene = read::scene(&self.scene).map_err(|problems| Stop::problems(&problems))?;
        let power = match self.power {
            Scheme::Same => Power::Same,
            Scheme::Attenuated => Power::Attenuated {
                threshold: 0.1,
                kill: 0.5,
            },
        };
        let walk = Walk::new(&scene, power, self.photons, self.seed)
            .map_err(|error| Stop::Input(format!("--photons: {error}")))?;
        let format = self.output.as_deref().map_or(Format::Table, Format::of);
        if format == Format::Columns && !cfg!(feature = "parquet") {
            return Err(Stop::Input(
                "-o: this build does not write Parquet; write .npy or .csv, or build lab with it: cargo install --path . --features parquet".to_owned(),
            ));
        }
        // an unwritable place is found out before any work
        let output = Output::open(self.output.as_deref())?;
        let work = Work {
            walk: &walk,
            scene: &scene,
            format,
            pieces: walk.blocks(),
        };
        if work.pieces == 1 {
            let piece = work.piece(0);
            check(&piece.ledger, &scene)?;
            let rows = |_| Ok(piece.rows.clone());
            write(output, format, &scene, piece.ledger.hits, 1, rows)?;
            say(&piece.ledger, notes);
            return Ok(());
        }
        let aside = self.aside()?;
        let spool = Spool::open(&aside.path(), &self.identity(&scene, power, format))?;
        let ledger = work.fill(&spool, notes)?;
        // all pieces are kept: what follows may be interrupted at any time
        interrupt::at_once();
        if let Err(fault) = check(&ledger, &scene) {
            spool.remove()?;
            return Err(fault);
        }
        let load = |number| {
            let gone = || {
                Stop::System(format!(
                    "{}: a piece of the trace is gone",
                    aside.path().display()
                ))
            };
            Ok(spool.load(number).ok_or_else(gone)?.rows)
        };
        write(output, format, &scene, ledger.hits, work.pieces, load)?;
        spool.remove()?;
        say(&ledger, notes);
        Ok(())
    }

    /// Where pieces are kept: beside the file that they will be, or where the system keeps what nobody will ask for.
    fn aside(&self) -> Result<Aside, Stop> {
        let file = self
            .output
            .as_deref()
            .filter(|path| *path != Path::new("-"))
            .filter(|path| std::fs::metadata(path).map_or(true, |about| about.is_file()));
        if let Some((file, name)) = file.and_then(|file| Some((file, file.file_name()?))) {
            let name = format!(".{}.trace", name.to_string_lossy());
            return Ok(Aside::Beside(file.with_file_name(name)));
        }
        tempfile::tempdir()
            .map(Aside::Temporary)
            .map_err(|error| Stop::System(format!("no temporary folder: {error}")))
    }

    fn identity(&self, scene: &Scene, power: Power, format: Format) -> String {
        // everything that the rows depend on
        let about = format!("{:?} {:?} {}", scene.surfaces(), scene.colour, scene.open);
        format!(
            "{} {} {} photons, seed {}, {power:?}, {format:?}\n",
            program::build(),
            blake3::hash(about.as_bytes()),
            self.photons,
            self.seed
        )
    }
}

enum Aside {
    Beside(PathBuf),
    Temporary(tempfile::TempDir),
}

impl Aside {
    fn path(&self) -> PathBuf {
        match self {
            Self::Beside(path) => path.clone(),
            Self::Temporary(folder) => folder.path().join("trace"),
        }
    }
}

/// A trace in pieces.
struct Work<'w> {
    walk: &'w Walk<'w>,
    scene: &'w Scene,
    format: Format,
    pieces: u64,
}

impl Work<'_> {
    /// A piece is a block of paths: what an interruption loses at most, for each thread.
    fn piece(&self, number: u64) -> Piece {
        let trace = self.walk.trace(number);
        let mut rows = Vec::new();
        for record in &trace.records {
            self.format.row(self.scene, record, &mut rows);
        }
        Piece {
            ledger: trace.ledger,
            rows,
        }
    }

    /// Makes the pieces that are not there, and adds up where the light went, in their order.
    fn fill(&self, spool: &Spool, notes: Notes) -> Result<Ledger, Stop> {
        let stop: &AtomicBool = interrupt::graceful();
        let found: Vec<Option<Ledger>> = (0..self.pieces)
            .into_par_iter()
            .map(|number| spool.load(number).map(|piece| piece.ledger))
            .collect();
        let bar = Bar::new(notes);
        bar.begin(self.pieces, found.iter().flatten().count() as u64);
        let ledgers: Vec<Option<Ledger>> = found
            .into_par_iter()
            .enumerate()
            .with_max_len(1)
            .map(|(number, found)| {
                if found.is_some() || stop.load(Ordering::Relaxed) {
                    return Ok(found);
                }
                let piece = self.piece(number as u64);
                spool.save(number as u64, &piece)?;
                bar.advance(1);
                Ok(Some(piece.ledger))
            })
            .collect::<Result<_, Stop>>()?;
        bar.clear();
        let done = ledgers.iter().flatten().count();
        if done < ledgers.len() {
            return Err(Stop::Interrupted(format!(
                "interrupted with {done} of {} pieces traced and saved; the same command goes on from there",
                ledgers.len()
            )));
        }
        let mut all = Ledger::default();
        for ledger in ledgers.iter().flatten() {
            all.add(ledger);
        }
        Ok(all)
    }
}

/// Writes the rows of all pieces; those of a file that is no Parquet are read back and checked, one for each thread, while others before them are written.
fn write(
    mut output: Output,
    format: Format,
    scene: &Scene,
    hits: u64,
    pieces: u64,
    load: impl Fn(u64) -> Result<Vec<u8>, Stop> + Sync,
) -> Result<(), Stop> {
    #[cfg(feature = "parquet")]
    if format == Format::Columns {
        let mut stopped = None;
        output.through(|sink| {
            let mut columns = crate::light::hits::Columns::new(sink, scene.colour)?;
            for piece in 0..pieces {
                match load(piece) {
                    Ok(rows) => columns.group(&rows)?,
                    Err(stop) => {
                        stopped = Some(stop);
                        break;
                    }
                }
            }
            columns.finish()
        })?;
        return match stopped {
            Some(stop) => Err(stop),
            None => output.finish(),
        };
    }
    output.write_all(&format.head(scene.colour, hits))?;
    let chunk = rayon::current_num_threads().max(1);
    let some = |from: u64| -> Result<Vec<Vec<u8>>, Stop> {
        let to = (from + chunk as u64).min(pieces);
        (from..to).into_par_iter().map(&load).collect()
    };
    let mut ready = some(0)?;
    for next in (chunk as u64..pieces + chunk as u64).step_by(chunk) {
        let mut put = || ready.iter().try_for_each(|rows| output.write_all(rows));
        let (written, loaded) = rayon::join(&mut put, || some(next));
        written?;
        ready = loaded?;
    }
    output.finish()
}

fn check(ledger: &Ledger, scene: &Scene) -> Result<(), Stop> {
    ledger
        .check(scene.open)
        .map_err(|error| Stop::Input(error.to_string()))
}

fn say(ledger: &Ledger, notes: Notes) {
    let share = |power: f64| 100.0 * power / ledger.emitted;
    notes.say(&format!(
        "{} photons, {} hits ({:.3} a photon); {:.2} % of the light absorbed, {:.2} % on backs, {:.2} % escaped",
        ledger.paths,
        ledger.hits,
        ledger.hits as f64 / ledger.paths as f64,
        share(ledger.absorbed),
        share(ledger.behind),
        share(ledger.escaped),
    ));
}
