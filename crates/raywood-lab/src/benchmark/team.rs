//! Threads that work together, and the clock of their cores.

use super::clock::{self, Clock};
use super::error::BenchmarkError;
use crate::timing::Timing;

/// So many threads that work together.
pub(super) struct Team {
    pool: rayon::ThreadPool,
    /// The seconds of a cycle, before each measurement.
    cycles: Vec<f64>,
}

impl Team {
    pub(super) fn new(threads: usize) -> Result<Self, BenchmarkError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|_| BenchmarkError::Threads { threads })?;
        Ok(Self { pool, cycles: Vec::new() })
    }

    pub(super) fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Does something on the threads.
    pub(super) fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// Does something whose time counts on the threads, after a look at their clock, while all of them work: many cores are slower together
    /// than one alone.
    pub(super) fn measure<T: Send>(&mut self, work: impl FnOnce() -> T + Send) -> T {
        let cycles = self.pool.broadcast(|_| clock::cycle());
        self.cycles.push(Timing::new(cycles).median());
        self.run(work)
    }

    /// The clock, as it was before the measurements.
    pub(super) fn clock(&self) -> Clock {
        let threads = self.threads();
        let cores = std::thread::available_parallelism().map_or(threads, usize::from).min(threads);
        Clock { threads, cores, cycle: Timing::new(self.cycles.clone()) }
    }
}
