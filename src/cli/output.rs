//! Where data go: the standard output, or a file that appears whole or not at all.

use super::stop::Stop;
use crate::storage::{PREFIX, Unfinished};
use serde::Serialize;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A writer whose failures are never lost: nothing counts as written before [`Output::finish`].
pub struct Output {
    name: String,
    sink: Sink,
}

enum Sink {
    Stream(BufWriter<io::Stdout>),
    /// A device, a pipe: something that cannot be replaced by a file.
    Special(BufWriter<File>),
    File {
        writer: BufWriter<NamedTempFile>,
        target: PathBuf,
        guard: Unfinished,
    },
}

const BUFFER: usize = 1 << 16;

impl Output {
    /// Opens `path`; without one, or for `-`, the standard output. An unwritable place is found out here, before any work.
    ///
    /// # Errors
    /// If nothing can be written there.
    pub fn open(path: Option<&Path>) -> Result<Self, Stop> {
        let Some(path) = path.filter(|path| *path != Path::new("-")) else {
            return Ok(Self {
                name: "stdout".to_owned(),
                sink: Sink::Stream(BufWriter::with_capacity(BUFFER, io::stdout())),
            });
        };
        let name = path.display().to_string();
        let sink = Self::sink(path).map_err(|error| Stop::writing(&name, &error))?;
        Ok(Self { name, sink })
    }

    fn sink(path: &Path) -> io::Result<Sink> {
        // a link stays a link: what it points to is replaced
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        match fs::metadata(&target) {
            Ok(about) if about.is_dir() => {
                return Err(io::Error::other("it is a folder; give a file"));
            }
            Ok(about) if !about.is_file() => {
                let file = File::options().write(true).open(&target)?;
                return Ok(Sink::Special(BufWriter::with_capacity(BUFFER, file)));
            }
            _ => {}
        }
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // an ordinary file, as the umask of its user says, and as private as the one it replaces
            let mode = fs::metadata(&target).map_or(0o666, |about| about.permissions().mode());
            builder.permissions(fs::Permissions::from_mode(mode & 0o777));
        }
        if !folder.is_dir() {
            let what = if folder.exists() {
                "is not a folder"
            } else {
                "does not exist"
            };
            return Err(io::Error::other(format!("{} {what}", folder.display())));
        }
        // the system's words, without the name of a file that nobody asked for
        let plain = |error: io::Error| {
            let cause = error.get_ref().and_then(|inner| inner.source());
            match cause.and_then(|cause| cause.downcast_ref::<io::Error>()) {
                Some(cause) => io::Error::new(cause.kind(), cause.to_string()),
                None => io::Error::new(error.kind(), error.kind().to_string()),
            }
        };
        let (file, guard) = Unfinished::make(|| builder.tempfile_in(folder)).map_err(plain)?;
        Ok(Sink::File {
            guard,
            writer: BufWriter::with_capacity(BUFFER, file),
            target,
        })
    }

    fn writer(&mut self) -> &mut (dyn Write + Send) {
        match &mut self.sink {
            Sink::Stream(writer) => writer,
            Sink::Special(writer) => writer,
            Sink::File { writer, .. } => writer,
        }
    }

    /// Writes text, for `write!` and `writeln!`.
    ///
    /// # Errors
    /// If it could not be written.
    pub fn write_fmt(&mut self, text: fmt::Arguments<'_>) -> Result<(), Stop> {
        let result = self.writer().write_fmt(text);
        self.check(result)
    }

    /// Writes bytes.
    ///
    /// # Errors
    /// If they could not be written.
    pub fn write_all(&mut self, bytes: &[u8]) -> Result<(), Stop> {
        let result = self.writer().write_all(bytes);
        self.check(result)
    }

    /// Lets something else write.
    ///
    /// # Errors
    /// If it could not.
    #[cfg(feature = "parquet")]
    pub fn through<T>(
        &mut self,
        write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<T>,
    ) -> Result<T, Stop> {
        let result = write(self.writer());
        result.map_err(|error| Stop::writing(&self.name, &error))
    }

    /// Writes a value as indented JSON.
    ///
    /// # Errors
    /// If it could not be written.
    pub fn json(&mut self, value: &impl Serialize) -> Result<(), Stop> {
        let result = serde_json::to_writer_pretty(self.writer(), value).map_err(io::Error::from);
        self.check(result)?;
        self.write_all(b"\n")
    }

    /// Writes a number as the shortest decimal that reads back as the same number.
    ///
    /// # Errors
    /// If it could not be written.
    pub fn number(&mut self, x: f64) -> Result<(), Stop> {
        write!(self, "{}", Shortest(x))
    }

    /// Makes sure that everything has arrived, and puts a file in its place.
    ///
    /// # Errors
    /// If something was not written after all.
    pub fn finish(mut self) -> Result<(), Stop> {
        let flushed = self.writer().flush();
        self.check(flushed)?;
        let name = self.name;
        let done = match self.sink {
            Sink::Stream(_) | Sink::Special(_) => Ok(()),
            Sink::File {
                writer,
                target,
                guard,
            } => writer
                .into_inner()
                .map_err(io::IntoInnerError::into_error)
                .and_then(|file| {
                    // some file systems report a full disk only here
                    file.as_file().sync_data()?;
                    file.persist(&target).map_err(|error| error.error)?;
                    drop(guard);
                    Ok(())
                }),
        };
        done.map_err(|error| Stop::writing(&name, &error))
    }

    fn check(&self, result: io::Result<()>) -> Result<(), Stop> {
        result.map_err(|error| Stop::writing(&self.name, &error))
    }
}

/// Shows a number with as few digits as read back the same, and an exponent where that is shorter to read.
#[derive(Clone, Copy, Debug)]
pub struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) {
            fmt::Display::fmt(&self.0, f)
        } else {
            fmt::LowerExp::fmt(&self.0, f)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Shortest;

    #[test]
    fn numbers_are_short_and_read_back() {
        let shown = [0.1, 1.0, 1e-5, 1e-7, -2.5e300, 0.0].map(|x| Shortest(x).to_string());
        assert_eq!(shown, ["0.1", "1", "0.00001", "1e-7", "-2.5e300", "0"]);
        for x in [
            std::f64::consts::PI,
            1.0 / 3.0,
            f64::MIN_POSITIVE,
            5e-324,
            f64::MAX,
        ] {
            let back: f64 = Shortest(x).to_string().parse().expect("a number");
            assert_eq!(back.to_bits(), x.to_bits());
        }
    }
}
