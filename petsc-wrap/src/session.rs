//! Starts MPI and then PETSc, and finalises them in reverse order.

use std::cell::{Cell, OnceCell};
use std::ffi::{CString, c_char, c_int};
use std::rc::Rc;

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Error, Result, check};
use crate::memory::check_address_space;
use crate::options;
use crate::text::to_c;

/// The running MPI and PETSc. A process can have only one session in its lifetime.
///
/// A process with one rank and without options for PETSc loads and initialises PETSc when its first object is made. A
/// program that needs no such object starts in a fraction of the time. Several ranks initialise PETSc together at the
/// start.
///
/// Clones share the session. When the last clone or handle is dropped, the queued objects are destroyed and PETSc is
/// finalised, which is collective. MPI is finalised when the process then exits, since copies of a communicator of the
/// `mpi` crate may outlive the session. A rank that must leave alone calls [`Session::abort`].
#[derive(Clone)]
pub struct Session(Rc<Inner>);

pub(crate) struct Inner {
    finalized: Cell<bool>,
    /// Initialised at most once.
    petsc: OnceCell<CommandLine>,
}

/// The command line that PETSc was started with, which PETSc keeps.
struct CommandLine {
    _argv: Vec<*mut c_char>,
    _arguments: Vec<CString>,
}

/// Environment variable with options for PETSc.
const OPTIONS: &str = "PETSC_OPTIONS";

impl Session {
    /// Initialises MPI. Also initialises PETSc if there are options for it or several ranks. `options` (in the form of
    /// a command line) are used in addition to the options in `PETSC_OPTIONS`. Returns `None` if MPI was already
    /// initialised in this process.
    ///
    /// # Errors
    /// If PETSc cannot be loaded, or refuses the options.
    pub fn start(options: &[String]) -> Option<Result<Self>> {
        // Dropping it would finalise MPI.
        std::mem::forget(mpi::initialize()?);
        let is_alone = SimpleCommunicator::world().size() == 1;
        let session = Self(Rc::new(Inner { finalized: Cell::new(false), petsc: OnceCell::new() }));
        let waits = is_alone && options.is_empty() && std::env::var_os(OPTIONS).is_none_or(|text| text.is_empty());
        if waits {
            return Some(Ok(session));
        }
        Some(session.load_together().and_then(|()| session.start_petsc(options)).map(|()| session))
    }

    /// Loads and initialises PETSc if this has not been done yet, like the first object would.
    ///
    /// # Errors
    /// If PETSc cannot be loaded, or does not start.
    pub fn petsc(&self) -> Result<()> {
        if self.has_petsc() { Ok(()) } else { self.start_petsc(&[]) }
    }

    /// Whether PETSc is initialised.
    pub(crate) fn has_petsc(&self) -> bool {
        self.0.petsc.get().is_some()
    }

    /// Loads PETSc on all ranks. If one rank cannot load it, no rank starts it, since the start is collective, and all
    /// return the error of the first rank that failed. Collective.
    fn load_together(&self) -> Result<()> {
        let world = SimpleCommunicator::world();
        let why = load().err();
        let failing = if why.is_some() { world.rank() } else { world.size() };
        let mut first = failing;
        world.all_reduce_into(&failing, &mut first, SystemOperation::min());
        if first == world.size() {
            return Ok(());
        }
        let mut text = why.unwrap_or_default().into_bytes();
        let mut length = text.len();
        let from = world.process_at_rank(first);
        from.broadcast_into(&mut length);
        text.resize(length, 0);
        from.broadcast_into(&mut text);
        let mut text = String::from_utf8_lossy(&text).into_owned();
        if world.size() > 1 {
            text += &format!(" (rank {first} of {})", world.size());
        }
        Err(Error::NotLoaded(text))
    }

