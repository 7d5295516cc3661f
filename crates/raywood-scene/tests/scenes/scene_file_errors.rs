//! Scene files that are wrong: each is refused in one line that names the place and what was expected.

use raywood_scene::{LoadOptions, load_file};

use crate::formats_support::{Folder, check_error, error_of};

/// Files, the line and column of the fault, and pieces of the message.
const BAD: &[(&str, &str, &[&str])] = &[
    ("up = [0, 1", "1:", &["]"]),
    ("up = 1\nup = 2", "2:1", &["duplicate key"]),
    ("ups = [0, 1, 0]", "1:1", &["a scene file has no key `ups`", "did you mean `up`?"]),
    ("\n  zebra = 1", "2:3", &["no key `zebra`", "(there are: `model`, `sphere`,"]),
    ("up = [0, 0, 0]", "1:6", &["`up` is `[0, 0, 0]`", "a direction"]),
    ("up = [0, nan, 0]", "1:6", &["expected a direction"]),
    ("background = -1", "1:14", &["`-1`", "a colour", "at least 0"]),
    ("background = \"#12345\"", "1:14", &["#rrggbb"]),
    ("background = \"#12345\u{e9}\"", "1:14", &["#rrggbb"]),
    ("background = { zenith = 1, horizon = 1 }", "1:14", &["needs the key `nadir`"]),
    ("environment = \"no.hdr\"", "1:15", &["no such file: `no.hdr`"]),
    ("environment = 1", "1:15", &["a text in quotes"]),
    (
        "environment = \"sky:elevaton=20\"",
        "1:15",
        &["a sky has no `elevaton`: did you mean elevation?"],
    ),
    (
        "environment = \"sky:turbidity=11\"",
        "1:15",
        &["`11` is no turbidity of a sky: expected a number from 1 to 10"],
    ),
    ("sphere = 3", "1:10", &["headed [[sphere]]"]),
    ("[sphere]\nradius = 1", "1:", &["headed [[sphere]]"]),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1", "1:1", &["[[sphere]] needs the key `material`"]),
    (
        "[[sphere]]\ncenter = [0, 0, 0]\nradios = 1",
        "3:1",
        &["[[sphere]] has no key `radios`, did you mean `radius`?"],
    ),
    ("[[sphere]]\ncenter = [0, 0]", "2:10", &["`center` is `[0, 0]`", "three numbers"]),
    ("[[sphere]]\ncenter = [0, 0, \"1\"]", "2:10", &["three numbers"]),
    ("[[sphere]]\ncenter = [0, 0, 1e60]", "2:10", &["three numbers"]),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 0", "3:10", &["a number above 0"]),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = nan", "3:10", &["a number above 0"]),
    ("[[sphere]]\ncenter = [0, 0, 0]\nradius = 1979-05-27", "3:10", &["a number above 0"]),
    (
        "[[sphere]]\ncenter = [3e38, 0, 0]\nradius = 3e38\nmaterial = {}",
        "1:1",
        &["beyond the largest number"],
    ),
    (
        "material.gold = {}\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"gould\"",
        "5:12",
        &["`\"gould\"`", "did you mean `gold`?", "(there are: `gold`)"],
    ),
    ("material.gold = 1", "1:17", &["headed [material.NAME]"]),
    ("material.gold.colour = 1", "1:15", &["did you mean `color`?"]),
    ("material.gold.color = [2, 0, 0]", "1:23", &["each from 0 to 1"]),
    ("material.gold.roughness = 1.5", "1:27", &["a number from 0 to 1"]),
    ("material.gold.ior = 0.5", "1:21", &["a number from 1 to 10"]),
    ("material.gold.clearcoat = 1.5", "1:27", &["`clearcoat` is `1.5`", "a number from 0 to 1"]),
    ("material.gold.clearcoat_roughness = -1", "1:37", &["a number from 0 to 1"]),
    ("material.gold.clear_coat = 1", "1:15", &["did you mean `clearcoat`?"]),
    ("material.gold.sheen = [0.5, 0.5, 2]", "1:23", &["a colour", "each from 0 to 1"]),
    ("material.gold.sheen_roughness = \"soft\"", "1:33", &["a number from 0 to 1"]),
    ("material.gold.dispersion = -0.1", "1:28", &["a number of at least 0"]),
    ("material.gold.textures = true", "1:26", &["false"]),
    (
        "[material.gold]\nmetallic = 1\nmirror = 0.5",
        "3:10",
        &["`metallic` and `mirror`", "different kinds of material"],
    ),
    ("material.a.pattern = { kind = \"cheker\" }", "1:31", &["did you mean \"checker\"?"]),
    ("material.a.pattern = { kind = \"checker\" }", "1:22", &["checker needs the key `color`"]),
    (
        "material.a.pattern = { kind = \"checker\", color = 1, size = 1, joint = 1 }",
        "1:63",
        &["checker has no key `joint`"],
    ),
    ("material.a.pattern = { kind = \"marble\", color = 1, size = 0 }", "1:59", &["above 0"]),
    ("[[light]]\nintensity = 1", "1:1", &["[[light]] needs the key `kind`"]),
    ("[[light]]\nkind = \"pint\"", "2:8", &["did you mean \"point\"?"]),
    ("[[light]]\nkind = 7", "2:8", &["one of \"point\", \"spot\""]),
    (
        "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\ndirection = [0, 0, 1]",
        "4:1",
        &["a point light has no key `direction`"],
    ),
    (
        "[[light]]\nkind = \"spot\"\nposition = [0, 0, 0]\nintensity = 1",
        "1:1",
        &["needs `target` or `direction`"],
    ),
    (
        "[[light]]\nkind = \"spot\"\nposition = [1, 2, 3]\ntarget = [1, 2, 3]",
        "4:10",
        &["a point other than `position`"],
    ),
    (
        "[[light]]\nkind = \"spot\"\nposition = [1, 2, 3]\ndirection = [1, 2, 3]\nouter_angle = 20\ninner_angle = 30",
        "6:15",
        &["a number from 0 to 20"],
    ),
    (
        "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nangular_radius = 91",
        "4:18",
        &["`angular_radius` is `91`", "a number from 0 to 90"],
    ),
    (
        "[[light]]\nkind = \"spot\"\nposition = [0, 0, 0]\nangular_radius = 1",
        "4:1",
        &["a spot light has no key `angular_radius`"],
    ),
    ("[[camera]]\neye = [0, 0, 1]", "1:1", &["[[camera]] needs the key `target`"]),
    ("[[camera]]\neye = [0, 0, 1]\ntarget = [0, 0, 1]", "3:10", &["a point other than `eye`"]),
    ("[[camera]]\neye = [0, 9, 0]\ntarget = [0, 0, 0]", "1:1", &["looks straight up or down"]),
    (
        "[[camera]]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 180",
        "4:7",
        &["degrees from bottom to top"],
    ),
    ("[[camera]]\nname = 3\neye = [0, 0, 1]\ntarget = [0, 0, 0]", "2:8", &["a text in quotes"]),
    ("[[model]]\nscale = 2", "1:1", &["[[model]] needs the key `file`"]),
    ("[[model]]\nfile = \"chair.obj\"", "2:8", &["no such file: `chair.obj`, sought from"]),
    ("[[model]]\nfile = \"hall\"", "2:8", &["did you mean \"builtin:hall\"?"]),
    ("[[model]]\nfile = \"builtin:whited\"", "2:8", &["did you mean 'whitted'?"]),
    ("[[model]]\nfile = \"builtin:sphereflake?depth=99\"", "2:8", &["whole number from 0 to 7"]),
    (
        "[[model]]\nfile = \"builtin:sphereflake\"\nparameters = { depth = 1.5 }",
        "3:24",
        &["`depth` is `1.5`", "a whole number"],
    ),
    ("[[model]]\nfile = \"bad.toml\"\nparameters = { n = 1 }", "3:14", &["for built-in scenes"]),
    ("[[model]]\nfile = \"builtin:whitted\"\nscale = 0", "3:9", &["a number other than 0"]),
    ("[[model]]\nfile = \"builtin:whitted\"\nrotate = [1, 2]", "3:10", &["degrees around"]),
    (
        "[[model]]\nfile = \"builtin:whitted\"\nrotate = { axis = [1, 0, 0] }",
        "3:10",
        &["`rotate` needs the key `degrees`"],
    ),
    ("[[model]]\nfile = \"builtin:whitted\"\nmatrix = [[1, 0, 0, 0]]", "3:10", &["three rows"]),
    (
        "[[model]]\nfile = \"builtin:whitted\"\nmatrix = [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]",
        "1:1",
        &["flattens space"],
    ),
    (
        "[[model]]\nfile = \"builtin:terrain?n=4\"\nto = { translat = [1, 0, 0] }",
        "3:8",
        &["`to` has no key `translat`", "did you mean `translate`?"],
    ),
    ("[[model]]\nfile = \"builtin:terrain?n=4\"\nto = [1, 0, 0]", "3:6", &["`to` is", "a table"]),
    (
        "[[model]]\nfile = \"builtin:terrain?n=4\"\nto = { scale = 0 }",
        "3:16",
        &["a number other than 0"],
    ),
    (
        "[[model]]\nfile = \"builtin:terrain?n=4\"\nrotate = 10\nto = { rotate = 190 }",
        "4:6",
        &["flattens space on the way", "half a circle"],
    ),
    (
        "[[model]]\nfile = \"builtin:terrain?n=4\"\n[[model.instance]]\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\nto = { scale = 2 }",
        "5:16",
        &["the place is a `matrix`", "not `scale`"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\nto = { translate = [1, 0, 0] }",
        "1:1",
        &["spheres, which cannot move"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\nscale = 2\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]",
        "3:9",
        &["`scale` has no place beside it"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\nscale = [1, 2, 1]",
        "1:1",
        &["has spheres", "scaled alike"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\noverride.flor.color = 1",
        "3:",
        &["no material `flor`, did you mean `floor`? (there are: `floor`, `glass`, `mirror`)"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\noverride.floor = \"lava\"",
        "3:18",
        &["`\"lava\"`", "(there are: none)"],
    ),
    (
        "[[model]]\nfile = \"builtin:whitted\"\n[[model.instance]]\nfile = \"x\"",
        "4:1",
        &["[[model.instance]] has no key `file`"],
    ),
    ("[[model]]\nfile = \"bad.toml\"", "2:8", &["bad.toml shows bad.toml"]),
];

#[test]
fn wrong_files_are_refused_with_the_place_and_what_was_expected() {
    for (text, place, pieces) in BAD {
        let error = error_of("bad.toml", text);
        let start = format!("bad.toml:{place}");
        assert!(error.starts_with(&start), "{text}\ngave {error}\nexpected {start}");
        for piece in *pieces {
            assert!(error.contains(piece), "{text}\ngave {error}\nwithout {piece}");
        }
    }
}

#[test]
fn columns_count_characters() {
    let error = error_of("bad.toml", "# \u{e4}\u{f6}\u{fc}\n\"\u{e4}\" = 1");
    assert!(error.starts_with("bad.toml:2:1: "), "{error}");
    let error = error_of("bad.toml", "material.\"\u{e4}\u{f6}\" = 5");
    assert!(error.starts_with("bad.toml:1:17: "), "{error}");
    let error = error_of("bad.toml", b"up = [0, 1, 0]\n\xff\xfe");
    assert!(error.starts_with("bad.toml:2:1: a byte that is no UTF-8"), "{error}");
}

#[test]
fn scene_files_that_show_each_other_are_refused() {
    let folder = Folder::new();
    let show = |file: &str| format!("[[model]]\nfile = \"{file}\"");
    let first = folder.write("a.toml", show("b.toml"));
    folder.write("b.toml", show("./c.toml"));
    folder.write("c.toml", show("a.toml"));
    let error = load_file(&first, &LoadOptions::default()).unwrap_err().to_string();
    check_error(&error);
    assert!(error.contains("c.toml:2:8: "), "{error}");
    assert!(error.ends_with("a.toml shows b.toml shows c.toml shows a.toml"), "{error}");

    // A long chain, each file of which is another.
    for number in 0..40 {
        folder.write(&format!("{number}.toml"), show(&format!("{}.toml", number + 1)));
    }
    folder.write("40.toml", "# nothing");
    let first = folder.path("0.toml");
    let error = load_file(&first, &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("16.toml:2:8: more than 16 scene files"), "{error}");
    assert!(load_file(&folder.path("30.toml"), &LoadOptions::default()).is_ok());
}

#[test]
fn absurd_counts_are_refused() {
    // Each file shows the one before a hundred times: a hundred millions of spheres by a few lines.
    let folder = Folder::new();
    let many = |file: &str| {
        let mut text = format!("[[model]]\nfile = \"{file}\"\n");
        for x in 0..100 {
            text += &format!("[[model.instance]]\ntranslate = [{x}, 0, 0]\n");
        }
        text
    };
    folder.write("0.toml", "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = {}");
    for number in 0..4 {
        folder.write(&format!("{}.toml", number + 1), many(&format!("{number}.toml")));
    }
    let error = load_file(&folder.path("4.toml"), &LoadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("4.toml:1:1: ") && error.contains("spheres, expected at most"),
        "{error}"
    );
}

#[test]
fn faults_in_models_are_told_of_the_model() {
    let folder = Folder::new();
    folder.write("broken.ply", "ply\nnonsense");
    folder.write("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl gone\nf 1 2 3\n");
    let broken = folder.write("a.toml", "[[model]]\nfile = \"broken.ply\"");
    let error = load_file(&broken, &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("broken.ply:2: "), "{error}");

    let odd = folder.write("b.toml", "[[model]]\nfile = \"odd.obj\"");
    let scene = load_file(&odd, &LoadOptions::default()).unwrap();
    assert!(scene.warnings[0].starts_with("odd.obj: "), "{:?}", scene.warnings);
    let strictly = LoadOptions::default().with_strict(true);
    assert!(load_file(&odd, &strictly).is_err());
}

/// Any prefix of a good file is a good file or has a place in it.
#[test]
fn cut_off_files_never_panic() {
    let text = include_str!("../../scenes/still-life.scene.toml");
    let short = text.split("[[model]]").next().unwrap();
    for end in (0..short.len()).filter(|end| short.is_char_boundary(*end)).step_by(7) {
        if let Err(error) = crate::formats_support::load("cut.toml", &short[..end]) {
            check_error(&error.to_string());
        }
    }
}
