//! Files of JSON that commands write and read again.

use std::fs::File;
use std::path::Path;

use serde_json::Value;

use crate::failure::Failure;

/// Finds out whether a file can be written, before long work and without harm to what is there.
pub(super) fn try_to_write(file: &Path) -> Result<(), Failure> {
    File::options().append(true).create(true).open(file).map(drop).map_err(|error| {
        Failure::BadInput(format!("{}: cannot be written: {error}", file.display()))
    })
}

/// Writes a file anew.
pub(super) fn write(file: &Path, value: &Value) -> Result<(), Failure> {
    std::fs::write(file, format!("{value:#}\n"))
        .map_err(|error| Failure::WhileRunning(format!("{}: {error}", file.display())))
}

/// Reads a file that was written.
pub(super) fn read(file: &Path) -> Result<Value, Failure> {
    let complain =
        |error: &dyn std::fmt::Display| Failure::BadInput(format!("{}: {error}", file.display()));
    let text = std::fs::read_to_string(file).map_err(|error| complain(&error))?;
    serde_json::from_str(&text).map_err(|error| complain(&error))
}
