//! Lights in the form that shading reads: the ambient ones added up, the others with direction and strength at a point.

use raywood::Vec3;
use raywood_scene::{Light, LightKind, Rgb};

/// The lights of a picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    /// All ambient lights together.
    pub(crate) ambient: Rgb,
    /// The others: those that cast shadows.
    pub(crate) directed: Vec<Light>,
}

/// A light as it is seen from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Illumination {
    /// Towards the light, unit length.
    pub(crate) direction: Vec3,
    /// What a white diffuse surface facing the light sends out.
    pub(crate) intensity: Rgb,
    /// Whether it shines there at all; else the rest means nothing.
    pub(crate) shines: bool,
}

impl Lights {
    /// Sorts the lights; those that are black, NaN or infinite are left out.
    pub(crate) fn new(lights: &[Light]) -> Self {
        let mut sorted = Self::default();
        for light in lights {
            if !(light.intensity.is_finite() && light.intensity.max_element() > 0.0) {
                continue;
            }
            match light.kind {
                LightKind::Ambient => sorted.ambient += light.intensity,
                _ => sorted.directed.push(light.clone()),
            }
        }
        sorted
    }
}

/// A loop over points that asks what a light brings to each.
pub(crate) trait OverPoints {
    /// Runs the loop. Must be `#[inline(always)]`.
    fn run(self, illuminate: impl Fn(Vec3) -> Illumination);
}

/// Runs a loop with what a light brings to a point, of a round one far away with its middle: one loop for each kind of light, so that none asks at every point which kind it is. Ambient
/// light brings nothing from anywhere.
#[inline(always)]
pub(crate) fn shine(light: &Light, points: impl OverPoints) {
    let intensity = light.intensity;
    match light.kind {
        LightKind::Point { position } => {
            points.run(|point| from_position(position, point, intensity));
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer } => points.run(|point| {
            let at_point = from_position(position, point, intensity);
            let share = cone_share(at_point.direction, direction, cos_inner, cos_outer);
            Illumination {
                intensity: share * at_point.intensity,
                shines: at_point.shines & (share > 0.0),
                ..at_point
            }
        }),
        LightKind::Directional { direction, .. } => {
            points.run(|_| Illumination { direction: -direction, intensity, shines: true });
        }
        LightKind::Ambient => {}
    }
}

/// The share of a spot light at its full strength that goes in a direction (from the point to the light); zero outside of its cone. The fall-off
/// that the glTF extension KHR_lights_punctual recommends.
#[inline(always)]
pub(crate) fn cone_share(to_light: Vec3, axis: Vec3, cos_inner: f32, cos_outer: f32) -> f32 {
    let cosine = -to_light.dot(axis);
    let inside = (cosine - cos_outer) / (cos_inner - cos_outer).max(1e-4);
    let inside = if inside < 1.0 { inside } else { 1.0 };
    if cosine > cos_outer { inside * inside } else { 0.0 }
}

/// A light at a position, seen from a point: it falls with the square of the distance.
#[inline(always)]
pub(crate) fn from_position(position: Vec3, point: Vec3, intensity: Rgb) -> Illumination {
    let towards = position - point;
    let distance = towards.length();
    let reciprocal = 1.0 / distance;
    let intensity = (reciprocal * intensity) * reciprocal;
    let direction = reciprocal * towards;
    // Nothing shines on the very point where it is, nor from farther than numbers reach. No `&&`, which would be a branch.
    let shines = (distance > 0.0) & (distance < f32::INFINITY);
    let finite = (intensity.x < f32::INFINITY) & (intensity.y < f32::INFINITY);
    let shines = shines & finite & (intensity.z < f32::INFINITY);
    Illumination { direction, intensity, shines }
}
