//! Real models, where this machine has them: exact numbers of triangles and the sizes that the models are known to have.

use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use crate::formats_support::{check_error, check_scene, real_scenes, triangle_count};
use raywood_scene::{LoadOptions, load_file};

/// File, triangles, and the size of the box around it.
const MODELS: &[(&str, usize, [f32; 3])] = &[
    ("sponza/sponza-dabrovic.obj", 66_450, [34.82, 16.56, 15.6]),
    ("sponza/sponza-crytek.glb", 262_267, [29.767, 12.448, 18.306]),
    ("stanford/bunny.ply", 69_451, [0.1557, 0.15433, 0.12067]),
    ("stanford/bunny.stl", 69_451, [0.1557, 0.12067, 0.15433]),
    ("stanford/dragon.ply", 871_414, [0.20489, 0.14444, 0.09162]),
    ("stanford/dragon-48k.ply", 47_794, [0.20366, 0.14387, 0.09088]),
    ("kitchen/country-kitchen.glb", 1_443_517, [6.9161, 3.38468, 8.65418]),
    ("coffee/coffee.glb", 235_271, [2.0, 0.81114, 2.09417]),
    ("living-room/living-room.glb", 143_163, [5.6362, 2.88220, 4.22822]),
    ("cornell-box/cornell-box.obj", 36, [2.02, 1.99, 2.03]),
    ("terrain/jacksboro.ply", 275_772, [29_938.83, 840.0, 31_818.967]),
    ("cad/koala.obj", 99_994, [3.78143, 5.36646, 9.27046]),
    ("cad/1002_tray_bottom.STL", 4_520, [355.6, 3.175, 355.6]),
    ("cad/featuretype.STL", 3_476, [5.0, 2.5, 1.375]),
    ("cad/cycloidal.ply", 43_368, [1.875, 1.87459, 1.10691]),
    ("hyperion/chrome.obj", 15_872, [2.371265, 2.396228, 2.371265]),
    ("gltf/CesiumMan.glb", 4_672, [0.31195, 1.50655, 1.13827]),
    ("gltf/DamagedHelmet.glb", 15_452, [1.88995, 1.80197, 2.0]),
    ("gltf/SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12, [6.0, 4.0, 0.0]),
    ("gltf/CesiumMilkTruck/CesiumMilkTruck.gltf", 3_624, [4.86891, 2.58292, 2.792]),
    ("gltf/Duck/Duck.gltf", 4_212, [1.65478, 1.54041, 1.15252]),
    ("gltf/TransmissionRoughnessTest.glb", 77_792, [2.0, 0.9, 0.5]),
];

#[test]
fn models_have_their_triangles_and_size() {
    let Some(folder) = real_scenes() else { return };
    for &(name, triangles, size) in MODELS {
        let scene = load_file(&folder.join(name), &LoadOptions::default()).unwrap();
        check_scene(&scene);
        assert_eq!(triangle_count(&scene), triangles, "{name}");
        let bounds = scene.bounds();
        let found = (bounds.max - bounds.min).to_array();
        for axis in 0..3 {
            let expected = size[axis];
            assert!(
                (found[axis] - expected).abs() <= 2e-4 * expected.max(1e-3),
                "{name}: {found:?}"
            );
        }
    }
}

/// All files in a folder and its folders.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

#[test]
fn odd_files_load_or_say_what_is_wrong() {
    let Some(folder) = real_scenes() else { return };
    let (mut loaded, mut refused) = (0, Vec::new());
    for path in files(&folder.join("odd")) {
        let lax = catch_unwind(|| load_file(&path, &LoadOptions::default()));
        let strict = catch_unwind(|| load_file(&path, &LoadOptions::default().with_strict(true)));
        let (Ok(lax), Ok(_)) = (lax, strict) else { panic!("{} panics", path.display()) };
        match lax {
            Ok(scene) => {
                check_scene(&scene);
                loaded += 1;
            }
            Err(error) => {
                check_error(&error.to_string());
                assert!(error.to_string().starts_with(&*path.to_string_lossy()));
                let is_model = ["obj", "ply", "stl", "gltf", "glb"]
                    .contains(&&*path.extension().unwrap_or_default().to_string_lossy());
                if is_model {
                    refused.push(path.file_name().unwrap().to_string_lossy().into_owned());
                }
            }
        }
    }
    assert!(loaded > 60, "only {loaded} files loaded");
    // These are broken beyond mending, and no others are.
    let expected = [
        "non_sparse_accessor_without_buffer_view.gltf",
        "single_elements_err_ascii.ply",
        "invalid-relative-texture-index.obj",
        "invalid-relative-vertex-index.obj",
        "issue-140-zero-face-idx.obj",
        "invalid_index.obj",
    ];
    assert_eq!(refused, expected);
}
