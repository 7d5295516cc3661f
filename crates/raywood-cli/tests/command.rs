//! The command as a user meets it: what it writes, says and exits with.

mod support;

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use raywood_testkit::html::{check_well_formed, is_self_contained};
use raywood_testkit::image::Picture;
use serde_json::Value;
use support::{code, files, folder, json, raywood, run, stderr, stdout, write_triangle};

#[test]
fn every_builtin_renders_to_a_picture() {
    let folder = folder("builtins");
    let list = json(&run(&folder, "scenes --json"));
    let scenes = list.as_array().expect("a list");
    let names: Vec<_> = scenes.iter().map(|s| s["name"].as_str().expect("a name")).collect();
    assert!(names.len() >= 4 && names.contains(&"builtin:whitted"), "{names:?}");
    for name in names {
        let output = run(&folder, &format!("render {name} -o out.png --size 96x60 -n 1 --json"));
        let report = json(&output);
        assert_eq!(stderr(&output), "", "{name}: silent when piped");
        assert_eq!(report["rays"]["primary"], 96 * 60);
        assert!(report["structure"]["nodes"].as_u64().expect("a number") >= 1);
        let picture = Picture::read(&folder.join("out.png")).expect("a PNG");
        assert_eq!((picture.width, picture.height), (96, 60));
        assert!(picture.colors() > 200, "{name}: only {} colours", picture.colors());
    }
}

