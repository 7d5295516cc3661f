//! `raywood-bench table`: the summary of a recorded run.

use std::fs;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::table::{markdown, replace};

/// Print the summary of a recorded run as Markdown.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// What `trace --json` wrote
    file: PathBuf,

    /// Put it into a page instead, between the marks that are there
    #[arg(long, value_name = "PAGE")]
    into: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let complain = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::BadInput(format!("{}: {error}", path.display()))
    };
    let read = |path: &Path| fs::read_to_string(path).map_err(|error| complain(path, &error));
    let run = serde_json::from_str(&read(&args.file)?).map_err(|e| complain(&args.file, &e))?;
    let summary = markdown(&run).map_err(|error| complain(&args.file, &error))?;
    let Some(page) = &args.into else {
        print!("{summary}");
        return Ok(());
    };
    let text = replace(&read(page)?, &summary).map_err(|error| complain(page, &error))?;
    fs::write(page, text).map_err(Failure::while_running)
}
