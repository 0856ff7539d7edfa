//! One call of a program: input written, answer read, time kept.

use std::io::{Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// What is kept of the end of a program's complaints.
const COMPLAINT: usize = 1000;

/// How long what a program has written may take to arrive after its end.
const GRACE: Duration = Duration::from_secs(5);

/// A program, what it is told and what it may cost.
pub(super) struct Call<'a> {
    pub(super) program: &'a str,
    pub(super) arguments: &'a [String],
    pub(super) timeout: Duration,
    pub(super) input: Vec<u8>,
    /// The most bytes it may answer.
    pub(super) most: usize,
}

impl Call<'_> {
    /// Starts the program, writes, reads and waits. Writing, reading and waiting each have a thread of their own, so that neither side can wait for the other
    /// for ever.
    pub(super) fn make(self) -> Result<Vec<u8>, String> {
        let start = Instant::now();
        let mut child = self
            .command()
            .spawn()
            .map_err(|error| format!("it cannot be started: {error}; is it installed?"))?;
        let (Some(mut stdin), Some(stdout), Some(stderr)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        else {
            kill(&mut child);
            return Err("it has no pipes to talk through".to_owned());
        };
        let input = self.input;
        thread::spawn(move || {
            // a program that does not read to the end may still answer; what it answers is judged
            let _ = stdin.write_all(&input);
        });
        let most = self.most;
        let answer = gathered(move || read(stdout, most + 1));
        let complaint = gathered(move || tail(stderr));
        let outcome = waited(&mut child, start + self.timeout, &answer, most);
        let told = || {
            let complaint = complaint.recv_timeout(GRACE).unwrap_or_default();
            let lines: Vec<String> = String::from_utf8_lossy(&complaint)
                .lines()
                .filter(|line| !line.trim().is_empty())
                .map(|line| line.chars().filter(|c| !c.is_control()).collect())
                .collect();
            let last = lines[lines.len().saturating_sub(3)..].join(" / ");
            if last.is_empty() {
                String::new()
            } else {
                format!("; it said: {last}")
            }
        };
        match outcome {
            Outcome::Late => Err(format!(
                "it took longer than {} s and was killed",
                self.timeout.as_secs_f64()
            )),
            Outcome::Talkative => Err(format!(
                "it answered more than {most} bytes, more than all targets need, and was killed"
            )),
            Outcome::Lost(what) => Err(what),
            Outcome::Ended(status, _) if !status.success() => {
                Err(format!("it failed with {status}{}", told()))
            }
            Outcome::Ended(_, answer) => Ok(answer),
        }
    }

    fn command(&self) -> Command {
        let mut command = Command::new(self.program);
        command
            .args(self.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        #[cfg(unix)]
        {
            use std::os::unix::process::CommandExt;
            // a group of its own, so that what it starts can be killed with it
            command.process_group(0);
        }
        command
    }
}

enum Outcome {
    Ended(ExitStatus, Vec<u8>),
    Late,
    Talkative,
    Lost(String),
}

/// Waits for the end of the program and of its answer, but no longer than until `deadline`; whatever happens, the program has ended and is reaped.
fn waited(
    child: &mut Child,
    deadline: Instant,
    answer: &Receiver<Vec<u8>>,
    most: usize,
) -> Outcome {
    let left = deadline.saturating_duration_since(Instant::now());
    let found = match answer.recv_timeout(left) {
        Ok(found) => found,
        Err(RecvTimeoutError::Timeout) => {
            kill(child);
            return Outcome::Late;
        }
        Err(RecvTimeoutError::Disconnected) => {
            kill(child);
            return Outcome::Lost("its answer was lost".to_owned());
        }
    };
    if found.len() > most {
        kill(child);
        return Outcome::Talkative;
    }
    // it has closed its output; most programs end then
    let mut pause = Duration::from_micros(200);
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Outcome::Ended(status, found),
            Ok(None) if Instant::now() >= deadline => {
                kill(child);
                return Outcome::Late;
            }
            Ok(None) => {
                thread::sleep(pause);
                pause = (2 * pause).min(Duration::from_millis(20));
            }
            Err(error) => {
                kill(child);
                return Outcome::Lost(format!("its end was not seen: {error}"));
            }
        }
    }
}

/// Ends the program with all that it has started, and reaps it.
fn kill(child: &mut Child) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id())
        .ok()
        .and_then(rustix::process::Pid::from_raw)
    {
        // it may have ended already
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// The bytes that `read` gives, from a thread of its own.
fn gathered(read: impl FnOnce() -> Vec<u8> + Send + 'static) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        // nobody may be waiting any more
        let _ = sender.send(read());
    });
    receiver
}

/// At most so many bytes.
fn read(from: impl Read, most: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    // what was read before an error is judged as an answer
    let _ = from.take(most as u64).read_to_end(&mut bytes);
    bytes
}

/// The last bytes of all that comes.
fn tail(mut from: impl Read) -> Vec<u8> {
    let mut kept = Vec::new();
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut buffer) {
        kept.extend_from_slice(&buffer[..count]);
        if kept.len() > 2 * COMPLAINT {
            kept.drain(..kept.len() - COMPLAINT);
        }
    }
    kept
}
