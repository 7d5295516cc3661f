//! Where scenes come from: a file, which may hold the tree over the scene as well, or `builtin:` and the name of a scene made by code.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

use raywood::SavedTree;
use raywood_scene::{LoadOptions, SavedScene, Scene, builtin, builtins, load_file};

use crate::failure::Failure;
use crate::mapped_file;
use crate::print;

/// What precedes the name of a built-in scene.
pub(crate) const BUILTIN_PREFIX: &str = "builtin:";

/// A scene and how long it took to get it.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
    /// The tree over its surfaces, if it was saved with it.
    pub(crate) tree: Option<SavedTree>,
    pub(crate) time: Duration,
}

impl Loaded {
    /// Prints what was left out or mended.
    pub(crate) fn print_warnings(&self) {
        for warning in &self.scene.warnings {
            print::warning(format_args!("{}: {warning}", self.scene.name));
        }
    }
}

/// As many triangles are copied for what cannot deal with instances: they and a tree over them take some five gigabytes.
const MOST_COPIED: u64 = 30_000_000;

impl Loaded {
    /// Refuses scenes in which something moves, for `what` cannot show that.
    pub(crate) fn standing_still(self, what: &str) -> Result<Self, Failure> {
        if self.scene.instances.moves() {
            return Err(Failure::BadInput(format!(
                "{}: {what} needs a scene in which nothing moves: expected no instances with `to`",
                self.scene.name
            )));
        }
        Ok(self)
    }

    /// Copies instances to where they stand, for `what` cannot deal with them.
    pub(crate) fn without_instances(mut self, what: &str) -> Result<Self, Failure> {
        self.scene.flatten(MOST_COPIED).map_err(|error| {
            Failure::BadInput(format!(
                "{}: {what} needs a scene without instances: {error}",
                self.scene.name
            ))
        })?;
        Ok(self)
    }
}

/// Loads or makes the scene.
pub(crate) fn load(name: &str, strict: bool) -> Result<Loaded, Failure> {
    let started = Instant::now();
    if is_saved(Path::new(name)) {
        let SavedScene { scene, tree } = open_saved(Path::new(name))?;
        return Ok(Loaded { scene, tree: Some(tree), time: started.elapsed() });
    }
    let scene = match name.strip_prefix(BUILTIN_PREFIX) {
        Some(builtin_name) => builtin(builtin_name).map_err(Failure::bad_input)?,
        None => {
            let path = Path::new(name);
            load_file(path, &LoadOptions::default().with_strict(strict)).map_err(|error| {
                let hint = if path.exists() { String::new() } else { hint_at_builtins(name) };
                Failure::BadInput(format!("{error}{hint}"))
            })?
        }
    };
    Ok(Loaded { scene, tree: None, time: started.elapsed() })
}

/// Whether a file is a saved scene, by its first bytes, whatever it is called.
fn is_saved(path: &Path) -> bool {
    let mut first = [0; SavedTree::SIGNATURE.len()];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut first)).is_ok()
        && first == SavedTree::SIGNATURE
}

/// Opens a saved scene where the system keeps it.
fn open_saved(path: &Path) -> Result<SavedScene, Failure> {
    let mapped = mapped_file::map(path).map_err(|error| {
        Failure::BadInput(format!("{}: could not be mapped: {error}", path.display()))
    })?;
    SavedScene::open(path, mapped).map_err(Failure::bad_input)
}

/// What follows the error about a file that does not exist: the built-in scene that was meant, or all of them.
fn hint_at_builtins(name: &str) -> String {
    let plain_name = name.split('?').next().unwrap_or_default();
    if builtins().iter().any(|scene| scene.name == plain_name) {
        return format!("; did you mean {BUILTIN_PREFIX}{name}?");
    }
    if Path::new(name).components().count() > 1 {
        return String::new();
    }
    let names: Vec<_> = builtins().iter().map(|s| format!("{BUILTIN_PREFIX}{}", s.name)).collect();
    format!("; the built-in scenes are {}", names.join(", "))
}
