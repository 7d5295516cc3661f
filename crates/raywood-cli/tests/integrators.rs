//! Ways of rendering as a user asks for them: `--integrator`, `--environment`, `--exposure`, `--no-lights`.

mod support;

use std::fs;

use raywood_testkit::image::Picture;
use support::{code, folder, json, run, stderr, stdout, write_triangle};

/// A Radiance picture of one colour: 2 x 1 texels of these bytes, which share an exponent.
fn write_sky(folder: &std::path::Path, texel: [u8; 4]) {
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    let bytes = [&header[..], &texel, &texel].concat();
    fs::write(folder.join("sky.hdr"), bytes).expect("a file");
}

#[test]
fn every_integrator_draws_and_says_so() {
    let folder = folder("integrators");
    let help = stdout(&run(&folder, "render --help"));
    let said = stderr(&run(&folder, "render --integrator pth"));
    assert!(said.contains("did you mean path? expected one of whitted, path, "), "{said}");
    let names = said.split("expected one of ").nth(1).and_then(|names| names.lines().next());
    let names: Vec<_> = names.expect("the names").split(", ").collect();
    assert!(names.len() >= 8, "{names:?}");
    let mut pictures = Vec::new();
    for name in names {
        assert!(help.contains(name), "{name} is not in the help");
        let arguments = format!("render builtin:whitted --size 48x30 -n 2 --integrator {name}");
        let report = json(&run(&folder, &format!("{arguments} --json")));
        assert_eq!(
            (&report["integrator"], &report["rays"]["primary"]),
            (&name.into(), &2880.into())
        );
        pictures.push(Picture::read(&folder.join("render.png")).expect("a PNG"));
        // The same by one thread.
        let output = run(&folder, &format!("{arguments} -t 1 -o again.png"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let again = Picture::read(&folder.join("again.png")).expect("a PNG");
        assert_eq!(pictures.last(), Some(&again), "{name} by one thread");
    }
    let all_differ = |i: usize| !pictures[..i].contains(&pictures[i]);
    assert!((1..pictures.len()).all(all_differ), "two integrators show the same");
}

#[test]
fn whitted_is_what_nobody_needs_to_ask_for() {
    let folder = folder("default-integrator");
    let render = |name: &str, options: &str| {
        let output =
            run(&folder, &format!("render builtin:whitted --size 48x30 -o {name} {options}"));
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        fs::read(folder.join(name)).expect("a picture")
    };
    assert!(render("a.png", "") == render("b.png", "--integrator whitted"));
}

#[test]
fn a_panorama_lights_the_scene_and_is_seen() {
    let folder = folder("environment");
    write_triangle(&folder);
    // A green of one half.
    write_sky(&folder, [0, 127, 0, 128]);
    let color = |options: &str| {
        let view = "--eye 0.3,0.3,2 --target 0.3,0.3,0 --no-lights";
        let arguments = format!("render triangle.obj --size 16x16 -n 64 {view} {options}");
        let output = run(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let picture = Picture::read(&folder.join("render.png")).expect("a PNG");
        let pixel = |x: usize, y: usize| {
            let first = 3 * (y * picture.width + x);
            [picture.rgb[first], picture.rgb[first + 1], picture.rgb[first + 2]]
        };
        (pixel(8, 8), pixel(0, 0))
    };
    let (lit, sky) = color("-i path --environment sky.hdr");
    assert!(sky[1] > 180 && sky[0] < 20, "{sky:?}");
    assert!(lit[1] > 120 && lit[0] < 20 && lit[1] < sky[1], "{lit:?}");
    assert_eq!(color("-i path --environment none"), ([0; 3], [0; 3]));
    let (_, sky) = color("--environment sky.hdr");
    assert!(sky[1] > 180 && sky[0] < 20, "Whitted's method shows it too: {sky:?}");

    // By formula: blue, and a sun that lights what it can see with either method.
    for method in ["path", "whitted"] {
        let options = format!("-i {method} --environment sky:elevation=60,azimuth=180");
        let view = "--eye 0.3,0.3,2 --target 0.3,0.3,0";
        let arguments = format!("render triangle.obj --size 16x16 -n 64 {view} {options}");
        let output = run(&folder, &arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let picture = Picture::read(&folder.join("render.png")).expect("a PNG");
        let pixel = |x: usize, y: usize| &picture.rgb[3 * (y * picture.width + x)..][..3];
        let (lit, sky) = (pixel(8, 8), pixel(8, 0));
        assert!(sky[2] > sky[0] + 20, "{method}: {sky:?}");
        assert!(lit.iter().all(|&channel| channel > 60), "{method}: {lit:?}");
    }
    let said = stderr(&run(&folder, "render triangle.obj --environment sky:height=3"));
    assert!(said.contains("a sky has no `height`"), "{said}");

    let said = stderr(&run(&folder, "render triangle.obj --environment triangle.obj"));
    assert!(said.contains("triangle.obj: is in no known format: expected a Radiance"), "{said}");
    let said = stderr(&run(&folder, "render triangle.obj --environment missing.hdr"));
    assert!(said.contains("missing.hdr: no such file"), "{said}");
}

#[test]
fn exposure_is_found_or_given() {
    let folder = folder("exposure");
    write_triangle(&folder);
    // Much light: 2^6.
    write_sky(&folder, [127, 127, 127, 135]);
    let exposure = |options: &str| {
        let arguments = format!("render triangle.obj --size 16x16 --environment sky.hdr {options}");
        let report = json(&run(&folder, &format!("{arguments} --json")));
        report["exposure"].as_f64().expect("a number")
    };
    let found = exposure("-i path");
    assert!((found - 0.8 / 64.0).abs() < 0.002, "{found}");
    assert_eq!(exposure(""), 1.0, "Whitted's pictures are left as they are");
    assert_eq!((exposure("-i path --exposure=-3"), exposure("--exposure 1")), (0.125, 2.0));
    let said = stderr(&run(&folder, "render triangle.obj --exposure bright"));
    assert!(said.contains("expected stops from -32 to 32"), "{said}");
}
