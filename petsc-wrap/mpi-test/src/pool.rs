//! The ranks of a test program: they are started when first needed and kept for the next test.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::os::unix::net::{UnixListener, UnixStream};
use std::process::{Child, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;
use tempfile::TempDir;

use crate::cores::Cores;
use crate::launch::{keep_files_in, mpirun};
use crate::message::{Order, Report, receive, send};
use crate::times;
use crate::worker::ROLE;

/// Time limit of a test: longer than any test takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(900);

/// Time limit for the start and the end of mpirun: longer than they take.
const STARTUP: Duration = Duration::from_secs(120);

/// Ranks that wait for a test, by number of ranks.
pub struct Pool {
    cores: Cores,
    /// Whether output is shown immediately, and not only for failed tests.
    shows_output: bool,
    idle: Mutex<HashMap<usize, Vec<Ranks>>>,
}

impl Pool {
    /// Creates a pool without ranks.
    pub fn new(cores: Cores, shows_output: bool) -> Self {
        Self { cores, shows_output, idle: Mutex::default() }
    }

    /// Runs a test on `count` ranks, once there are cores for them, and records its times under `name`.
    pub fn run(&self, count: usize, test: &str, name: &str) -> Result<(), Failed> {
        let run = || {
            let waiting = self.idle().get_mut(&count).and_then(Vec::pop);
            let mut ranks = match waiting {
                Some(ranks) => ranks,
                None => {
                    Ranks::start(count, self.shows_output).map_err(|error| format!("mpirun -n {count}: {error}"))?
                }
            };
            let processor = ranks.run(test)?;
            self.idle().entry(count).or_default().push(ranks);
            Ok(Some(processor))
        };
        self.cores.with(count, || times::timed(name, run))
    }

    /// Ends all waiting ranks.
    ///
    /// # Errors
    /// Their output, if they do not end normally. At the end they drop their context and finalise MPI.
    pub fn finish(&self) -> Result<(), String> {
        let all: Vec<Ranks> = self.idle().drain().flat_map(|(_, ranks)| ranks).collect();
        all.into_iter().try_for_each(Ranks::finish)
    }

    fn idle(&self) -> std::sync::MutexGuard<'_, HashMap<usize, Vec<Ranks>>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Processes of this program under one mpirun.
struct Ranks {
    mpirun: Child,
    connections: Vec<Connection>,
    /// Their output, if it is not shown immediately.
    output: Option<File>,
    _folder: TempDir,
}

struct Connection {
    rank: usize,
    reports: BufReader<UnixStream>,
}

impl Ranks {
    fn start(count: usize, shows_output: bool) -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        let socket = folder.path().join("orders");
        let listener = UnixListener::bind(&socket)?;
        let mut command = mpirun(count);
        keep_files_in(folder.path(), &mut command);
        command.arg(std::env::current_exe()?).env(ROLE, &socket).stdin(Stdio::null());
        let mut output = None;
        if !shows_output {
            let path = folder.path().join("output");
            let file = File::create(&path)?;
            command.stdout(file.try_clone()?).stderr(file);
            output = Some(File::open(path)?);
        }
        let mut ranks = Self { mpirun: command.spawn()?, connections: Vec::new(), output, _folder: folder };
        listener.set_nonblocking(true)?;
        let begin = Instant::now();
        while ranks.connections.len() < count {
            match listener.accept() {
                Ok((stream, _)) => ranks.connections.push(Connection::new(stream)?),
                Err(error) if error.kind() != io::ErrorKind::WouldBlock => return Err(error),
                Err(_) if ranks.mpirun.try_wait()?.is_some() || begin.elapsed() > STARTUP => {
                    return Err(io::Error::other(format!("no ranks came up\n{}", ranks.printed())));
                }
                Err(_) => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        Ok(ranks)
    }

    /// Runs a test on all of these ranks; they are ended if it fails.
    fn run(&mut self, test: &str) -> Result<f64, Failed> {
        if let Some(output) = &mut self.output {
            output.seek(SeekFrom::End(0)).map_err(|error| error.to_string())?;
        }
        for connection in &mut self.connections {
            send(&Order::Run(test.to_owned()), connection.reports.get_mut()).map_err(|error| error.to_string())?;
        }
        let (mut failures, mut taken) = (Vec::new(), 0.0);
        for Connection { rank, reports } in &mut self.connections {
            match receive(reports) {
                Ok(Some(Report::Passed { processor })) => taken += processor,
                Ok(Some(Report::Failed { message })) => failures.push(format!("rank {rank}: {message}")),
                // This rank ended together with the one that failed, or on its own.
                Ok(_) => failures.push(format!("rank {rank} ended")),
                Err(error) => failures.push(format!("rank {rank}: no answer within {LIMIT:?} ({error})")),
            }
            if !failures.is_empty() {
                break;
            }
        }
        if failures.is_empty() {
            return Ok(taken);
        }
        // The failed rank may not be the first one that was heard.
        self.end();
        for Connection { rank, reports } in &mut self.connections {
            // A rank that hangs sends no more messages.
            let _ = reports.get_ref().set_read_timeout(Some(Duration::from_secs(1)));
            if let Ok(Some(Report::Failed { message })) = receive(reports) {
                failures.push(format!("rank {rank}: {message}"));
            }
        }
        Err(format!("{}\n{}", failures.join("\n"), self.printed()).into())
    }

    fn finish(mut self) -> Result<(), String> {
        self.dismiss();
        if self.end() {
            return Ok(());
        }
        Err(format!("{} rank(s) did not end in order\n{}", self.connections.len(), self.printed()))
    }

    /// Closes the sending side of the connections, so that the ranks get no more orders.
    fn dismiss(&self) {
        for connection in &self.connections {
            let _ = connection.reports.get_ref().shutdown(std::net::Shutdown::Write);
        }
    }

    /// Waits for mpirun, with a time limit; it ends when a rank fails. Returns whether it ended successfully.
    fn end(&mut self) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(30) {
            match self.mpirun.try_wait() {
                Ok(None) => std::thread::sleep(Duration::from_millis(5)),
                Ok(Some(status)) => return status.success(),
                Err(_) => return false,
            }
        }
        let _ = self.mpirun.kill();
        let _ = self.mpirun.wait();
        false
    }

    fn printed(&mut self) -> String {
        let mut text = Vec::new();
        if let Some(output) = &mut self.output {
            let _ = output.read_to_end(&mut text);
        }
        String::from_utf8_lossy(&text).into_owned()
    }
}

impl Connection {
    fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(STARTUP))?;
        let mut reports = BufReader::new(stream);
        let Some(Report::Ready { rank }) = receive(&mut reports)? else {
            return Err(io::Error::other("a rank ended before its first word"));
        };
        reports.get_ref().set_read_timeout(Some(LIMIT))?;
        Ok(Self { rank, reports })
    }
}

impl Drop for Ranks {
    fn drop(&mut self) {
        self.dismiss();
        self.end();
    }
}
