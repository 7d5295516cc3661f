//! `raywood bench` as a user meets it.

mod support;

use raywood::SimdLevel;
use support::{code, folder, json, run, stderr, stdout, write_triangle};

const SMALL: &str = "bench builtin:whitted --rays 256 --rounds 2 --size 64x40 --threads 2";
const KINDS: [&str; 4] = ["primary", "shadow", "reflection", "diffuse"];

/// The levels that the command finds usable here.
fn levels() -> Vec<&'static str> {
    let usable = SimdLevel::available().filter(|level| *level <= SimdLevel::active());
    usable.map(SimdLevel::name).collect()
}

#[test]
fn every_format_has_every_kind_and_level() {
    let folder = folder("bench-formats");
    for format in ["table", "markdown", "csv", "json"] {
        let output = run(&folder, &format!("{SMALL} --format {format}"));
        assert_eq!((code(&output), stderr(&output).as_str()), (0, ""), "silent when piped");
        let text = stdout(&output);
        assert!(text.ends_with('\n') && !text.ends_with("\n\n"), "{format}");
        for name in KINDS.iter().chain(&levels()).chain(&["picture"]) {
            assert!(text.contains(name), "{format}: {name} is missing");
        }
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}

#[test]
fn tables_fit_a_terminal_and_have_as_many_cells_in_every_row() {
    let folder = folder("bench-rows");
    let text = stdout(&run(&folder, SMALL));
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }

    let text = stdout(&run(&folder, &format!("{SMALL} --format csv")));
    let fields: Vec<_> = text.lines().map(|line| line.split(',').count()).collect();
    // Each kind on each level, each kind on two threads, pictures on one and on two.
    assert_eq!(fields.len(), 1 + 4 * levels().len() + 4 + 2, "{text}");
    assert!(fields.iter().all(|&count| count == fields[0]), "{text}");

    let text = stdout(&run(&folder, &format!("{SMALL} --format markdown")));
    for block in text.split("\n\n").filter(|block| block.starts_with('|')) {
        let cells: Vec<_> = block.lines().map(|line| line.matches('|').count()).collect();
        assert!(cells.len() > 2 && cells.iter().all(|&count| count == cells[0]), "{block}");
    }
}

#[test]
fn json_says_what_was_measured() {
    let folder = folder("bench-json");
    let report = json(&run(&folder, &format!("{SMALL} --format json --structure bvh-wide")));
    assert_eq!((&report["structure"], &report["scene"]), (&"bvh-wide".into(), &"whitted".into()));
    assert_eq!(report["simd"], SimdLevel::active().name());
    assert_eq!(report["simd_levels"], serde_json::json!(levels()));
    assert_eq!(report["pictures"]["rays"]["primary"], 64 * 40);
    for clock in report["core_clocks"].as_array().expect("a list") {
        assert!(clock["hertz"].as_f64() > Some(1e7), "{clock}");
    }
    let pictures = report["pictures"]["speeds"].as_array().expect("a list");
    for speed in report["rays"].as_array().expect("a list").iter().chain(pictures) {
        assert_eq!(speed["seconds"]["rounds"], 2);
        for key in ["ns_per_ray", "million_rays_per_second", "cycles_per_ray", "frames_per_second"]
        {
            assert!(speed[key].as_f64() > Some(0.0), "{key} of {speed}");
        }
    }

    // A structure without vector instructions.
    let report = json(&run(&folder, &format!("{SMALL} --format json --structure octree")));
    assert!(report["simd"].is_null() && report["simd_levels"] == serde_json::json!([]));
    assert_eq!(report["rays"].as_array().map(Vec::len), Some(2 * KINDS.len()));
}

#[test]
fn bad_requests_name_what_was_expected() {
    let folder = folder("bench-bad");
    for (arguments, expected) in [
        ("bench nowhere.obj", "nowhere.obj"),
        ("bench --structure bush", "uniform-grid"),
        ("bench --rays 1e6", "a whole number from 1 to 16777216"),
        ("bench --rounds 0", "a whole number from 1 to 10000"),
        ("bench --threads 1,0", "1..=1024"),
        ("bench --size 0x5", "0x5"),
        ("bench --format xml", "markdown"),
        ("bench builtin:whitted --eye 0,0,0 --target 0,0,0", "same point"),
    ] {
        let output = run(&folder, arguments);
        assert_eq!((code(&output), stdout(&output)), (2, String::new()), "{arguments}");
        assert!(stderr(&output).contains(expected), "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn a_triangle_and_nothing_at_all_can_be_measured() {
    let folder = folder("bench-little");
    write_triangle(&folder);
    std::fs::write(folder.join("empty.obj"), "v 0 0 0\n").expect("a file");
    for scene in ["triangle.obj", "empty.obj"] {
        for format in ["table", "markdown", "csv", "json"] {
            let options = "--rays 64 --rounds 1 --size 16x10";
            let output = run(&folder, &format!("bench {scene} {options} --format {format}"));
            assert_eq!(code(&output), 0, "{}", stderr(&output));
            assert!(!stdout(&output).contains("NaN"), "{}", stdout(&output));
        }
    }
}
