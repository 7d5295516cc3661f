//! A scene file with one model gives the picture of the model itself.

use std::path::Path;

use raywood_render::{Integrator, PreparedScene, Progress, RenderOptions, default_view, render};
use raywood_scene::{LoadOptions, Scene, builtin, load_bytes};

/// The picture as bits.
fn picture(scene: &Scene, integrator: &str) -> Vec<[u32; 3]> {
    let prepared = PreparedScene::new(scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    let integrator = Integrator::by_name(integrator).expect("an integrator");
    let options =
        RenderOptions { width: 64, height: 40, samples: 4, integrator, ..RenderOptions::default() };
    let (image, _) = render(&prepared, &view.camera, &view.lights, &options, &Progress::new())
        .expect("a picture");
    let bits = |y| image.row(y).iter().map(|color| color.to_array().map(f32::to_bits));
    (0..40).flat_map(bits).collect()
}

#[test]
fn a_model_looks_the_same_in_a_scene_file() {
    for name in ["whitted", "sphereflake?depth=3", "terrain?n=64", "forest?n=200"] {
        let alone = builtin(name).expect("a scene");
        let text = format!("[[model]]\nfile = \"builtin:{name}\"");
        let shown = load_bytes(Path::new("one.toml"), text.as_bytes(), &LoadOptions::default())
            .expect("a scene");
        for integrator in ["whitted", "path", "albedo"] {
            assert!(
                picture(&alone, integrator) == picture(&shown, integrator),
                "{name} {integrator}"
            );
        }
    }
}
