//! `raywood-bench table`: the summary of a recorded run.

use std::fs;
use std::path::{Path, PathBuf};

use super::output;
use crate::failure::Failure;
use crate::page::{Marks, replace};
use crate::{build, query, table};

/// Print the summary of a recorded run as Markdown.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// What `trace --json`, `build --json` or `query --json` wrote
    file: PathBuf,

    /// Put it into a page instead, between the marks that are there
    #[arg(long, value_name = "PAGE")]
    into: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let complain = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::BadInput(format!("{}: {error}", path.display()))
    };
    let run = output::read(&args.file)?;
    let (marks, summary) = match run["command"].as_str() {
        Some("build") => (Marks::Builds, build::table::markdown(&run)),
        Some("query") => (Marks::Queries, query::table::markdown(&run)),
        _ => (Marks::Traces, table::markdown(&run)),
    };
    let summary = summary.map_err(|error| complain(&args.file, &error))?;
    let Some(page) = &args.into else {
        print!("{summary}");
        return Ok(());
    };
    let text = fs::read_to_string(page).map_err(|error| complain(page, &error))?;
    let text = replace(&text, marks, &summary).map_err(|error| complain(page, &error))?;
    fs::write(page, text).map_err(Failure::while_running)
}
