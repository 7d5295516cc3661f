//! Pictures as a user asks for them: formats, tone mapping, how long, how sharp, and what Ctrl-C leaves.

mod support;

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use raywood_testkit::image::Picture;
use serde_json::Value;
use support::{code, files, folder, json, raywood, run, stderr, stdout, write_triangle};

const SMALL: &str = "render builtin:whitted --size 48x30 -n 2";

#[test]
fn the_ending_chooses_the_format() {
    let folder = folder("formats");
    for (name, start, options) in [
        ("a.png", &b"\x89PNG"[..], ""),
        ("deep.PNG", b"\x89PNG", "--bits 16"),
        ("a.jpg", b"\xff\xd8\xff", "--quality 50"),
        ("a.exr", b"v/1\x01", ""),
        ("whole.exr", b"v/1\x01", "--bits 32"),
        ("a.hdr", b"#?RADIANCE\n", ""),
    ] {
        let output = run(&folder, &format!("{SMALL} -o {name} {options}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let bytes = fs::read(folder.join(name)).expect("a picture");
        assert!(bytes.starts_with(start), "{name} begins with {:?}", &bytes[..4]);
    }
    let size = |name: &str| fs::metadata(folder.join(name)).expect("a file").len();
    assert!(size("deep.PNG") > size("a.png") && size("whole.exr") > size("a.exr"));
    assert_eq!(files(&folder).len(), 6, "nothing else is left");
}

#[test]
fn light_is_written_as_it_is_and_lights_another_scene() {
    let folder = folder("light");
    // The picture of a panorama is a panorama: of one colour, ten times as bright as white.
    write_triangle(&folder);
    let sky = [&b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n"[..], &[0, 160, 0, 132]];
    fs::write(folder.join("sky.hdr"), sky.concat()).expect("a file");
    let away = "render triangle.obj --eye 0,0,5 --target 0,0,9 --size 8x4 -n 1";
    for name in ["sky.exr", "again.hdr"] {
        let output = run(&folder, &format!("{away} -i path --environment sky.hdr -o {name}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
    }
    let shown = |sky: &str| {
        let arguments = format!("{away} --environment {sky} --tone-map none --exposure=-4");
        let output = run(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        Picture::read(&folder.join("render.png")).expect("a PNG").rgb[1]
    };
    let expected = shown("sky.hdr");
    // A sixteenth of 10 in sRGB.
    assert!((200..212).contains(&expected), "{expected}");
    for name in ["sky.exr", "again.hdr"] {
        assert!(shown(name).abs_diff(expected) <= 1, "{name}");
    }
}

#[test]
fn tone_maps_and_exposures_change_what_is_shown() {
    let folder = folder("tone");
    let picture = |options: &str| {
        let output = run(&folder, &format!("{SMALL} {options}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        Picture::read(&folder.join("render.png")).expect("a PNG")
    };
    let mut pictures = vec![picture("")];
    assert_eq!(pictures[0], picture("--tone-map soft --exposure 0 --filter tent --seed 0"));
    for map in ["reinhard", "aces", "agx", "neutral"] {
        pictures.push(picture(&format!("--tone-map {map}")));
    }
    pictures.push(picture("--exposure auto"));
    pictures.push(picture("--filter box"));
    pictures.push(picture("--filter blackman-harris"));
    pictures.push(picture("--seed 1"));
    pictures.push(picture("--aperture 0.5"));
    assert!((1..pictures.len()).all(|i| !pictures[..i].contains(&pictures[i])));
    let report = json(&run(&folder, &format!("{SMALL} --exposure auto --f-number 2 --json")));
    assert!(report["exposure"].as_f64().is_some_and(|exposure| exposure != 1.0));
    assert!(report["lens"]["focus"].as_f64().is_some_and(|focus| focus > 0.0));
}

/// Whether a text stands anywhere in a file.
fn contains(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

#[test]
fn files_say_how_they_were_made_and_equal_pictures_are_equal_files() {
    let folder = folder("metadata");
    let written = |name: &str, options: &str| {
        let output = run(&folder, &format!("{SMALL} -o {name} {options}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        fs::read(folder.join(name)).expect("a picture")
    };
    for ending in ["png", "exr", "hdr"] {
        let plain = written(&format!("a.{ending}"), "-t 1");
        assert!(plain == written(&format!("b.{ending}"), "-t 2"), "{ending} differs");
        let version = format!("raywood {}", env!("CARGO_PKG_VERSION"));
        assert!(contains(&plain, &version) && contains(&plain, "raywood:seed"), "{ending}");
        assert!(!contains(&plain, "raywood:command"), "{ending}");
        let full = written(&format!("c.{ending}"), "--metadata full");
        assert!(contains(&full, &format!("-o c.{ending} --metadata full")), "{ending}");
        assert!(contains(&full, "raywood:seconds"), "{ending}");
        let none = written(&format!("d.{ending}"), "--metadata none");
        assert!(!contains(&none, "raywood:"), "{ending}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_before_any_work() {
    let folder = folder("refused");
    for (arguments, expected) in [
        (
            "-o a.bmp",
            "a.bmp: pictures are written as PNG, OpenEXR, Radiance, JPEG: the name must end in one of .png, .exr,",
        ),
        ("-o a.jpg --bits 16", "a.jpg: --bits 16: JPEG has 8 bits a channel"),
        ("-o a.exr --bits 8", "a.exr: --bits 8: OpenEXR has 16 or 32 bits a channel"),
        ("-o a.png --quality 80", "a.png: --quality is of JPEG: PNG loses nothing"),
        ("-o a.jpg --quality 0", "expected a whole number from 1 to 100"),
        (
            "-o a.exr --tone-map agx",
            "a.exr: OpenEXR holds light as it is, --tone-map is for what a screen shows",
        ),
        ("-o a.hdr --exposure 1", "a.hdr: Radiance holds light as it is, --exposure is for"),
        (
            "-o a.exr --heatmap nodes",
            "a.exr: OpenEXR holds light, but heat maps and bounds are drawn",
        ),
        ("--aovs depth", "render.png: PNG has no layers for --aovs: expected .exr"),
        (
            "-o a.exr --aovs depth,fog",
            "`fog` is no layer: expected some of albedo, normal, position, depth, ids, samples, variance, or all",
        ),
        (
            "--denoise",
            "--denoise: expected integrator path, or light with --noise or --time, 8 samples",
        ),
        ("--denoise -i path", "8 samples per pixel or more"),
        ("--tone-map film", "expected one of soft, none, reinhard, aces, agx, neutral"),
        ("--filter gauss", "expected one of tent, box, blackman-harris"),
        ("--noise 2", "expected a relative error above 0 and below 1"),
        ("--time soon", "expected a time, as in 30s"),
        ("--focus 3", "--aperture"),
        ("--aperture 1 --f-number 2", "cannot be used with"),
        ("--aperture 0", "expected a number above 0"),
        ("--aperture 1 --focus 99,1", "--focus 99,1: the picture has 48x30 pixels"),
        (
            "--aperture 1 --focus 0,0 --eye 0,90,0 --target 0,99,0",
            "--focus 0,0: nothing is seen there",
        ),
        ("--metadata some", "possible values: none, settings, full"),
    ] {
        let output = run(&folder, &format!("{SMALL} {arguments}"));
        let said = stderr(&output);
        assert_eq!(code(&output), 2, "{arguments}: {said}");
        assert!(said.contains(expected), "{arguments}: {said}");
        assert_eq!(stdout(&output), "", "{arguments}");
    }
    assert_eq!(files(&folder), [""; 0]);
}

#[test]
fn layers_lie_beside_the_picture() {
    let folder = folder("layers");
    let arguments = "render builtin:whitted --size 32x20 -n 8 -i path -o a.exr --aovs";
    let sizes = ["depth", "all"].map(|names| {
        let output = run(&folder, &format!("{arguments} {names}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let bytes = fs::read(folder.join("a.exr")).expect("a picture");
        let has = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
        assert!(has("depth.Z\0") && has("R\0"));
        let others = ["albedo.G", "normal.X", "position.Z", "primitive.id", "material.id"];
        let has_others = others.iter().filter(|name| has(name)).count();
        assert_eq!(has_others, if names == "all" { 5 } else { 0 });
        assert_eq!(has("samples.N") && has("variance.Y"), names == "all");
        bytes.len()
    });
    assert!(sizes[0] < sizes[1]);
    // Of Whitted's method, too.
    let output = run(&folder, &format!("{SMALL} -o b.exr --aovs all"));
    assert_eq!(code(&output), 0, "{}", stderr(&output));
}

#[test]
fn noise_is_removed_on_request() {
    let folder = folder("denoise");
    let picture = |options: &str| {
        let scene = "render builtin:whitted --size 64x40 -i path --exposure 0";
        let output = run(&folder, &format!("{scene} {options}"));
        assert_eq!((code(&output), stderr(&output).as_str()), (0, ""));
        let written = folder.join("render.png");
        let told = contains(&fs::read(&written).expect("a picture"), "raywood:denoised");
        assert_eq!(told, options.contains("--denoise"));
        Picture::read(&written).expect("a PNG")
    };
    let reference = picture("-n 512");
    let [before, after] =
        ["-n 8", "-n 8 --denoise"].map(|options| picture(options).difference(&reference));
    assert!(after.mean < before.mean, "{after:?}, and before {before:?}");
}

#[test]
fn noise_and_time_end_a_picture() {
    let folder = folder("goals");
    let scene = "render builtin:whitted --size 64x40 -i path";
    let report = json(&run(&folder, &format!("{scene} --noise 3% --json -n 512")));
    let passes = &report["passes"];
    assert_eq!(passes["ended"], "noise", "{passes}");
    assert!(passes["noise"].as_f64().is_some_and(|noise| noise < 0.03), "{passes}");
    assert!(passes["fewest_samples"].as_u64().is_some_and(|fewest| fewest >= 16), "{passes}");
    let first = fs::read(folder.join("render.png")).expect("a picture");
    let output = run(&folder, &format!("{scene} --noise 0.03 -n 512 -t 1"));
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(stdout(&output).contains("on average"), "{}", stdout(&output));
    assert!(first == fs::read(folder.join("render.png")).expect("a picture"), "by one thread");

    // Whitted's method, too.
    let report = json(&run(&folder, "render builtin:whitted --size 64x40 --time 0.2s --json"));
    assert_eq!(report["passes"]["ended"], "time", "{report}");
    let report = json(&run(&folder, "render builtin:whitted --size 64x40 -n 3 --time 9h --json"));
    assert_eq!(report["passes"]["ended"], "samples", "{report}");
    assert_eq!(report["passes"]["mean_samples"], 3.0, "{report}");
    let report = json(&run(&folder, &format!("{SMALL} --json")));
    assert_eq!(report["passes"], Value::Null);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_picture_so_far() {
    let folder = folder("keep");
    let mut child = raywood(&folder)
        .args("render builtin:whitted --size 64x40 -i path -n 1000000".split_whitespace())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command starts");
    std::thread::sleep(Duration::from_millis(1500));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill starts").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    let said = std::io::read_to_string(child.stderr.take().expect("its errors")).expect("text");
    assert!(said.starts_with("raywood: stopped: after "), "{said}");
    assert!(said.contains(" of 1000000 samples per pixel; render.png is what there was"), "{said}");
    let picture = Picture::read(&folder.join("render.png")).expect("a PNG");
    assert_eq!((picture.width, picture.height), (64, 40));
    assert!(picture.colors() > 200);
    assert_eq!(files(&folder), ["render.png"]);
}
