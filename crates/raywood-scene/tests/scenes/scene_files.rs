//! Scene files: every key, what models become in them, and that the examples of the documentation load.

use std::path::Path;

use raywood::Vec3;
use raywood_scene::{
    Axes, Background, Clearcoat, LightKind, LoadOptions, Material, Pattern, Rgb, Scene, Sheen, Sky,
    builtin, load_file, save_scene,
};

use crate::formats_support::{Folder, check_scene, load, png, triangle_count};

/// The scene of a text.
fn scene(text: &str) -> Scene {
    load("some.scene.toml", text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

fn near(a: Vec3, b: impl Into<Vec3>) -> bool {
    let b = b.into();
    (a - b).length() < 1e-5 * (1.0 + b.length())
}

#[test]
fn the_examples_of_the_documentation_load() {
    let page = include_str!("../../../../docs/scene-file.md");
    let examples: Vec<_> = page.split("```toml\n").skip(1).collect();
    assert!(examples.len() >= 6);
    for example in examples {
        let text = example.split("```").next().unwrap();
        let loaded = scene(text);
        assert!(loaded.warnings.is_empty(), "{text}\n{:?}", loaded.warnings);
        assert!(loaded.bounds().is_finite());
    }
}

#[test]
fn the_documentation_names_every_key() {
    let page = include_str!("../../../../docs/scene-file.md");
    let tables = ["", "[material.a]\n", "[[model]]\n", "[[light]]\n", "[[camera]]\n"];
    for text in tables.map(|table| format!("{table}zz = 1")) {
        let error = load("keys.toml", text).unwrap_err().to_string();
        let keys = error.split("(there are: ").nth(1).unwrap().trim_end_matches(')');
        for key in keys.split(", ").map(|key| key.trim_matches('`')) {
            let named = [format!("`{key}`"), format!("[{key}")];
            assert!(named.iter().any(|name| page.contains(name)), "{key}");
        }
    }
}

#[test]
fn the_shipped_scene_loads() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/still-life.scene.toml");
    let loaded = load_file(&path, &LoadOptions::default()).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert!(!loaded.cameras.is_empty());
    assert_eq!(loaded.name, "still-life.scene.toml");
}

/// Corners, normals and materials of all triangles in order.
fn surfaces(scene: &Scene) -> Vec<([Vec3; 3], Vec<Vec3>, String)> {
    let mesh = &scene.mesh;
    let one = |(triangle, corners): (u32, &[u32; 3])| {
        let normals = corners.iter().filter_map(|c| mesh.normals.get(*c as usize).copied());
        let material = &scene.materials[mesh.materials[triangle as usize] as usize];
        (mesh.triangles.corners(triangle), normals.collect(), material.name.clone())
    };
    (0..).zip(mesh.triangles.triangles()).map(one).collect()
}

#[test]
fn a_scene_file_with_one_model_is_that_model() {
    for name in ["whitted", "sphereflake?depth=2", "terrain?n=32", "forest?n=300", "hall"] {
        let alone = builtin(name).unwrap();
        let shown = scene(&format!("[[model]]\nfile = \"builtin:{name}\""));
        assert!(surfaces(&alone) == surfaces(&shown), "{name}");
        assert_eq!(alone.spheres.as_slice(), shown.spheres.as_slice());
        assert_eq!(alone.sphere_materials, shown.sphere_materials);
        assert_eq!(alone.materials, shown.materials);
        assert_eq!(alone.lights, shown.lights);
        assert_eq!(alone.cameras, shown.cameras);
        assert_eq!(alone.background, shown.background);
        assert_eq!(alone.up, shown.up);
        assert_eq!(alone.instances.placed(), shown.instances.placed());
        assert_eq!(
            alone.instances.objects().collect::<Vec<_>>(),
            shown.instances.objects().collect::<Vec<_>>()
        );
    }
}

/// One triangle with two corners on the axes and one above the origin.
const TRIANGLE: &str = "v 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\n";

/// The scene of a text beside a file with the triangle, `t.obj`.
fn with_triangle(text: &str) -> Scene {
    let folder = Folder::new();
    folder.write("t.obj", TRIANGLE);
    let path = folder.write("some.toml", text);
    let loaded = load_file(&path, &LoadOptions::default());
    let loaded = loaded.unwrap_or_else(|error| panic!("{text}\n{error}"));
    check_scene(&loaded);
    loaded
}

#[test]
fn models_are_scaled_then_turned_then_moved() {
    let cases = [
        ("translate = [1, 2, 3]", [2.0, 2.0, 3.0]),
        ("scale = 2", [2.0, 0.0, 0.0]),
        ("scale = [3, 1, -1]", [3.0, 0.0, 0.0]),
        ("rotate = 90", [0.0, 0.0, -1.0]),
        ("rotate = [0, 0, 90]", [0.0, 1.0, 0.0]),
        ("rotate = [90, 90, 0]", [0.0, 0.0, -1.0]),
        ("rotate = { axis = [0, 0, 2], degrees = 180 }", [-1.0, 0.0, 0.0]),
        ("translate = [5, 0, 0]\nscale = 2\nrotate = 90", [5.0, 0.0, -2.0]),
        ("matrix = [[0, 0, 1, 7], [0, 1, 0, 8], [1, 0, 0, 9]]", [7.0, 8.0, 10.0]),
    ];
    for (keys, expected) in cases {
        let shown = with_triangle(&format!("[[model]]\nfile = \"t.obj\"\n{keys}"));
        let corners = shown.mesh.triangles.corners(0);
        assert!(corners.iter().any(|&c| near(c, expected)), "{keys}: {corners:?}");
    }
    // A single angle turns around what is up.
    let shown = with_triangle("up = [0, 0, 1]\n[[model]]\nfile = \"t.obj\"\nrotate = 90");
    assert!(shown.mesh.triangles.corners(0).iter().any(|&c| near(c, [0.0, 1.0, 0.0])));
    assert_eq!(shown.up, Some(Vec3::Z));
}

#[test]
fn instances_stand_where_they_are_told_and_keep_their_material() {
    let shown = with_triangle(
        "[material.red]\ncolor = [1, 0, 0]\n[[model]]\nfile = \"t.obj\"\nscale = 2\ntint = 0.5\n\
         [[model.instance]]\ntranslate = [10, 0, 0]\n\
         [[model.instance]]\nmaterial = \"red\"\nscale = 3\ntint = [1, 0, 0]\n\
         [[model.instance]]\nmaterial = { color = 0.1 }",
    );
    // Few triangles are copied.
    assert!(shown.instances.is_empty());
    assert_eq!(triangle_count(&shown), 3);
    let materials: Vec<_> =
        shown.mesh.materials.iter().map(|&id| shown.materials[id as usize].diffuse).collect();
    assert_eq!(materials[1], Rgb::new(1.0, 0.0, 0.0));
    assert_eq!(materials[2], Rgb::splat(0.1));
    assert!(near(shown.mesh.triangles.corners(0)[0], [12.0, 0.0, 0.0]));
    assert!(near(shown.mesh.triangles.corners(1)[0], [6.0, 0.0, 0.0]));
    assert_eq!(shown.mesh.colors[0], Rgb::splat(0.5));
    assert_eq!(shown.mesh.colors[3], Rgb::new(0.5, 0.0, 0.0));
}

#[test]
fn models_in_many_places_are_shared() {
    let mut text =
        "[material.red]\ncolor = [1, 0, 0]\n[[model]]\nfile = \"builtin:terrain?n=64\"\n"
            .to_owned();
    for number in 0..20 {
        text += &format!("[[model.instance]]\ntranslate = [{}, 0, 0]\n", 100 * number);
    }
    text += "material = \"red\"\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\nmaterial = {}\n";
    let shown = scene(&text);
    let alone = builtin("terrain?n=64").unwrap();
    assert_eq!(shown.instances.objects().len(), 1);
    assert_eq!(shown.instances.placed().len(), 20);
    assert_eq!(triangle_count(&shown), triangle_count(&alone));
    assert_eq!(shown.visible_triangles(), 20 * alone.visible_triangles());
    assert_eq!(shown.instances.placed()[19].material, Some(0));
    assert_eq!(shown.instances.placed()[18].material, None);

    // The same, from a scene file that another one shows turned around.
    let folder = Folder::new();
    folder.write("inner.toml", &text);
    let path = folder.write("outer.toml", "[[model]]\nfile = \"inner.toml\"\nrotate = 180\n[[model]]\nfile = \"inner.toml\"\ntranslate = [0, 9, 0]");
    let outer = load_file(&path, &LoadOptions::default()).unwrap();
    check_scene(&outer);
    assert_eq!(outer.instances.placed().len(), 40);
    assert_eq!(outer.visible_triangles(), 40 * alone.visible_triangles());
    let place = outer.instances.placed()[19].transform.point(Vec3::ZERO);
    assert!((place - Vec3::new(-1900.0, 0.0, 0.0)).length() < 1e-2, "{place:?}");
    let material = outer.instances.placed()[19].material.unwrap();
    assert_eq!(outer.materials[material as usize].name, "red");
}

#[test]
fn models_move_to_other_places() {
    let file = "[[model]]\nfile = \"builtin:terrain?n=8\"\nscale = 2\n";
    let moving = |more: &str| scene(&format!("{file}{more}"));
    let place = |scene: &Scene, number: usize, point: Vec3| {
        let instance = &scene.instances.placed()[number];
        [Some(instance.transform), instance.later].map(|place| place.map(|p| p.point(point)))
    };

    // However few its triangles are; what is not said stays.
    let shown = moving("translate = [1, 2, 3]\nto = { translate = [5, 2, 3] }\n");
    check_scene(&shown);
    assert!(shown.instances.moves());
    assert_eq!(shown.instances.placed().len(), 1);
    let expected = [Vec3::new(3.0, 2.0, 3.0), Vec3::new(7.0, 2.0, 3.0)].map(Some);
    assert_eq!(place(&shown, 0, Vec3::X), expected);
    let bounds = shown.bounds().extent().x - moving("").bounds().extent().x;
    assert!((bounds - 4.0).abs() < 0.1, "{bounds}");

    // Some instances move, others do not; what moves as a whole comes after what moves in it.
    let instances = "[[model.instance]]\ntranslate = [10, 0, 0]\n[[model.instance]]\nto = { translate = [0, 7, 0] }\n";
    let shown = moving(instances);
    assert_eq!(place(&shown, 0, Vec3::X), [Some(Vec3::new(12.0, 0.0, 0.0)), None]);
    assert_eq!(place(&shown, 1, Vec3::X)[1], Some(Vec3::new(2.0, 7.0, 0.0)));
    let shown = moving(&format!("to = {{ translate = [0, 0, 1] }}\n{instances}"));
    assert_eq!(place(&shown, 0, Vec3::X)[1], Some(Vec3::new(12.0, 0.0, 1.0)));
    assert_eq!(place(&shown, 1, Vec3::X)[1], Some(Vec3::new(2.0, 7.0, 1.0)));

    // What moves nowhere stands still, and is copied.
    assert!(moving("to = {}\n").instances.is_empty());
    assert!(
        moving("translate = [1, 2, 3]\nto = { translate = [1, 2, 3], scale = 2 }\n")
            .instances
            .is_empty()
    );

    // In a scene file that another one shows.
    let folder = Folder::new();
    folder.write("inner.toml", format!("{file}to = {{ translate = [4, 0, 0] }}\n"));
    let path = folder.write(
        "outer.toml",
        "[[model]]\nfile = \"inner.toml\"\ntranslate = [0, 1, 0]\nto = { translate = [0, 1, 8] }",
    );
    let outer = load_file(&path, &LoadOptions::default()).unwrap();
    let expected = [Vec3::new(2.0, 1.0, 0.0), Vec3::new(6.0, 1.0, 8.0)].map(Some);
    assert_eq!(place(&outer, 0, Vec3::X), expected);
}

#[test]
fn materials_are_as_they_are_described() {
    let shown = scene(
        "[material.gold]\ncolor = \"#ff8000\"\nmetallic = 1\nroughness = 0.25\n\
         [material.glass]\ntransmission = 1\nior = 1.6\nabsorption = [1, 2, 3]\n\
         [material.old]\ncolor = 0.5\nmirror = [0.1, 0.2, 0.3]\nspecular = 0.4\nshininess = 90\n\
         pattern = { kind = \"tiles\", color = 0.2, size = 2, joint = 0.1, angle = 90 }\n\
         [material.wall]\npattern = { kind = \"masonry\", length = 2, height = 1 }\n\
         [material.lamp]\nemission = [9, 8, 7]\n\
         [material.clay]\ncolor = 0.3\nreflectance = 0.1\n\
         [material.veil]\ntransmission = [1, 0.5, 0]\nior = 1\n",
    );
    let named = |name: &str| shown.materials.iter().find(|m| m.name == name).unwrap();
    let names: Vec<_> = shown.materials.iter().map(|m| &m.name[..]).collect();
    assert_eq!(names, ["gold", "glass", "old", "wall", "lamp", "clay", "veil"]);

    let gold = named("gold").metallic_roughness.unwrap();
    assert!(near(gold.base, [1.0, 0.215_860_5, 0.0]), "{gold:?}");
    assert_eq!((gold.metallic, gold.roughness, gold.transmission), (1.0, 0.25, 0.0));
    assert_eq!(named("gold").mirror, gold.light_shares().mirror);
    let glass = named("glass");
    assert_eq!((glass.transmission, glass.ior), (Rgb::ONE, 1.6));
    assert_eq!((glass.absorption, glass.diffuse), (Vec3::new(1.0, 2.0, 3.0), Rgb::ZERO));
    let f0 = (0.6f32 / 2.6).powi(2);
    assert!(near(glass.metallic_roughness.unwrap().reflectance, Rgb::splat(f0)));
    let old = named("old");
    assert_eq!(old.mirror, Rgb::new(0.1, 0.2, 0.3));
    assert_eq!((old.specular, old.shininess), (Rgb::splat(0.4), 90.0));
    assert!(
        matches!(old.pattern, Pattern::Tiles { size: 2.0, joint: 0.1, edge: [x, 1.0], .. } if x.abs() < 1e-6)
    );
    let masonry = Pattern::Masonry { length: 2.0, height: 1.0, joint: 0.0 };
    assert_eq!(named("wall").pattern, masonry);
    assert_eq!(named("lamp").emission, Rgb::new(9.0, 8.0, 7.0));
    assert_eq!(named("lamp").diffuse, Rgb::splat(0.7));
    assert_eq!(named("clay").metallic_roughness.unwrap().reflectance, Rgb::splat(0.1));
    assert_eq!(named("veil").transmission, Rgb::new(1.0, 0.5, 0.0));
    assert_eq!(named("veil").ior, 1.0);
}

/// The scene again, from a file in which it is saved.
fn saved(scene: &Scene) -> Scene {
    let tree = raywood::Bvh::build(scene.mesh.triangles.clone()).unwrap();
    let mut bytes = Vec::new();
    save_scene(scene, &tree, &mut bytes).unwrap();
    load("saved.rwood", bytes).unwrap()
}

#[test]
fn coats_sheen_and_dispersion_lie_over_materials_and_are_saved() {
    let shown = with_triangle(
        "[material.car]\ncolor = [0.5, 0, 0]\nclearcoat = 0.75\nclearcoat_roughness = 0.25\n\
         [material.velvet]\nsheen = [0.5, 0.25, 1]\nsheen_roughness = 0.125\n\
         [material.gem]\ntransmission = 1\nior = 2.4\ndispersion = 0.36\n\
         [material.glossy]\npattern = { kind = \"marble\", color = 0.5, size = 1 }\nclearcoat = 1\nsheen = 1\n\
         [material.bare]\nclearcoat = 0\nsheen = 0\nclearcoat_roughness = 1\nsheen_roughness = 1\n\
         [[model]]\nfile = \"t.obj\"\n",
    );
    let named = |name: &str| shown.materials.iter().find(|m| m.name == name).unwrap();
    let coat = |strength, roughness| Some(Clearcoat { strength, roughness });
    let sheen = |color, roughness| Some(Sheen { color, roughness });
    let layers = |name| (named(name).clearcoat, named(name).sheen, named(name).dispersion);
    assert_eq!(layers("car"), (coat(0.75, 0.25), None, 0.0));
    assert_eq!(layers("velvet"), (None, sheen(Rgb::new(0.5, 0.25, 1.0), 0.125), 0.0));
    assert_eq!(layers("gem"), (None, None, 0.36));
    // They go with both kinds of material; a coat is smooth and sheen that of velvet where nothing is said.
    assert!(matches!(named("glossy").pattern, Pattern::Marble { .. }));
    assert_eq!(layers("glossy"), (coat(1.0, 0.0), sheen(Rgb::ONE, 0.5), 0.0));
    assert_eq!(layers("bare"), (None, None, 0.0));
    assert_eq!(saved(&shown).materials, shown.materials);
}

#[test]
fn overrides_change_layers_and_take_them_away() {
    let folder = Folder::new();
    let car = "[[model]]\nfile = \"builtin:whitted\"\n[model.override.floor]\nclearcoat = 0.5\nsheen = 0.25\n";
    folder.write("car.toml", car);
    let floor = |changes: &str| -> Material {
        let text = format!("[[model]]\nfile = \"car.toml\"\n[model.override.floor]\n{changes}");
        let path = folder.write("outer.toml", text);
        let shown = load_file(&path, &LoadOptions::default()).unwrap();
        shown.materials.into_iter().find(|material| material.name == "floor").unwrap()
    };
    let same = floor("");
    assert_eq!(same.clearcoat, Some(Clearcoat { strength: 0.5, roughness: 0.0 }));
    assert_eq!(same.sheen, Some(Sheen { color: Rgb::splat(0.25), roughness: 0.5 }));
    let rough = floor("clearcoat_roughness = 0.75\nsheen_roughness = 0.125");
    assert_eq!(rough.clearcoat, Some(Clearcoat { strength: 0.5, roughness: 0.75 }));
    assert_eq!(rough.sheen, Some(Sheen { color: Rgb::splat(0.25), roughness: 0.125 }));
    let bare = floor("clearcoat = 0\nsheen = 0");
    let original = builtin("whitted").unwrap().materials.swap_remove(0);
    assert_eq!(bare, original);
}

#[test]
fn overrides_change_what_they_name_and_nothing_else() {
    let shown = scene(
        "[material.gold]\nmetallic = 1\n[[model]]\nfile = \"builtin:whitted\"\noverride.mirror = \"gold\"\n\
         [model.override.glass]\nior = 1.2\n[model.override.floor]\ncolor = 0.5\n",
    );
    let original = builtin("whitted").unwrap();
    let own = &shown.materials[1..];
    assert_eq!(own[0].pattern, original.materials[0].pattern);
    assert_eq!(own[0].diffuse, Rgb::splat(0.5));
    assert_eq!(own[1].ior, 1.2);
    assert_eq!(own[1].transmission, original.materials[1].transmission);
    assert_eq!(own[2], shown.materials[0]);
    assert_eq!(shown.sphere_materials, [2, 3]);
}

#[test]
fn overridden_materials_keep_their_textures() {
    let folder = Folder::new();
    folder.write("red.png", png(1, &[[255, 0, 0, 255]]));
    folder.write("t.mtl", "newmtl wood\nKd 0.8 0.8 0.8\nmap_Kd red.png\n");
    folder.write(
        "t.obj",
        "mtllib t.mtl\nusemtl wood\nv 1 0 0\nv 0 0 1\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n",
    );
    let load = |text: &str| {
        let path = folder.write("some.toml", text);
        let loaded = load_file(&path, &LoadOptions::default()).unwrap();
        check_scene(&loaded);
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        loaded
    };
    // Twice, behind another model's: images are there once.
    let shown = load(
        "[[model]]\nfile = \"builtin:whitted\"\n[[model]]\nfile = \"t.obj\"\n[model.override.wood]\ncolor = 0.5\n\
         roughness = 0.3\n[[model]]\nfile = \"t.obj\"\n[model.override.wood]\ntextures = false\n",
    );
    assert_eq!(shown.images.len(), 1);
    let woods: Vec<_> = shown.materials.iter().filter(|m| m.name == "wood").collect();
    assert_eq!(woods.len(), 2);
    assert!(woods[0].textures.as_ref().unwrap().color.is_some());
    assert_eq!(woods[0].metallic_roughness.unwrap().base, Rgb::splat(0.5));
    assert_eq!(woods[0].metallic_roughness.unwrap().roughness, 0.3);
    assert_eq!(woods[1].textures, None);
    // Vertices of the model without texture coordinates have some that do no harm.
    let uvs = &shown.mesh.texture_coordinates[0];
    assert_eq!(uvs.len(), shown.mesh.triangles.positions().len());
}

#[test]
fn lights_and_cameras_are_read_and_move_with_their_model() {
    let shown = scene(
        "background = { zenith = 1, horizon = [0, 1, 0], nadir = \"#000000\" }\n\
         [[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -2, 0]\nintensity = 2\n\
         [[light]]\nkind = \"spot\"\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\ninner_angle = 30\nouter_angle = 60\nintensity = [1, 2, 3]\n\
         [[light]]\nkind = \"ambient\"\nintensity = 0\n\
         [[light]]\nkind = \"point\"\nposition = [1, 2, 3]\nintensity = 50\n\
         [[camera]]\nname = \"one\"\neye = [0, 1, 5]\ntarget = [0, 1, 0]\n\
         [[camera]]\nname = \"two\"\neye = [0, 5, 0]\ntarget = [0, 1, 0]\nup = [0, 0, -2]\nfov = 20\n\
         [[model]]\nfile = \"builtin:whitted\"\n",
    );
    assert_eq!(
        shown.background,
        Background { zenith: Rgb::ONE, horizon: Rgb::Y, nadir: Rgb::ZERO }
    );
    // Those of the model are left out, its camera is the last.
    assert_eq!(shown.lights.len(), 4);
    assert_eq!(shown.lights[0].name, "sun");
    assert_eq!(shown.lights[0].kind, LightKind::directional(-Vec3::Y));
    let LightKind::Spot { direction, cos_inner, cos_outer, .. } = shown.lights[1].kind else {
        panic!("no spot light")
    };
    assert_eq!(direction, -Vec3::Y);
    assert!((cos_inner - 0.75f32.sqrt()).abs() < 1e-6 && (cos_outer - 0.5).abs() < 1e-6);
    let names: Vec<_> = shown.cameras.iter().map(|c| (&c.name[..], c.fov_y)).collect();
    assert_eq!(names, [("one", 35.0), ("two", 20.0), ("camera", 38.0)]);
    assert_eq!(shown.cameras[1].up, -Vec3::Z);

    let lit = "[[light]]\nkind = \"ambient\"\nintensity = 0\n[[model]]\nfile = \"builtin:whitted\"\nlights = true\nscale = 2\ntranslate = [0, 1, 0]";
    let shown = scene(lit);
    assert_eq!(shown.lights.len(), 3);
    let lamp = &shown.lights[2];
    assert_eq!(lamp.kind, LightKind::Point { position: Vec3::new(-9.0, 19.0, 11.0) });
    assert!(near(lamp.intensity, 4.0 * Rgb::new(112.0, 108.0, 100.0)));
    assert!(near(shown.cameras[0].eye, [-0.2, 5.7, 10.4]));
    assert!(scene(&lit.replace("true", "false")).lights.len() == 1);
    let spheres = shown.spheres.as_slice();
    assert!(near(spheres[0].0, [1.04, 4.32, 0.0]) && (spheres[0].1 - 1.84).abs() < 1e-5);
}

#[test]
fn suns_take_up_an_angle_wherever_they_are_shown() {
    let sun = "[[light]]\nkind = \"directional\"\ndirection = [0, -1, 0]\nintensity = 1\nangular_radius = 30\n";
    let shown = with_triangle(&format!("{sun}[[model]]\nfile = \"t.obj\"\n"));
    let angular_radius = 30f32.to_radians();
    let expected = LightKind::Directional { direction: -Vec3::Y, angular_radius };
    assert_eq!(shown.lights[0].kind, expected);
    assert_eq!(saved(&shown).lights, shown.lights);

    let folder = Folder::new();
    folder.write("sun.toml", sun);
    let text = "[[model]]\nfile = \"sun.toml\"\nrotate = [90, 0, 0]\nscale = 2";
    let outer = load_file(&folder.write("outer.toml", text), &LoadOptions::default()).unwrap();
    let LightKind::Directional { direction, angular_radius: turned } = outer.lights[0].kind else {
        panic!("no directional light")
    };
    assert!(near(direction, -Vec3::Z), "{direction:?}");
    assert_eq!((turned, outer.lights[0].intensity), (angular_radius, Rgb::ONE));
}

#[test]
fn panoramas_surround_scenes_and_are_saved_with_them() {
    let folder = Folder::new();
    let mut hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    hdr.extend([128, 0, 0, 129, 0, 128, 0, 129]);
    folder.write("sky.hdr", hdr);
    folder.write("t.obj", TRIANGLE);
    folder.write("inner.toml", "environment = \"sky.hdr\"\n[[model]]\nfile = \"t.obj\"");
    let load =
        |text: &str| load_file(&folder.write("outer.toml", text), &LoadOptions::default()).unwrap();
    let outer = load("[[model]]\nfile = \"inner.toml\"");
    let panorama = outer.environment.as_ref().unwrap();
    assert_eq!((panorama.width(), panorama.height()), (2, 1));
    assert_eq!(load("background = 1\n[[model]]\nfile = \"inner.toml\"").environment, None);

    assert_eq!(saved(&outer).environment, outer.environment);
}

#[test]
fn skies_surround_scenes_and_light_them() {
    let sky = Sky { elevation: 20.0, azimuth: 60.0, ..Sky::default() };
    let panorama = sky.panorama().unwrap();
    let text = "up = [0, 0, 1]\nenvironment = \"sky:elevation=20,azimuth=60\"\n\
                [[model]]\nfile = \"builtin:whitted\"\n";
    let shown = scene(text);
    // The sun stands where it does in the panorama, and the model's own lights are left out.
    assert!(shown.environment.as_ref() == Some(&panorama));
    assert_eq!(shown.lights, sky.lights(&panorama, &Axes::new(Vec3::Z)));
    let again = saved(&shown);
    assert!(again.environment == shown.environment);
    assert_eq!(again.lights, shown.lights);

    // They join what lights the file has, and those of models where these are asked for.
    let lamp = "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\nintensity = 5\n";
    let names = |text: &str| -> Vec<String> {
        scene(text).lights.into_iter().map(|light| light.name).collect()
    };
    assert_eq!(names(&format!("{text}{lamp}")), ["", "sun", "sky"]);
    let own = builtin("whitted").unwrap().lights.len();
    assert_eq!(names(&format!("{text}lights = true\n")).len(), own + 2);

    // A scene file that another shows brings its sky and its sun.
    let folder = Folder::new();
    folder.write("inner.toml", text);
    let outer = folder.write("outer.toml", "[[model]]\nfile = \"inner.toml\"");
    let outer = load_file(&outer, &LoadOptions::default()).unwrap();
    assert!(outer.environment.as_ref() == Some(&panorama));
    assert_eq!(outer.lights, shown.lights);
}