#[test]
fn a_report_names_every_phase_and_kind_of_ray() {
    let folder = folder("report");
    let output = run(&folder, "render builtin:whitted --size 64x40");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    for word in ["render.png", "load", "build", "render", "write", "MB", "rays/s", "threads"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    for kind in ["primary", "shadow", "reflection", "refraction"] {
        assert!(text.contains(kind), "no {kind} in {text}");
    }
    assert_eq!(files(&folder), ["render.png"]);
}

#[test]
fn the_camera_and_lights_can_be_overridden() {
    let folder = folder("override");
    write_triangle(&folder);
    let picture = |name: &str, options: &str| {
        let arguments = format!("render triangle.obj -o {name}.png --size 64x40 -n 1 {options}");
        let output = run(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        Picture::read(&folder.join(format!("{name}.png"))).expect("a PNG")
    };
    let front = picture("front", "--eye 0.3,0.3,2 --target 0.3,0.3,0");
    assert_eq!(front, picture("again", "--eye 0.3,0.3,2 --target 0.3,0.3,0 --threads 3"));
    assert_ne!(front, picture("moved", "--eye -0.3,0.3,2 --target 0.3,0.3,0"));
    assert_ne!(front, picture("turned", "--eye 0.3,0.3,2 --target 0.3,0.3,0 --up -1,0,0"));
    assert_ne!(front, picture("wide", "--eye 0.3,0.3,2 --target 0.3,0.3,0 --fov 80"));
    assert_ne!(front, picture("lit", "--eye 0.3,0.3,2 --target 0.3,0.3,0 --light 2,2,2"));
}

#[test]
fn the_picture_does_not_depend_on_the_structure() {
    let folder = folder("structures");
    let said = stderr(&run(&folder, "render --structure hedge"));
    let names = said.split("expected one of ").nth(1).expect("the names").lines().next();
    let names: Vec<_> = names.expect("the names").split(", ").collect();
    assert!(names.len() >= 5 && names.contains(&"bvh-sah-binned"), "{names:?}");
    let mut pictures = names.iter().map(|name| {
        let arguments =
            format!("render builtin:sphereflake?depth=2 --size 96x60 --structure {name}");
        let report = json(&run(&folder, &format!("{arguments} --json")));
        assert_eq!(report["structure"]["name"], *name);
        (*name, Picture::read(&folder.join("render.png")).expect("a PNG"))
    });
    let (_, first) = pictures.next().expect("a picture");
    for (name, picture) in pictures {
        // The wide tree traces coherent rays in packets, which round differently; mirrors enlarge that.
        let difference = picture.difference(&first);
        let is_close = difference.mean <= 0.1 && difference.outliers <= 0.002;
        let is_same = if name == "bvh-wide" { is_close } else { picture == first };
        assert!(is_same, "{name}: {difference:?}");
    }
}

#[test]
fn the_picture_does_not_depend_on_the_build() {
    let folder = folder("builds");
    let said = stderr(&run(&folder, "render --build ultra"));
    assert!(said.contains("expected one of fastest, fast, balanced, high, best"), "{said}");
    let mut pictures = Vec::new();
    for preset in raywood::BuildPreset::ALL {
        let name = preset.name();
        let arguments =
            format!("render builtin:sphereflake --size 48x30 --build {name} -o {name}.png");
        let output = run(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let picture = Picture::read(&folder.join(format!("{name}.png"))).expect("a picture");
        pictures.push((name, picture));
    }
    for (name, picture) in &pictures {
        // Which rays leave their packets for being incoherent depends on the tree, and packets round differently; mirrors enlarge that.
        let difference = picture.difference(&pictures[0].1);
        assert!(difference.mean <= 0.1 && difference.outliers <= 0.002, "{name}: {difference:?}");
    }
    for command in ["info builtin:whitted", "compare builtin:whitted --structures bvh-wide"] {
        let output = run(&folder, &format!("{command} --build fastest"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
    }
}

#[test]
fn a_heat_map_is_drawn_above_a_legend_and_reported() {
    let folder = folder("heatmap");
    write_triangle(&folder);
    let arguments = "render triangle.obj --size 96x60 -n 2 --structure brute-force";
    let report = json(&run(&folder, &format!("{arguments} --heatmap primitives --json")));
    // One triangle, which every ray tests.
    assert_eq!(report["heatmap"]["quantity"], "primitives");
    for (key, expected) in [("mean", 1.0), ("max", 1.0), ("scale", 1.0)] {
        assert_eq!(report["heatmap"][key], expected, "{key}");
    }
    assert_eq!(report["rays"]["primary"], 96 * 60 * 2);
    assert_eq!(report["bounds"], Value::Null);
    let picture = Picture::read(&folder.join("render.png")).expect("a PNG");
    assert!(picture.width >= 96 && picture.height > 60, "{} rows", picture.height);

    let output = run(&folder, &format!("{arguments} --heatmap primitives --heatmap-max 0.5"));
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    let expected = "primitive tests per ray: mean 1.0, maximum 1, scale 0 to 0.5, 5,760 pixels";
    assert!(text.contains(expected), "{text}");

    let without = json(&run(&folder, &format!("{arguments} --json")));
    assert_eq!(without["heatmap"], Value::Null);
}

#[test]
fn bounds_are_drawn_over_pictures_and_heat_maps_of_every_structure() {
    let folder = folder("bounds");
    let picture = |options: &str| {
        let arguments = "render builtin:sphereflake?depth=2 --size 96x60 -n 1 --json";
        let report = json(&run(&folder, &format!("{arguments} {options}")));
        (Picture::read(&folder.join("render.png")).expect("a PNG"), report)
    };
    let (plain, _) = picture("");
    for structure in ["uniform-grid", "octree", "kd-tree", "bvh-median"] {
        let (with, report) = picture(&format!("--structure {structure} --show-bounds 1"));
        assert_eq!(report["bounds"]["level"], 1);
        assert!(report["bounds"]["boxes"].as_u64() > Some(1), "{structure}");
        assert_eq!((with.width, with.height), (plain.width, plain.height));
        assert_ne!(with, plain, "{structure}");
    }
    let (heat, _) = picture("--heatmap nodes");
    let (both, report) = picture("--heatmap nodes --show-bounds 2");
    assert_eq!((both.width, both.height), (heat.width, heat.height));
    assert_ne!(both, heat);
    assert!(!report["heatmap"].is_null() && !report["bounds"].is_null());
}

#[test]
fn info_tells_what_a_scene_holds() {
    let folder = folder("info");
    write_triangle(&folder);
    let output = run(&folder, "info triangle.obj");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    for word in ["triangles  1\n", "(0, 0, 0) to (1, 1, 0)", "1 nodes", "materials"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    let report = json(&run(&folder, "info triangle.obj --json"));
    assert_eq!(report["triangles"], 1);
    assert_eq!(report["bounds"]["max"], serde_json::json!([1.0, 1.0, 0.0]));
}

#[test]
fn the_lecture_is_judged_on_a_page_as_text_and_as_json() {
    let folder = folder("lecture");
    write_triangle(&folder);
    let output = run(&folder, "lecture --quick --only nodes --html page.html");
    assert_eq!((code(&output), stderr(&output).as_str()), (0, ""));
    let text = stdout(&output);
    assert!(text.starts_with("nodes: ") && text.ends_with("wrote page.html\n"), "{text}");
    let page = fs::read_to_string(folder.join("page.html")).expect("a page");
    assert_eq!(check_well_formed(&page), Ok(()));
    assert!(is_self_contained(&page));
    assert!(page.contains("<svg") && page.contains("2,047") && page.contains("\u{2713} holds"));

    let all = json(&run(&folder, "lecture triangle.obj --quick --format json --threads 2"));
    assert_eq!(all["scenes"], serde_json::json!(["triangle.obj"]));
    let experiments = all["experiments"].as_array().expect("experiments");
    assert!(experiments.len() >= 7, "{} experiments", experiments.len());
    for experiment in experiments {
        assert!(!experiment["tables"][0]["rows"].as_array().expect("rows").is_empty());
        let said = stderr(&run(
            &folder,
            &format!("lecture --only {}x", experiment["id"].as_str().expect("an id")),
        ));
        assert!(said.contains(experiment["id"].as_str().expect("an id")), "{said}");
    }
}

#[test]
fn bad_input_is_exit_code_2_and_one_clear_line() {
    let folder = folder("bad");
    write_triangle(&folder);
    fs::write(folder.join("broken.obj"), "v 0 0 0\nf 1 2 3\n").expect("a file");
    fs::write(folder.join("empty.ply"), "").expect("a file");
    fs::write(folder.join("points.obj"), "v 1 1 1\n").expect("a file");
    fs::write(folder.join("model.xyz"), "what is this").expect("a file");
    fs::create_dir(folder.join("directory.obj")).expect("a folder");
    fs::create_dir(folder.join("directory.png")).expect("a folder");
    for (arguments, expected) in [
        ("render missing.obj", "missing.obj: no such file"),
        ("render hall", "did you mean builtin:hall?"),
        ("render builtin:hal", "hall"),
        ("render builtin:terrain?m=5", "n"),
        ("render builtin:terrain?n=x", "x"),
        ("render broken.obj", "broken.obj:2: "),
        ("render empty.ply", "empty.ply: is empty"),
        ("render model.xyz", ".obj"),
        ("render directory.obj", "directory"),
        ("render triangle.obj -o picture.gif", ".png"),
        ("render triangle.obj -o directory.png", "directory"),
        ("render triangle.obj -o nowhere/picture.png", "there is no folder nowhere"),
        ("render triangle.obj --size 0x5", "0x5"),
        ("render triangle.obj --size 1000000x1000000", "1000000x1000000"),
        ("render triangle.obj --samples 0", "samples"),
        ("render triangle.obj --depth 1000", "depth"),
        ("render triangle.obj --eye 0,0,0 --target 0,0,0", "eye"),
        ("render triangle.obj --camera 3", "none"),
        ("render builtin:forest --structure kd-tree", "show 5"),
        (
            "render builtin:mill --structure kd-tree",
            "another structure needs a scene in which nothing moves",
        ),
        ("build builtin:mill -o mill.rwood", "a saved scene needs a scene in which nothing moves"),
        ("info builtin:forest --structure octree", "at most 30000000 are copied"),
        ("render triangle.obj --show-bounds 7", "there is no level 7: the bvh-wide has level"),
        ("info missing.glb", "missing.glb: no such file"),
        ("lecture missing.glb", "missing.glb: no such file"),
        ("lecture points.obj", "nothing to measure"),
        ("lecture --html nowhere/page.html", "there is no folder nowhere"),
    ] {
        let output = run(&folder, arguments);
        let said = stderr(&output);
        assert_eq!(code(&output), 2, "{arguments}: {said}");
        let clear = said.starts_with("raywood: error: ") && said.contains(expected);
        assert!(clear && said.lines().count() == 1, "{arguments}: {said}");
        assert_eq!(stdout(&output), "", "{arguments}");
    }

    // Wrong usage is answered by the usage.
    for arguments in [
        "",
        "paint",
        "render --size big triangle.obj",
        "render --eye 1,2 triangle.obj",
        "render --threads 0",
        "render --shutter 0.5",
        "render --shutter 0.5,0.2",
        "render --shutter 0,1.5",
        "render --shutter=-0.5,1",
        "render --shutter a,b",
        "render --heatmap time",
        "render --heatmap-max 5",
        "render --heatmap nodes --heatmap-max 0",
        "render --heatmap nodes --heatmap-max nan",
        "render --show-bounds -1",
        "lecture --only trees",
        "lecture --format yaml",
    ] {
        let output = run(&folder, arguments);
        let said = stderr(&output);
        assert_eq!(code(&output), 2, "{arguments}: {said}");
        assert!(said.contains("Usage: raywood") || said.contains("--help"), "{arguments}: {said}");
    }
    let unknown = stderr(&run(&folder, "render --heatmap time"));
    assert!(unknown.contains("expected one of nodes, boxes, primitives, tests"), "{unknown}");
    let left = files(&folder);
    assert!(!left.iter().any(|name| name.ends_with(".tmp")), "{left:?}");
}

#[test]
fn an_unwritable_place_is_refused_before_any_work() {
    let folder = folder("unwritable");
    let started = Instant::now();
    let output = run(&folder, "render builtin:terrain?n=4096 -o nowhere/picture.png");
    assert_eq!(code(&output), 2);
    assert!(started.elapsed() < Duration::from_secs(1), "after {:?}", started.elapsed());
}

#[test]
fn vertices_that_are_no_numbers_are_dropped_or_refused() {
    let folder = folder("nan");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n";
    fs::write(folder.join("nan.obj"), text).expect("a file");
    let mended = run(&folder, "render nan.obj --size 32x20 --json");
    assert_eq!(json(&mended)["triangles"], 1);
    assert!(stderr(&mended).starts_with("raywood: warning: nan.obj: "), "{}", stderr(&mended));
    let refused = run(&folder, "render nan.obj --strict");
    assert_eq!(code(&refused), 2, "{}", stderr(&refused));
    assert!(stderr(&refused).contains("nan.obj:4"), "{}", stderr(&refused));
}

#[test]
fn a_picture_of_nothing_is_said_to_be_one() {
    let folder = folder("nothing");
    fs::write(folder.join("flat.obj"), "v 1 1 1\nv 2 2 2\nv 3 3 3\nf 1 2 3\n").expect("a file");
    fs::write(folder.join("points.obj"), "v 1 1 1\n").expect("a file");
    for (file, expected) in
        [("flat.obj", "no triangle has any area"), ("points.obj", "no triangles")]
    {
        let output = run(&folder, &format!("render {file} --size 32x20"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{file}: {}", stderr(&output));
    }
}

#[test]
fn help_fits_a_screen() {
    let folder = folder("help");
    for arguments in [
        "-h",
        "render -h",
        "compare -h",
        "bench -h",
        "query -h",
        "lecture -h",
        "info -h",
        "scenes -h",
    ] {
        let text = stdout(&run(&folder, arguments));
        let lines = text.lines().count();
        assert!((5..=24).contains(&lines), "{arguments} has {lines} lines:\n{text}");
        let longest = text.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(80), "{arguments} has long lines:\n{text}");
    }
}

#[cfg(unix)]
#[test]
fn a_reader_who_leaves_is_no_error() {
    let folder = folder("pipe");
    let program = env!("CARGO_BIN_EXE_raywood");
    let script = format!("'{program}' scenes | true; '{program}' info builtin:whitted | true");
    let output = Command::new("sh").args(["-c", &script]).current_dir(&folder).output();
    assert_eq!(stderr(&output.expect("a shell starts")), "");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_within_a_second_and_leaves_nothing() {
    let folder = folder("interrupt");
    fs::write(folder.join("old.png"), "an old picture").expect("a file");
    for (arguments, delay) in [
        ("render builtin:whitted --samples 20000 -o old.png", 100),
        ("render builtin:whitted --samples 20000 -o old.png", 300),
        ("render builtin:whitted --samples 20000 -o old.png", 1000),
        ("lecture --only growth --html old.png", 500),
    ] {
        let mut child = raywood(&folder)
            .args(arguments.split_whitespace())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command starts");
        std::thread::sleep(Duration::from_millis(delay));
        assert_eq!(child.try_wait().expect("a child"), None, "it ended before it was stopped");
        let stopped = Instant::now();
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.expect("kill starts").success());
        let status = child.wait().expect("it ends");
        assert_eq!(status.code(), Some(130));
        assert!(stopped.elapsed() < Duration::from_secs(1), "after {:?}", stopped.elapsed());
        assert_eq!(files(&folder), ["old.png"]);
    }
    assert_eq!(fs::read(folder.join("old.png")).expect("a file"), b"an old picture");
}

#[test]
fn a_build_beyond_the_memory_limit_is_refused_with_advice() {
    let folder = folder("memory");
    let scene = "builtin:terrain?n=100";
    let refused = |arguments: &str, advice: &str| {
        let output = run(&folder, arguments);
        assert_eq!(code(&output), 2, "{arguments}");
        assert_eq!(stdout(&output), "", "{arguments}");
        let said = stderr(&output);
        assert!(
            said.contains("--memory-limit 100K; expected ") && said.contains(" of memory"),
            "{said}"
        );
        assert!(said.trim_end().ends_with(advice), "{said}");
    };
    let limited = format!("{scene} --memory-limit 100k");
    refused(&format!("render {limited} --size 8x8 -n 1"), "expected a higher limit");
    refused(&format!("info {limited} --structure kd-tree"), "expected a higher limit");
    refused(
        &format!("compare {limited} --structures bvh-wide --rays 10 --rounds 1"),
        "expected a higher limit",
    );
    refused(&format!("bench {limited} --rays 10 --rounds 1"), "expected a higher limit");
    fs::write(folder.join("points.csv"), "x,y,z\n0,0,0\n").expect("a file");
    refused(&format!("query {limited} --points points.csv -o out.csv"), "expected a higher limit");
    assert_eq!(files(&folder), ["points.csv"]);

    // Between what the fastest build needs and what the best does.
    let limited = format!("{scene} --memory-limit 3500K");
    let output = run(&folder, &format!("info {limited} --build best"));
    let said = stderr(&output);
    assert_eq!(code(&output), 2, "{}", stdout(&output));
    let start = "raywood: error: building bvh-wide may take ";
    assert!(
        said.starts_with(start) && said.contains("K of memory, above --memory-limit 3500K"),
        "{said}"
    );
    assert!(said.trim_end().ends_with("; expected a higher limit or --build fastest"), "{said}");
    assert_eq!(code(&run(&folder, &format!("info {limited} --build fastest"))), 0);
    assert_eq!(code(&run(&folder, &format!("info {scene} --build best --memory-limit 1G"))), 0);

    let output = run(&folder, "info builtin:whitted --memory-limit lots");
    assert_eq!(code(&output), 2);
    let said = stderr(&output);
    assert!(said.contains("expected a number of bytes, or one with K, M, G or T"), "{said}");
}
