//! Test helpers of the workspace: a brute-force oracle in double precision, a reference for all queries of any scene, one in integers for rays of double precision, shapes by their distance functions, closed and nasty meshes, rays and points that look for trouble,
//! pseudo-random numbers, means told apart from noise, saved trees taken apart and forged, image comparison, well-formed pages. Not published.

pub mod closed;
pub mod distance;
pub mod exact;
pub mod html;
pub mod image;
pub mod nasty;
pub mod oracle;
pub mod overlap;
pub mod placement;
pub mod points;
pub mod rays;
pub mod reference;
mod rng;
pub mod saved;
pub mod shapes;
pub mod significance;
pub mod solids;

pub use rng::Rng;

use std::path::{Path, PathBuf};

/// The folder of real test models: `$RAYWOOD_TEST_SCENES`, or `None` (said on stderr) where it is not set or does not exist.
pub fn test_scenes() -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("RAYWOOD_TEST_SCENES").map(PathBuf::from) else {
        eprintln!("skipped: set RAYWOOD_TEST_SCENES to the folder of test models to run this");
        return None;
    };
    if !Path::new(&folder).is_dir() {
        eprintln!("skipped: RAYWOOD_TEST_SCENES={} is not a folder", folder.display());
        return None;
    }
    Some(folder)
}
