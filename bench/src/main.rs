//! The command `raywood-bench`: Raywood beside other ray tracing kernels, on the same rays in the same run. `README.md` says how to
//! use it, `BIAS.md` what not to conclude from it.

mod answers;
mod build;
mod commands;
mod cut;
mod embree;
mod failure;
mod machine;
mod measure;
mod memory;
mod outcome;
mod page;
mod peers;
mod pinhole;
mod pixel_order;
mod query;
mod ratios;
mod ray_sets;
mod reference;
mod report;
mod scenes;
mod table;

use std::process::ExitCode;

use clap::Parser;

/// Raywood beside other ray tracing kernels.
#[derive(Parser)]
#[command(name = "raywood-bench", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 done, 1 failed while running, 2 usage or bad input")]
struct Cli {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    match Cli::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("raywood-bench: error: {failure}");
            failure.exit_code()
        }
    }
}
