//! Scenes saved with the tree over their surfaces: a [saved tree](raywood::SavedTree) with sections for what a scene has besides.

mod checksums;
mod environment;
mod images;
mod scene;
mod stored;

use std::io::{self, Write};
use std::path::Path;

use raywood::{Bvh, SavedGeometry, SavedTree};

use crate::error::{LoadError, Place};
use crate::{Environment, Material, Mesh, Scene};
use scene::Small;
use stored::{Reader, Stored};

/// Everything of a scene that is small.
const SCENE: &str = "scene";
/// A shading normal per vertex.
const NORMALS: &str = "normals";
/// A colour per vertex.
const COLORS: &str = "colors";
/// Both sets of texture coordinates per vertex.
const TEXTURE_COORDINATES: [&str; 2] = ["texture-coords-0", "texture-coords-1"];
/// A tangent per vertex.
const TANGENTS: &str = "tangents";
/// What textures name.
const IMAGES: &str = "images";
/// The panorama around the scene.
const ENVIRONMENT: &str = "environment";
/// The material of each triangle.
const MATERIALS: &str = "materials";
/// The material of each sphere.
const SPHERE_MATERIALS: &str = "sphere-materials";

/// Saves a scene with the tree over its surfaces, first its triangles and then its spheres. All comes back but the scene's name, which is the file's then, and its warnings. The same bytes
/// for any number of threads.
///
/// # Errors
///
/// A scene with [instances](Scene::instances), which must be [flattened](Scene::flatten) first; what the writer says: see [`Bvh::save_with`].
pub fn save_scene<G: SavedGeometry>(
    scene: &Scene,
    tree: &Bvh<G>,
    writer: impl Write,
) -> io::Result<()> {
    // All fields, so that a new one is not forgotten.
    let Scene {
        name: _,
        mesh:
            Mesh {
                triangles: _,
                normals,
                colors,
                texture_coordinates: [first_coordinates, second_coordinates],
                tangents,
                materials: of_triangles,
            },
        spheres: _,
        sphere_materials,
        materials,
        images,
        lights,
        cameras,
        up,
        background,
        environment,
        warnings: _,
        instances,
    } = scene;
    if !instances.is_empty() {
        let problem = "a scene with instances cannot be saved, only one whose instances are copied";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
    }
    let small = Small {
        up: *up,
        background: *background,
        materials: materials.clone(),
        lights: lights.clone(),
        cameras: cameras.clone(),
    };
    let mut sections = vec![(SCENE, small.to_bytes())];
    let large = [
        (NORMALS, to_bytes(normals)),
        (COLORS, to_bytes(colors)),
        (TEXTURE_COORDINATES[0], to_bytes(first_coordinates)),
        (TEXTURE_COORDINATES[1], to_bytes(second_coordinates)),
        (TANGENTS, to_bytes(tangents)),
        (IMAGES, to_bytes(images)),
        (ENVIRONMENT, to_bytes(environment.as_slice())),
        (MATERIALS, to_bytes(of_triangles)),
        (SPHERE_MATERIALS, to_bytes(sphere_materials)),
    ];
    sections.extend(large.into_iter().filter(|(_, bytes)| !bytes.is_empty()));
    let sections: Vec<_> = sections.iter().map(|(name, bytes)| (*name, &bytes[..])).collect();
    tree.save_with(&sections, writer)
}

/// A scene that was [saved](save_scene) with its tree.
#[derive(Debug)]
pub struct SavedScene {
    /// The scene. Its triangles may lie in the memory that the bytes came in.
    pub scene: Scene,
    /// The tree over its surfaces.
    pub tree: SavedTree,
}

impl SavedScene {
    /// Opens a saved scene, or a saved tree without one, which gets the default material. The path is for the scene's name and for messages. Checks everything: see
    /// [`SavedTree::open`].
    ///
    /// # Errors
    ///
    /// The bytes are no saved tree or scene that can be used.
    pub fn open(
        path: &Path,
        bytes: impl AsRef<[u8]> + Send + Sync + 'static,
    ) -> Result<Self, LoadError> {
        let whole =
            |error: raywood::SavedTreeError| LoadError::new(path, Place::File, error.to_string());
        let tree = SavedTree::open(bytes).map_err(whole)?;
        let fault = |section: &str, at: usize, problem: String| {
            LoadError::new(
                path,
                Place::File,
                format!("section `{section}`, byte {at} of it: {problem}"),
            )
        };
        let mut scene = Scene {
            name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            spheres: tree.spheres().clone(),
            ..Scene::default()
        };
        if let Some(bytes) = tree.section(SCENE) {
            let small = Small::of_bytes(bytes).map_err(|f| fault(SCENE, f.at, f.problem))?;
            let Small { up, background, materials, lights, cameras } = small;
            scene = Scene { up, background, materials, lights, cameras, ..scene };
        }
        if scene.materials.is_empty() {
            scene.materials.push(Material::default());
        }

        let vertices = tree.mesh().positions().len();
        let of = |name, (at, problem)| fault(name, at, problem);
        let [first, second] = TEXTURE_COORDINATES;
        scene.mesh = Mesh {
            triangles: tree.mesh().clone(),
            normals: per_vertex(&tree, vertices, NORMALS).map_err(|f| of(NORMALS, f))?,
            colors: per_vertex(&tree, vertices, COLORS).map_err(|f| of(COLORS, f))?,
            texture_coordinates: [
                per_vertex(&tree, vertices, first).map_err(|f| of(first, f))?,
                per_vertex(&tree, vertices, second).map_err(|f| of(second, f))?,
            ],
            tangents: per_vertex(&tree, vertices, TANGENTS).map_err(|f| of(TANGENTS, f))?,
            materials: values(&tree, MATERIALS).map_err(|f| of(MATERIALS, f))?,
        };
        scene.sphere_materials =
            values(&tree, SPHERE_MATERIALS).map_err(|f| of(SPHERE_MATERIALS, f))?;
        scene.images = values(&tree, IMAGES).map_err(|f| of(IMAGES, f))?;
        let mut environments: Vec<Environment> =
            values(&tree, ENVIRONMENT).map_err(|f| of(ENVIRONMENT, f))?;
        scene.environment = environments.pop();
        Ok(Self { scene, tree })
    }
}

/// Values side by side.
fn to_bytes<T: Stored>(values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(values));
    values.iter().for_each(|value| value.put(&mut bytes));
    bytes
}

/// What is wrong with a section, and at which byte of it.
type Wrong = (usize, String);

/// The values side by side in a section; none if there is no such section.
fn values<T: Stored>(tree: &SavedTree, name: &str) -> Result<Vec<T>, Wrong> {
    let bytes = tree.section(name).unwrap_or_default();
    let mut reader = Reader { bytes, at: 0 };
    let mut values = Vec::with_capacity(bytes.len() / size_of::<T>());
    while reader.at < bytes.len() {
        values.push(T::get(&mut reader).map_err(|fault| (fault.at, fault.problem))?);
    }
    Ok(values)
}

/// The same of one value for each vertex, or none at all.
fn per_vertex<T: Stored>(tree: &SavedTree, vertices: usize, name: &str) -> Result<Vec<T>, Wrong> {
    let values = values(tree, name)?;
    match values.len() == vertices || values.is_empty() {
        true => Ok(values),
        false => Err((0, format!("{} values, but there are {vertices} vertices", values.len()))),
    }
}
