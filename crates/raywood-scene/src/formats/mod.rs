//! The file formats, one module each, and the registry that names them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use crate::error::LoadError;
use crate::{LoadOptions, Scene};

mod file_name;
mod gltf;
mod images;
mod mtl;
mod notes;
mod obj;
mod ply;
mod polygon;
mod raw_mesh;
mod rwood;
mod scene_file;
mod stl;
mod text;

/// A file format that scenes are loaded from.
#[derive(Debug)]
pub struct Format {
    /// What it is called.
    pub name: &'static str,
    /// The extensions of its files, in lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// What it is, in a few words.
    pub description: &'static str,
    /// Whether a file that begins with these bytes (all of them are given) is likely to be one.
    pub(crate) recognises: fn(&[u8]) -> bool,
    /// Makes a scene of a file.
    pub(crate) load: fn(&Input<'_>) -> Result<Scene, LoadError>,
}

/// All formats. To add one: write its module, and add its line here.
pub const FORMATS: &[Format] =
    &[obj::FORMAT, gltf::FORMAT, ply::FORMAT, stl::FORMAT, rwood::FORMAT, scene_file::FORMAT];

/// A file to load: its name (for messages, and to find the files it names), its bytes, and how to load it.
pub(crate) struct Input<'a> {
    pub(crate) path: &'a Path,
    pub(crate) bytes: &'a [u8],
    pub(crate) options: &'a LoadOptions,
    pub(crate) nesting: &'a Nesting,
}

/// Which files are being loaded because others show them.
#[derive(Debug, Default)]
pub(crate) struct Nesting {
    /// The scene files that are being read, each shown by the one before.
    pub(crate) open: Vec<PathBuf>,
    /// How many files there were so far, shared by all of them.
    pub(crate) files: Arc<AtomicUsize>,
}
