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
                let plain_name = name.split('?').next().unwrap_or_default();
                match builtins().iter().any(|b| b.name == plain_name) && !path.exists() {
                    true => {
                        Failure::BadInput(format!("{error}; did you mean {BUILTIN_PREFIX}{name}?"))
                    }
                    false => Failure::bad_input(error),
                }
            })?
        }
    };
    Ok(Loaded { scene, time: started.elapsed() })
}
