//! Walks the node tree of a glTF scene, and the copies of meshes that its nodes ask for (`EXT_mesh_gpu_instancing`).

use gltf_json::Node;

use super::accessor;
use super::document::Document;
use super::transform::Transform;
use crate::error::LoadError;

/// A node in its place in the world.
#[derive(Clone)]
pub(super) struct Instance<'a> {
    /// Its number in the file.
    pub(super) index: usize,
    /// What it shows.
    pub(super) node: &'a Node,
    /// From its space to the world's.
    pub(super) to_world: Transform,
    /// Whether its mesh is shown here.
    pub(super) shows_mesh: bool,
    /// Whether only its mesh is.
    pub(super) is_copy: bool,
}

impl Instance<'_> {
    /// The number of the mesh that is shown here.
    pub(super) fn mesh(&self) -> Option<usize> {
        self.node.mesh.filter(|_| self.shows_mesh).map(|mesh| mesh.value())
    }
}

/// All nodes of the default scene (the first if none is named; all trees if there is no scene), parents first. Nodes must form
/// trees: one that is reached twice would be shown twice, or without end.
pub(super) fn instances<'a>(document: &'a Document<'_>) -> Result<Vec<Instance<'a>>, LoadError> {
    let root = &document.root;
    let scene = match root.scene {
        Some(scene) => root.scenes.get(scene.value()),
        None => root.scenes.first(),
    };
    let roots: Vec<usize> = match scene {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None => {
            let mut is_child = vec![false; root.nodes.len()];
            for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
                if let Some(is_child) = is_child.get_mut(child.value()) {
                    *is_child = true;
                }
            }
            (0..root.nodes.len()).filter(|&i| !is_child[i]).collect()
        }
    };

    let mut instances = Vec::new();
    let mut is_reached = vec![false; root.nodes.len()];
    let mut waiting: Vec<(usize, Transform)> =
        roots.into_iter().rev().map(|root| (root, Transform::IDENTITY)).collect();
    while let Some((index, parent)) = waiting.pop() {
        let place = || format!("nodes[{index}]");
        let Some(node) = root.nodes.get(index) else {
            return Err(document.error(place(), "is not there"));
        };
        if std::mem::replace(&mut is_reached[index], true) {
            let message = "is reached twice; nodes must form trees, without cycles";
            return Err(document.error(place(), message));
        }
        let to_world = parent.after(&Transform::of_node(node));
        let children = node.children.iter().flatten().rev();
        waiting.extend(children.map(|child| (child.value(), to_world)));
        instances.push(Instance { index, node, to_world, shows_mesh: true, is_copy: false });
    }

    // Copies of meshes, in place of these; cameras and lights stay single.
    let mut all = Vec::with_capacity(instances.len());
    for mut instance in instances {
        let copies = copies(document, &instance)?;
        let Instance { index, node, .. } = instance;
        instance.shows_mesh = copies.is_none();
        all.push(instance);
        if all.len() + copies.as_ref().map_or(0, Vec::len) > MOST_COPIES {
            let message = format!("shows more than {MOST_COPIES} meshes, with all before it");
            return Err(document.error(format!("nodes[{index}]"), message));
        }
        let copy = |to_world| Instance { index, node, to_world, is_copy: true, shows_mesh: true };
        all.extend(copies.into_iter().flatten().map(copy));
    }
    Ok(all)
}

/// The most copies of meshes: a small file can ask for any number.
const MOST_COPIES: usize = 1 << 21;

/// The extension by which a node shows its mesh many times.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";

/// Where a node shows its mesh, if it shows it at other places than its own.
fn copies(
    document: &Document<'_>,
    instance: &Instance<'_>,
) -> Result<Option<Vec<Transform>>, LoadError> {
    let extensions = instance.node.extensions.as_ref();
    let Some(extension) = extensions.and_then(|e| e.others.get(INSTANCING)) else {
        return Ok(None);
    };
    let place = || format!("nodes[{}].extensions.{INSTANCING}", instance.index);
    let attribute = |name: &str| extension.get("attributes")?.get(name)?.as_u64();
    let translations = read::<3>(document, attribute("TRANSLATION"))?;
    let rotations = read::<4>(document, attribute("ROTATION"))?;
    let scales = read::<3>(document, attribute("SCALE"))?;
    let lengths = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut lengths = lengths.into_iter().flatten();
    let count = lengths.next().unwrap_or(0);
    if lengths.any(|length| length != count) {
        return Err(document.error(place(), "has attributes of different numbers of elements"));
    }
    let of = |i: usize| {
        let translation = translations.as_ref().map_or([0.0; 3], |all| all[i]);
        let rotation = rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |all| all[i]);
        let scale = scales.as_ref().map_or([1.0; 3], |all| all[i]);
        instance.to_world.after(&Transform::of_parts(translation, rotation, scale))
    };
    Ok(Some((0..count).map(of).collect()))
}

/// All elements of an accessor, if there is one.
fn read<const N: usize>(
    document: &Document<'_>,
    index: Option<u64>,
) -> Result<Option<Vec<[f32; N]>>, LoadError> {
    let Some(index) = index else { return Ok(None) };
    let index = usize::try_from(index).unwrap_or(usize::MAX);
    let mut elements = Vec::new();
    accessor::open(document, index)?.read::<N>(|element| elements.push(element));
    Ok(Some(elements))
}
