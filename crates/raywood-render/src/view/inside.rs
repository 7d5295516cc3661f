//! A camera and lights within a closed room.

use raywood::{Aabb, Ray, Vec3};
use raywood_scene::{Axes, Camera, Light, LightKind, Rgb, ambient};

use super::probes::Surroundings;
use super::setting::standpoints;
use crate::PreparedScene;
use crate::camera_rays::CameraRays;

/// The vertical field of view within rooms, in degrees: wide, since one cannot step back.
const FOV_Y: f32 = 55.0;

/// The best of some views: from each standpoint, stepped back towards the wall, in eight directions.
pub(super) fn camera(prepared: &PreparedScene<'_>, bounds: &Aabb, aspect: f32) -> Camera {
    let mut best: Option<(f32, Camera)> = None;
    let axes = prepared.axes();
    for point in standpoints(bounds, axes) {
        if Surroundings::of(prepared, point).fronts < 0.6 {
            continue;
        }
        for eighth in 0..8 {
            let (sin, cos) = (eighth as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
            let towards = cos * axes.across + sin * axes.along;
            let camera = stepped_back(prepared, bounds, point, towards);
            let score = score(prepared, bounds, &camera, aspect);
            if best.as_ref().is_none_or(|(best, _)| score > *best) {
                best = Some((score, camera));
            }
        }
    }
    match best {
        Some((_, camera)) => camera,
        None => stepped_back(prepared, bounds, bounds.center(), axes.across),
    }
}

/// A camera that looks along the level direction `towards` and a little down, from as far back as the room reaches.
fn stepped_back(prepared: &PreparedScene<'_>, bounds: &Aabb, point: Vec3, towards: Vec3) -> Camera {
    let diagonal = bounds.diagonal();
    let behind = prepared.tracer().intersect(&Ray::new(point, -towards));
    let room = behind.map_or(0.25 * diagonal, |hit| hit.t);
    let eye = point - 0.85 * room * towards;
    let up = prepared.axes().up;
    let target = eye + 0.3 * diagonal * (towards - 0.12 * up);
    Camera { name: String::new(), eye, target, up, fov_y: FOV_Y }
}

/// How much a view shows: depth, and many different surfaces; nothing right before the eye.
fn score(prepared: &PreparedScene<'_>, bounds: &Aabb, camera: &Camera, aspect: f32) -> f32 {
    const ROWS: u32 = 18;
    let columns = ((ROWS as f32 * aspect) as u32).clamp(1, 4 * ROWS);
    let Ok(rays) = CameraRays::new(camera, columns, ROWS) else { return f32::NEG_INFINITY };
    let longest = bounds.extent().max_element();
    let near = 0.04 * bounds.diagonal();

    let (mut depth, mut too_near, mut seen) = (0.0, 0, Vec::new());
    for row in 0..ROWS {
        for column in 0..columns {
            let ray = rays.ray(column as f32 + 0.5, row as f32 + 0.5);
            // The open sky counts as a distant wall would, no more.
            let Some(hit) = prepared.tracer().intersect(&ray) else {
                depth += 0.3;
                continue;
            };
            depth += (hit.t / longest).min(1.0);
            too_near += u32::from(hit.t < near);
            seen.push(hit.primitive);
        }
    }
    seen.sort_unstable();
    seen.dedup();
    (depth + 0.3 * seen.len() as f32 - 1.5 * too_near as f32) / (columns * ROWS) as f32
}

/// Lights for a room: some below its ceiling, along its length; a weak one beside the camera; ambient light; and the sun
/// where the roof is open.
///
/// Their strengths follow from how far away their surroundings are, so rooms of any size look alike.
pub(super) fn lights(prepared: &PreparedScene<'_>, bounds: &Aabb, camera: &Camera) -> Vec<Light> {
    let Axes { across, up, along } = *prepared.axes();
    let (reach_across, reach_along) = (Axes::reach(bounds, across), Axes::reach(bounds, along));
    let (length, width, lengthwise) = if reach_across >= reach_along {
        (reach_across, reach_along, across)
    } else {
        (reach_along, reach_across, along)
    };
    let places: &[f32] = if length > 1.5 * width { &[-0.22, 0.0, 0.22] } else { &[0.0] };

    let mut lights: Vec<Light> = places
        .iter()
        .filter_map(|&place| {
            let below = bounds.center() + place * length * lengthwise;
            below_ceiling(prepared, bounds, below)
        })
        .map(|(position, distance)| point_light("ceiling", position, 0.55 * distance * distance))
        .collect();

    // Beside the camera, so that its shadows show a little.
    let forward = (camera.target - camera.eye).normalize_or_zero();
    let right = forward.cross(camera.up).normalize_or_zero();
    let around = Surroundings::of(prepared, camera.eye);
    let view = if around.enclosed > 0.5 {
        around.distance
    } else {
        (bounds.center() - camera.eye).length()
    };
    let beside = camera.eye + 0.03 * view * (right + camera.up.normalize_or_zero());
    let fill = if lights.is_empty() { 0.8 } else { 0.25 };
    lights.push(point_light("fill", beside, fill * view * view));
    lights.push(ambient(0.3));

    // Where the roof is open the sun shines in, steeply and a little aslant.
    if !prepared.tracer().occluded(&Ray::new(bounds.center(), up)) {
        lights.push(Light {
            name: "sun".into(),
            kind: LightKind::directional(-(0.25 * across + up + 0.35 * along).normalize_or_zero()),
            intensity: Rgb::splat(0.9),
        });
    }
    lights
}

/// A good place for a lamp straight above a point: the most open one of some heights, with the mean distance of what
/// it lights. `None` if all of them lie within something.
fn below_ceiling(prepared: &PreparedScene<'_>, bounds: &Aabb, point: Vec3) -> Option<(Vec3, f32)> {
    let up = prepared.axes().up;
    let ceiling = prepared.tracer().intersect(&Ray::new(point, up));
    let to_top = 0.5 * Axes::reach(bounds, up) - (point - bounds.center()).dot(up);
    let height = ceiling.map_or(to_top, |hit| hit.t);
    [0.7, 0.5, 0.3]
        .into_iter()
        .map(|share| point + share * height * up)
        .map(|position| (position, Surroundings::of(prepared, position)))
        .filter(|(_, around)| around.fronts >= 0.6)
        .map(|(position, around)| (position, around.distance))
        .reduce(|best, next| if next.1 > 1.2 * best.1 { next } else { best })
}

fn point_light(name: &str, position: Vec3, strength: f32) -> Light {
    Light {
        name: name.into(),
        kind: LightKind::Point { position },
        intensity: Rgb::splat(strength),
    }
}
