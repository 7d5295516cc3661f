//! A camera for what is seen from outside.

use rayon::prelude::*;
use raywood::{Aabb, Geometry, Vec3};
use raywood_scene::{Camera, Framing, Scene, default_direction, frame_bounds};

use crate::PreparedScene;
use crate::camera_rays::CameraRays;

/// The best of some three-quarter views of where the detail is.
pub(super) fn camera(prepared: &PreparedScene<'_>, bounds: &Aabb, aspect: f32) -> Camera {
    let up = prepared.axes().up;
    let Some(detail) = detail_bounds(prepared, bounds) else {
        return frame_surfaces(prepared, bounds, up, aspect);
    };

    // What stands around the detail may hide it: look from where most of it can be seen, from the usual side if it is
    // nearly as good.
    let usual = default_direction(up);
    let level = usual - usual.dot(up) * up;
    let side = level.dot(Vec3::X) * Vec3::X;
    let from_left = usual - 2.0 * side;
    let from_front = usual - side;
    let from_behind = 2.0 * usual.dot(up) * up - usual;
    [usual, from_left, from_front, level, level - side, from_behind]
        .into_iter()
        .map(|from| frame_bounds(&detail, from, up, aspect))
        .map(|camera| (visible_share(prepared, &detail, &camera), camera))
        .reduce(|best, next| if next.0 > best.0 + 0.15 { next } else { best })
        .map_or_else(|| frame_bounds(bounds, usual, up, aspect), |(_, camera)| camera)
}

/// The default camera, moved so near that the surfaces themselves (not only their box) fill the picture.
fn frame_surfaces(prepared: &PreparedScene<'_>, bounds: &Aabb, up: Vec3, aspect: f32) -> Camera {
    let nearest = Framing::new(bounds, default_direction(up), up, aspect);
    let centering = include_surfaces(prepared, bounds, nearest).centering();
    include_surfaces(prepared, bounds, centering).camera()
}

/// Includes all vertices of the mesh, and the corners of boxes around all spheres.
fn include_surfaces(prepared: &PreparedScene<'_>, bounds: &Aabb, empty: Framing) -> Framing {
    // A vertex that no triangle uses may lie anywhere; it counts only if it is where the surfaces are.
    let inside = |vertex: &&Vec3| {
        vertex.min(bounds.min) == bounds.min && vertex.max(bounds.max) == bounds.max
    };
    let scene = prepared.scene();
    // Where there are objects, the corners of triangles that stand in the world; else all vertices, of which nearly all are corners.
    let triangles = &scene.mesh.triangles;
    let own = scene.instances.own_triangles(triangles);
    let corners: Vec<_> = match scene.instances.is_empty() {
        true => Vec::new(),
        false => (0..own).flat_map(|triangle| triangles.corners(triangle)).collect(),
    };
    let vertices = if scene.instances.is_empty() { triangles.positions() } else { &corners };
    let mut framing = vertices
        .par_chunks(1 << 14)
        .map(|vertices| {
            let mut framing = empty.clone();
            vertices.iter().filter(inside).for_each(|&vertex| framing.include(vertex));
            framing
        })
        .reduce(|| empty.clone(), |a, b| a.merge(&b));

    let spheres = &scene.spheres;
    let around_spheres = (0..spheres.len() as u32).map(|sphere| spheres.bounds(sphere));
    for Aabb { min, max } in around_spheres.chain(instance_bounds(scene)) {
        for corner in 0..8 {
            let pick =
                |bit: u32, min: f32, max: f32| if corner >> bit & 1 == 0 { min } else { max };
            framing.include(Vec3::new(
                pick(0, min.x, max.x),
                pick(1, min.y, max.y),
                pick(2, min.z, max.z),
            ));
        }
    }
    framing
}

/// The boxes around instances, but empty ones.
fn instance_bounds(scene: &Scene) -> impl Iterator<Item = Aabb> {
    let bounds = scene.instances.bounds(&scene.mesh.triangles);
    bounds.into_iter().filter(|bounds| !bounds.is_empty())
}

/// The box around where nearly all primitives are, if it is much smaller than the whole: what stands on a wide floor, or
/// before a backdrop.
fn detail_bounds(prepared: &PreparedScene<'_>, bounds: &Aabb) -> Option<Aabb> {
    const MOST_SAMPLES: usize = 1 << 14;
    const FEWEST: usize = 500;
    let scene = prepared.scene();
    let centers: Vec<Vec3> = if scene.instances.is_empty() {
        let surfaces = PreparedScene::surfaces(scene);
        let step = surfaces.len().div_ceil(MOST_SAMPLES).max(1);
        let primitives = (0..surfaces.len()).step_by(step);
        primitives.map(|primitive| surfaces.bounds(primitive as u32).center()).collect()
    } else {
        instance_bounds(scene).map(|bounds| bounds.center()).collect()
    };
    if centers.len() < FEWEST {
        return None;
    }

    // All but a hundredth at either end of each axis, and some margin.
    let range = |axis: usize| {
        let mut values: Vec<f32> = centers.iter().map(|center| center[axis]).collect();
        values.sort_unstable_by(f32::total_cmp);
        let skip = values.len() / 100;
        (values[skip], values[values.len() - 1 - skip])
    };
    let [x, y, z] = [range(0), range(1), range(2)];
    let core = Aabb::new([x.0, y.0, z.0], [x.1, y.1, z.1]);
    let margin = Vec3::splat(0.15 * core.diagonal());
    let detail =
        Aabb::new((core.min - margin).max(bounds.min), (core.max + margin).min(bounds.max));
    (core.diagonal() > 0.0 && detail.diagonal() < 0.5 * bounds.diagonal()).then_some(detail)
}

/// The share of a camera's rays, of those that meet the box, that nothing stops before it.
fn visible_share(prepared: &PreparedScene<'_>, bounds: &Aabb, camera: &Camera) -> f32 {
    const SIZE: u32 = 24;
    let Ok(rays) = CameraRays::new(camera, SIZE, SIZE) else { return 0.0 };
    let (mut meet, mut visible) = (0, 0);
    for row in 0..SIZE {
        for column in 0..SIZE {
            let ray = rays.ray(column as f32 + 0.5, row as f32 + 0.5);
            let Some(entry) = entry(bounds, ray.origin, ray.direction) else { continue };
            meet += 1;
            visible += u32::from(!prepared.tracer().occluded(&ray.with_interval(0.0, entry)));
        }
    }
    visible as f32 / meet.max(1) as f32
}

/// Where a ray from outside enters a box.
fn entry(bounds: &Aabb, origin: Vec3, direction: Vec3) -> Option<f32> {
    let (mut near, mut far) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let a = (bounds.min[axis] - origin[axis]) / direction[axis];
        let b = (bounds.max[axis] - origin[axis]) / direction[axis];
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near < far && near > 0.0).then_some(near)
}
