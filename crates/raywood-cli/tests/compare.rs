//! `raywood compare` as a user meets it.

mod support;

use raywood::StructureKind;
use raywood_testkit::html::{check_well_formed, is_self_contained};
use serde_json::Value;
use support::{code, folder, json, run, stderr, stdout, write_triangle};

const SMALL: &str = "compare builtin:whitted --rays 256 --rounds 2";

#[test]
fn every_format_names_every_structure() {
    let folder = folder("compare-formats");
    for format in ["table", "markdown", "csv", "json"] {
        let output = run(&folder, &format!("{SMALL} --format {format}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert_eq!(stderr(&output), "", "{format}: silent when piped");
        let text = stdout(&output);
        assert!(text.ends_with('\n') && !text.ends_with("\n\n"), "{format}");
        for kind in StructureKind::ALL {
            assert!(text.contains(kind.name()), "{format}: {} is missing", kind.name());
        }
        for kind in ["primary", "shadow", "reflection", "diffuse"] {
            assert!(text.contains(kind), "{format}: {kind} is missing");
        }
    }
}

#[test]
fn tables_have_as_many_cells_in_every_row() {
    let folder = folder("compare-rows");
    let text = stdout(&run(&folder, &format!("{SMALL} --format csv")));
    let fields: Vec<_> = text.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(fields.len(), 1 + 4 * StructureKind::ALL.len(), "{text}");
    assert!(fields.iter().all(|&count| count == fields[0]), "{text}");

    let text = stdout(&run(&folder, &format!("{SMALL} --format markdown")));
    let mut columns = 0;
    for line in text.lines() {
        let cells = line.matches('|').count();
        assert!(columns == 0 || cells == 0 || cells == columns, "{line}");
        columns = cells;
    }

    let text = stdout(&run(&folder, SMALL));
    for line in text.lines().filter(|line| line.starts_with("  bvh-")) {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

#[test]
fn chosen_structures_are_compared_in_the_order_given() {
    let folder = folder("compare-chosen");
    let arguments =
        format!("{SMALL} --structures kd-tree,octree,kd-tree --format json --threads 1");
    let report = json(&run(&folder, &arguments));
    let structures = report["structures"].as_array().expect("a list");
    let names: Vec<_> = structures.iter().map(|s| s["name"].as_str()).collect();
    assert_eq!(names, [Some("kd-tree"), Some("octree")]);
    assert_eq!((&report["threads"], &report["scene"]), (&1.into(), &"whitted".into()));
    for structure in structures {
        let levels = structure["levels"].as_array().expect("a list");
        let number = |level: &Value| level["nodes"].as_u64().expect("a number");
        let nodes: u64 = levels.iter().map(number).sum();
        assert_eq!(structure["nodes"], Value::from(nodes));
        assert!(structure["build_seconds"]["median"].as_f64() > Some(0.0));
        for rays in structure["rays"].as_array().expect("a list") {
            assert!(rays["million_rays_per_second"].as_f64() > Some(0.0), "{rays}");
            assert!(rays["per_ray"]["nodes"].as_f64() > Some(0.0), "{rays}");
            assert_eq!(rays["seconds"]["rounds"], 2);
        }
    }
}

#[test]
fn the_page_is_whole_and_needs_nothing_else() {
    let folder = folder("compare-page");
    let output = run(&folder, &format!("{SMALL} --html page.html --format csv"));
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.join("page.html")).expect("a page");
    assert_eq!(check_well_formed(&page), Ok(()));
    assert!(is_self_contained(&page));
    let maps = page.matches("data:image/png;base64,").count();
    assert_eq!(maps, 2 * StructureKind::ALL.len(), "a small scene has a map of every structure");
    for kind in StructureKind::ALL {
        assert!(page.contains(kind.name()), "{} is missing", kind.name());
    }
}

#[test]
fn bad_requests_are_one_line_and_exit_code_2() {
    let folder = folder("compare-bad");
    for (arguments, expected) in [
        ("compare nowhere.obj", "nowhere.obj"),
        ("compare --structures kd-tree,bush", "uniform-grid"),
        ("compare --rays 1e6", "a whole number from 1 to 16777216"),
        ("compare --rounds 0", "a whole number from 1 to 10000"),
        ("compare --html nowhere/page.html", "nowhere"),
        ("compare --format xml", "markdown"),
        ("compare builtin:whitted --camera 9", "no camera `9`"),
        ("compare builtin:whitted --eye 0,0,0 --target 0,0,0", "same point"),
    ] {
        let output = run(&folder, arguments);
        assert_eq!((code(&output), stdout(&output)), (2, String::new()), "{arguments}");
        assert!(stderr(&output).contains(expected), "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn a_triangle_and_nothing_at_all_can_be_compared() {
    let folder = folder("compare-little");
    write_triangle(&folder);
    std::fs::write(folder.join("empty.obj"), "v 0 0 0\n").expect("a file");
    let report = json(&run(&folder, "compare triangle.obj --rays 64 --rounds 1 --format json"));
    assert!(report["ray_sets"][0]["hits"].as_u64() > Some(0));
    for format in ["table", "markdown", "csv", "json"] {
        let output = run(&folder, &format!("compare empty.obj --rays 64 --format {format}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert!(!stdout(&output).contains("NaN"), "{}", stdout(&output));
    }
}
