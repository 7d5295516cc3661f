//! The subcommands, one per file. To add one, write its file and name it here.

mod build;
mod names;
mod output;
mod plot;
mod query;
mod scene_args;
mod table;
mod trace;

use clap::Subcommand;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::Failure;

/// What to do.
#[derive(Subcommand)]
pub(crate) enum Command {
    Trace(Box<trace::Args>),
    Build(Box<build::Args>),
    Query(Box<query::Args>),
    Table(table::Args),
    Plot(plot::Args),
}

impl Command {
    /// Does it.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Trace(args) => trace::run(args),
            Self::Build(args) => build::run(args),
            Self::Query(args) => query::run(args),
            Self::Table(args) => table::run(args),
            Self::Plot(args) => plot::run(args),
        }
    }
}

/// A pool of threads for each number of them.
fn pools(threads: &[u16]) -> Result<Vec<ThreadPool>, Failure> {
    let pool = |&threads: &u16| ThreadPoolBuilder::new().num_threads(threads.into()).build();
    threads
        .iter()
        .map(pool)
        .collect::<Result<_, _>>()
        .map_err(|error| Failure::while_running(format!("cannot start the threads: {error}")))
}
