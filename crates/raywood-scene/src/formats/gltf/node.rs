//! Walks the node tree of a glTF scene.

use gltf_json::Node;

use super::document::Document;
use super::transform::Transform;
use crate::error::LoadError;

/// A node in its place in the world.
pub(super) struct Instance<'a> {
    /// Its number in the file.
    pub(super) index: usize,
    /// What it shows.
    pub(super) node: &'a Node,
    /// From its space to the world's.
    pub(super) to_world: Transform,
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
        instances.push(Instance { index, node, to_world });
    }
    Ok(instances)
}
