//! Textures: where images lie, holes for every kind of ray, normal maps, what is far away.

use raywood::Vec3;
use raywood_render::{RenderOptions, Setting};
use raywood_scene::{
    Camera, Encoding, LightKind, Magnification, Material, MetallicRoughness, Rgb, Scene,
    SurfaceTextures, Texture, TextureImage,
};

use crate::common::{
    assert_near, flat_background, image, level, light, look, matte, one_pixel, scene,
};

/// A camera whose one pixel is so small that it sees a single texel.
fn camera(eye: [f32; 3], target: [f32; 3]) -> Camera {
    Camera { fov_y: 0.01, ..crate::common::camera(eye, target) }
}

/// An upright square from (-1, -1) to (1, 1) at a depth, seen from +z.
fn upright(z: f32) -> [[f32; 3]; 4] {
    [[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]
}

/// Texture coordinates of a quadrilateral whose image stands upright on it.
const UPRIGHT: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

fn plain_image(width: u32, texels: &[[u8; 4]], encoding: Encoding) -> TextureImage {
    let height = texels.len() as u32 / width;
    TextureImage::new(width, height, texels.to_vec(), encoding, None).expect("a sound image")
}

fn textured(base: Material, textures: SurfaceTextures) -> Material {
    Material { textures: Some(Box::new(textures)), ..base }
}

/// A scene of quadrilaterals whose images stand upright on them.
fn pictures(
    quads: &[([[f32; 3]; 4], u32)],
    materials: Vec<Material>,
    images: Vec<TextureImage>,
) -> Scene {
    let mut scene = scene(quads, &[], materials);
    scene.mesh.texture_coordinates[0] = UPRIGHT.repeat(quads.len());
    scene.images = images;
    scene
}

/// A white square with a hole in its left half.
fn half_hole(cutoff: Option<f32>) -> (Material, TextureImage) {
    let texels = [[255, 255, 255, 0], [255, 255, 255, 255]];
    let image = TextureImage::new(2, 1, texels.to_vec(), Encoding::Srgb, cutoff);
    let texture = Texture { magnification: Magnification::Nearest, ..Texture::new(0) };
    let textures =
        SurfaceTextures { color: Some(texture), opacity: Some(1.0), ..Default::default() };
    (textured(matte(0.5), textures), image.expect("a sound image"))
}

const FRONT: LightKind = LightKind::directional(Vec3::new(0.0, 0.0, -1.0));

#[test]
fn an_image_stands_upright_and_its_colours_become_linear_light_once() {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [128, 128, 128, 255]];
    let texture = Texture { magnification: Magnification::Nearest, ..Texture::new(0) };
    let lamp = Material { emission: Rgb::ONE, ..matte(0.0) };
    let textures = SurfaceTextures { emission: Some(texture), ..Default::default() };
    let scene = pictures(
        &[(upright(0.0), 0)],
        vec![textured(lamp, textures)],
        vec![plain_image(2, &texels, Encoding::Srgb)],
    );
    let at = |x: f32, y: f32| look(&scene, &camera([x, y, 5.0], [x, y, 0.0]), &one_pixel()).0;
    assert_eq!([at(-0.5, 0.5), at(0.5, 0.5), at(-0.5, -0.5)], [Rgb::X, Rgb::Y, Rgb::Z]);
    // The half of 255 as the eye sees it is a fifth of the light.
    assert_near(at(0.5, -0.5), Rgb::splat(0.21586), 1e-4);
    // From behind it is mirrored.
    let (behind, _) = look(&scene, &camera([-0.5, 0.5, -5.0], [-0.5, 0.5, 0.0]), &one_pixel());
    assert_eq!(behind, Rgb::X);
}

