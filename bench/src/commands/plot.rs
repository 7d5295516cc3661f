//! `raywood-bench plot`: a recorded run of `build` as a picture.

use std::fs;
use std::path::PathBuf;

use super::output::read;
use crate::build::pareto::svg;
use crate::failure::Failure;

/// Draw the time to build against the time to trace, from a recorded run of `build --trace`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// What `build --trace --json` wrote
    file: PathBuf,

    /// The SVG to write
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let picture = svg(&read(&args.file)?)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", args.file.display())))?;
    fs::write(&args.output, picture)
        .map_err(|error| Failure::WhileRunning(format!("{}: {error}", args.output.display())))
}
