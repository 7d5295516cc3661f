//! Textures of model files: images inside and beside them, how they lie, what is missing or broken.

use base64::Engine;
use raywood::Vec3;
use raywood_scene::{
    Encoding, Magnification, Material, Scene, SurfaceTextures, Texture, Wrap, load_file,
};

use crate::formats_support::{Folder, check_error, check_scene, jpeg, png, textured_square};

fn load(folder: &Folder, name: &str, contents: impl AsRef<[u8]>) -> Scene {
    let scene = load_file(&folder.write(name, contents), &Default::default()).unwrap();
    check_scene(&scene);
    scene
}

fn textures(material: &Material) -> &SurfaceTextures {
    material.textures.as_deref().expect("textures")
}

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];

#[test]
fn images_inside_beside_and_in_the_json() {
    let folder = Folder::new();
    folder.write("a b.png", png(2, &[RED, GREEN]));
    let inside = png(1, &[GREEN]);
    let data = base64::engine::general_purpose::STANDARD.encode(jpeg());
    let more = format!(
        r#""images":[{{"uri":"a%20b.png"}},{{"bufferView":5,"mimeType":"image/png"}},{{"uri":"data:image/jpeg;base64,{data}"}}],
        "textures":[{{"source":0}},{{"source":1}},{{"source":2}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}},"metallicRoughnessTexture":{{"index":1}}}},
        "emissiveTexture":{{"index":2}},"emissiveFactor":[1,1,1],"occlusionTexture":{{"index":1}}}}],"#
    );
    let scene = load(&folder, "m.glb", textured_square(&more, &[&inside]));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let found = textures(&scene.materials[0]);
    let image =
        |texture: Option<Texture>| &scene.images[texture.expect("a texture").image as usize];
    let color = image(found.color);
    assert_eq!((color.texels(), color.encoding()), (&[RED, GREEN][..], Encoding::Srgb));
    let metal = image(found.metallic_roughness);
    assert_eq!((metal.texels(), metal.encoding()), (&[GREEN][..], Encoding::Linear));
    let emission = image(found.emission);
    assert_eq!((emission.width(), emission.height(), emission.encoding()), (8, 8, Encoding::Srgb));
    assert!(emission.texels().iter().all(|texel| *texel == [192, 192, 192, 255]));
    assert_eq!(scene.mesh.texture_coordinates[0][1], [1.0, 1.0]);
    // Nobody reads these.
    assert!(scene.mesh.texture_coordinates[1].is_empty() && scene.mesh.tangents.is_empty());
}

#[test]
fn samplers_sets_transforms_and_shared_images() {
    let folder = Folder::new();
    let more = r#""images":[{"bufferView":5,"mimeType":"image/png"}],
        "samplers":[{"wrapS":33071,"wrapT":33648,"magFilter":9728}],
        "textures":[{"source":0,"sampler":0},{"source":0}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}},
        "emissiveTexture":{"index":1,"extensions":{"KHR_texture_transform":{"offset":[0.25,0.5],"scale":[2,4],"texCoord":1}}},
        "emissiveFactor":[1,1,1],
        "normalTexture":{"index":1,"scale":0.5,"extensions":{"KHR_texture_transform":{"offset":[0.125,0]}}}}],
        "extensionsUsed":["KHR_texture_transform"],"#;
    let scene = load(&folder, "m.glb", textured_square(more, &[&png(1, &[RED])]));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let found = textures(&scene.materials[0]);
    let color = found.color.expect("a texture");
    assert_eq!((color.set, color.wrap), (1, [Wrap::Clamp, Wrap::Mirror]));
    assert_eq!(color.magnification, Magnification::Nearest);
    let emission = found.emission.expect("a texture");
    assert_eq!((emission.set, emission.transform.point([1.0, 1.0])), (1, [2.25, 4.5]));
    let (normal, scale) = found.normal.expect("a texture");
    assert_eq!((normal.set, scale, normal.transform.point([0.0, 0.0])), (0, 0.5, [0.125, 0.0]));
    // As colour, as light and as numbers.
    assert_eq!(scene.images.len(), 3);
    assert_eq!(scene.mesh.texture_coordinates[1][2], [0.5, 0.0]);
    assert_eq!(scene.mesh.tangents[3], [1.0, 0.0, 0.0, -1.0]);
}