#[test]
fn textures_multiply_colours_and_without_an_image_nothing_changes() {
    let base = Rgb::new(0.4, 0.6, 0.8);
    let texels = [[255, 128, 0, 255]];
    for (image, share) in [(0, Rgb::new(1.0, 0.21586, 0.0)), (7, Rgb::ONE)] {
        let textures = SurfaceTextures { color: Some(Texture::new(image)), ..Default::default() };
        let mut scene = pictures(
            &[(upright(0.0), 0)],
            vec![textured(Material { diffuse: base, ..Material::default() }, textures)],
            vec![plain_image(1, &texels, Encoding::Srgb)],
        );
        scene.lights = vec![light(FRONT, 1.0)];
        let (color, _) = look(&scene, &camera([0.2, 0.1, 5.0], [0.2, 0.1, 0.0]), &one_pixel());
        assert_near(color, base * share, 1e-4);
    }
}

#[test]
fn rays_from_the_eye_and_from_mirrors_go_through_holes() {
    let (sheet, image) = half_hole(Some(0.5));
    let lamp = Material { emission: Rgb::new(0.1, 0.7, 0.3), ..matte(0.0) };
    let mirror = Material { mirror: Rgb::ONE, ..matte(0.0) };
    let quads = [(upright(0.0), 0), (upright(-1.0), 1)];
    let scene = pictures(&quads, vec![sheet, lamp, mirror], vec![image]);
    let at = |x: f32| look(&scene, &camera([x, 0.0, 5.0], [x, 0.0, 0.0]), &one_pixel());
    let (color, rays) = at(-0.5);
    assert_eq!((color, rays.refraction), (Rgb::new(0.1, 0.7, 0.3), 1));
    let (color, rays) = at(0.5);
    assert_eq!((color, rays.refraction), (Rgb::ZERO, 0));

    // By a mirror that leans back the eye sees the sheet from its front. Holes are no bounces.
    let mut scene = scene;
    scene.mesh.materials[2..].fill(1);
    let mirrored = crate::common::scene(
        &[
            (upright(0.0), 0),
            (upright(-1.0), 1),
            ([[-1.0, -1.0, 9.0], [-1.0, 1.0, 9.0], [1.0, 1.0, 9.0], [1.0, -1.0, 9.0]], 2),
        ],
        &[],
        scene.materials.clone(),
    );
    let mut mirrored = Scene { images: scene.images.clone(), ..mirrored };
    mirrored.mesh.texture_coordinates[0] = UPRIGHT.repeat(3);
    let options = RenderOptions { max_depth: 1, ..one_pixel() };
    let back = |x: f32| look(&mirrored, &camera([x, 0.0, 5.0], [x, 0.0, 9.0]), &options).0;
    assert_eq!(back(-0.5), Rgb::new(0.1, 0.7, 0.3));
    assert_eq!(back(0.5), Rgb::ZERO);
}

#[test]
fn shadows_have_the_holes_of_what_casts_them() {
    let (sheet, image) = half_hole(Some(0.5));
    // A sheet between a wall and the sun; the eye looks at the wall from behind the sheet.
    let mut scene =
        pictures(&[(upright(1.0), 0), (upright(0.0), 1)], vec![sheet, matte(0.5)], vec![image]);
    scene.lights = vec![light(FRONT, 1.0)];
    for opaque_shadows in [false, true] {
        let options = RenderOptions { opaque_shadows, ..one_pixel() };
        let at = |x: f32| look(&scene, &camera([x, 0.0, 0.9], [x, 0.0, 0.0]), &options).0;
        assert_near(at(-0.5), Rgb::splat(0.5), 1e-6);
        assert_eq!(at(0.5), Rgb::ZERO);
    }
}

#[test]
fn what_is_half_there_lets_half_through() {
    let (sheet, mut half) = half_hole(None);
    half = plain_image(1, &[[255, 255, 255, 128]], half.encoding());
    let lamp = Material { emission: Rgb::ONE, ..matte(0.5) };
    let mut scene =
        pictures(&[(upright(1.0), 0), (upright(0.0), 1)], vec![sheet, lamp], vec![half]);
    scene.lights = vec![light(FRONT, 1.0)];
    let there = 128.0 / 255.0;
    let eye = camera([0.1, 0.2, 5.0], [0.1, 0.2, 0.0]);
    let (color, _) = look(&scene, &eye, &one_pixel());
    // The sheet in the sun, and through it the lamp, lit through the sheet.
    let behind = 1.0 + 0.5 * (1.0 - there);
    assert_near(color, Rgb::splat(there * 0.5 + (1.0 - there) * behind), 1e-5);
    let opaque = RenderOptions { opaque_shadows: true, ..one_pixel() };
    assert_eq!(look(&scene, &eye, &opaque).0, color);
}

