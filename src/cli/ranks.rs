//! Ranks: processes that `mpirun` starts to trace one run together.
//!
//! Only the main thread of a rank speaks MPI (`MPI_THREAD_FUNNELED`), so communicators, which are not `Send`, need no
//! `unsafe` and no lock; threads of the pool trace.

use std::env;
use std::process::ExitCode;

use mpi::Threading;
use mpi::environment::Universe;
use mpi::topology::{Communicator, SimpleCommunicator};

use crate::error::{Diagnostic, Kind, Result};

use super::fail;

/// Set for every process that the launcher of an MPI library starts: by Open MPI, by MPICH and Slurm's PMI, by PMIx.
const LAUNCHED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"];

/// One of the processes of a run.
pub(super) struct Ranks {
    world: SimpleCommunicator,
    /// Ends MPI when it goes: all ranks wait there for each other.
    _universe: Universe,
}

impl Ranks {
    /// Of a process that a launcher started; `None` for any other, which pays nothing for MPI.
    ///
    /// # Errors
    /// An MPI library without threads.
    pub(super) fn started() -> Result<Option<Self>> {
        if !LAUNCHED.iter().any(|name| env::var_os(name).is_some()) {
            return Ok(None);
        }
        let Some((universe, provided)) = mpi::initialize_with_threading(Threading::Funneled) else {
            return Ok(None);
        };
        if provided < Threading::Funneled {
            let found = format!("an MPI library that allows the threads of `{provided:?}`");
            let required = "MPI_THREAD_FUNNELED: one thread that communicates beside those that trace";
            return Err(Diagnostic::new(Kind::Limit, found, required));
        }
        Ok(Some(Self { world: universe.world(), _universe: universe }))
    }

    /// The same, which so far must be the only process of its run.
    ///
    /// # Errors
    /// The exit code of a process that cannot go on; of several processes the first says why.
    pub(super) fn alone() -> std::result::Result<Option<Self>, ExitCode> {
        let ranks = Self::started().map_err(|error| ExitCode::from(fail(None, &[error])))?;
        let Some(ranks) = ranks else { return Ok(None) };
        if ranks.size() == 1 {
            return Ok(Some(ranks));
        }
        if ranks.rank() > 0 {
            return Err(ExitCode::SUCCESS);
        }
        let found = format!("{} processes that are to trace one run together", ranks.size());
        let error = Diagnostic::new(Kind::Unavailable, found, "one process: `mpirun -n 1`, or no `mpirun`");
        Err(ExitCode::from(fail(None, &[error])))
    }

    /// This process among the others: 0 reads, reports and writes.
    pub(super) fn rank(&self) -> u32 {
        self.world.rank().unsigned_abs()
    }

    /// Number of processes.
    pub(super) fn size(&self) -> u32 {
        self.world.size().unsigned_abs()
    }
}

impl Drop for Ranks {
    /// A panic of one rank ends all: else `MPI_Finalize` waits for ranks that wait for this one.
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.world.abort(1);
        }
    }
}