#[test]
fn coats_and_sheen_have_textures() {
    let folder = Folder::new();
    let more = r#""images":[{"bufferView":5,"mimeType":"image/png"}],"textures":[{"source":0}],
        "materials":[{"extensions":{
        "KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0,"texCoord":1},"clearcoatRoughnessTexture":{"index":0}},
        "KHR_materials_sheen":{"sheenColorFactor":[1,1,1],"sheenColorTexture":{"index":0},"sheenRoughnessTexture":{"index":9}}}}],"#;
    let scene = load(&folder, "m.glb", textured_square(more, &[&png(1, &[RED])]));
    let found = textures(&scene.materials[0]);
    let [coat, roughness, color] =
        [&found.clearcoat, &found.clearcoat_roughness, &found.sheen_color]
            .map(|texture| texture.expect("a texture"));
    assert_eq!((coat.set, roughness.set, found.sheen_roughness), (1, 0, None));
    let encoding = |texture: Texture| scene.images[texture.image as usize].encoding();
    assert_eq!([coat, roughness].map(encoding), [Encoding::Linear; 2]);
    assert_eq!(encoding(color), Encoding::Srgb);
}

#[test]
fn alpha_is_cut_out_or_blended_as_the_material_says() {
    let folder = Folder::new();
    let image = png(2, &[[9, 9, 9, 100], [9, 9, 9, 140]]);
    let with = |mode: &str| {
        let more = format!(
            r#""images":[{{"bufferView":5}}],"textures":[{{"source":0}}],
            "materials":[{{"alphaMode":"{mode}","alphaCutoff":0.25,"pbrMetallicRoughness":{{
            "baseColorFactor":[1,1,1,0.5],"baseColorTexture":{{"index":0}}}}}}],"#
        );
        load(&folder, "m.glb", textured_square(&more, &[&image]))
    };
    let (opaque, blend, mask) = (with("OPAQUE"), with("BLEND"), with("MASK"));
    assert_eq!(textures(&opaque.materials[0]).opacity, None);
    assert_eq!(textures(&blend.materials[0]).opacity, Some(0.5));
    assert_eq!(blend.images[0].cutoff(), None);
    assert_eq!(textures(&mask.materials[0]).opacity, Some(1.0));
    let cutoff = mask.images[0].cutoff().expect("a cut-out");
    assert!((cutoff - 0.5).abs() < 1e-6, "{cutoff}");
    for scene in [opaque, blend, mask] {
        assert_eq!(scene.materials[0].transmission, Vec3::ZERO);
    }
}

#[test]
fn missing_and_broken_images_are_shown_as_a_checker_and_said_once() {
    let folder = Folder::new();
    let whole = png(8, &[RED; 64]);
    let mut ends = whole.clone();
    ends.truncate(60);
    folder.write("ends.png", &ends);
    folder.write("text.png", "no image at all");
    let more = r#""images":[{"uri":"none.png"},{"uri":"ends.png"},{"uri":"text.png"},{"bufferView":99},{"uri":"http://a.b/c.png"}],
        "textures":[{"source":0},{"source":1},{"source":2},{"source":3},{"source":4}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},
        {"pbrMetallicRoughness":{"baseColorTexture":{"index":1}},"normalTexture":{"index":4}},
        {"pbrMetallicRoughness":{"baseColorTexture":{"index":2}},"emissiveTexture":{"index":3}}],"#;
    let scene = load(&folder, "m.glb", textured_square(more, &[]));
    let said = scene.warnings.join("\n");
    assert!(
        said.contains("images[0]: names the file `none.png`, which is not there (5 images in all are missing or broken): colours are shown as a magenta checker"),
        "{said}"
    );
    for material in &scene.materials {
        let texture = textures(material).color.expect("a texture");
        let image = &scene.images[texture.image as usize];
        assert!(image.texels().contains(&[255, 0, 255, 255]) && image.width() > 1);
    }
    let (normal, _) = textures(&scene.materials[1]).normal.expect("a texture");
    assert_eq!(scene.images[normal.image as usize].texels(), [[128, 128, 255, 255]]);

    let strict = raywood_scene::LoadOptions::default().with_strict(true);
    let error = load_file(&folder.path("m.glb"), &strict).unwrap_err().to_string();
    check_error(&error);
    assert!(error.contains("images["), "{error}");
}

