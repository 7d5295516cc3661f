//! Files that are not there, not whole, or not what they seem: an error or a sound scene, never a panic.

use std::fs;

use crate::formats_support::{
    Folder, Random, check_error, check_scene, cube_buffer, cube_json, cube_ply, error_of, glb,
    load, square_stl, survives, triangle_count,
};
use raywood_scene::formats::FORMATS;
use raywood_scene::{LoadOptions, load_file};

/// A small sound file of each format and encoding.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let obj = "mtllib x.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .2 0\nvn 0 0 1\nusemtl m\ns 1\nf 1//1 2//1 3/1/1\nf 1 2 3 -2 -1\nl 1 2\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n4 0 1 2 -1\n";
    let stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\nendsolid s\n";
    let nodes = r#""nodes":[{"mesh":0,"scale":[1,2,-3],"children":[1]},{"camera":0,"rotation":[0,1,0,0]}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],
        "materials":[{"alphaMode":"BLEND","pbrMetallicRoughness":{"roughnessFactor":0.2}}],"#;
    let cube = glb(&cube_json(nodes), &cube_buffer());
    // In base64, A stands for six bits of zero: all corners at the origin, all indices 0.
    let uri = format!("{{\"byteLength\":132,\"uri\":\"data:;base64,{}\"}}", "A".repeat(176));
    let gltf = cube_json(nodes).replace("{\"byteLength\":132}", &uri);
    vec![
        ("a.obj", obj.into()),
        ("a.ply", ply.into()),
        ("b.ply", cube_ply(true)),
        ("c.ply", cube_ply(false)),
        ("a.stl", stl.into()),
        ("b.stl", square_stl()),
        ("a.glb", cube),
        ("a.gltf", gltf.into()),
    ]
}

#[test]
fn what_is_no_file() {
    let folder = Folder::new();
    let error_at = |name: &str| {
        let path = folder.path(name);
        let error = load_file(&path, &LoadOptions::default()).unwrap_err();
        assert_eq!(error.file(), path);
        let error = error.to_string();
        check_error(&error);
        error
    };
    assert!(error_at("missing.obj").ends_with("missing.obj: no such file"));
    fs::create_dir(folder.path("folder.ply")).unwrap();
    assert!(error_at("folder.ply").ends_with("folder.ply: is a directory, expected a file"));
    for format in FORMATS {
        for extension in format.extensions {
            let name = format!("empty.{extension}");
            folder.write(&name, "");
            let error = error_at(&name);
            assert!(
                error.ends_with(&format!("is empty, expected {}", format.description)),
                "{error}"
            );
        }
    }
    folder.write("picture.jpeg", "no picture");
    let error = error_at("picture.jpeg");
    assert!(
        error.ends_with(
            "has the unknown extension .jpeg; the known ones are .obj, .glb, .gltf, .ply, .stl, .rwood, .toml"
        ),
        "{error}"
    );
    folder.write("nameless", "no model");
    assert!(error_at("nameless").contains("nameless: has no extension"));
}

#[test]
fn formats_are_told_by_their_contents() {
    for (name, contents) in samples() {
        let scene = load("unnamed", contents).unwrap();
        assert!(triangle_count(&scene) > 0, "{name}");
    }
    assert!(load("CUBE.PLY", cube_ply(true)).is_ok());
}

#[test]
fn every_prefix_of_a_file() {
    let folder = Folder::new();
    for (name, contents) in samples() {
        for length in 0..contents.len() {
            let loads = survives(&folder, name, &contents[..length]);
            // A file that states its length is known to be cut short.
            let stated = ["b.ply", "c.ply", "b.stl", "a.glb", "a.gltf"].contains(&name);
            assert!(!(loads && stated), "{name} loads when cut to {length} bytes");
        }
    }
}

#[test]
fn random_mutations_of_a_file() {
    let folder = Folder::new();
    let mut random = Random(2);
    let tokens: [&[u8]; 12] = [
        b"-1",
        b"nan",
        b"4294967296",
        b"1e39",
        b" ",
        b"\n",
        b"/",
        b"\\",
        b"\0",
        b"0",
        b"\xff",
        b"999999999999999999999",
    ];
    for (name, contents) in samples() {
        for _ in 0..5000 {
            let mut mutated = contents.clone();
            for _ in 0..=random.below(4) {
                let at = random.below(mutated.len());
                match random.below(5) {
                    0 => mutated[at] = random.below(256) as u8,
                    1 => mutated[at] ^= 1 << random.below(8),
                    2 => {
                        mutated.remove(at);
                    }
                    3 => {
                        let token = tokens[random.below(tokens.len())];
                        mutated.splice(at..at, token.iter().copied());
                    }
                    _ => {
                        let end = (at + 1 + random.below(8)).min(mutated.len());
                        let token = tokens[random.below(tokens.len())];
                        mutated.splice(at..end, token.iter().copied());
                    }
                }
            }
            survives(&folder, name, &mutated);
        }
    }
}

#[test]
fn faults_by_the_thousand_make_one_line() {
    let mut obj = "v 0 0 0\n".to_owned();
    for i in 0..20_000 {
        obj += &format!("v nan 0 {i}\nf 1 1\nusemtl m{i}\nmtllib {i}.mtl\nf 1 1 1\nweird{i}\n");
    }
    let scene = load("faults.obj", obj).unwrap();
    assert!(scene.warnings.len() < 40, "{} warnings", scene.warnings.len());
    assert!(scene.warnings.iter().all(|warning| warning.len() < 1000));
    assert!(scene.warnings[0].starts_with("20000 vertices are NaN"), "{}", scene.warnings[0]);
}

#[test]
fn one_vertex_with_many_normals_is_no_trap() {
    let mut obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    for i in 0..100_000 {
        obj += &format!("vn 0 1 {i}\nf 1//-1 2//-1 3//-1\n");
    }
    let scene = load("fan.obj", obj).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 100_000);
}

#[test]
fn huge_promises_are_refused_at_once() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let error = error_of("huge.ply", format!("{header}{}", " ".repeat(100)));
    assert_eq!(
        error,
        "huge.ply:3: the header promises 4000000000 of element vertex, which take at least 48000000000 bytes, but only 100 follow"
    );
    // Elements without properties take no bytes, and no time.
    let nothing = "ply\nformat ascii 1.0\nelement nothing 18446744073709551615\nend_header\n";
    let scene = load("nothing.ply", nothing).unwrap();
    assert_eq!(triangle_count(&scene), 0);
}