/// However many sheets of holes stand behind each other, the ray comes to an end.
#[test]
fn a_forest_of_holes_has_an_end() {
    let (sheet, image) = half_hole(Some(0.5));
    let quads: Vec<_> = (0..400).map(|i| (upright(-0.01 * i as f32), 0)).collect();
    let mut scene = pictures(&quads, vec![sheet], vec![image]);
    scene.background = flat_background(Rgb::ONE);
    let eye = camera([-0.5, 0.0, 5.0], [-0.5, 0.0, 0.0]);
    let (_, rays) = look(&scene, &eye, &one_pixel());
    assert_eq!(rays.refraction, 256);
    scene.mesh.materials.truncate(200);
    scene.mesh.materials.resize(800, 1);
    assert!(
        Setting::of(&raywood_render::PreparedScene::new(&scene).expect("a tree"))
            == Setting::Outside
    );
}

/// The light that a square with a normal map sends back, the sun coming from a direction.
fn bumped(normal: [u8; 3], towards: Vec3, change: impl Fn(&mut Scene)) -> f32 {
    let [x, y, z] = normal;
    let textures = SurfaceTextures { normal: Some((Texture::new(0), 1.0)), ..Default::default() };
    let map = plain_image(1, &[[x, y, z, 255]], Encoding::Linear);
    let mut scene = pictures(&[(upright(0.0), 0)], vec![textured(matte(1.0), textures)], vec![map]);
    scene.lights = vec![light(LightKind::directional(-towards), 1.0)];
    change(&mut scene);
    look(&scene, &camera([0.0, 0.0, 5.0], [0.0; 3]), &one_pixel()).0.x
}

#[test]
fn normal_maps_lean_as_their_colours_say() {
    let flat = [128, 128, 255];
    // Red leans to the right of the image, green to its top.
    let (right, up) = ([218, 128, 218], [128, 218, 218]);
    let from = |x: f32, y: f32| Vec3::new(x, y, 1.0) / Vec3::new(x, y, 1.0).length();
    let level = bumped(flat, from(1.0, 0.0), |_| ());
    assert!((level - 0.5f32.sqrt()).abs() < 0.01, "{level}");
    let as_it_is = |_: &mut Scene| ();
    // An image that lies mirrored, its left to the right: its right is to the left.
    let mirrored = |scene: &mut Scene| {
        for uv in &mut scene.mesh.texture_coordinates[0] {
            uv[0] = 1.0 - uv[0];
        }
    };
    // One that lies upside down.
    let turned = |scene: &mut Scene| {
        for uv in &mut scene.mesh.texture_coordinates[0] {
            *uv = uv.map(|x| 1.0 - x);
        }
    };
    let given = |scene: &mut Scene| scene.mesh.tangents = vec![[1.0, 0.0, 0.0, 1.0]; 4];
    let given_mirrored = |scene: &mut Scene| scene.mesh.tangents = vec![[-1.0, 0.0, 0.0, -1.0]; 4];
    type Change = fn(&mut Scene);
    for (change, x, y) in [
        (as_it_is as Change, 1.0, 1.0),
        (mirrored, -1.0, 1.0),
        (turned, -1.0, -1.0),
        (given, 1.0, 1.0),
        (given_mirrored, -1.0, 1.0),
    ] {
        let facing = [bumped(right, from(x, 0.0), change), bumped(up, from(0.0, y), change)];
        let averted = [bumped(right, from(-x, 0.0), change), bumped(up, from(0.0, -y), change)];
        assert!(facing.iter().all(|&light| light > 0.97), "{x} {y}: {facing:?}");
        assert!(averted.iter().all(|&light| light < 0.2), "{x} {y}: {averted:?}");
    }
}

