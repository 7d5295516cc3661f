//! Scenes saved with their trees.

use std::path::Path;

use raywood::{Bvh, Joined, Vec3};
use raywood_scene::{
    Camera, Clearcoat, Encoding, Instances, Light, LightKind, LoadOptions, Magnification, Material,
    MetallicRoughness, Pattern, SavedScene, Scene, Sheen, SurfaceTextures, Texture, TextureImage,
    TextureTransform, Wrap, builtin, builtins, load_bytes, load_file, save_scene,
};
use raywood_testkit::saved::{Forgery, correct_checksums};
use raywood_testkit::{Rng, test_scenes};

/// The bytes of a scene with its tree.
fn saved(scene: &Scene) -> Vec<u8> {
    let surfaces = Joined { first: &scene.mesh.triangles, second: &scene.spheres };
    let mut file = Vec::new();
    let tree = Bvh::build(surfaces).expect("it builds");
    save_scene(scene, &tree, &mut file).expect("it is saved");
    file
}

fn open(file: Vec<u8>) -> Result<SavedScene, String> {
    SavedScene::open(Path::new("some/x.rwood"), file).map_err(|error| error.to_string())
}

/// Asserts that a scene comes back, all of it but name and warnings.
fn comes_back(scene: &Scene) {
    let file = saved(scene);
    let loaded = open(file.clone()).expect("it is sound");
    let expected = Scene { name: "x.rwood".to_owned(), warnings: Vec::new(), ..scene.clone() };
    assert!(format!("{:?}", loaded.scene) == format!("{expected:?}"), "{}", scene.name);
    assert!(saved(&loaded.scene) == file, "{}: not the same when saved again", scene.name);
    let as_a_format = load_bytes(Path::new("x"), &file, &LoadOptions::default());
    let as_a_format = as_a_format.expect("it is recognised");
    assert_eq!((as_a_format.mesh, &*as_a_format.name), (loaded.scene.mesh, "x"));
}

#[test]
fn every_builtin_comes_back() {
    for entry in builtins() {
        // Instances are not saved, and copies of the forest's would be too many.
        let name = if entry.name == "forest" { "forest?n=3" } else { entry.name };
        let mut scene = builtin(name).expect("it is made");
        // Its ground and its plants where they grew are enough.
        scene.instances = Instances::default();
        comes_back(&scene);
    }
}

#[test]
fn everything_that_a_scene_can_have_comes_back() {
    let mut rng = Rng::new(5);
    let mut color = || rng.in_cube();
    let patterns = [
        Pattern::Plain,
        Pattern::Checker { other: color(), size: 0.5 },
        Pattern::Marble { vein: color(), size: f32::NAN },
        Pattern::Tiles { other: color(), size: 2.0, edge: [0.6, -0.8], joint: -0.0 },
        Pattern::Masonry { length: 1.0, height: f32::INFINITY, joint: 1e-40 },
    ];
    let materials = patterns.map(|pattern| Material {
        name: format!("{pattern:?}: \u{e4}\u{1f332}\0"),
        diffuse: color(),
        pattern,
        specular: color(),
        shininess: color().x,
        mirror: color(),
        transmission: color(),
        ior: color().y,
        absorption: color(),
        emission: color(),
        metallic_roughness: None,
        clearcoat: None,
        sheen: None,
        dispersion: 0.0,
        textures: None,
    });
    let direction = color();
    let kinds = [
        LightKind::Point { position: color() },
        LightKind::Spot { position: color(), direction, cos_inner: 0.9, cos_outer: 0.5 },
        LightKind::Directional { direction, angular_radius: 0.25 },
        LightKind::Ambient,
    ];
    let lights = kinds.map(|kind| Light { name: format!("{kind:?}"), kind, intensity: color() });
    let camera =
        Camera { name: String::new(), eye: color(), target: color(), up: Vec3::Z, fov_y: 40.0 };
    let mut scene = builtin("whitted").expect("it is made");
    let vertices = scene.mesh.triangles.positions().len();
    scene.mesh.normals = (0..vertices).map(|_| color()).collect();
    scene.mesh.colors = (0..vertices).map(|_| color()).collect();
    scene.materials = materials.to_vec();
    scene.lights = lights.to_vec();
    scene.cameras = vec![camera.clone(), Camera { name: "other".to_owned(), ..camera }];
    scene.background.nadir = color();
    for up in [None, Some(Vec3::Z)] {
        scene.up = up;
        comes_back(&scene);
    }
}

