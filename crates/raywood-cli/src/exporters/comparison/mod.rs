//! `raywood compare`: structures on the same rays.

mod contents;
mod csv;
pub(crate) mod html;
mod json;

use raywood_lab::Comparison;
use serde_json::Value;

use super::{Contents, Export};

/// A comparison and what it was made of.
pub(crate) struct Compared<'a> {
    /// The scene's name.
    pub(crate) scene: &'a str,
    /// What was found.
    pub(crate) comparison: &'a Comparison,
}

impl Export for Compared<'_> {
    fn contents(&self) -> Contents {
        contents::contents(self)
    }

    fn csv(&self) -> String {
        csv::write(self)
    }

    fn json(&self) -> Value {
        json::write(self)
    }
}
