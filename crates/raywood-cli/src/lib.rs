//! The command `raywood`: a model file in, a ray-traced picture out.
//!
//! A library only so that tests and fuzz targets reach into the command; nothing here is meant for others, or stays as it is.

mod build_args;
mod checkpoint;
mod commands;
mod exporters;
mod failure;
mod image_args;
mod interrupt;
mod mapped_file;
mod output_file;
mod parse;
mod picture;
mod print;
mod progress_bar;
mod query;
mod report;
mod scene_source;
mod settings;
mod simd_args;
mod surroundings;
mod view_args;
mod watch;

use std::process::ExitCode;

use clap::Parser;

#[doc(hidden)]
pub use query::{FileRows, read_points, read_rays};

/// What follows the list of options.
const AFTER_HELP: &str = "\
Try: raywood render, raywood render model.glb -o picture.png

Exit codes: 0 done, 1 failed while running, 2 usage or bad input, 130 Ctrl-C";

/// Fast ray tracing of model files and built-in scenes.
#[derive(Parser)]
#[command(name = "raywood", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: commands::Command,
}

/// Does what the arguments of the process ask for.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    interrupt::install();
    match cli.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            print::failure(&failure);
            failure.exit_code()
        }
    }
}
