//! The processes that `mpirun` starts, and the messages between them.
//!
//! Only the main thread of a rank speaks MPI (`MPI_THREAD_FUNNELED`), so communicators, which are not `Send`, need no
//! `unsafe` and no lock; threads of the pool trace.

use std::env;
use std::time::Duration;

use mpi::Threading;
use mpi::environment::Universe;
use mpi::point_to_point::{Destination, MatchedReceiveVec, Source};
use mpi::topology::{Communicator, SimpleCommunicator};

use crate::error::{Diagnostic, Kind, Result};
use crate::run::share::Post;

/// Set for every process that the launcher of an MPI library starts: by Open MPI, by MPICH and Slurm's PMI, by PMIx.
const LAUNCHED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"];

/// Between two looks at whether a message has gone out.
const SENDING: Duration = Duration::from_micros(50);

/// One of the processes of a run.
pub struct Ranks {
    world: SimpleCommunicator,
    neighbours: u32,
    /// Ends MPI when it goes: all ranks wait there for each other.
    _universe: Universe,
}

impl Ranks {
    /// Of a process that a launcher started together with others; `None` for any other, which pays nothing for MPI.
    ///
    /// # Errors
    /// An MPI library without threads.
    pub fn started() -> Result<Option<Self>> {
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
        let world = universe.world();
        let neighbours = world.split_shared(0).size().unsigned_abs();
        Ok(Some(Self { world, neighbours, _universe: universe }))
    }
}

impl Post for Ranks {
    fn rank(&self) -> u32 {
        self.world.rank().unsigned_abs()
    }

    fn size(&self) -> u32 {
        self.world.size().unsigned_abs()
    }

    fn neighbours(&self) -> u32 {
        self.neighbours
    }

    /// A message has fewer than 2^31 bytes: the maps of all replicates are a gibibyte at most.
    fn send(&self, to: u32, message: &[u8]) {
        let to = self.world.process_at_rank(to.cast_signed());
        mpi::request::scope(|scope| {
            let mut request = to.immediate_send(scope, message);
            // Not in a call that waits: it takes a core until the other rank listens.
            while let Err(pending) = request.test() {
                request = pending;
                std::thread::sleep(SENDING);
            }
        });
    }

    fn poll(&self) -> Option<(u32, Vec<u8>)> {
        let probed = self.world.any_process().immediate_matched_probe()?;
        let (message, status) = probed.matched_receive_vec::<u8>();
        Some((status.source_rank().unsigned_abs(), message))
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
