//! The subcommands, one per file. To add one, write its file and name it here.

mod table;
mod trace;

use clap::Subcommand;

use crate::failure::Failure;

/// What to do.
#[derive(Subcommand)]
pub(crate) enum Command {
    Trace(Box<trace::Args>),
    Table(table::Args),
}

impl Command {
    /// Does it.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Trace(args) => trace::run(args),
            Self::Table(args) => table::run(args),
        }
    }
}
