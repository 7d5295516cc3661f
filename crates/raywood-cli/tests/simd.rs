//! The vector instructions that every command that traces can be told to use.

mod support;

use std::process::Output;

use raywood::SimdLevel;
use support::{code, folder, json, raywood, run, stderr, stdout, write_triangle};

#[test]
fn every_command_that_traces_can_be_told_the_instructions() {
    let folder = folder("simd");
    write_triangle(&folder);
    let info = |level: &str| json(&run(&folder, &format!("info triangle.obj --json {level}")));
    assert_eq!(info("")["simd"], SimdLevel::active().name());
    assert_eq!(info("--simd portable")["simd"], "portable");
    assert_eq!(info("--structure kd-tree")["simd"], serde_json::Value::Null);
    let text = stdout(&run(&folder, "info triangle.obj --simd portable"));
    assert!(text.contains("traced by  portable\n"), "{text}");

    let small = "bench triangle.obj --rays 64 --rounds 1 --size 16x10 --format json";
    let report = json(&run(&folder, &format!("{small} --simd portable")));
    assert_eq!(report["simd_levels"], serde_json::json!(["portable"]));
    for arguments in [
        "render triangle.obj --size 16x10",
        "compare triangle.obj --rays 64 --rounds 1",
        "lecture triangle.obj --quick --only sah",
    ] {
        let output = run(&folder, &format!("{arguments} --simd portable"));
        assert_eq!(code(&output), 0, "{arguments}: {}", stderr(&output));
    }
}

#[test]
fn instructions_that_do_not_exist_are_an_error_wherever_they_are_named() {
    let folder = folder("simd-bad");
    write_triangle(&folder);
    let with_variable = |value: &str, arguments: &str| -> Output {
        let mut command = raywood(&folder);
        command.env(SimdLevel::VARIABLE, value).args(arguments.split_whitespace());
        command.output().expect("the command starts")
    };
    for command in ["render", "compare", "bench", "lecture", "info"] {
        let output = with_variable("sse", &format!("{command} triangle.obj"));
        let expected = "raywood: error: RAYWOOD_SIMD: `sse` is no level: expected one of portable, avx2, avx512\n";
        assert_eq!((code(&output), stderr(&output).as_str()), (2, expected), "{command}");
    }
    let said = stderr(&run(&folder, "render triangle.obj --simd sse"));
    assert!(said.contains("expected one of portable, avx2, avx512"), "{said}");

    // An empty variable says nothing, and the option has the last word.
    assert_eq!(code(&with_variable("", "info triangle.obj")), 0);
    let report = json(&with_variable("sse", "info triangle.obj --simd portable --json"));
    assert_eq!(report["simd"], "portable");
    let report = json(&with_variable("portable", "info triangle.obj --json"));
    assert_eq!(report["simd"], "portable");

    for level in SimdLevel::ALL.iter().filter(|level| !level.is_available()) {
        for output in [
            run(&folder, &format!("info triangle.obj --simd {}", level.name())),
            with_variable(level.name(), "info triangle.obj"),
        ] {
            let said = stderr(&output);
            assert_eq!(code(&output), 2, "{said}");
            assert!(said.contains(&format!("no {}: it has portable", level.name())), "{said}");
        }
    }
}
