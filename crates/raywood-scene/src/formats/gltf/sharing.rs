//! Which meshes become objects that instances show, and which are copied. A place that flattens the mesh gets a copy in any case, for there is no way back from there.

use super::document::Document;
use super::node::Instance;
use super::primitive::{Reads, size};
use super::transform::Transform;
use crate::error::LoadError;
use crate::instances::is_worth_sharing;

/// What nodes show.
pub(super) struct Shared<'a> {
    /// All that stands in the world by itself: lights and cameras, and meshes that are copied.
    pub(super) copied: Vec<Instance<'a>>,
    /// Meshes in their own space.
    pub(super) objects: Vec<Instance<'a>>,
    /// Where these are shown.
    pub(super) placed: Vec<crate::Instance>,
}

/// Decides of each mesh whether it is shared.
pub(super) fn share<'a>(
    document: &Document<'_>,
    instances: Vec<Instance<'a>>,
    reads: &[Reads],
) -> Result<Shared<'a>, LoadError> {
    let mut uses = vec![0u64; document.root.meshes.len()];
    for mesh in instances.iter().filter_map(Instance::mesh) {
        if let Some(uses) = uses.get_mut(mesh) {
            *uses += 1;
        }
    }
    let mut is_shared = vec![false; uses.len()];
    for (mesh, &uses) in uses.iter().enumerate().filter(|(_, uses)| **uses > 1) {
        let triangles = size(document, mesh, reads)?.triangles;
        is_shared[mesh] = is_worth_sharing(triangles, uses);
    }

    let mut numbers = vec![None; uses.len()];
    let mut shared = Shared { copied: Vec::new(), objects: Vec::new(), placed: Vec::new() };
    for mut instance in instances {
        let mesh = instance.mesh().filter(|&mesh| is_shared.get(mesh) == Some(&true));
        let transform = instance.to_world.rounded();
        if let Some(mesh) = mesh.filter(|_| transform.check().is_ok()) {
            let object = *numbers[mesh].get_or_insert_with(|| {
                shared.objects.push(Instance {
                    to_world: Transform::IDENTITY,
                    is_copy: true,
                    ..instance.clone()
                });
                shared.objects.len() as u32 - 1
            });
            shared.placed.push(crate::Instance::new(object, transform));
            if instance.is_copy {
                continue;
            }
            // Its node's light and camera stay.
            instance.shows_mesh = false;
        }
        shared.copied.push(instance);
    }
    Ok(shared)
}
