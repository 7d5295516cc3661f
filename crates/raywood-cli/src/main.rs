//! The program of the command, all of which is in `lib.rs`.

use std::process::ExitCode;

fn main() -> ExitCode {
    raywood_cli::run()
}
