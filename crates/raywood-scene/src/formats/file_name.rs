//! Finding the files that a model names, however the program that wrote it spelled them.

use std::fs;
use std::path::{Path, PathBuf};

use crate::files_read;

/// Where a file named in a model is: as named, else with the strokes of Windows turned, else right beside the model; else in any of these places with letters of
/// other case.
pub(crate) fn find(folder: &Path, name: &[u8]) -> Option<PathBuf> {
    let name = std::str::from_utf8(name).ok().filter(|name| !name.is_empty())?;
    let turned = name.replace('\\', "/");
    let bare = turned.rsplit('/').next().unwrap_or_default();
    let spellings = [name, &turned, bare];
    let exactly = spellings.iter().map(|name| folder.join(name)).find(|path| path.is_file());
    let found =
        exactly.or_else(|| [&*turned, bare].iter().find_map(|name| find_in_any_case(folder, name)));
    if found.is_none() {
        // Who watches the scene's files waits for it.
        files_read::note(&folder.join(&turned));
    }
    found
}

/// A file whose name differs by the case of letters alone, that of its folders as well; of several the first in order.
fn find_in_any_case(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut found = folder.to_owned();
    for part in name.split('/').filter(|part| !matches!(*part, "" | ".")) {
        if part == ".." {
            found.push(part);
            continue;
        }
        let place = if found.as_os_str().is_empty() { Path::new(".") } else { &found };
        let names = fs::read_dir(place).ok()?.flatten().map(|entry| entry.file_name());
        let same = |name: &std::ffi::OsString| {
            name.to_string_lossy().to_lowercase() == part.to_lowercase()
        };
        let entry = names.filter(same).min()?;
        found.push(entry);
    }
    found.is_file().then_some(found)
}
