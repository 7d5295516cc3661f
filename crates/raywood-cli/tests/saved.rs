//! `raywood build` and what other commands do with a saved scene.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;
use support::{code, files, folder, json, raywood, run, stderr, stdout, write_triangle};

/// The bytes of a picture of a scene, and the report.
fn picture(folder: &Path, scene: &str, options: &str) -> (Vec<u8>, Value) {
    let output =
        run(folder, &format!("render {scene} -o out.png --size 160x100 -n 2 --json {options}"));
    let report = json(&output);
    (fs::read(folder.join("out.png")).expect("a picture"), report)
}

#[test]
fn a_saved_scene_gives_the_same_picture() {
    let folder = folder("saved-pictures");
    write_triangle(&folder);
    for scene in ["builtin:whitted", "builtin:hall", "builtin:sphereflake?depth=3", "triangle.obj"]
    {
        let report = json(&run(&folder, &format!("build {scene} -o x.rwood --json")));
        let bytes = fs::metadata(folder.join("x.rwood")).expect("a file").len();
        assert_eq!(report["bytes"], bytes, "{scene}");
        let (expected, built) = picture(&folder, scene, "");
        let (found, loaded) = picture(&folder, "x.rwood", "");
        assert!(expected == found, "{scene}: another picture");
        assert_eq!((&built["saved_tree"], &loaded["saved_tree"]), (&false.into(), &true.into()));
        assert_eq!(loaded["structure"], built["structure"], "{scene}");
        assert_eq!(report["structure"], built["structure"], "{scene}");
        // The tree is not built again: there is nothing to wait for.
        let seconds = |report: &Value| report["seconds"]["build"].as_f64().expect("a number");
        if scene == "builtin:hall" {
            assert!(seconds(&loaded) < 0.1 * seconds(&built), "{loaded} {built}");
        }
    }
}

#[test]
fn other_trees_are_built_where_they_are_asked_for() {
    let folder = folder("saved-others");
    json(&run(&folder, "build builtin:terrain?n=32 -o x.rwood --build best --json"));
    let (_, best) = picture(&folder, "x.rwood", "");
    assert_eq!(best["saved_tree"], true);
    for options in ["--build fast", "--structure kd-tree"] {
        let (found, report) = picture(&folder, "x.rwood", options);
        assert_eq!(report["saved_tree"], false, "{options}");
        assert_ne!(report["structure"], best["structure"], "{options}");
        let (expected, built) = picture(&folder, "builtin:terrain?n=32", options);
        assert_eq!(report["structure"], built["structure"], "{options}");
        assert!(found == expected, "{options}");
    }
    let (_, report) = picture(&folder, "x.rwood", "--structure bvh-wide");
    assert_eq!(report["saved_tree"], true);
}

