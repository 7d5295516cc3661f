//! Surfaces that send out light: triangles and spheres, chosen by their power.
//!
//! Points of triangles are chosen evenly, of spheres those that are seen, by the [cone](Cone) around them.

use std::f32::consts::PI;

use raywood::{Hit, Vec3};
use raywood_scene::luminance;

use super::cone::Cone;
use super::{AliasTable, LightSample};
use crate::PreparedScene;
use crate::instanced::Placed;
use crate::prepared::{Element, Which};
use crate::textured::emission_at;

/// All surfaces of a scene that send out light.
pub(crate) struct AreaLights {
    elements: Vec<Element>,
    table: AliasTable,
    /// Of each material the probability that a point is chosen, per unit of area; zero of what is dark.
    densities: Vec<f32>,
}

/// A point that lies on a light, as it is seen from another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit {
    pub(crate) element: Element,
    /// When it is seen, if anything moves.
    pub(crate) time: f32,
    /// How far away it is.
    pub(crate) distance: f32,
    /// The cosine between the way and the surface's normal, at least zero.
    pub(crate) cosine: f32,
}

impl AreaLights {
    /// Those of the scene; `None` if nothing sends out light. O(primitives).
    pub(crate) fn new(scene: &PreparedScene<'_>) -> Option<Self> {
        let powers: Vec<f64> = (0..scene.material_count())
            .map(|material| f64::from(luminance(scene.mean_emission(material))))
            .collect();
        if powers.iter().all(|&power| power <= 0.0) {
            return None;
        }
        let mut elements = Vec::new();
        let mut weights = Vec::new();
        for element in scene.elements() {
            let power = powers[scene.material_index(element)];
            let weight = if power > 0.0 { power * area(scene, element) } else { 0.0 };
            if weight > 0.0 {
                elements.push(element);
                weights.push(weight);
            }
        }
        let table = AliasTable::new(&weights)?;
        let densities = powers.iter().map(|power| (power / table.total()) as f32).collect();
        Some(Self { elements, table, densities })
    }

    /// Chooses a point that light comes from to `point` at a time; `None` where it chose one that sends none there. `choice` and `u` are random numbers.
    pub(crate) fn sample(
        &self,
        scene: &PreparedScene<'_>,
        (point, time): (Vec3, f32),
        choice: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let element = self.elements[self.table.choose(choice)];
        let per_area = self.densities[scene.material_index(element)];
        let Element { primitive, instance } = element;
        match scene.which(primitive) {
            Which::Triangle(triangle) => {
                let [u, v] = even_barycentrics(u);
                let [p0, p1, p2] = scene.corners(triangle, instance, time);
                let target = (1.0 - u - v) * p0 + u * p1 + v * p2;
                let normal = (p1 - p0).cross(p2 - p0).normalize_or_zero();
                let per_area = per_area * shrunk(scene, triangle, instance, time);
                let way = target - point;
                let distance = way.length();
                let direction = way / distance;
                let cosine = direction.dot(normal).abs();
                let density = per_area * distance * distance / cosine;
                let radiance = emission_at(scene, &Hit { t: 0.0, u, v, primitive, instance });
                let is_sound = cosine > 0.0 && density > 0.0 && density.is_finite();
                is_sound.then_some(LightSample { direction, target, radiance, density })
            }
            Which::Sphere(sphere) => {
                let (center, radius) = scene.scene().spheres.as_slice()[sphere as usize];
                let radiance = scene.material_of(element).emission;
                let way = center - point;
                let distance = way.length();
                let cone = Cone::around_sphere(distance, radius)?;
                let direction = cone.sample(way / distance, u);
                // Where the cone's ray enters the sphere; at its rim it may just miss.
                let along = direction.dot(way);
                let inside = (radius * radius - (distance * distance - along * along)).max(0.0);
                let target = point + (along - inside.sqrt()) * direction;
                let density = per_area * 4.0 * PI * radius * radius / cone.solid_angle();
                let is_sound = density > 0.0 && density.is_finite();
                is_sound.then_some(LightSample { direction, target, radiance, density })
            }
        }
    }

    /// The density by solid angle with which [`sample`](Self::sample) chooses a point, as it is seen from another.
    pub(crate) fn density(&self, scene: &PreparedScene<'_>, lit: Lit) -> f32 {
        let Lit { element, time, distance, cosine } = lit;
        let per_area = self.densities[scene.material_index(element)];
        match scene.which(element.primitive) {
            Which::Triangle(triangle) if cosine > 0.0 => {
                let per_area = per_area * shrunk(scene, triangle, element.instance, time);
                per_area * distance * distance / cosine
            }
            Which::Triangle(_) => 0.0,
            Which::Sphere(sphere) => {
                let (_, radius) = scene.scene().spheres.as_slice()[sphere as usize];
                // The distance of the centre follows from that of a point and its angle.
                let squared =
                    distance * distance + radius * radius + 2.0 * distance * radius * cosine;
                Cone::around_sphere(squared.sqrt(), radius)
                    .map_or(0.0, |cone| per_area * 4.0 * PI * radius * radius / cone.solid_angle())
            }
        }
    }
}

/// Barycentric weights of a point of a triangle, evenly distributed: Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
fn even_barycentrics([u, v]: [f32; 2]) -> [f32; 2] {
    if v > u { [0.5 * u, v - 0.5 * u] } else { [u - 0.5 * v, 0.5 * v] }
}

/// How much larger a triangle was at time 0, when it was weighed: 1 where nothing moves.
#[inline]
fn shrunk(scene: &PreparedScene<'_>, triangle: u32, instance: u32, time: f32) -> f32 {
    if !scene.placed(instance).is_some_and(Placed::moves) {
        return 1.0;
    }
    let [first, now] = [0.0, time].map(|time| {
        let [p0, p1, p2] = scene.corners(triangle, instance, time);
        (p1 - p0).cross(p2 - p0).length()
    });
    first / now
}

/// The area of an element, at time 0.
fn area(scene: &PreparedScene<'_>, element: Element) -> f64 {
    match scene.which(element.primitive) {
        Which::Triangle(triangle) => {
            let [p0, p1, p2] = scene.corners(triangle, element.instance, 0.0);
            0.5 * f64::from((p1 - p0).cross(p2 - p0).length())
        }
        Which::Sphere(sphere) => {
            let (_, radius) = scene.scene().spheres.as_slice()[sphere as usize];
            4.0 * std::f64::consts::PI * f64::from(radius) * f64::from(radius)
        }
    }
}
