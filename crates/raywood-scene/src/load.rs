//! From a file's name to a scene: reads the file and hands it to the format that knows it.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use raywood::TriangleMesh;

use crate::error::{LoadError, Place};
use crate::files_read;
use crate::formats::{FORMATS, Format, Input, Nesting};
use crate::{Material, Scene};

/// How to load a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Refuse what would otherwise be mended and said in [`Scene::warnings`]: vertices that are NaN or infinite, faces with
    /// fewer than three vertices, materials that no file defines, and the like. What is merely not supported (lines,
    /// points, images in other formats) is left out with a warning all the same.
    pub strict: bool,
}

impl LoadOptions {
    /// The same options, strict or not.
    #[must_use]
    pub fn with_strict(mut self, strict: bool) -> Self {
        self.strict = strict;
        self
    }
}

/// Loads a scene from a file in one of the known [`FORMATS`], told by the name's extension, or by the file's first bytes
/// where the extension is missing or unknown.
///
/// What was mended or left out is said in [`Scene::warnings`]. No contents, however broken, make it panic, or allocate for more
/// than the bytes that are really there can hold. (The copies of meshes that glTF and scene files ask for are bounded by number.)
///
/// # Errors
///
/// A file that cannot be read, is in no known format, or is broken beyond mending: see [`LoadError`].
pub fn load_file(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    load_bytes(path, &read_file(path)?, options)
}

/// Loads a scene as [`load_file`] does, from contents at hand. The path gives the name and extension, and where the other files
/// that a model names are sought.
///
/// # Errors
///
/// As [`load_file`].
pub fn load_bytes(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Scene, LoadError> {
    load_nested(path, bytes, options, &Nesting::default())
}

/// Loads a scene as [`load_bytes`] does, from a file that another one may show.
pub(crate) fn load_nested(
    path: &Path,
    bytes: &[u8],
    options: &LoadOptions,
    nesting: &Nesting,
) -> Result<Scene, LoadError> {
    let format = format_of(path, bytes)?;
    if bytes.is_empty() {
        let message = format!("is empty, expected {}", format.description);
        return Err(LoadError::new(path, Place::File, message));
    }
    let mut scene = (format.load)(&Input { path, bytes, options, nesting })?;

    scene.name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if scene.materials.is_empty() {
        scene.materials.push(Material::default());
    }
    if !scene.spheres.as_slice().is_empty() {
        return Ok(scene);
    }
    if scene.mesh.triangles.triangles().is_empty() {
        scene.warnings.push("there are no triangles to show".to_owned());
    } else if !has_area(&scene.mesh.triangles) {
        scene.warnings.push("no triangle has any area: there is nothing to see".to_owned());
    }
    Ok(scene)
}

/// The bytes of a regular file. Anything else (a directory, a pipe, a device) might never end, and is refused.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    files_read::note(path);
    let refuse = |message: &str| Err(LoadError::new(path, Place::File, message));
    let metadata = fs::metadata(path).map_err(|error| LoadError::io(path, error))?;
    if metadata.is_dir() {
        return refuse("is a directory, expected a file");
    }
    if !metadata.is_file() {
        return refuse("is not a regular file");
    }

    let mut bytes = Vec::new();
    let size = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
    if bytes.try_reserve_exact(size).is_err() {
        return refuse("is larger than the memory there is");
    }
    let read = File::open(path).and_then(|mut file| file.read_to_end(&mut bytes));
    read.map_err(|error| LoadError::io(path, error))?;
    Ok(bytes)
}

/// The format of a file: by its extension, else by how it begins.
fn format_of(path: &Path, bytes: &[u8]) -> Result<&'static Format, LoadError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let by_extension = FORMATS.iter().find(|format| format.extensions.contains(&&*extension));
    let by_contents = || FORMATS.iter().find(|format| (format.recognises)(bytes));
    by_extension.or_else(by_contents).ok_or_else(|| {
        let known: Vec<_> = FORMATS.iter().flat_map(|format| format.extensions).collect();
        let known = known.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ");
        let found = if extension.is_empty() {
            "has no extension".to_owned()
        } else {
            format!("has the unknown extension .{extension}")
        };
        LoadError::new(path, Place::File, format!("{found}; the known ones are {known}"))
    })
}

/// Whether any triangle has an area, as far as double precision can tell.
fn has_area(mesh: &TriangleMesh) -> bool {
    (0..mesh.triangles().len() as u32).any(|triangle| {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.to_array().map(f64::from));
        let (e, f) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        e[1] * f[2] != e[2] * f[1] || e[2] * f[0] != e[0] * f[2] || e[0] * f[1] != e[1] * f[0]
    })
}