#[test]
fn textures_come_back() {
    let texture = Texture {
        image: 1,
        set: 1,
        transform: TextureTransform::new([0.25, -3.0], 0.3, [2.0, 0.5]),
        wrap: [Wrap::Mirror, Wrap::Clamp],
        magnification: Magnification::Nearest,
    };
    let all = SurfaceTextures {
        color: Some(texture),
        opacity: Some(0.5),
        opacity_map: Some(Texture::new(0)),
        normal: Some((texture, 0.75)),
        metallic_roughness: Some(texture),
        glossiness: Some(texture),
        specular_color: Some(texture),
        specular: Some(texture),
        transmission: Some(texture),
        occlusion: Some((texture, 0.25)),
        clearcoat: Some(Texture::new(1)),
        clearcoat_roughness: Some(texture),
        sheen_color: Some(texture),
        sheen_roughness: Some(Texture::new(0)),
        emission: Some(Texture::new(0)),
    };
    let made_of = MetallicRoughness {
        base: Vec3::X,
        metallic: 0.25,
        roughness: 0.5,
        reflectance: Vec3::splat(0.04),
        transmission: 0.125,
    };
    let mut scene = builtin("terrain?n=8").expect("it is made");
    let vertices = scene.mesh.triangles.positions().len();
    scene.materials[0].metallic_roughness = Some(made_of);
    scene.materials[0].clearcoat = Some(Clearcoat { strength: 0.75, roughness: 0.25 });
    scene.materials[0].sheen = Some(Sheen { color: Vec3::Y, roughness: 0.375 });
    scene.materials[0].dispersion = 0.5;
    scene.materials[0].textures = Some(Box::new(all));
    scene.mesh.texture_coordinates[1] = (0..vertices).map(|i| [i as f32, -0.5]).collect();
    scene.mesh.tangents = vec![[0.0, 1.0, 0.0, -1.0]; vertices];
    let texels = (0..15).map(|i| [i, 2 * i, 255 - i, 17 * i]).collect();
    let image = TextureImage::new(5, 3, texels, Encoding::Srgb, Some(0.5)).expect("it is small");
    scene.images = vec![TextureImage::uniform([1, 2, 3, 4], Encoding::Linear), image];
    comes_back(&scene);
    let loaded = open(saved(&scene)).expect("it is sound").scene;
    // Texel by texel, which the text of an image does not tell.
    assert!(loaded.images == scene.images);
    assert_eq!(loaded.materials, scene.materials);
    assert_eq!(loaded.mesh, scene.mesh);

    // What is wrong with them is said.
    let honest = Forgery::of(&saved(&scene));
    let refused = |section: &str, change: &dyn Fn(&mut Vec<u8>), expected: &str| {
        let mut forgery = honest.clone();
        change(forgery.section(section));
        let error = open(forgery.file()).expect_err("it is refused");
        assert!(error.contains(expected), "{error}");
    };
    refused("images", &|bytes| bytes[0] = 0, "an image of 0 x 1");
    refused("images", &|bytes| bytes.truncate(bytes.len() - 1), "more bytes are expected");
    refused("images", &|bytes| bytes[8] = 9, "is no Encoding");
    refused("tangents", &|bytes| bytes.truncate(16), "1 values, but there are");
    refused("texture-coords-1", &|bytes| bytes.truncate(8), "1 values, but there are");
}

#[test]
fn a_tree_without_a_scene_gets_the_default_material() {
    let mesh = builtin("terrain?n=8").expect("it is made").mesh.triangles;
    let mut file = Vec::new();
    Bvh::build(&mesh).expect("it builds").save(&mut file).expect("it is saved");
    let SavedScene { scene, .. } = open(file).expect("it is sound");
    assert_eq!((&scene.mesh.triangles, &scene.materials[..]), (&mesh, &[Material::default()][..]));
}

