//! Loads whatever bytes as a saved scene, checksums made right; what loads can be saved again and is then the same.

#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use raywood::Joined;
use raywood_scene::{SavedScene, save_scene};
use raywood_testkit::saved::correct_checksums;

fuzz_target!(|bytes: &[u8]| {
    let mut file = bytes.to_vec();
    correct_checksums(&mut file);
    let Ok(SavedScene { scene, tree }) = SavedScene::open(Path::new("x"), file) else { return };
    let surfaces = Joined { first: &scene.mesh.triangles, second: &scene.spheres };
    let mut again = Vec::new();
    save_scene(&scene, &tree.bvh(surfaces).expect("it is its own"), &mut again).expect("it is saved");
    let loaded = SavedScene::open(Path::new("x"), again.clone()).expect("it is sound").scene;
    assert_eq!(format!("{loaded:?}"), format!("{scene:?}"));
});
