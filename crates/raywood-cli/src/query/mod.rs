//! What `raywood query` is made of: arrays of rays or points in, piece by piece, the scene's answers out, in any format.
//!
//! `input -> format's Rows (numbers) -> Questioner (a Table of answers) -> format's TableWriter -> sink`
//!
//! A new kind of question is an entry in [`kind`], a new column one in [`field`], a new format a folder in [`formats`].

pub(crate) mod field;
pub(crate) mod formats;
pub(crate) mod input;
pub(crate) mod kind;
pub(crate) mod questioner;
mod records;
pub(crate) mod sink;
mod table;
mod whole_file;

pub use whole_file::{FileRows, read_points, read_rays};