#[test]
fn what_is_wrong_with_a_scene_is_said() {
    let mut scene = builtin("whitted").expect("it is made");
    let vertices = scene.mesh.triangles.positions().len();
    scene.mesh.normals = vec![Vec3::X; vertices];
    let honest = Forgery::of(&saved(&scene));
    let error = |change: &dyn Fn(&mut Forgery)| {
        let mut forgery = honest.clone();
        change(&mut forgery);
        open(forgery.file()).expect_err("it is refused")
    };
    assert_eq!(
        error(&|forgery| forgery.set("scene", 0, 3)),
        "some/x.rwood: section `scene`, byte 0 of it: a scene of version 3, expected version 2; save it again from its model"
    );
    assert!(
        error(&|forgery| forgery.set("scene", 4, 7)).contains("7 before this, expected 0 or 1")
    );
    assert!(error(&|forgery| forgery.section("scene").push(0)).contains("more bytes than"));
    assert!(error(&|forgery| forgery.section("normals").truncate(12)).ends_with(&format!(
        "section `normals`, byte 0 of it: 1 values, but there are {vertices} vertices"
    )));
    assert!(error(&|forgery| forgery.section("normals").truncate(11)).contains("but it ends"));
    let damaged = error(&|forgery| forgery.version = 9);
    assert!(damaged.starts_with("some/x.rwood: is a saved tree of version 9"), "{damaged}");
}

#[test]
fn no_pattern_panics_whatever_its_numbers_are() {
    let odd = [0.0, -0.0, 1e-45, 1e-20, 1.0, -1e30, f32::MAX, f32::INFINITY, f32::NAN];
    let base = Vec3::ONE;
    for a in odd {
        for b in odd {
            let patterns = [
                Pattern::Checker { other: base, size: a },
                Pattern::Marble { vein: base, size: a },
                Pattern::Tiles { other: base, size: a, edge: [b, 1.0], joint: b },
                Pattern::Tiles { other: base, size: b, edge: [1.0, b], joint: a },
                Pattern::Masonry { length: a, height: b, joint: b },
                Pattern::Masonry { length: b, height: a, joint: a },
            ];
            for pattern in patterns {
                let points = odd.map(|x| Vec3::new(x, -x, a));
                for &point in &points {
                    std::hint::black_box(pattern.color(base, point));
                }
                let columns = [0, 1, 2].map(|axis| points.map(|point| point[axis]));
                let mut colors = [[0.0; 9]; 3];
                pattern.colors(base, &columns, &mut colors, 9);
            }
        }
    }
}

#[test]
fn no_scene_that_is_cut_or_changed_does_harm() {
    let honest = Forgery::of(&saved(&builtin("whitted").expect("it is made")));
    let length = honest.clone().section("scene").len();
    for at in 0..length {
        let mut cut = honest.clone();
        cut.section("scene").truncate(at);
        assert!(open(cut.file()).is_err(), "{at} of {length} bytes");
    }
    let mut refused = 0;
    for at in (0..length / 4).map(|word| 4 * word) {
        for number in [0, 5, 0x7fff_ffff, u32::MAX] {
            let mut forgery = honest.clone();
            forgery.set("scene", at, number);
            refused += usize::from(open(forgery.file()).is_err());
        }
    }
    assert!(refused > 20, "{refused}");
}

#[test]
fn what_fuzzing_found_does_no_harm() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/found/saved_scene");
    // A package on its own has no such folder.
    let Ok(entries) = folder.read_dir() else { return };
    let mut loaded = 0;
    for entry in entries {
        let mut file = std::fs::read(entry.expect("an entry").path()).expect("a file");
        correct_checksums(&mut file);
        if let Ok(SavedScene { scene, .. }) = open(file) {
            comes_back(&scene);
            loaded += 1;
        }
    }
    assert!(loaded > 2, "{loaded}");
}

#[test]
fn real_models_come_back() {
    let Some(folder) = test_scenes() else { return };
    for name in ["sponza-dabrovic", "country-kitchen", "bunny"] {
        let Some(path) = find(&folder, name) else { continue };
        comes_back(&load_file(&path, &LoadOptions::default()).expect("a model"));
    }
}

/// A model whose name begins so.
fn find(folder: &Path, name: &str) -> Option<std::path::PathBuf> {
    let mut entries: Vec<_> = folder.read_dir().ok()?.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    entries.into_iter().find_map(|path| {
        if path.is_dir() {
            return find(&path, name);
        }
        let is_model =
            path.extension().is_some_and(|e| ["obj", "glb", "ply", "stl"].iter().any(|m| e == *m));
        let is_it = path.file_stem().is_some_and(|stem| stem.to_string_lossy().starts_with(name));
        (is_model && is_it).then_some(path)
    })
}
