//! Small pictures of the built-in scenes against stored ones. `RAYWOOD_BLESS=1` writes the stored ones anew.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use raywood_render::{PreparedScene, Progress, RenderOptions, default_view, render, write_png};
use raywood_scene::{builtin, builtins};
use raywood_testkit::image::Picture;

/// Machines may differ in the last digits of sines and powers, which moves an edge here and there; a change that one would
/// see differs by more.
const LARGEST_MEAN: f64 = 0.3;
const MOST_OUTLIERS: f64 = 0.005;

fn stored(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references").join(format!("{name}.png"))
}

/// Renders a scene small, to a file.
fn rendered(name: &str, scene: &str) -> PathBuf {
    let scene = builtin(scene).expect("a built-in scene");
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let options = RenderOptions { width: 160, height: 100, samples: 4, ..RenderOptions::default() };
    let view = default_view(&prepared, 1.6);
    let (image, _) = render(&prepared, &view.camera, &view.lights, &options, &Progress::new())
        .expect("it renders");
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    write_png(&image, File::create(&path).expect("a file")).expect("it is written");
    path
}

#[test]
fn the_builtins_look_as_they_did() {
    let bless = std::env::var_os("RAYWOOD_BLESS").is_some();
    for entry in builtins() {
        let now = rendered(entry.name, entry.name);
        let stored = stored(entry.name);
        if bless {
            fs::copy(&now, &stored).expect("the reference is written");
        }
        let (now, before) = (Picture::read(&now).expect("a PNG"), Picture::read(&stored));
        let before = before.unwrap_or_else(|error| panic!("{error}: bless a new scene's picture"));
        let difference = now.difference(&before);
        assert!(
            difference.mean < LARGEST_MEAN && difference.outliers < MOST_OUTLIERS,
            "{}: {difference:?}",
            entry.name
        );
    }
}

#[test]
fn a_change_that_one_would_see_is_seen() {
    let now = Picture::read(&rendered("other-terrain", "terrain?seed=12")).expect("a PNG");
    let difference = now.difference(&Picture::read(&stored("terrain")).expect("a PNG"));
    assert!(
        difference.mean > LARGEST_MEAN && difference.outliers > MOST_OUTLIERS,
        "{difference:?}"
    );
}
