//! Cameras of glTF.

use raywood::Vec3;

use super::document::Document;
use super::node::Instance;
use crate::Camera;
use crate::error::{LoadError, Place};
use crate::formats::notes::Notes;

/// The perspective cameras of a scene, in the order of its nodes.
pub(super) fn cameras(
    document: &Document<'_>,
    instances: &[Instance<'_>],
    center_and_radius: &dyn Fn() -> (Vec3, f32),
    notes: &mut Notes,
) -> Result<Vec<Camera>, LoadError> {
    let mut measure = None;
    let mut cameras = Vec::new();
    for Instance { index, node, to_world, .. } in instances.iter().filter(|i| !i.is_copy) {
        let Some(source) = node.camera.and_then(|c| document.root.cameras.get(c.value())) else {
            continue;
        };
        let Some(perspective) = &source.perspective else {
            notes
                .say(format!("nodes[{index}].camera is left out: only perspective ones are known"));
            continue;
        };

        // A camera looks along its -z, with its y up.
        let eye = to_world.point([0.0; 3]);
        let forward = to_world.direction([0.0, 0.0, -1.0]);
        let up = to_world.direction([0.0, 1.0, 0.0]);
        let fov_y = perspective.yfov.to_degrees();
        let is_sound =
            eye.is_finite() && forward.cross(up).length() > 1e-3 && (0.01..=179.9).contains(&fov_y);
        if !is_sound {
            let place = Place::Json(format!("nodes[{index}].camera"));
            notes.mend_line(place, "sees nothing (its angle or its node's matrix)", "left out")?;
            continue;
        }
        let name = source.name.clone().or_else(|| node.name.clone()).unwrap_or_default();
        // The target is as far away as the middle of the scene, if that is in front.
        let (center, radius) = *measure.get_or_insert_with(center_and_radius);
        let ahead = (center - eye).dot(forward);
        let distance = if ahead > 0.01 * radius { ahead } else { radius };
        cameras.push(Camera { name, eye, target: eye + distance * forward, up, fov_y });
    }
    Ok(cameras)
}
