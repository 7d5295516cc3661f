//! Real and odd model files through the whole program, where the folder of test models is given.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use raywood_testkit::{image::Picture, test_scenes};

/// All model files below a folder, in order.
fn models_below(folder: &Path) -> Vec<PathBuf> {
    let mut models = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            models.extend(models_below(&path));
        } else if is_model(&path) {
            models.push(path);
        }
    }
    models.sort();
    models
}

fn is_model(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    ["obj", "ply", "stl", "gltf", "glb"].iter().any(|known| extension == *known)
}

fn render(model: &Path, picture: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_raywood"))
        .arg("render")
        .arg(model)
        .arg("-o")
        .arg(picture)
        .args(["--size", "96x60", "-n", "1"])
        .stdin(Stdio::null())
        .output()
        .expect("the command starts")
}

#[test]
fn every_good_model_renders_to_a_picture() {
    let Some(scenes) = test_scenes() else { return };
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("model.png");
    let mut good = models_below(&scenes);
    good.retain(|model| !model.starts_with(scenes.join("odd")));
    assert!(good.len() > 20, "only {} models", good.len());
    for model in good {
        let output = render(&model, &picture);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{}: {said}", model.display());
        let colors = Picture::read(&picture).expect("a PNG").colors();
        assert!(colors > 50, "{}: only {colors} colours", model.display());
    }
}

#[test]
fn every_odd_model_renders_or_is_refused_in_one_clear_line() {
    let Some(scenes) = test_scenes() else { return };
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("odd.png");
    let odd = models_below(&scenes.join("odd"));
    assert!(odd.len() > 50, "only {} models", odd.len());
    for model in odd {
        let output = render(&model, &picture);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let name = model.file_name().unwrap_or_default().to_string_lossy();
        match output.status.code() {
            Some(0) => {
                let warnings_only = said.lines().all(|l| l.starts_with("raywood: warning: "));
                assert!(warnings_only, "{}: {said}", model.display());
            }
            Some(2) => {
                let clear = said.starts_with("raywood: error: ") && said.contains(&*name);
                assert!(clear && said.lines().count() == 1, "{}: {said}", model.display());
            }
            other => panic!("{}: exit code {other:?}: {said}", model.display()),
        }
    }
}
