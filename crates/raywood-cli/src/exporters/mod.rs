//! How what was measured is written: one kind of report per folder, one format per file. A new report implements [`Export`]; a new format
//! is a line in [`Format`].

pub(crate) mod benchmark;
pub(crate) mod comparison;
mod contents;
mod json;
mod markdown;
mod table;

use serde_json::Value;

pub(crate) use contents::Contents;
pub(crate) use json::structure;

/// What can be written in every format.
pub(crate) trait Export {
    /// What people read, rounded.
    fn contents(&self) -> Contents;

    /// Lines of comma-separated values, the first with their names.
    fn csv(&self) -> String;

    /// Everything.
    fn json(&self) -> Value;
}

/// The formats for standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// For reading in a terminal
    Table,
    /// For pasting into a page
    Markdown,
    /// One line per thing that was timed
    Csv,
    /// Everything
    Json,
}

impl Format {
    /// The report in this format, with a line's end at the end.
    pub(crate) fn write(self, report: &impl Export) -> String {
        match self {
            Self::Table => table::write(&report.contents()),
            Self::Markdown => markdown::write(&report.contents()),
            Self::Csv => report.csv(),
            Self::Json => format!("{:#}\n", report.json()),
        }
    }
}
