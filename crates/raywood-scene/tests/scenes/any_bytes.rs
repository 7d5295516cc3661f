//! Files of whatever bytes, one function for each format: an error or a sound scene, never a panic. The fuzz targets run these on bytes of their own choice.

#![allow(unreachable_pub)]

use std::fs;

use raywood_scene::load_environment;

use crate::formats_support::{Folder, check_error, survives, textured_square};

thread_local! {
    /// Where the files lie that others name.
    static FOLDER: Folder = Folder::new();
}

/// A PLY file.
pub fn ply(bytes: &[u8]) {
    FOLDER.with(|folder| survives(folder, "x.ply", bytes));
}

/// An STL file.
pub fn stl(bytes: &[u8]) {
    FOLDER.with(|folder| survives(folder, "x.stl", bytes));
}

/// An OBJ file; what follows the first byte of zero is its material library, `x.mtl`.
pub fn obj(bytes: &[u8]) {
    let mut files = bytes.splitn(2, |&byte| byte == 0);
    let (model, library) = (files.next().unwrap_or_default(), files.next().unwrap_or_default());
    FOLDER.with(|folder| {
        folder.write("x.mtl", library);
        survives(folder, "x.obj", model);
    });
}

/// A glTF file, as text or binary, as it begins.
pub fn gltf(bytes: &[u8]) {
    let name = if bytes.starts_with(b"glTF") { "x.glb" } else { "x.gltf" };
    FOLDER.with(|folder| survives(folder, name, bytes));
}

/// A scene file.
pub fn scene_file(bytes: &[u8]) {
    FOLDER.with(|folder| survives(folder, "x.toml", bytes));
}

/// The image of textures: of every kind in a glTF file, and as colours, heights and cut-outs of an MTL file.
pub fn image(bytes: &[u8]) {
    let materials = r#""images":[{"bufferView":5,"mimeType":"image/png"}],"textures":[{"source":0}],
        "materials":[{"alphaMode":"MASK","emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},
        "normalTexture":{"index":0},"occlusionTexture":{"index":0},
        "pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}}}],"#;
    let library = "newmtl m\nmap_Kd image\nmap_Bump image\nmap_d image\n";
    let model = "mtllib x.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n";
    FOLDER.with(|folder| {
        // One that is larger than images may be is refused with the model.
        survives(folder, "x.glb", &textured_square(materials, &[bytes]));
        folder.write("image", bytes);
        folder.write("x.mtl", library);
        survives(folder, "x.obj", model.as_bytes());
    });
}

/// A panorama.
pub fn hdr(bytes: &[u8]) {
    let path = FOLDER.with(|folder| folder.write("x.hdr", bytes));
    match load_environment(&path) {
        Err(error) => check_error(&error.to_string()),
        Ok(environment) => {
            for (turn, down) in [(0.0, 0.0), (1.0, 1.0), (0.3, 0.6), (0.999, 0.001)] {
                let light = environment.light(turn, down);
                assert!(
                    light.is_finite() && light.to_array().iter().all(|x| *x >= 0.0),
                    "{light:?}"
                );
            }
        }
    }
    let _ = fs::remove_file(path);
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::{gltf, hdr, image, obj, ply, scene_file, stl};
    use crate::formats_support::{Random, jpeg, png};

    /// What feeds a format with bytes.
    type Feed = fn(&[u8]);

    /// A panorama of two rows, in runs.
    const PANORAMA: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 8\n\
        \x02\x02\x00\x08\x88\x01\x88\x02\x88\x03\x88\x80\x02\x02\x00\x08\x88\x01\x88\x02\x88\x03\x88\x80";

    /// A scene file with a key of each kind.
    const SCENE_FILE: &[u8] = br##"up = [0, 1, 0]
background = { zenith = 1, horizon = [0, 1, 0.5], nadir = "#102030" }
[material.gold]
metallic = 1
[[sphere]]
center = [0, 1.5, -2e1]
radius = 1
material = { transmission = 1, absorption = 2 }
[[model]]
file = "builtin:whitted"
rotate = { axis = [0, 0, 1], degrees = 90 }
override.mirror = "gold"
instance = [{ scale = 2 }, { matrix = [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]] }]
[[light]]
kind = "spot"
position = [0, 0, 0]
target = [1, 0, 0]
intensity = 1
"##;

    /// Images of both formats.
    fn images() -> [Vec<u8>; 2] {
        [png(2, &[[1, 2, 3, 4], [200, 100, 0, 255], [0; 4], [9; 4]]), jpeg()]
    }

    #[test]
    fn what_fuzzing_found_does_no_harm() {
        let found = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/found");
        // A package on its own has no such folder.
        if !found.is_dir() {
            return;
        }
        let targets: [(&str, Feed); 6] = [
            ("ply", ply),
            ("stl", stl),
            ("obj", obj),
            ("gltf", gltf),
            ("image", image),
            ("hdr", hdr),
        ];
        for (target, feed) in targets {
            let entries = fs::read_dir(found.join(target)).expect("a folder for each target");
            let mut count = 0;
            for entry in entries {
                feed(&fs::read(entry.expect("an entry").path()).expect("a file"));
                count += 1;
            }
            assert!(count > 0, "{target}");
        }
    }

    #[test]
    fn images_panoramas_and_scene_files_that_are_cut_or_changed_do_no_harm() {
        let [png, jpeg] = images();
        let samples: [(Vec<u8>, Feed); 4] = [
            (png, image),
            (jpeg, image),
            (PANORAMA.to_vec(), hdr),
            (SCENE_FILE.to_vec(), scene_file),
        ];
        let mut random = Random(3);
        for (sample, feed) in samples {
            feed(&sample);
            for length in 0..sample.len() {
                feed(&sample[..length]);
            }
            for _ in 0..500 {
                let mut changed = sample.clone();
                for _ in 0..=random.below(3) {
                    let at = random.below(changed.len());
                    changed[at] = random.below(256) as u8;
                }
                feed(&changed);
            }
        }
    }
}
