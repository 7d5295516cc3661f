//! Why a file could not be loaded: which file, where in it, what was found and what was expected.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be loaded. Prints as one line that names the file, the place in it, and what was found there
/// and expected instead: `model.obj:12: face uses vertex 9, but only 8 vertices precede it`.
#[derive(Debug)]
pub struct LoadError {
    file: PathBuf,
    place: Place,
    message: String,
    source: Option<io::Error>,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file; the first is 1.
    Line(usize),
    /// A line of a text file and a column in it, counted in characters; the first is 1.
    Column {
        /// The line.
        line: usize,
        /// The column.
        column: usize,
    },
    /// A byte of a binary file; the first is 0.
    Byte(usize),
    /// A value in a JSON document, such as `accessors[3].bufferView`.
    Json(String),
}

impl LoadError {
    /// An error at a place in a file.
    pub(crate) fn new(file: &Path, place: Place, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), place, message: message.into(), source: None }
    }

    /// The operating system's refusal to read a file.
    pub(crate) fn io(file: &Path, source: io::Error) -> Self {
        let message = match source.kind() {
            io::ErrorKind::NotFound => "no such file".to_owned(),
            io::ErrorKind::PermissionDenied => "may not be read (permission denied)".to_owned(),
            _ => format!("could not be read: {source}"),
        };
        Self { file: file.to_owned(), place: Place::File, message, source: Some(source) }
    }

    /// The file that is at fault: the one asked for, or one that it names.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Where in the file.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// What was found there, and what was expected.
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = one_line(&self.file.display().to_string());
        let message = one_line(&self.message);
        match &self.place {
            Place::File => write!(f, "{file}: {message}"),
            Place::Line(line) => write!(f, "{file}:{line}: {message}"),
            Place::Column { line, column } => write!(f, "{file}:{line}:{column}: {message}"),
            place => write!(f, "{file}: {place}: {message}"),
        }
    }
}

impl std::error::Error for LoadError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|source| source as _)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => write!(f, "the file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Column { line, column } => write!(f, "line {line}, column {column}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Json(path) => write!(f, "{}", one_line(path)),
        }
    }
}

/// The text with control characters made visible, so that nothing in a file's contents or name breaks a line.
pub(crate) fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

/// A piece of a file in quotes for a message: one line, shortened if long.
pub fn quoted(bytes: &[u8]) -> String {
    format!("`{}`", shortened(bytes))
}

/// A piece of a file for a message: one line, shortened if long.
pub(crate) fn shortened(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST)]);
    let dots = if bytes.len() > LONGEST { "..." } else { "" };
    format!("{}{dots}", one_line(&shown))
}
