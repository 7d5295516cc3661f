//! Long work as a user does it: broken off and gone on with, in parts on several machines.

mod support;

use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use raywood_render::{Contents, FilmFile, ImageFormat, Region, WriteOptions};
use support::{code, files, folder, json, raywood, run, stderr, stdout};

/// Starts a command in the background.
fn start(folder: &Path, arguments: &str) -> Child {
    let mut command = raywood(folder);
    command.args(arguments.split_whitespace());
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the command starts")
}

/// Waits for something, for some minutes at most, as machines may be busy.
fn wait_for(what: &str, is_there: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_there() {
        assert!(started.elapsed() < Duration::from_secs(300), "{what} does not come");
        thread::sleep(Duration::from_millis(2));
    }
}

fn assert_done(output: &Output) {
    assert_eq!(code(output), 0, "{}", stderr(output));
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

const SMALL: &str = "builtin:whitted --size 150x100";

#[test]
fn what_is_killed_goes_on_to_the_same_bytes() {
    let folder = folder("killed");
    for (integrator, options) in [
        ("path", "-n 40"),
        ("path", "--noise 8%"),
        ("path", "-n 32 --denoise --f-number 2"),
        ("whitted", "-n 60"),
        ("ao", "-n 50"),
        ("whitted", "--noise 3%"),
        ("normals", "-n 70"),
    ] {
        let command = format!("render {SMALL} -i {integrator} {options}");
        assert_done(&run(&folder, &format!("{command} -o whole.png --threads 2")));
        let resume = "--checkpoint a.film --resume --checkpoint-every 0.01 -o again.png";
        for threads in [1, 3] {
            let mut child = start(&folder, &format!("{command} {resume} --threads {threads}"));
            let film = folder.join("a.film");
            let before = fs::metadata(&film).and_then(|film| film.modified()).ok();
            wait_for("a film", || {
                let after = fs::metadata(&film).and_then(|film| film.modified()).ok();
                after.is_some() && after != before
            });
            child.kill().expect("it is killed");
            child.wait().expect("it ends");
        }
        assert_done(&run(&folder, &format!("{command} {resume}")));
        assert!(bytes(&folder, "again.png") == bytes(&folder, "whole.png"), "{command}");

        // Of what is finished the picture is written anew, and without any ray.
        fs::remove_file(folder.join("again.png")).expect("a picture");
        let again = json(&run(&folder, &format!("{command} {resume} --json")));
        assert!(bytes(&folder, "again.png") == bytes(&folder, "whole.png"), "{command}");
        assert_eq!(again["rays"]["primary"], 0);
        fs::remove_file(folder.join("a.film")).expect("a film");
    }
    // What was killed while it wrote leaves its unfinished file.
    let left = files(&folder).into_iter().filter(|name| !name.ends_with(".tmp")).count();
    assert_eq!(left, 2, "{:?}", files(&folder));
}

#[cfg(unix)]
#[test]
fn what_is_asked_to_end_keeps_a_film_even_before_there_is_a_picture() {
    let folder = folder("ctrl-c-film");
    // Whitted's pixels have all samples or none.
    for (signal, options, expected) in [
        (
            "-INT",
            "-i whitted -n 5000",
            "before there was a picture; a.film has what was done, --resume goes on",
        ),
        ("-TERM", "-i path -n 60000", "b.png is what there was; --resume goes on from a.film"),
    ] {
        let command = format!("render {SMALL} {options} --checkpoint a.film -o b.png");
        let child = raywood(&folder)
            .args(command.split_whitespace())
            .args(["--checkpoint-every", "0.01"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the command starts");
        wait_for("a film", || folder.join("a.film").exists());
        if options.contains("path") {
            wait_for("a picture", || {
                FilmFile::read(&*bytes(&folder, "a.film"))
                    .is_ok_and(|file| file.film.samples().0 > 0)
            });
        }
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(kill.expect("kill starts").success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(code(&output), 130);
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
        fs::remove_file(folder.join("a.film")).expect("a film");
    }
}

#[test]
fn shares_and_regions_are_put_together_to_the_same_bytes() {
    let folder = folder("shares");
    for (integrator, options) in
        [("path", "-n 8"), ("whitted", "-n 5"), ("path", "--noise 5%"), ("depth", "-n 1")]
    {
        let command = format!("render {SMALL} -i {integrator} {options}");
        assert_done(&run(&folder, &format!("{command} -o whole.png")));
        for tile in 1..=3 {
            let film = format!("--checkpoint {tile}.film --tile {tile}/3 --threads {tile}");
            let output = run(&folder, &format!("{command} {film}"));
            assert_done(&output);
            assert!(stdout(&output).starts_with(&format!("wrote {tile}.film: ")));
        }
        assert!(!files(&folder).contains(&"render.png".to_owned()));
        for name in ["merged.png", "merged.film"] {
            assert_done(&run(&folder, &format!("merge 3.film 1.film 2.film -o {name}")));
        }
        assert!(bytes(&folder, "merged.png") == bytes(&folder, "whole.png"), "{command}");
        let go_on = format!("{command} --checkpoint merged.film --resume -o denoised.png");
        assert_done(&run(&folder, &go_on));
        assert!(bytes(&folder, "denoised.png") == bytes(&folder, "whole.png"), "{command}");

        // A region is what is cut out of the whole.
        let region = "--region 29,40,70,21 --metadata none -o region.png";
        assert_done(&run(&folder, &format!("{command} {region}")));
        let whole = bytes(&folder, "merged.film");
        let FilmFile { film, exposure, is_light, .. } = FilmFile::read(&*whole).expect("a film");
        let cropped = film.cropped(Region { x: 29, y: 40, width: 70, height: 21 });
        let image = cropped.image(is_light).exposed(exposure);
        let format = ImageFormat::of_path(Path::new("region.png")).expect("PNG");
        let (mut expected, options) = (Cursor::new(Vec::new()), WriteOptions::of(format));
        format.write(Contents::Computed(&image, &[]), &options, &mut expected).expect("bytes");
        assert!(bytes(&folder, "region.png") == expected.into_inner(), "{command}");
        for name in files(&folder) {
            fs::remove_file(folder.join(name)).expect("a file");
        }
    }
}

#[test]
fn films_of_other_seeds_add_up() {
    let folder = folder("seeds");
    for seed in 1..=3 {
        let film = format!("--seed {seed} --checkpoint {seed}.film -o {seed}.png");
        assert_done(&run(&folder, &format!("render {SMALL} -i path -n 8 {film}")));
    }
    let merged = json(&run(&folder, "merge 2.film 3.film 1.film -o a.film --json"));
    assert_eq!(
        (merged["seeds"].as_str(), merged["fewest_samples"].as_u64()),
        (Some("1, 2, 3"), Some(24))
    );
    assert_done(&run(&folder, "merge 1.film 2.film 3.film 2.film -o b.film"));
    assert!(
        bytes(&folder, "a.film") == bytes(&folder, "b.film"),
        "in any order, twice counts once"
    );

    // What was merged has samples of several seeds, which must not be added again.
    for (films, expected) in [
        ("a.film 2.film", "2.film: has samples of seed 2, and a.film of seed 1, 2, 3"),
        ("3.film a.film", "a.film: has samples of seed 1, 2, 3, and 3.film of seed 3"),
    ] {
        let output = run(&folder, &format!("merge {films} -o c.film"));
        assert_eq!(code(&output), 2);
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    assert_done(&run(&folder, "merge a.film b.film -o c.film"));
    assert!(bytes(&folder, "a.film") == bytes(&folder, "c.film"));
}

#[test]
fn films_of_what_moves_go_on_to_the_same_bytes() {
    let folder = folder("motion");
    let picture = "render builtin:mill --size 150x100 -i path -n 40 --shutter 0.1,0.7";
    assert_done(&run(&folder, &format!("{picture} --checkpoint whole.film -o whole.png")));
    let parts =
        format!("{picture} --checkpoint parts.film --resume --checkpoint-every 0.01 -o parts.png");
    let mut child = start(&folder, &parts);
    wait_for("a film", || folder.join("parts.film").exists());
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    assert_done(&run(&folder, &parts));
    assert!(bytes(&folder, "parts.film") == bytes(&folder, "whole.film"));
    assert!(bytes(&folder, "parts.png") == bytes(&folder, "whole.png"));

    // Another shutter, another picture.
    let simple = "render builtin:mill --size 96x32 -n 4";
    for (name, tile, shutter) in
        [("1", 1, "0,0.5"), ("2", 2, "0,0.5"), ("3", 3, "0,0.5"), ("other", 3, "0,0.25")]
    {
        let film = format!("--tile {tile}/3 --checkpoint {name}.film");
        assert_done(&run(&folder, &format!("{simple} --shutter {shutter} {film}")));
    }
    assert_done(&run(&folder, "merge 1.film 2.film 3.film -o merged.film"));
    let refused = run(&folder, "merge 1.film 2.film other.film -o none.film");
    assert_eq!(code(&refused), 2);
    let expected = "--shutter is 0,0.25 in it, 0,0.5 in 1.film";
    assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
    let refused = run(&folder, &format!("{simple} --checkpoint merged.film --resume"));
    let expected = "--shutter is 0,0.5 in it, not given now";
    assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
}

#[test]
fn films_of_something_else_are_refused_by_what_differs() {
    let folder = folder("refused");
    let simple = "render builtin:whitted --size 64x40 -n 2";
    assert_done(&run(&folder, &format!("{simple} --checkpoint a.film")));
    let film = bytes(&folder, "a.film");
    let again = format!("{simple} --checkpoint a.film");
    let resume = format!("{again} --resume");
    for (command, expected) in [
        (
            again.clone(),
            "a.film: is there already: expected --resume to go on with it, or another name",
        ),
        (
            format!("{resume} --depth 5"),
            "a.film: is of another picture: --depth is 10 in it, 5 now",
        ),
        (resume.replace("64x40", "64x41"), "--size is 64x40 in it, 64x41 now"),
        (format!("{resume} -i path"), "--integrator is whitted in it, path now"),
        (format!("{resume} --seed 7"), "--seed is 0 in it, 7 now"),
        (resume.replace("-n 2", "-n 3"), "--samples is 2 in it, 3 now"),
        (format!("{resume} --filter box"), "--filter is tent in it, box now"),
        (
            format!("{resume} --aperture 0.1 --focus 4"),
            "lens is not given in it, radius 0.05, focus 4 now",
        ),
        (format!("{resume} --eye 1,2,3"), "camera is at "),
        (format!("{resume} --light 1,2,3"), "the scene's lights are others"),
        (format!("{resume} --environment sky"), "--environment is not given in it, "),
        (format!("{resume} --simd portable"), "cannot go on to the same last digits: --simd is "),
        (format!("{resume} --build fast"), "--structure and --build is bvh-wide (balanced) of "),
        (
            resume.replace("builtin:whitted", "builtin:sphereflake"),
            "the scene's spheres are others",
        ),
        (
            format!("{resume} --heatmap tests"),
            "heat maps and bounds are drawn at once, expected neither",
        ),
        (format!("{resume} -o a.film"), "a.film: pictures are written as"),
        (format!("{simple} --resume"), "--checkpoint <FILE>"),
        (format!("{simple} --tile 1/2"), "--checkpoint <FILE>"),
        (
            format!("{simple} --checkpoint no/a.film"),
            "no/a.film: cannot be written: there is no folder no",
        ),
        (
            format!("{simple} --region 60,0,5,5"),
            "a region of 5x5 pixels at 60,0 does not lie in a picture of 64x40",
        ),
        (
            format!("{simple} --checkpoint b.film --tile 5/5"),
            "share 5 of 5 has no tile: a picture of 64x40 pixels has 4 tiles",
        ),
        (
            simple.replace("-n 2", "-i path -n 8 --denoise --region 0,0,5,5"),
            "--denoise: needs the whole picture",
        ),
        ("merge a.film no.film".to_owned(), "no.film: "),
        ("merge a.film -o a.gif".to_owned(), "a.gif: pictures are written as"),
        ("merge .".to_owned(), ".: is a folder, expected a film"),
    ] {
        let output = run(&folder, &command);
        let said = stderr(&output);
        assert_eq!(code(&output), 2, "{command}: {said}");
        assert!(said.contains(expected), "{command}: {said}");
        assert!(bytes(&folder, "a.film") == film, "{command}: the film is another");
    }
    assert_eq!(files(&folder).len(), 2, "{:?}", files(&folder));
}

#[test]
fn damaged_films_are_refused_and_stay_as_they_are() {
    let folder = folder("damaged");
    let simple = "render builtin:whitted --size 40x40 -n 1 --checkpoint a.film";
    assert_done(&run(&folder, simple));
    let film = bytes(&folder, "a.film");
    let mut flipped = film.clone();
    flipped[film.len() / 2] ^= 4;
    let mut newer = film.clone();
    newer[8] = 9;
    for (bytes, expected) in [
        (film[..film.len() - 1].to_vec(), "a.film: is cut off: "),
        (film[..3].to_vec(), "a.film: is no film: it begins with other bytes"),
        (Vec::new(), "a.film: is no film: it begins with other bytes"),
        ([&film[..], b"\n"].concat(), "a.film: has bytes at its end that do not belong to it"),
        (flipped, "a.film: is damaged: the checksum of the pixels is wrong"),
        (newer, "a.film: is a film of version 9 of the format"),
        (b"solid model\n".to_vec(), "a.film: is no film: it begins with other bytes"),
    ] {
        fs::write(folder.join("a.film"), &bytes).expect("a file");
        for command in [format!("{simple} --resume"), "merge a.film".to_owned()] {
            let output = run(&folder, &command);
            assert_eq!(code(&output), 2, "{command}");
            assert!(stderr(&output).contains(expected), "{command}: {}", stderr(&output));
        }
        assert_eq!(fs::read(folder.join("a.film")).expect("a file"), bytes);
    }
}

#[test]
fn what_is_missing_or_unlike_is_not_merged() {
    let folder = folder("unlike");
    let simple = "render builtin:whitted --size 100x70";
    for (name, options) in [
        ("1", "-n 2 --tile 1/2"),
        ("2", "-n 2 --tile 2/2"),
        ("other", "-n 2 --tile 2/2 --fov 20"),
        ("digits", "-n 2 --tile 2/2 --simd portable"),
    ] {
        assert_done(&run(&folder, &format!("{simple} {options} --checkpoint {name}.film")));
    }
    for (films, expected) in [
        (
            "1.film 1.film",
            "6 of 12 tiles of 32x32 pixels are in no film, the first at column 32, row 0: expected the films of all shares or regions, or --partial",
        ),
        ("1.film other.film", "other.film: is of another picture than 1.film: camera is at "),
    ] {
        let output = run(&folder, &format!("merge {films} -o merged.png"));
        assert_eq!(code(&output), 2, "{films}");
        assert!(stderr(&output).contains(expected), "{films}: {}", stderr(&output));
        assert!(!files(&folder).contains(&"merged.png".to_owned()));
    }
    assert_done(&run(&folder, "merge 1.film --partial -o partial.png"));
    let output = run(&folder, "merge 1.film digits.film -o merged.png");
    assert_done(&output);
    if stderr(&run(&folder, "info builtin:whitted --simd avx2")).is_empty() {
        let expected = "warning: digits.film: last digits may differ from those of one rendering: --simd is portable in it, ";
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

/// A command that is killed when the test ends, however it does.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn watching_renders_again_and_survives_half_written_files() {
    let folder = folder("watch");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    let scene =
        "[[model]]\nfile = \"part.toml\"\n[[camera]]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";
    let part = |radius: f32| {
        let sphere = "[[sphere]]\ncenter = [0, 0, 0]\nmaterial = { color = 0.8 }\n";
        write("part.toml", &format!("{sphere}radius = {radius}\n"));
    };
    write("scene.toml", scene);
    part(1.0);

    let said = fs::File::create(folder.join("said")).expect("a file");
    let command = "render scene.toml --watch --size 40x25 -o a.png";
    let child = raywood(&folder)
        .args(command.split_whitespace())
        .stdout(Stdio::null())
        .stderr(said)
        .spawn()
        .expect("the command starts");
    let _running = Running(child);
    let said = || fs::read_to_string(folder.join("said")).expect("text");
    let rounds = |count: usize| {
        wait_for("the picture", || said().matches("files, Ctrl-C ends").count() == count);
    };
    rounds(1);
    let first = bytes(&folder, "a.png");

    // A file that the scene names.
    part(0.5);
    rounds(2);
    let second = bytes(&folder, "a.png");
    assert!(first != second);

    // Half a file, which is said; the picture stays.
    write("scene.toml", &scene[..30]);
    rounds(3);
    assert!(said().contains("error: scene.toml:3:2: "), "{}", said());
    assert!(bytes(&folder, "a.png") == second);

    // And all is well again.
    part(1.0);
    write("scene.toml", scene);
    rounds(4);
    assert!(bytes(&folder, "a.png") == first);

    // A file that is not there yet is waited for.
    write("scene.toml", &scene.replace("part.toml", "other.toml"));
    rounds(5);
    assert!(said().contains("no such file: `other.toml`"), "{}", said());
    fs::copy(folder.join("part.toml"), folder.join("other.toml")).expect("a file");
    rounds(6);
    assert!(bytes(&folder, "a.png") == first);

    let output = run(&folder, "render nowhere.toml --watch");
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("nowhere.toml: no such file"), "{}", stderr(&output));
}

#[test]
fn frames_are_pictures_of_a_camera_that_moves() {
    let folder = folder("frames");
    let simple = "builtin:whitted --size 48x30 -n 1 -i path";
    assert_done(&run(&folder, &format!("render {simple} --frames 4 -o turn_%02d.png")));
    let turn: Vec<_> = (1..=4).map(|n| bytes(&folder, &format!("turn_0{n}.png"))).collect();
    assert!((1..4).all(|i| turn[i] != turn[i - 1]));
    // The first is what is rendered without frames; half a turn is half a turn, either way round.
    assert_done(&run(&folder, &format!("render {simple} -o one.png")));
    assert!(bytes(&folder, "one.png") == turn[0]);
    assert_done(&run(&folder, &format!("render {simple} --frames 2 --turn -360 -o b.png")));
    assert!(bytes(&folder, "b_0001.png") == turn[0]);

    // What is there is left out, and only if that is asked for.
    fs::write(folder.join("turn_02.png"), "mine").expect("a file");
    fs::remove_file(folder.join("turn_03.png")).expect("a file");
    let go_on = format!("render {simple} --frames 4 -o turn_%02d.png --skip-existing");
    assert_done(&run(&folder, &go_on));
    assert!(bytes(&folder, "turn_02.png") == b"mine" && bytes(&folder, "turn_03.png") == turn[2]);
    assert_done(&run(&folder, &format!("render {simple} --frames 4 -o turn_%02d.png")));
    assert!(bytes(&folder, "turn_02.png") == turn[1]);
}

#[test]
fn cameras_of_a_scene_are_the_keys_of_a_way() {
    let folder = folder("way");
    let camera = |name: &str, eye: [f32; 3]| {
        format!("[[camera]]\nname = \"{name}\"\neye = {eye:?}\ntarget = [0, 0, 0]\n")
    };
    let text = [
        "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = { color = 0.8, pattern = { kind = \"checker\", color = 0.1, size = 0.5 } }\n".to_owned(),
        "[[light]]\nkind = \"directional\"\ndirection = [-1, -2, -1]\nintensity = 1\n".to_owned(),
        camera("front", [0.0, 0.0, 5.0]),
        camera("side", [5.0, 1.0, 0.0]),
        camera("back", [0.0, 0.0, -6.0]),
    ];
    fs::write(folder.join("a.toml"), text.concat()).expect("a file");
    let simple = "render a.toml --size 40x25";
    assert_done(&run(&folder, &format!("{simple} --frames 5 --through all -o way.png")));
    assert_done(&run(&folder, &format!("{simple} --frames 3 --through 3,front -o back.png")));
    for (camera, frame) in [("front", "way_0001"), ("2", "way_0003"), ("back", "way_0005")] {
        assert_done(&run(&folder, &format!("{simple} --camera {camera} -o key.png")));
        assert!(bytes(&folder, "key.png") == bytes(&folder, &format!("{frame}.png")), "{camera}");
    }
    assert!(bytes(&folder, "way_0002.png") != bytes(&folder, "way_0001.png"));
    assert!(bytes(&folder, "back_0003.png") == bytes(&folder, "way_0001.png"));

    for (options, expected) in [
        (
            "--frames 2 --through front,left",
            "a.toml: has no camera `left`; its cameras: 1 front, 2 side, 3 back",
        ),
        ("--frames 0", "--frames"),
        (
            "--frames 2 -o a%s.png",
            "a%s.png: expected one number of the frame in the name, as %d or %04d",
        ),
        ("--frames 2 --exposure auto", "--exposure auto would flicker"),
        ("--through all", "--frames <N>"),
        ("--frames 2 --checkpoint a.film", "cannot be used with"),
        ("--frames 2 --watch", "cannot be used with"),
    ] {
        let output = run(&folder, &format!("{simple} {options}"));
        assert_eq!(code(&output), 2, "{options}");
        assert!(stderr(&output).contains(expected), "{options}: {}", stderr(&output));
    }
    let output = run(&folder, "render builtin:whitted --watch");
    assert!(stderr(&output).contains("--watch: builtin:whitted does not change, expected a file"));
}