#[test]
fn every_command_takes_a_saved_scene() {
    let folder = folder("saved-commands");
    write_triangle(&folder);
    let text = stdout(&run(&folder, "build triangle.obj -o x.rwood"));
    for word in
        ["wrote x.rwood: triangle.obj", "load", "1 triangles", "build", "1 nodes", "write", "MB"]
    {
        assert!(text.contains(word), "no {word} in {text}");
    }
    let info = json(&run(&folder, "info x.rwood --json"));
    assert_eq!((&info["scene"], &info["triangles"]), (&"x.rwood".into(), &1.into()));
    let text = stdout(&run(&folder, "render x.rwood --size 32x20"));
    assert!(text.contains("bvh-wide as saved, 1 nodes"), "{text}");

    fs::write(folder.join("rays.csv"), "ox,oy,oz,dx,dy,dz\n0.2,0.2,1,0,0,-1\n").expect("a file");
    let answer = |scene: &str| {
        let output = run(&folder, &format!("query {scene} --rays rays.csv"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stdout(&output)
    };
    assert_eq!(answer("x.rwood"), answer("triangle.obj"));

    let bench = "bench x.rwood --format json --rays 256 --rounds 1 --size 16x16 --threads 1";
    assert_eq!(json(&run(&folder, bench))["scene"], "x.rwood");
    let compare = "compare x.rwood --format json --rays 64 --rounds 1 --structures kd-tree";
    let compared = run(&folder, compare);
    assert_eq!(code(&compared), 0, "{}", stderr(&compared));
    assert!(stdout(&compared).contains("x.rwood"));
}

#[test]
fn the_bytes_are_the_same_again() {
    let folder = folder("saved-bytes");
    let build = |arguments: &str| {
        let output = run(&folder, &format!("build {arguments}"));
        assert_eq!((code(&output), stderr(&output)), (0, String::new()));
    };
    build("builtin:terrain?n=64 -o one.rwood --threads 1");
    build("builtin:terrain?n=64 -o three.rwood --threads 3");
    let one = fs::read(folder.join("one.rwood")).expect("a file");
    assert!(one == fs::read(folder.join("three.rwood")).expect("a file"));
    // In its own place, of which it is made while it is mapped.
    build("one.rwood -o one.rwood");
    assert!(one == fs::read(folder.join("one.rwood")).expect("a file"));
    // Recognised by what it is, not by its name.
    fs::copy(folder.join("one.rwood"), folder.join("unnamed")).expect("a copy");
    let (_, report) = picture(&folder, "unnamed", "");
    assert_eq!(report["saved_tree"], true);
}

#[test]
fn a_file_that_cannot_be_used_is_told_of() {
    let folder = folder("saved-errors");
    write_triangle(&folder);
    json(&run(&folder, "build triangle.obj -o x.rwood --json"));
    let honest = fs::read(folder.join("x.rwood")).expect("a file");
    let complaint = |bytes: &[u8]| {
        fs::write(folder.join("y.rwood"), bytes).expect("a file");
        let output = run(&folder, "info y.rwood");
        assert_eq!((code(&output), stdout(&output)), (2, String::new()));
        stderr(&output)
    };
    let start = "raywood: error: y.rwood: ";
    let mut damaged = honest.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 4;
    assert!(
        complaint(&damaged).starts_with(&format!("{start}is damaged: the checksum of section"))
    );
    assert_eq!(
        complaint(&honest[..100]),
        format!("{start}is cut off: 100 bytes, expected {}\n", honest.len())
    );
    let mut newer = honest.clone();
    newer[8] = 2;
    assert!(
        complaint(&newer).starts_with(&format!(
            "{start}is a saved tree of version 2 of the format, a newer one"
        ))
    );
    assert_eq!(
        complaint(b"v 0 0 0\n"),
        format!("{start}is no saved tree: it begins with other bytes\n")
    );
    assert_eq!(complaint(b""), format!("{start}is empty, expected a scene saved with its tree\n"));
}

#[test]
fn nothing_is_left_of_what_fails() {
    let folder = folder("saved-failures");
    write_triangle(&folder);
    fs::write(folder.join("x.rwood"), "precious").expect("a file");
    for (arguments, complaint) in [
        ("build triangle.obj -o x.ply", "x.ply: the name of a saved scene must end in .rwood"),
        ("build missing.obj -o x.rwood", "missing.obj: no such file"),
        ("build builtin:hall -o x.rwood --memory-limit 1K", "above --memory-limit"),
        ("build triangle.obj -o no/x.rwood", "there is no folder no"),
    ] {
        let output = raywood(&folder).args(arguments.split(' ')).output().expect("it starts");
        assert_eq!(code(&output), 2, "{arguments}");
        assert!(stderr(&output).contains(complaint), "{arguments}: {}", stderr(&output));
    }
    let mut names = files(&folder);
    names.sort();
    assert_eq!(names, ["triangle.obj", "x.rwood"]);
    assert_eq!(fs::read(folder.join("x.rwood")).expect("a file"), b"precious");
}
