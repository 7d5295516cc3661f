//! glTF 2.0 (Khronos 2017), as JSON with buffers beside it (`.gltf`) or all in one (`.glb`).
//!
//! The node tree is flattened: every mesh of the default scene is copied to world space, once for each node that shows it, or for each of its instances
//! (`EXT_mesh_gpu_instancing`); large ones that are shown often become [objects](crate::Instances) instead (see `sharing.rs`). Read:
//! triangles, strips and fans, indexed or not; `POSITION`, `NORMAL`, `TANGENT`, `TEXCOORD_0`, `TEXCOORD_1`, `COLOR_0`; sparse and normalised
//! accessors; metallic and rough materials with clear coats, sheen and dispersion, and all their textures (PNG and JPEG) but the normals of coats; perspective
//! cameras; punctual lights. Left out with a warning: images in other formats, points and lines, skins (shown as stored), morph targets
//! and animations.
//!
//! The crate `gltf-json` reads the JSON and checks what it can. What it does not check (that buffers are as long as promised, that
//! views and accessors lie within them, that nodes form trees) is checked here, before anything is read or allocated.

use raywood::{Aabb, Vec3};

use self::document::Document;
use self::primitive::Reads;
use self::sharing::Shared;
use super::notes::Notes;
use super::raw_mesh::RawMesh;
use super::{Format, Input};
use crate::error::{LoadError, Place};
use crate::{Instances, Material, MaterialId, Scene};

mod accessor;
mod camera;
mod check;
mod container;
mod document;
mod layers;
mod light;
mod material;
mod node;
mod primitive;
mod sharing;
mod texture;
mod transform;

pub(super) const FORMAT: Format = Format {
    name: "glTF",
    extensions: &["glb", "gltf"],
    description: "a glTF 2.0 file",
    recognises: |bytes| {
        let start = &bytes[..bytes.len().min(4096)];
        let is_json = start.trim_ascii_start().starts_with(b"{");
        start.starts_with(b"glTF") || is_json && memchr::memmem::find(bytes, b"\"asset\"").is_some()
    },
    load,
};

/// The most triangles, and the most vertices, that copies of meshes may add up to: a small file can ask for any number of copies.
const MOST: u64 = 1 << 27;

fn load(input: &Input<'_>) -> Result<Scene, LoadError> {
    let mut notes = Notes::new(input.path, input.options.strict);
    let document = Document::open(input, &mut notes)?;
    let root = &document.root;
    let instances = node::instances(&document)?;

    // Materials, and a last one for what has none.
    let mut textures = texture::Textures::new(root);
    let mut materials: Vec<Material> =
        root.materials.iter().map(|m| material::convert(m, &mut textures)).collect();
    materials.push(Material::default());
    let reads: Vec<Reads> = materials.iter().map(Reads::of).collect();

    // Triangles in world space, then those of objects in their own. All sizes are known beforehand.
    let mut mesh = RawMesh::default();
    let Shared { copied, objects, placed } = sharing::share(&document, instances, &reads)?;
    let size = primitive::total_size(&document, copied.iter().chain(&objects), &reads)?;
    if size.vertices.max(size.triangles) > MOST {
        let (triangles, vertices) = (size.triangles, size.vertices);
        let message = format!(
            "its nodes show {triangles} triangles and {vertices} vertices in all, expected at most {MOST} of each"
        );
        return Err(LoadError::new(input.path, Place::File, message));
    }
    mesh.positions.reserve_exact(size.vertices as usize);
    mesh.triangles.reserve_exact(size.triangles as usize);
    mesh.materials.reserve_exact(size.triangles as usize);
    for instance in &copied {
        primitive::add(&document, instance, &reads, &mut mesh, &mut notes)?;
    }
    for object in &objects {
        mesh.object_starts.push(mesh.triangles.len() as u32);
        primitive::add(&document, object, &reads, &mut mesh, &mut notes)?;
    }
    if !mesh.materials.contains(&(materials.len() as MaterialId - 1)) {
        materials.pop();
    }
    mesh.drop_unplaced_triangles();
    let (starts, end) = (std::mem::take(&mut mesh.object_starts), mesh.triangles.len() as u32);
    let instances = Instances::new(starts, end, placed)
        .map_err(|error| LoadError::new(input.path, Place::File, error.to_string()))?;
    let mesh = mesh.finish(input)?;
    let images = textures.load(&document, &mut notes)?;

    let mut scene = Scene { mesh, instances, materials, images, ..Scene::default() };
    let measure = || center_and_radius(&scene.bounds());
    let cameras = camera::cameras(&document, &copied, &measure, &mut notes)?;
    let lights = light::lights(&document, &copied, &measure, &mut notes);
    if !root.animations.is_empty() {
        notes.say("animations are not played: shown as stored");
    }
    (scene.cameras, scene.lights) = (cameras, lights);
    scene.warnings = notes.into_warnings();
    scene.up = Some(Vec3::Y);
    Ok(scene)
}

/// The middle and half the diagonal of what holds all triangles, from which cameras and lights take their measure; some place and size
/// if there are none.
fn center_and_radius(bounds: &Aabb) -> (Vec3, f32) {
    let center = bounds.min * 0.5 + bounds.max * 0.5;
    let radius = (bounds.max - bounds.min).length() * 0.5;
    if center.is_finite() && radius.is_finite() && radius > 0.0 {
        (center, radius)
    } else {
        (Vec3::ZERO, 1.0)
    }
}
