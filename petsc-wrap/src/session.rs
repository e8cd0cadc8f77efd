//! MPI, then PETSc; finalised in reverse.

use std::cell::Cell;
use std::ffi::{CString, c_char, c_int};
use std::rc::Rc;

use mpi::environment::Universe;
use mpi::traits::Communicator;
use petsc_sys as sys;

use crate::comm::Comm;
use crate::error::{Error, Result, check};

/// The running MPI and PETSc; at most one a process, ever.
///
/// Clones share it. The last one to go (a handle's or this) destroys what is queued and finalises PETSc and MPI, which
/// is collective; a rank that must leave alone calls [`Session::abort`].
#[derive(Clone)]
pub struct Session(Rc<Inner>);

pub(crate) struct Inner {
    /// Dropped after PETSc is finalised.
    universe: Universe,
    finalized: Cell<bool>,
}

/// Settings of Open MPI for a process that nobody launched: no daemon for processes that it might spawn, and no search for
/// networks. They take a third of a second, many times what a small impact does. What the user sets stands. No folder for the session
/// either: without the daemon all such processes would have the same one, which the first to end takes from the others.
const ALONE: [(&str, &str); 3] =
    [("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_orte_create_session_dirs", "0"), ("OMPI_MCA_pml", "ob1")];

/// What mpirun and srun leave in the environment.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK"];

fn start_alone_quickly() {
    if LAUNCHED.iter().any(|name| std::env::var_os(name).is_some()) {
        return;
    }
    for (name, value) in ALONE {
        if std::env::var_os(name).is_none() {
            // SAFETY: the program has no other thread before MPI is initialised, so none reads the environment meanwhile.
            unsafe { std::env::set_var(name, value) };
        }
    }
}

impl Session {
    /// Initialises MPI, then PETSc with the given options (as on a command line) beside those of `PETSC_OPTIONS`.
    ///
    /// # Errors
    /// PETSc refuses the options. `None` where MPI was initialised before in this process.
    pub fn start(options: &[String]) -> Option<Result<Self>> {
        start_alone_quickly();
        let universe = mpi::initialize()?;
        Some(Self::with_universe(universe, options))
    }

    fn with_universe(universe: Universe, options: &[String]) -> Result<Self> {
        // MPI's and the program's own signal handling stay in charge.
        let words = ["ricochet".to_owned(), "-no_signal_handler".to_owned()];
        let owned: Vec<CString> =
            words.iter().chain(options).map(|word| CString::new(word.replace('\0', "")).unwrap_or_default()).collect();
        let mut argv: Vec<*mut c_char> = owned.iter().map(|word| word.as_ptr().cast_mut()).collect();
        let mut argc = argv.len() as c_int;
        argv.push(std::ptr::null_mut());
        let mut args = argv.as_mut_ptr();
        // SAFETY: MPI is initialised; argc and the NULL-terminated argv outlive the call. PETSc keeps argv in a global
        // for PetscGetArgs, which is not called here.
        check(unsafe { sys::PetscInitialize(&raw mut argc, &raw mut args, std::ptr::null(), std::ptr::null()) })?;
        // SAFETY: the handler has the right type and needs no context.
        check(unsafe { sys::PetscPushErrorHandler(Some(crate::error::record), std::ptr::null_mut()) })?;
        Ok(Self(Rc::new(Inner { universe, finalized: Cell::new(false) })))
    }

    /// All ranks.
    pub fn world(&self) -> Comm {
        Comm::new(self.clone(), self.0.universe.world())
    }

    /// This rank alone.
    pub fn alone(&self) -> Comm {
        Comm::new(self.clone(), mpi::topology::SimpleCommunicator::self_comm())
    }

    /// Ends all ranks at once with this exit status.
    pub fn abort(&self, status: i32) -> ! {
        self.0.universe.world().abort(status)
    }

    /// Finalises PETSc (collective) and tells what it says; otherwise done when the last handle is dropped.
    ///
    /// # Errors
    /// PETSc's.
    pub fn finish(self) -> Result<()> {
        match Rc::try_unwrap(self.0) {
            Ok(inner) => inner.finalize(),
            Err(shared) => {
                let handles = Rc::strong_count(&shared);
                Err(Error::Callback(format!("{handles} PETSc handles outlive the session").into()))
            }
        }
    }
}

impl Inner {
    fn finalize(&self) -> Result<()> {
        if self.finalized.replace(true) {
            return Ok(());
        }
        // SAFETY: every handle keeps this alive, so all of them are gone and only queued objects are left.
        check(unsafe { sys::PetscGarbageCleanup(sys::PETSC_COMM_WORLD) })?;
        // SAFETY: as above; MPI is still initialised.
        check(unsafe { sys::PetscFinalize() })
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The other ranks are somewhere else: waiting for them in PetscFinalize would wait for ever.
            self.universe.world().abort(PANICKED);
        }
        if let Err(error) = self.finalize() {
            eprintln!("PETSc could not be finalised: {error}");
        }
    }
}

/// Exit status after a panic, as of any Rust program.
const PANICKED: i32 = 101;

/// PETSc's version as `major.minor.patch`.
pub fn petsc_version() -> String {
    format!("{}.{}.{}", sys::PETSC_VERSION_MAJOR, sys::PETSC_VERSION_MINOR, sys::PETSC_VERSION_SUBMINOR)
}
