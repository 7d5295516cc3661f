//! All rows of a file at once, for tests that feed the readers with any bytes.

use std::path::Path;

use super::formats::Format;
use super::input::Input;
use super::kind::Subject;
use crate::failure::Failure;

/// What a file holds.
#[derive(Clone, Debug)]
pub struct FileRows {
    /// How many numbers a row has: 3 of points; of rays 6, or 8 with `t_min` and `t_max`.
    pub width: usize,
    /// How many rows the file says that it has, where it does.
    pub total: Option<u64>,
    /// How many rows were read.
    pub rows: usize,
    /// Their numbers.
    pub numbers: Vec<f32>,
}

/// The rays of a file, whose name's ending tells its format, read at most `piece` at a time; or what is wrong, as the user is told.
pub fn read_rays(path: &Path, piece: usize) -> Result<FileRows, String> {
    read(path, Subject::Rays, piece).map_err(|failure| failure.to_string())
}

/// The same of points.
pub fn read_points(path: &Path, piece: usize) -> Result<FileRows, String> {
    read(path, Subject::Points, piece).map_err(|failure| failure.to_string())
}

fn read(path: &Path, subject: Subject, piece: usize) -> Result<FileRows, Failure> {
    let format = Format::of_name(path).ok_or_else(|| {
        Failure::BadInput(format!("{}: its ending tells no format", path.display()))
    })?;
    let mut reader = format.read(Input::new(path), subject)?;
    let (width, total) = (reader.width(), reader.total());
    let mut file = FileRows { width, total, rows: 0, numbers: Vec::new() };
    loop {
        let count = reader.read(piece, &mut file.numbers)?;
        if count == 0 {
            return Ok(file);
        }
        file.rows += count;
    }
}