    fn start_petsc(&self, options: &[String]) -> Result<()> {
        let library = load().map_err(Error::NotLoaded)?;
        let program = std::env::args_os().next();
        let program = program.map_or_else(|| "program".to_owned(), |path| path.to_string_lossy().into_owned());
        let words = [&program[..]].into_iter().chain(options::SESSION_OPTIONS);
        let arguments: Vec<CString> = words.chain(options.iter().map(String::as_str)).map(to_c).collect();
        let mut argv: Vec<*mut c_char> = arguments.iter().map(|word| word.as_ptr().cast_mut()).collect();
        let mut argc = c_int::try_from(argv.len()).map_err(|_| Error::TooLarge { number: argv.len() })?;
        argv.push(std::ptr::null_mut());
        let mut args = argv.as_mut_ptr();
        // SAFETY: MPI is initialised; argc and the NULL-terminated argv are valid. PETSc keeps argv. The session keeps
        // it too; if PETSc does not start, nobody calls PETSc any more.
        check(unsafe { sys::PetscInitialize(&raw mut argc, &raw mut args, std::ptr::null(), std::ptr::null()) })?;
        let _ = self.0.petsc.set(CommandLine { _argv: argv, _arguments: arguments });
        // SAFETY: the handler has the right type and needs no context.
        check(unsafe { sys::PetscPushErrorHandler(Some(crate::error::record), std::ptr::null_mut()) })?;
        // Some packages (CHOLMOD, for instance) print a message in addition to the error that they return. Users should
        // not see it.
        // SAFETY: PETSc reads this pointer only in its own calls, and no other thread makes any.
        unsafe { *sys::PetscErrorPrintf() = Some(library.PetscErrorPrintfNone) };
        Ok(())
    }

    /// Communicator of all ranks.
    pub fn world(&self) -> Comm {
        Comm::new(self.clone(), SimpleCommunicator::world())
    }

    /// Communicator of this rank alone.
    pub fn alone(&self) -> Comm {
        Comm::new(self.clone(), SimpleCommunicator::self_comm())
    }

    /// Ends all ranks immediately with this exit status.
    pub fn abort(&self, status: i32) -> ! {
        SimpleCommunicator::world().abort(status)
    }

    /// Ends this process immediately, without finalising anything and without the exit handlers of libraries. All ranks
    /// must call it.
    pub fn leave(&self, status: i32) -> ! {
        // SAFETY: the process ends here; no handler or destructor runs that could use data in an unknown state.
        unsafe { libc::_exit(status) }
    }

    /// Finalises PETSc (collective) and returns its errors. Without this call, PETSc is finalised when the last handle
    /// is dropped.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn finish(self) -> Result<()> {
        // Dropped objects may still hold the session, for example closures with a communicator.
        self.world().collect_garbage()?;
        match Rc::try_unwrap(self.0) {
            Ok(inner) => inner.finalize(),
            Err(shared) => {
                let handles = Rc::strong_count(&shared);
                Err(Error::Callback(format!("{handles} PETSc handles outlive the session").into()))
            }
        }
    }
}

/// Loads PETSc, if the process has enough address space for it.
fn load() -> std::result::Result<&'static sys::Library, String> {
    check_address_space()?;
    sys::load()
}

impl Inner {
    fn finalize(&self) -> Result<()> {
        if self.finalized.replace(true) || self.petsc.get().is_none() {
            return Ok(());
        }
        // SAFETY: every handle keeps this alive, so all handles are gone and only queued objects are left.
        check(unsafe { sys::PetscGarbageCleanup(*sys::PETSC_COMM_WORLD()) })?;
        // SAFETY: as above; MPI is still initialised.
        check(unsafe { sys::PetscFinalize() })
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The other ranks are somewhere else in the program: PetscFinalize would wait for them for ever.
            SimpleCommunicator::world().abort(PANICKED);
        }
        if let Err(error) = self.finalize() {
            eprintln!("PETSc could not be finalised: {error}");
        }
        // Not earlier: a rank that exits while its session lives shall end the others, and not wait for them.
        // SAFETY: the function has the type of an exit handler.
        unsafe { libc::atexit(end_mpi) };
    }
}

/// Finalises MPI. To be called once, when the process exits after its session.
extern "C" fn end_mpi() {
    // SAFETY: MPI was initialised by the session. The destructors of the program's own values have run.
    unsafe { mpi::ffi::MPI_Finalize() };
}

/// Exit status after a panic, the same as for any Rust program.
const PANICKED: i32 = 101;

/// PETSc's version as `major.minor.patch`.
pub fn petsc_version() -> String {
    format!("{}.{}.{}", sys::PETSC_VERSION_MAJOR, sys::PETSC_VERSION_MINOR, sys::PETSC_VERSION_SUBMINOR)
}
