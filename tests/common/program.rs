//! Runs the program like a user: alone or under mpirun, with a time limit.

use std::fs::{self, File};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A small box whose run takes a tenth of a second: 50 time steps of a solid, 150 unknowns.
#[allow(dead_code, reason = "not every test that shares this module runs it")]
pub const BOX: &str = r#"title = "Small plate"
[body]
model = "solid"
reduction = "none"
young = 70e9
poisson = 0.23
density = 2500
size = [0.5, 0.5, 0.02]
cells = [4, 4, 1]
order = 1
symmetry = "none"
[impactor]
mass = 52
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1
[time]
end = 1e-3
step = 2e-5
[contact]
localization = "point"
[solver]
newton = "full"
"#;

/// Time limit of a run. Everything ends sooner even on a machine with many times its load; only a program that hangs
/// reaches it.
pub const LIMIT: Duration = Duration::from_secs(300);

/// Exit status and output of the program.
#[derive(Debug)]
#[allow(dead_code, reason = "not every test that shares this module reads all")]
pub struct Outcome {
    pub status: Option<i32>,
    pub signal: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    /// Standard error without the lines of progress, which appear on slow machines.
    pub fn told(&self) -> String {
        let is_progress = |line: &&str| line.starts_with("step ") || line.ends_with(" so far)");
        self.stderr.lines().filter(|line| !is_progress(line)).map(|line| format!("{line}\n")).collect()
    }
}

/// The program in `folder`, under mpirun on this number of ranks, or alone if `ranks` is 0.
pub fn ricochet(folder: &Path, ranks: usize) -> Command {
    let program = env!("CARGO_BIN_EXE_ricochet");
    let mut command = match ranks {
        0 => Command::new(program),
        ranks => {
            let mut command = mpi_test::mpirun(ranks);
            command.arg(program);
            command
        }
    };
    command.current_dir(folder).env("OMP_NUM_THREADS", "1").env_remove("PETSC_OPTIONS").env_remove("RICOCHET_LOG");
    command
}

/// A started program. Its output goes to files, so it does not block without a reader.
pub struct Started {
    pub child: Child,
    output: [std::path::PathBuf; 2],
    _folder: tempfile::TempDir,
}

pub fn start(command: &mut Command) -> Started {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let folder = tempfile::Builder::new()
        .prefix(&format!("output-{}-", NUMBER.fetch_add(1, Ordering::Relaxed)))
        .tempdir()
        .expect("a temporary folder");
    let output = ["stdout", "stderr"].map(|name| folder.path().join(name));
    let [stdout, stderr] = output.each_ref().map(|path| File::create(path).expect("a temporary file"));
    mpi_test::keep_files_in(folder.path(), command);
    // A separate process group, so that a signal to it reaches only mpirun and its helpers.
    let child = command.stdin(Stdio::null()).stdout(stdout).stderr(stderr).process_group(0).spawn();
    Started { child: child.expect("the program starts"), output, _folder: folder }
}

impl Started {
    /// Standard error so far.
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&fs::read(&self.output[1]).unwrap_or_default()).into_owned()
    }

    /// Waits for the end. A program that exceeds the limit is killed and fails the test.
    pub fn wait(mut self, limit: Duration) -> Outcome {
        let status = wait(&mut self.child, limit);
        // mpirun of Open MPI 5 ends its own messages with a NUL character.
        let text =
            |path: &std::path::PathBuf| String::from_utf8_lossy(&fs::read(path).unwrap_or_default()).replace('\0', "");
        let [stdout, stderr] = self.output.each_ref().map(text);
        let Some(status) = status else {
            panic!("not ended after {limit:?}; it said:\n{stdout}{stderr}");
        };
        Outcome { status: status.code(), signal: status.signal(), stdout, stderr }
    }
}

/// Kills the program if its test fails, because its folder is deleted too.
impl Drop for Started {
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = wait(&mut self.child, Duration::ZERO);
        }
    }
}

fn wait(child: &mut Child, limit: Duration) -> Option<ExitStatus> {
    let begin = Instant::now();
    while begin.elapsed() < limit {
        if let Some(status) = child.try_wait().expect("the child is ours") {
            return Some(status);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    // mpirun ends its ranks on SIGTERM.
    send("TERM", &format!("-{}", child.id()));
    std::thread::sleep(Duration::from_secs(3));
    send("KILL", &format!("-{}", child.id()));
    let _ = child.wait();
    None
}

/// Sends a signal to a process, or to a group (`-` and its number).
pub fn send(signal: &str, target: &str) {
    let _ = Command::new("kill").args([&format!("-{signal}"), "--", target]).stderr(Stdio::null()).status();
}

/// The child processes of a process.
#[allow(dead_code, reason = "not every test that shares this module ends ranks")]
pub fn children(parent: u32) -> Vec<String> {
    let parent = parent.to_string();
    fs::read_dir("/proc")
        .unwrap()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.bytes().all(|byte| byte.is_ascii_digit()))
        .filter(|process| {
            let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
            // Fields after the name in brackets: state, parent.
            let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().nth(1);
            fields == Some(parent.as_str())
        })
        .collect()
}

/// Runs the program to its end.
#[allow(dead_code, reason = "not every test that shares this module runs to the end")]
pub fn run(command: &mut Command) -> Outcome {
    start(command).wait(LIMIT)
}

/// Does the work for all items on a few threads; returns the messages of those that fail.
#[allow(dead_code, reason = "not every test that shares this module has many items")]
pub fn on_threads<T: Sync>(
    threads: usize,
    items: &[T],
    work: impl Fn(usize, &T) -> Result<(), String> + Sync,
) -> Vec<String> {
    let next = AtomicUsize::new(0);
    let failures = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let n = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(n) else { break };
                    if let Err(message) = work(n, item) {
                        failures.lock().unwrap_or_else(|e| e.into_inner()).push(message);
                    }
                }
            });
        }
    });
    failures.into_inner().unwrap_or_else(|e| e.into_inner())
}

/// Waits until a file has been written to this number of times more.
#[allow(dead_code, reason = "not every test that shares this module waits for files")]
pub fn wait_for_writes(path: &Path, count: usize) {
    let written = || path.metadata().and_then(|data| data.modified()).expect("the file is there");
    let begin = Instant::now();
    for _ in 0..count {
        let before = written();
        while written() == before {
            assert!(begin.elapsed() < LIMIT, "nothing is written");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Waits until a process has installed a handler for SIGTERM, the 15th signal.
#[allow(dead_code, reason = "not every test that shares this module sends signals")]
pub fn wait_for_handlers(process: u32) {
    let takes_sigterm = || {
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask >> 14 & 1 == 1)
    };
    let begin = Instant::now();
    while !takes_sigterm() {
        assert!(begin.elapsed() < LIMIT, "the program does not begin");
        std::thread::sleep(Duration::from_millis(5));
    }
}
