//! Scene files through the whole program.

mod support;

use std::fs;

use support::{code, folder, json, run, stderr};

const SCENE: &str = r#"
[material.gold]
metallic = 1
roughness = 0.1

[[model]]
file = "triangle.obj"
scale = 2

[[sphere]]
center = [0, 0, -2]
radius = 1
material = "gold"

[[camera]]
name = "front"
eye = [0, 0, 6]
target = [0, 0, 0]

[[camera]]
name = "side"
eye = [6, 0, 0]
target = [0, 0, 0]
"#;

#[test]
fn every_command_takes_scene_files() {
    let folder = folder("scene-files");
    support::write_triangle(&folder);
    fs::write(folder.join("a.scene.toml"), SCENE).expect("a file");

    let info = json(&run(&folder, "info a.scene.toml --json"));
    assert_eq!((&info["triangles"], &info["spheres"]), (&1.into(), &1.into()));
    assert_eq!(info["bounds"]["max"][0], 2.0);
    assert_eq!(info["cameras"][1]["name"], "side");
    assert_eq!(info["materials"][0]["name"], "gold");

    // Each camera sees something else, and the saved scene looks as the scene file.
    let picture = |scene: &str, camera: &str| {
        let arguments = format!("render {scene} --camera {camera} -o out.png --size 64x40 --json");
        json(&run(&folder, &arguments));
        fs::read(folder.join("out.png")).expect("a picture")
    };
    json(&run(&folder, "build a.scene.toml -o a.rwood --json"));
    let [front, side] = ["front", "side"].map(|camera| picture("a.scene.toml", camera));
    assert!(front != side);
    assert!(side == picture("a.rwood", "side"));
    assert!(side == picture("a.scene.toml", "2"));
}

/// A sky in a scene file is that of the command line, with both methods and when it is saved.
#[test]
fn skies_are_the_same_in_scene_files_and_on_the_command_line() {
    let folder = folder("skies-of-scene-files");
    support::write_triangle(&folder);
    let text = "environment = \"sky:elevation=20\"\n[[model]]\nfile = \"triangle.obj\"\n";
    fs::write(folder.join("a.toml"), text).expect("a file");
    json(&run(&folder, "build a.toml -o a.rwood --json"));
    for method in ["whitted", "path --samples 4"] {
        let [named, shown, saved] =
            ["triangle.obj --environment sky:elevation=20", "a.toml", "a.rwood"].map(|scene| {
                let options = format!("-i {method} -o out.png --size 64x40 --json");
                json(&run(&folder, &format!("render {scene} {options}")));
                fs::read(folder.join("out.png")).expect("a picture")
            });
        assert!(named == shown, "{method}");
        assert!(shown == saved, "{method}");
    }
}

#[test]
fn wrong_scene_files_end_with_one_line_and_code_2() {
    let folder = folder("wrong-scene-files");
    fs::write(folder.join("bad.toml"), "[[sphere]]\nradios = 1\n").expect("a file");
    let output = run(&folder, "render bad.toml -o out.png");
    assert_eq!(code(&output), 2);
    let error = stderr(&output);
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.contains("bad.toml:2:1: [[sphere]] has no key `radios`, did you mean `radius`?"));
    assert!(!folder.join("out.png").exists());
}