#[test]
fn formats_that_are_not_known_leave_the_plain_material() {
    let folder = Folder::new();
    folder.write("a.webp", b"RIFF....WEBPVP8 ");
    let more = r#""images":[{"uri":"a.webp"}],"textures":[{"extensions":{"EXT_texture_webp":{"source":0}}},{}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":1}}],
        "extensionsUsed":["EXT_texture_webp"],"extensionsRequired":["EXT_texture_webp"],"#;
    let scene = load(&folder, "m.glb", textured_square(more, &[]));
    assert_eq!(
        scene.warnings,
        [
            "1 texture has no image, left out",
            "1 image left out: WebP is not known here, PNG and JPEG are"
        ]
    );
    assert_eq!(scene.images[0].texels(), [[255; 4]]);
}

#[test]
fn images_of_absurd_size_are_refused_at_once() {
    let folder = Folder::new();
    let more = r#""images":[{"bufferView":5}],"textures":[{"source":0}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"#;
    // The header alone tells.
    let with_size = |width: u32, height: u32| {
        let mut image = png(1, &[RED]);
        image[16..20].copy_from_slice(&width.to_be_bytes());
        image[20..24].copy_from_slice(&height.to_be_bytes());
        let path = folder.write("m.glb", textured_square(more, &[&image]));
        load_file(&path, &Default::default())
    };
    let error = with_size(100_000, 100_000).unwrap_err().to_string();
    check_error(&error);
    assert!(
        error.ends_with("images[0]: has 100000x100000 texels, expected at most 16384x16384"),
        "{error}"
    );
    // A size that is allowed, but for which there are no bytes: broken, and no memory is taken for it.
    let said = with_size(16384, 16384).unwrap().warnings.join("\n");
    assert!(said.contains("promises 16384x16384 texels, but has"), "{said}");
}

#[test]
fn maps_of_mtl_files_are_found_however_they_are_spelled() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path("Tex")).unwrap();
    folder.write("Tex/Wood.PNG", png(2, &[RED, GREEN]));
    folder.write("holes.png", png(2, &[[255; 4], [0, 0, 0, 255]]));
    folder.write("bumps.png", png(2, &[[0, 0, 0, 255], [255; 4]]));
    folder.write(
        "m.mtl",
        "newmtl wood\nKd 0 0 0\nKs 0.5 0.5 0.5\nNs 20\nd 0.5\nmap_Kd -s 2 3 1 -o 0.25 0.5 -clamp on tex\\wood.png\n\
        map_d holes.png\nmap_Bump -bm 0.5 C:\\art\\bumps.png\nmap_Ns gloss.png\n\
        newmtl unused\nmap_Kd nowhere.png\n",
    );
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 0.5 0.25\n\
        usemtl wood\nf 1/1 2/2 3/3\nf 2/2 4/4 3/1\n";
    let scene = load(&folder, "m.obj", obj);
    assert_eq!(scene.warnings, ["m.mtl: 1 texture is not shown: shininess"]);

    let found = textures(&scene.materials[0]);
    let color = found.color.expect("a texture");
    assert_eq!(scene.images[color.image as usize].texels(), [RED, GREEN]);
    assert_eq!((scene.materials[0].diffuse, color.wrap), (Vec3::ONE, [Wrap::Clamp; 2]));
    // At (0, 0) of the file the image is read at (0.25, 0.5), its v upwards.
    assert_eq!(color.transform.point([0.0, 1.0]), [0.25, 0.5]);
    assert_eq!(color.transform.point([1.0, 0.5]), [2.25, -1.0]);
    assert_eq!((found.opacity, scene.materials[0].transmission), (Some(0.5), Vec3::ZERO));
    let (bumps, strength) = found.normal.expect("a texture");
    assert_eq!(strength, 0.5);
    let normal = scene.images[bumps.image as usize].texels()[0];
    assert!(normal[2] > 200 && normal != [0, 0, 0, 255], "{normal:?}");

    // The corner that two faces see with other coordinates is two vertices.
    assert_eq!(scene.mesh.triangles.positions().len(), 5);
    let coordinates = &scene.mesh.texture_coordinates[0];
    assert_eq!(coordinates[..4], [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [0.5, 0.75]]);
    assert_eq!(coordinates[4], [0.0, 1.0]);
}

#[test]
fn texture_coordinates_that_no_texture_reads_change_nothing() {
    let folder = Folder::new();
    folder.write("m.mtl", "newmtl plain\nKd 1 0 0\n");
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nusemtl plain\nf 1/1 2/2 3/1\nf 1/2 2/1 3/2\n";
    let scene = load(&folder, "m.obj", obj);
    assert_eq!(scene.mesh.triangles.positions().len(), 3);
    assert!(scene.mesh.texture_coordinates.iter().all(Vec::is_empty) && scene.images.is_empty());
}