#[test]
fn metal_and_roughness_vary_with_their_texture() {
    // Blue is metal, green roughness: a smooth metal mirrors with its colour, chalk scatters.
    let surface = MetallicRoughness {
        base: Rgb::new(0.9, 0.6, 0.2),
        metallic: 1.0,
        roughness: 1.0,
        reflectance: Rgb::splat(0.04),
        transmission: 0.0,
    };
    let material = Material { metallic_roughness: Some(surface), ..Material::default() };
    let texture = Texture { magnification: Magnification::Nearest, ..Texture::new(0) };
    let textures = SurfaceTextures { metallic_roughness: Some(texture), ..Default::default() };
    let texels = [[9, 0, 255, 255], [9, 255, 0, 255]];
    let mut scene = pictures(
        &[(upright(0.0), 0)],
        vec![textured(material, textures)],
        vec![plain_image(2, &texels, Encoding::Linear)],
    );
    scene.background = flat_background(Rgb::ONE);
    scene.lights = vec![light(LightKind::Ambient, 1.0)];
    let at = |x: f32| look(&scene, &camera([x, 0.0, 5.0], [x, 0.0, 0.0]), &one_pixel());
    let (metal, rays) = at(-0.5);
    assert_near(metal, surface.base, 1e-5);
    assert_eq!(rays.reflection, 1);
    let (chalk, rays) = at(0.5);
    assert_near(chalk, surface.base, 1e-5);
    assert_eq!(rays.reflection, 0);
}

#[test]
fn occlusion_takes_from_the_ambient_light_alone() {
    let textures =
        SurfaceTextures { occlusion: Some((Texture::new(0), 0.5)), ..Default::default() };
    let mut scene = pictures(
        &[(upright(0.0), 0)],
        vec![textured(matte(1.0), textures)],
        vec![plain_image(1, &[[51, 0, 0, 255]], Encoding::Linear)],
    );
    scene.lights = vec![light(LightKind::Ambient, 0.5), light(FRONT, 0.25)];
    let (color, _) = look(&scene, &camera([0.1, 0.1, 5.0], [0.1, 0.1, 0.0]), &one_pixel());
    // A fifth of the light arrives, of which half counts.
    assert_near(color, Rgb::splat(0.5 * 0.6 + 0.25), 1e-5);
}

/// A floor of fine checks to the horizon: close up black and white, far away an even gray, without waves between.
#[test]
fn what_is_far_away_does_not_shimmer() {
    let texel =
        |i: usize| if (i % 64 + i / 64).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
    let texels: Vec<_> = (0..64 * 64).map(texel).collect();
    let lamp = Material { emission: Rgb::ONE, ..matte(0.0) };
    let textures = SurfaceTextures { emission: Some(Texture::new(0)), ..Default::default() };
    let mut scene = pictures(
        &[(level(0.0, 100.0, true), 0)],
        vec![textured(lamp, textures)],
        vec![plain_image(64, &texels, Encoding::Srgb)],
    );
    for uv in &mut scene.mesh.texture_coordinates[0] {
        *uv = uv.map(|x| 20.0 * x);
    }
    let options = RenderOptions { width: 64, height: 64, ..RenderOptions::default() };
    let eye = crate::common::camera([0.0, 2.0, 90.0], [0.0, 0.0, 60.0]);
    let (picture, _) = image(&scene, &eye, &options);
    let spread = |rows: std::ops::Range<u32>| {
        let values: Vec<f32> = rows
            .flat_map(|y| (0..64).map(move |x| (x, y)))
            .map(|(x, y)| picture.pixel(x, y).x)
            .collect();
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f32>();
        (mean, (variance / values.len() as f32).sqrt())
    };
    // The horizon is above the middle.
    let horizon = (0..64).find(|&y| picture.pixel(32, y).x > 0.0).expect("a horizon");
    let (mean, deviation) = spread(horizon + 3..horizon + 8);
    assert!((mean - 0.5).abs() < 0.01 && deviation < 0.05, "{mean} {deviation}");
    let (_, near) = spread(60..64);
    assert!(near > 0.1, "{near}");
}
