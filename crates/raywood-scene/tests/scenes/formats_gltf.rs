//! glTF: known contents, known counts, and what is said about faults.

use crate::formats_support::{
    Folder, area, check_scene, cube_buffer, cube_json, error_of, glb, load, load_strictly,
    triangle_count, volume,
};
use raywood::Vec3;
use raywood_scene::{Clearcoat, LightKind, LoadOptions, Place, Sheen, load_file};

/// The cube with these members.
fn cube(more: &str) -> Vec<u8> {
    glb(&cube_json(more), &cube_buffer())
}

#[test]
fn nodes_place_and_mirror() {
    // Without a scene all trees are shown; a child is scaled after it is turned and before it is moved.
    let scene = load("a.glb", cube(r#""nodes":[{"mesh":0}],"#)).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 12);
    assert!((volume(&scene) - 8.0).abs() < 1e-5);
    assert_eq!(scene.warnings, [""; 0]);

    let more = r#""scene":0,"scenes":[{"nodes":[1]}],"nodes":[
        {"mesh":0,"scale":[-1,2,3]},
        {"children":[0,2],"translation":[10,0,0],"rotation":[0,0,0.70710678,0.70710678]},
        {"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,50,1]},
        {"mesh":0,"translation":[999,0,0]}],"#;
    let scene = load("a.glb", cube(more)).unwrap();
    check_scene(&scene);
    assert_eq!(triangle_count(&scene), 24);
    // Mirrored copies still show their outsides.
    assert!((volume(&scene) - 8.0 * (6.0 + 1.0)).abs() < 1e-2, "{}", volume(&scene));
    let bounds = scene.bounds();
    assert!((bounds.min - Vec3::new(8.0, -1.0, -3.0)).length() < 1e-5, "{bounds:?}");
    assert!((bounds.max - Vec3::new(12.0, 1.0, 51.0)).length() < 1e-4, "{bounds:?}");
}

#[test]
fn buffers_beside_and_inside() {
    let folder = Folder::new();
    let nodes = r#""nodes":[{"mesh":0}],"#;
    folder.write("my cube%.bin", cube_buffer());
    let beside = cube_json(nodes)
        .replace("{\"byteLength\":132}", "{\"byteLength\":132,\"uri\":\"my%20cube%25.bin\"}");
    let path = folder.write("beside.gltf", &beside);
    assert_eq!(triangle_count(&load_file(&path, &LoadOptions::default()).unwrap()), 12);

    let missing = folder.write("missing.gltf", beside.replace("my%20", "your%20"));
    let error = load_file(&missing, &LoadOptions::default()).unwrap_err().to_string();
    assert!(
        error.ends_with("buffers[0]: names the file `your%20cube%25.bin`, which is not there"),
        "{error}"
    );
    folder.write("my cube%.bin", &cube_buffer()[..100]);
    let error = load_file(&path, &LoadOptions::default()).unwrap_err().to_string();
    assert!(error.ends_with("buffers[0]: 100 bytes found, but byteLength promises 132"), "{error}");
    let web =
        folder.write("web.gltf", beside.replace("my%20cube%25.bin", "https://example.org/a.bin"));
    let error = load_file(&web, &LoadOptions::default()).unwrap_err().to_string();
    assert!(
        error.contains("buffers[0]: found uri `https://example.org/a.bin`, expected"),
        "{error}"
    );

    // The same inside, in base64 of our own.
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let encode = |chunk: &[u8]| {
        let bits = u32::from(chunk[0]) << 16 | u32::from(chunk[1]) << 8 | u32::from(chunk[2]);
        [18, 12, 6, 0].map(|shift| char::from(digits[(bits >> shift & 63) as usize]))
    };
    let data: String = cube_buffer().chunks(3).flat_map(encode).collect();
    let uri =
        format!("{{\"byteLength\":132,\"uri\":\"data:application/octet-stream;base64,{data}\"}}");
    let inside = cube_json(nodes).replace("{\"byteLength\":132}", &uri);
    assert!((volume(&load("inside.gltf", &inside).unwrap()) - 8.0).abs() < 1e-5);
    let error = error_of("bad.gltf", inside.replace("base64,AA", "base64,A*"));
    assert!(
        error.starts_with("bad.gltf: buffers[0]: found a data URI that is not base64"),
        "{error}"
    );
}

#[test]
fn primitives_of_every_mode() {
    // Five positions, used as strip, fan, list without indices, and points.
    let positions = [[0, 0], [1, 0], [0, 1], [1, 1], [0, 2u8]];
    let buffer: Vec<u8> = positions.iter().flat_map(|&[x, y]| [x, y, 0, 0]).collect();
    let with = |primitives: &str| {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"],
            "nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitives}]}}],
            "buffers":[{{"byteLength":20}}],"bufferViews":[{{"buffer":0,"byteLength":20,"byteStride":4}}],
            "accessors":[{{"bufferView":0,"componentType":5121,"count":5,"type":"VEC3"}},
            {{"bufferView":0,"componentType":5121,"count":3,"type":"VEC3","normalized":true}}]}}"#
        );
        load("modes.glb", glb(&json, &buffer))
    };
    let strip = with(r#"{"mode":5,"attributes":{"POSITION":0}}"#).unwrap();
    assert_eq!(strip.mesh.triangles.triangles(), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    let fan = with(r#"{"mode":6,"attributes":{"POSITION":0}}"#).unwrap();
    assert_eq!(fan.mesh.triangles.triangles(), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let list =
        with(r#"{"attributes":{"POSITION":0}},{"mode":0,"attributes":{"POSITION":0}}"#).unwrap();
    assert_eq!(list.mesh.triangles.triangles(), [[0, 1, 2]]);
    let said = list.warnings.join("\n");
    assert!(said.contains("1 primitive has points or lines"), "{said}");
    assert!(said.contains("1 primitive ends within a triangle"), "{said}");
    let normalized = with(r#"{"attributes":{"POSITION":1}}"#).unwrap();
    assert!((area(&normalized) * 255.0 * 255.0 - 0.5).abs() < 1e-4);
}

#[test]
fn sparse_accessors_normals_and_colors() {
    // Three positions of zero, two of them replaced; normals and colours as bytes.
    let mut buffer = vec![1, 2, 0, 0];
    buffer.extend([2.0, 0.0, 0.0, 0.0, 4.0, 0.0f32].map(f32::to_le_bytes).concat());
    buffer.extend([0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0]);
    buffer.extend([255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 51, 255]);
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[1,1,-1]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"COLOR_0":2,"_OWN":1}}]}],
        "buffers":[{"byteLength":52}],
        "bufferViews":[{"buffer":0,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":24},
        {"buffer":0,"byteOffset":28,"byteLength":12,"byteStride":4},{"buffer":0,"byteOffset":40,"byteLength":12}],
        "accessors":[{"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,4,0],
        "sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}},
        {"bufferView":2,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},
        {"bufferView":3,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"}]}"#;
    let scene = load("sparse.glb", glb(json, &buffer)).unwrap();
    check_scene(&scene);
    assert_eq!(area(&scene), 4.0);
    assert_eq!(scene.mesh.normals, [Vec3::new(0.0, 0.0, -1.0); 3]);
    assert_eq!(scene.mesh.colors, [Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, 0.2)]);
    // Mirrored: the triangle's own normal agrees with those of its vertices.
    let [a, b, c] = scene.mesh.triangles.corners(0);
    assert!((b - a).cross(c - a).z < 0.0);

    let broken = String::from_utf8_lossy(json.as_bytes()).replace("\"count\":2,", "\"count\":4,");
    let error = error_of("sparse.glb", glb(&broken, &buffer));
    assert!(error.starts_with("sparse.glb: accessors[0].sparse: its 4 elements"), "{error}");
    buffer[1] = 3;
    let error = error_of("sparse.glb", glb(json, &buffer));
    assert!(error.starts_with("sparse.glb: accessors[0].sparse: names element 3"), "{error}");
}

#[test]
fn materials() {
    let more = r#""nodes":[{"mesh":0}],"textures":[{},{}],"materials":[
        {"name":"matt","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0.125,1],"metallicFactor":0}},
        {"name":"chrome","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.9,1,1],"roughnessFactor":0}},
        {"name":"rough metal","pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.2,1]}},
        {"name":"glass","pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{
            "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
            "KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[0.5,1,1]}}},
        {"name":"lamp","emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}}},
        {"name":"veil","alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25],"metallicFactor":0}},
        {"name":"hole","alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}},
        {"name":"sign","extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}},
        {"name":"paint","extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":0.75,"clearcoatRoughnessFactor":0.25}}},
        {"name":"velvet","extensions":{"KHR_materials_sheen":{"sheenColorFactor":[1,0.5,7],"sheenRoughnessFactor":0.5}}},
        {"name":"diamond","pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_dispersion":{"dispersion":0.36}}},
        {"name":"nothing","extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":"x"},"KHR_materials_sheen":{"sheenColorFactor":3},"KHR_materials_dispersion":7}},
        {"name":"picture","pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":1},"emissiveFactor":[1,1,1],"emissiveTexture":{"index":1}}],"#;
    let scene = load("m.glb", cube(more)).unwrap();
    check_scene(&scene);
    let by_name = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap();

    let matt = by_name("matt");
    assert_eq!(matt.diffuse, Vec3::new(0.5, 0.25, 0.125));
    assert_eq!((matt.mirror, matt.transmission), (Vec3::ZERO, Vec3::ZERO));
    let chrome = by_name("chrome");
    assert_eq!((chrome.mirror, chrome.diffuse), (Vec3::new(0.8, 0.9, 1.0), Vec3::ZERO));
    let rough = by_name("rough metal");
    assert!(
        rough.mirror == Vec3::ZERO && rough.diffuse.x > 0.3 && rough.specular.x > rough.specular.z
    );
    let glass = by_name("glass");
    assert_eq!((glass.ior, glass.transmission, glass.diffuse), (1.33, Vec3::ONE, Vec3::ZERO));
    assert!((glass.absorption.x - 0.5f32.ln() / -2.0).abs() < 1e-6 && glass.absorption.y == 0.0);
    assert_eq!(by_name("lamp").emission, Vec3::new(4.0, 2.0, 0.0));
    let veil = by_name("veil");
    assert_eq!((veil.ior, veil.transmission), (1.0, Vec3::splat(0.75)));
    assert_eq!(by_name("hole").transmission, Vec3::ONE);
    assert_eq!((by_name("sign").emission, by_name("sign").diffuse), (Vec3::X, Vec3::ZERO));
    let coat = Clearcoat { strength: 0.75, roughness: 0.25 };
    assert_eq!((by_name("paint").clearcoat, by_name("paint").sheen), (Some(coat), None));
    let sheen = Sheen { color: Vec3::new(1.0, 0.5, 1.0), roughness: 0.5 };
    assert_eq!((by_name("velvet").sheen, by_name("velvet").clearcoat), (Some(sheen), None));
    assert_eq!((by_name("diamond").dispersion, glass.dispersion), (0.36, 0.0));
    let nothing = by_name("nothing");
    assert_eq!((nothing.clearcoat, nothing.sheen, nothing.dispersion), (None, None, 0.0));
    assert_eq!(by_name("picture").emission, Vec3::ZERO);
    assert_eq!(scene.warnings, ["3 textures have no image, left out"]);
}

#[test]
fn cameras_and_lights() {
    let more = r#""nodes":[{"mesh":0},
        {"camera":0,"translation":[0,0,10]},{"camera":1},
        {"extensions":{"KHR_lights_punctual":{"light":0}},"rotation":[-0.70710678,0,0,0.70710678]},
        {"extensions":{"KHR_lights_punctual":{"light":1}},"translation":[0,5,0]},
        {"extensions":{"KHR_lights_punctual":{"light":2}},"translation":[0,0,5]}],
        "cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}},
        {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":0.1}}],
        "extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"directional","intensity":3.1415927,"color":[1,0.5,0.25]},
        {"type":"point","intensity":6.2831853},
        {"type":"spot","spot":{"innerConeAngle":0.2,"outerConeAngle":0.4}}]}},"#;
    let scene = load("lit.glb", cube(more)).unwrap();
    check_scene(&scene);
    let [camera] = &scene.cameras[..] else { panic!("{:?}", scene.cameras) };
    assert_eq!(
        (camera.eye, camera.target, camera.up),
        (Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO, Vec3::Y)
    );
    assert!((camera.fov_y - 0.5f32.to_degrees()).abs() < 1e-4);

    let [sun, lamp, spot] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    let LightKind::Directional { direction, angular_radius: 0.0 } = sun.kind else {
        panic!("{sun:?}")
    };
    assert!((direction - Vec3::new(0.0, -1.0, 0.0)).length() < 1e-6, "{direction:?}");
    assert!((sun.intensity - Vec3::new(1.0, 0.5, 0.25)).length() < 1e-6);
    assert_eq!(lamp.kind, LightKind::Point { position: Vec3::new(0.0, 5.0, 0.0) });
    assert!((lamp.intensity - Vec3::splat(2.0)).length() < 1e-6);
    let LightKind::Spot { cos_inner, cos_outer, .. } = spot.kind else { panic!("{spot:?}") };
    assert!((cos_inner - 0.2f32.cos()).abs() < 1e-6 && (cos_outer - 0.4f32.cos()).abs() < 1e-6);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);

    // Sunlight in lux would leave nothing but white.
    let bright = more.replace("3.1415927", "100000");
    let scene = load("lit.glb", cube(&bright)).unwrap();
    assert!(scene.lights[0].intensity.x < 2.0);
    assert!(
        scene.warnings.iter().any(|w| w.contains("the lights are scaled")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn faults_name_their_place() {
    let nodes = r#""nodes":[{"mesh":0}],"#;
    let sound = cube_json(nodes);
    let cases = [
        (
            "\"byteOffset\":96,\"byteLength\":36",
            "\"byteOffset\":97,\"byteLength\":36",
            "bufferViews[1]: covers 36 bytes from byte 97 of buffer 0, which has 132",
        ),
        (
            "\"byteOffset\":96",
            "\"byteOffset\":18446744073709551615",
            "bufferViews[1]: covers 36 bytes",
        ),
        (
            "\"count\":8",
            "\"count\":9",
            "accessors[0]: its 9 elements of 12 bytes reach past the end of bufferViews[0]",
        ),
        (
            "\"count\":8",
            "\"count\":4611686018427387904",
            "accessors[0]: its 4611686018427387904 elements",
        ),
        (
            "\"count\":8",
            "\"count\":7",
            "accessors[1]: index 11 is 7, but meshes[0].primitives[0] has 7 vertices",
        ),
        (
            "\"POSITION\":0",
            "\"POSITION\":5",
            "meshes[0].primitives[0].attributes.POSITION: found accessor 5, but there are 2",
        ),
        (
            "\"indices\":1",
            "\"indices\":5",
            "meshes[0].primitives[0].indices: names an element that is not there",
        ),
        ("\"indices\":1", "\"indices\":0", "accessors[0]: is of a type that indices cannot have"),
        (
            "\"type\":\"VEC3\"",
            "\"type\":\"VEC2\"",
            "accessors[0]: has 2 numbers an element, expected 3",
        ),
        ("5126", "5130", "accessors[0].componentType: has a value that glTF does not know"),
        ("\"mesh\":0", "\"mesh\":1", "nodes[0].mesh: names an element that is not there"),
        ("\"mesh\":0", "\"mesh\":0,\"children\":[0]", "f.glb: there"),
        (
            "\"byteLength\":132",
            "\"byteLength\":133333333333",
            "buffers[0]: 132 bytes found, but byteLength promises 133333333333",
        ),
        ("\"2.0\"", "\"1.0\"", "asset.version: found glTF"),
        (
            "\"nodes\"",
            "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\"",
            "extensionsRequired[0]: requires the extension KHR_draco_mesh_compression",
        ),
        ("\"asset\"", "\"asset\" oops", "JSON line 1 column 10: expected `:`"),
    ];
    for (from, to, expected) in cases {
        assert!(sound.contains(from), "{from}");
        let broken = sound.replacen(from, to, 1);
        if expected.starts_with("f.glb") {
            // A tree that only goes round has no root: nothing is shown, and that is said.
            let scene = load("f.glb", glb(&broken, &cube_buffer())).unwrap();
            assert_eq!(scene.warnings, ["there are no triangles to show"]);
            continue;
        }
        let error = error_of("f.glb", glb(&broken, &cube_buffer()));
        assert!(
            error.starts_with(&format!("f.glb: {expected}")),
            "{to}: {error}, expected {expected}"
        );
    }

    // Cycles and trees that grow together.
    for nodes in [
        r#""scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1]},{"children":[0]}],"#,
        r#""nodes":[{"children":[2]},{"children":[2]},{"mesh":0}],"#,
        r#""scenes":[{"nodes":[0,0]}],"nodes":[{"mesh":0}],"#,
    ] {
        let error = error_of("f.glb", cube(nodes));
        assert!(error.contains("is reached twice; nodes must form trees"), "{error}");
    }
}

#[test]
fn many_and_deep_nodes() {
    // A chain of 100,000 nodes, each one step further.
    let link = |i: usize| format!(r#"{{"children":[{}],"translation":[1,0,0]}}"#, i + 1);
    let chain: Vec<String> = (0..100_000).map(link).collect();
    let nodes = format!(r#""nodes":[{},{{"mesh":0}}],"#, chain.join(","));
    let scene = load("deep.glb", cube(&nodes)).unwrap();
    assert_eq!(scene.bounds().max.x, 100_001.0);

    // A small file that asks for very many triangles is refused before any is made, if they must be copied: nodes that flatten a mesh cannot share it.
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let many = |node: &str| {
        let nodes = format!(r#""nodes":[{}],"#, vec![node; 20_000].join(","));
        let json = cube_json(&nodes).replace(primitive, &vec![primitive; 2000].join(","));
        glb(&json, &cube_buffer())
    };
    let scene = load("many.glb", many(r#"{"mesh":0}"#)).unwrap();
    assert_eq!((scene.visible_triangles(), triangle_count(&scene)), (480_000_000, 24_000));
    let error = error_of("many.glb", many(r#"{"mesh":0,"scale":[1,0,1]}"#));
    assert!(error.contains("its nodes show 480000000 triangles"), "{error}");
    // An array without bytes behind it, too.
    let json = cube_json(r#""nodes":[{"mesh":0}],"#).replacen("\"bufferView\":0,\"componentType\":5126,\"count\":8", "\"componentType\":5126,\"count\":4000000000,\"sparse\":{\"count\":0,\"indices\":{\"bufferView\":1,\"componentType\":5121},\"values\":{\"bufferView\":0}}", 1);
    let error = error_of("zeros.glb", glb(&json, &cube_buffer()));
    assert!(error.contains("accessors[0]: has 4000000000 elements but no bufferView"), "{error}");
}

#[test]
fn vertices_that_are_nowhere() {
    let mut buffer = cube_buffer();
    buffer[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let file = glb(&cube_json(r#""nodes":[{"mesh":0}],"#), &buffer);
    let scene = load("nan.glb", &file).unwrap();
    check_scene(&scene);
    assert!((6..12).contains(&triangle_count(&scene)));
    assert!(scene.warnings[0].starts_with("1 vertex is NaN or infinite (accessors[0], element 0"));
    let error = load_strictly("nan.glb", &file).unwrap_err();
    assert_eq!(*error.place(), Place::Json("accessors[0], element 0, in nodes[0]".to_owned()));
}

#[test]
fn a_node_shows_its_mesh_where_its_instances_are() {
    // The cube, and two translations and a scale for each of two instances.
    let mut buffer = cube_buffer();
    let numbers = [10.0f32, 0.0, 0.0, 0.0, 20.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
    buffer.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    let with = |second: usize| {
        let json = cube_json(
            r#""nodes":[{"mesh":0,"camera":0,"translation":[0,0,5],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2,"SCALE":3}}}}],
            "cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],
            "extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"],"#,
        );
        let json = json.replace("\"byteLength\":132}]", "\"byteLength\":180}]");
        let views = r#"{"buffer":0,"byteOffset":96,"byteLength":36},{"buffer":0,"byteOffset":132,"byteLength":48}]"#;
        let json = json.replace(r#"{"buffer":0,"byteOffset":96,"byteLength":36}]"#, views);
        let last = r#"{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}"#;
        let more = format!(
            r#"{last},{{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}},{{"bufferView":2,"byteOffset":24,"componentType":5126,"count":{second},"type":"VEC3"}}"#
        );
        load("many.glb", glb(&json.replace(last, &more), &buffer))
    };
    let scene = with(2).unwrap();
    check_scene(&scene);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!((triangle_count(&scene), scene.cameras.len()), (24, 1));
    let bounds = scene.bounds();
    assert_eq!((bounds.min, bounds.max), (Vec3::new(-2.0, -1.0, 3.0), Vec3::new(11.0, 22.0, 7.0)));
    let error = with(1).unwrap_err().to_string();
    assert!(error.contains("has attributes of different numbers of elements"), "{error}");
}
