//! Where scenes come from: a file, or `builtin:` and the name of a scene made by code.

use std::path::Path;
use std::time::{Duration, Instant};

use raywood_scene::{LoadOptions, Scene, builtin, builtins, load_file};

use crate::failure::Failure;
use crate::print;

/// What precedes the name of a built-in scene.
pub(crate) const BUILTIN_PREFIX: &str = "builtin:";

/// A scene and how long it took to get it.
pub(crate) struct Loaded {
    pub(crate) scene: Scene,
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

/// Loads or makes the scene.
pub(crate) fn load(name: &str, strict: bool) -> Result<Loaded, Failure> {
    let started = Instant::now();
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
    Ok(Loaded { scene, time: started.elapsed() })
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
