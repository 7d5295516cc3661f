//! Punctual lights of glTF (`KHR_lights_punctual`).
//!
//! Units: glTF has lux for directional lights (the illuminance E of a surface that faces the light), and candela for points and
//! spots (E times the square of the distance). A white diffuse surface sends out E / pi, which is what a [`Light`]'s
//! intensity is, so both are divided by pi. A photograph has an exposure, and glTF does not say which: where the lights together
//! would leave the middle of the scene far too bright or too dark, they are all scaled alike, and a warning says so.

use std::f32::consts::PI;

use gltf_json::extensions::scene::khr_lights_punctual::{Light as Source, Type};
use gltf_json::validation::Checked;
use raywood::Vec3;

use super::document::Document;
use super::node::Instance;
use crate::formats::notes::Notes;
use crate::{Light, LightKind, Rgb, luminance};

/// How bright white surfaces in the middle of the scene may be without the lights being scaled.
const EXPOSURE: std::ops::RangeInclusive<f32> = 0.05..=5.0;

/// The lights of a scene.
pub(super) fn lights(
    document: &Document<'_>,
    instances: &[Instance<'_>],
    center_and_radius: &dyn Fn() -> (Vec3, f32),
    notes: &mut Notes,
) -> Vec<Light> {
    let sources: &[Source] = document.root.as_ref();
    let mut lights = Vec::new();
    for Instance { node, to_world, .. } in instances.iter().filter(|i| !i.is_copy) {
        let extension = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(source) = extension.and_then(|e| sources.get(e.light.value())) else { continue };

        // A light shines along its -z.
        let position = to_world.point([0.0; 3]);
        let direction = to_world.direction([0.0, 0.0, -1.0]);
        let color = Rgb::from(source.color.map(|c| if c.is_finite() { c.max(0.0) } else { 1.0 }));
        let strength = if source.intensity.is_finite() { source.intensity.max(0.0) } else { 0.0 };
        let kind = match (source.type_, &source.spot) {
            (Checked::Valid(Type::Directional), _) => LightKind::directional(direction),
            (Checked::Valid(Type::Spot), Some(spot)) => {
                let outer = spot.outer_cone_angle.clamp(0.001, 0.5 * PI);
                let inner = spot.inner_cone_angle.clamp(0.0, outer * 0.999);
                let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
                LightKind::Spot { position, direction, cos_inner, cos_outer }
            }
            _ => LightKind::Point { position },
        };
        if !position.is_finite() || direction == Vec3::ZERO {
            notes.say("a light is left out: its node's matrix puts it nowhere");
            continue;
        }
        let name = source.name.clone().or_else(|| node.name.clone()).unwrap_or_default();
        lights.push(Light { name, kind, intensity: (strength / PI) * color });
    }
    if !lights.is_empty() {
        expose(&mut lights, center_and_radius(), notes);
    }
    lights
}

/// Scales all lights if the middle of the scene would be white or black all over.
fn expose(lights: &mut [Light], (center, radius): (Vec3, f32), notes: &mut Notes) {
    let reaching = |light: &Light| {
        let falloff = match light.kind {
            LightKind::Point { position } | LightKind::Spot { position, .. } => {
                let distance = (center - position).length().max(0.25 * radius);
                1.0 / (distance * distance)
            }
            LightKind::Directional { .. } | LightKind::Ambient => 1.0,
        };
        luminance(light.intensity) * falloff
    };
    let brightness: f32 = lights.iter().map(reaching).sum();
    if brightness > 0.0 && brightness.is_finite() && !EXPOSURE.contains(&brightness) {
        let factor = 1.0 / brightness;
        for light in lights {
            light.intensity = factor * light.intensity;
        }
        notes.say(format!("the lights are scaled by {factor:.3e} to expose the picture"));
    }
}
