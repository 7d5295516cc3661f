//! Light that comes straight from lights: which ones a surface asks, and how much they bring if nothing is in the way.

use std::f32::consts::PI;

use raywood::Vec3;
use raywood_scene::{Light, LightKind, Rgb, luminance};

use super::picture::Picture;
use super::scatter::{Decision, Dice};
use super::shadow_rays::{Extent, ShadowRays};
use super::walks::Walk;
use crate::bsdf::Bsdf;
use crate::bsdf::frame::ShadingFrame;
use crate::light_sampling::{Cone, LightSample};
use crate::lights::{Illumination, cone_share, from_position};
use crate::shading::{Surface, light_cosine};
use crate::shadows::Aim;

/// A place where a path scatters.
pub(super) struct Vertex<'a> {
    pub(super) surface: &'a Surface<'a>,
    /// The normal that the surface is shaded with, and the frame around it.
    pub(super) normal: Vec3,
    pub(super) frame: ShadingFrame,
    pub(super) bsdf: &'a Bsdf,
    pub(super) walk: &'a Walk,
    /// Whether the path may go on: else lights can be found only by asking.
    pub(super) goes_on: bool,
}

impl Vertex<'_> {
    /// Asks one of the lights without extent, a shining surface and the surroundings, and sends shadow rays to what would bring light.
    pub(super) fn ask_lights(&self, picture: &Picture<'_>, dice: Dice, shadows: &mut ShadowRays) {
        let [_, choice] = dice.pair(Decision::Part);
        self.ask_point(picture, choice, dice, shadows);
        let scene = picture.frame.scene;
        let [area_choice, part_choice] = dice.pair(Decision::Light);
        if let Some(area) = &picture.area {
            let (point, u) = (self.surface.point.position, dice.pair(Decision::LightPoint));
            if let Some(sample) = area.sample(scene, point, area_choice, u) {
                self.ask(picture, &sample, shadows);
            }
        }
        if let Some(environment) = &picture.environment {
            let u = dice.pair(Decision::Surroundings);
            self.ask(picture, &environment.sample(scene, part_choice, u), shadows);
        }
    }

    /// Asks one of the lights without extent, chosen by what it brings if nothing is in the way: by a reservoir of one, so that one pass does (Chao 1982).
    fn ask_point(
        &self,
        picture: &Picture<'_>,
        mut choice: f32,
        dice: Dice,
        shadows: &mut ShadowRays,
    ) {
        let position = self.surface.point.position;
        let mut total = 0.0;
        let mut chosen: Option<(&Light, Illumination, f32)> = None;
        for light in &picture.frame.lights.directed {
            let illumination = illumination(light, position);
            if !illumination.shines {
                continue;
            }
            // What is round may still be half above a horizon below which its middle is.
            let facing = illumination.direction.dot(self.surface.geometric_normal);
            let facing = facing + angular_radius(light);
            // Glass lets light from behind through.
            let facing = if self.bsdf.is_glass() { 1.0 } else { facing.max(0.0) };
            let weight = facing * luminance(illumination.intensity);
            if weight.is_nan() || weight <= 0.0 {
                continue;
            }
            total += weight;
            let probability = weight / total;
            if choice < probability {
                choice /= probability;
                chosen = Some((light, illumination, weight));
            } else {
                choice = (choice - probability) / (1.0 - probability);
            }
        }
        let Some((light, Illumination { direction, intensity, .. }, weight)) = chosen else {
            return;
        };
        // A white diffuse surface, which scatters by 1 / pi, would send back the intensity.
        let light_there = (PI * total / weight) * intensity;
        let angle = angular_radius(light);
        let (direction, aim) = if angle > 0.0 {
            let direction = Cone::of_half_angle(angle).sample(direction, dice.pair(Decision::Disc));
            (direction, Aim::Direction(direction))
        } else {
            (direction, Aim::at(light))
        };
        self.send(direction, light_there, aim, Extent::None, shadows);
    }

    /// Asks a light with extent.
    fn ask(&self, picture: &Picture<'_>, sample: &LightSample, shadows: &mut ShadowRays) {
        let &LightSample { direction, target, radiance, density } = sample;
        let scattering =
            if self.goes_on { self.bsdf.density(self.frame.to_local(direction)) } else { 0.0 };
        let weight = picture.strategy.weight_of_light(density, scattering) / density;
        let aim = target.map_or(Aim::Direction(direction), Aim::Point);
        self.send(direction, weight * radiance, aim, Extent::Some, shadows);
    }

    /// Sends a shadow ray to a light that is so bright from here.
    fn send(
        &self,
        direction: Vec3,
        light: Rgb,
        aim: Aim,
        extent: Extent,
        shadows: &mut ShadowRays,
    ) {
        let share = self.bent_share(direction);
        if share == 0.0 {
            return;
        }
        let answer = self.bsdf.eval(self.frame.to_local(direction));
        let brought = share * (self.walk.weight * answer * light);
        if brought.max_element() > 0.0 && brought.is_finite() {
            let origin = self.surface.point.origin_towards(direction);
            shadows.push(aim.ray_from(origin), aim, extent, self.walk.pixel, brought);
        }
    }

    /// How much of light from a direction counts: none where the true surface lies between, and less where the normal for shading would leave the edge of its shadow
    /// jagged: see [`light_cosine`].
    #[inline]
    pub(super) fn bent_share(&self, direction: Vec3) -> f32 {
        let shading = direction.dot(self.normal);
        let geometric = direction.dot(self.surface.geometric_normal);
        if shading > 0.0 && geometric > 0.0 {
            light_cosine(direction, self.normal, self.surface.geometric_normal) / shading
        } else if shading < 0.0 && geometric < 0.0 {
            1.0
        } else {
            0.0
        }
    }
}

/// Half the angle that a light takes up, which paths never meet by themselves: at most a quarter of a circle.
fn angular_radius(light: &Light) -> f32 {
    match light.kind {
        LightKind::Directional { angular_radius, .. } if angular_radius > 0.0 => {
            angular_radius.min(0.5 * PI)
        }
        _ => 0.0,
    }
}

/// A light without extent as it is seen from a point; of one that is round and far away the middle.
fn illumination(light: &Light, point: Vec3) -> Illumination {
    let intensity = light.intensity;
    match light.kind {
        LightKind::Point { position } => from_position(position, point, intensity),
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            let there = from_position(position, point, intensity);
            let share = cone_share(there.direction, direction, cos_inner, cos_outer);
            let shines = there.shines && share > 0.0;
            Illumination { intensity: share * there.intensity, shines, ..there }
        }
        LightKind::Directional { direction, .. } => {
            Illumination { direction: -direction, intensity, shines: true }
        }
        // The surroundings take its place.
        LightKind::Ambient => {
            Illumination { direction: Vec3::ZERO, intensity: Rgb::ZERO, shines: false }
        }
    }
}
