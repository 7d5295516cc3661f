//! How a comparison is written: one format per file. To add one, write its file and name it here.

mod contents;
mod csv;
pub(crate) mod html;
mod json;
mod markdown;
mod table;

use raywood_lab::Comparison;

pub(crate) use json::structure;

/// A comparison and what it was made of.
pub(crate) struct Compared<'a> {
    /// The scene's name.
    pub(crate) scene: &'a str,
    /// What was found.
    pub(crate) comparison: &'a Comparison,
}

/// The formats for standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    /// For reading in a terminal
    Table,
    /// For pasting into a page
    Markdown,
    /// One line per structure and kind of rays
    Csv,
    /// Everything
    Json,
}

impl Format {
    /// The comparison in this format, with a line's end at the end.
    pub(crate) fn write(self, compared: &Compared<'_>) -> String {
        match self {
            Self::Table => table::write(compared),
            Self::Markdown => markdown::write(compared),
            Self::Csv => csv::write(compared),
            Self::Json => json::write(compared),
        }
    }
}
