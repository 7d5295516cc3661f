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

/// The light as seen from `point`, or `None` where it does not shine.
#[inline]
pub(crate) fn illuminate(light: &Light, point: Vec3) -> Option<Illumination> {
    match light.kind {
        LightKind::Point { position } => from_position(position, point, light.intensity),
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            let mut at_point = from_position(position, point, light.intensity)?;
            let cosine = -at_point.direction.dot(direction);
            if cosine <= cos_outer {
                return None;
            }
            // The fall-off that the glTF extension KHR_lights_punctual recommends.
            let inside = ((cosine - cos_outer) / (cos_inner - cos_outer).max(1e-4)).min(1.0);
            at_point.intensity *= inside * inside;
            Some(at_point)
        }
        LightKind::Directional { direction } => {
            Some(Illumination { direction: -direction, intensity: light.intensity })
        }
        LightKind::Ambient => None,
    }
}

/// A light at a position, seen from a point: it falls with the square of the distance.
#[inline]
fn from_position(position: Vec3, point: Vec3, intensity: Rgb) -> Option<Illumination> {
    let towards = position - point;
    let distance = towards.length();
    // Nothing shines on the very point where it is, nor from farther than numbers reach.
    if !(distance > 0.0 && distance.is_finite()) {
        return None;
    }
    let reciprocal = 1.0 / distance;
    let intensity = (reciprocal * intensity) * reciprocal;
    let direction = reciprocal * towards;
    intensity.is_finite().then_some(Illumination { direction, intensity })
}
