//! How much of a light reaches a point: the shadow ray, which what is transparent colours and weakens.

use raywood::{Aabb, Hit, Ray, SurfacePoint, Vec3, Vectorized};
use raywood_scene::{Light, LightKind, Rgb};

use crate::PreparedScene;
use crate::fresnel::dielectric;
use crate::lights::{Illumination, cone_share, from_position};
use crate::surface_material::SurfaceMaterial;
use crate::textured::opacity_at;

/// More surfaces than this between a point and a light, and the light counts as hidden.
pub(crate) const MOST_CROSSINGS: u32 = 32;

/// Finds out which rays to a light may meet something that lets light through: for each ray a number that is zero where it cannot.
pub(crate) struct LightMayPass<'a> {
    /// Boxes outside of which nothing lets light through.
    pub(crate) bounds: &'a [Aabb],
    /// Where the rays go.
    pub(crate) aim: Aim,
    /// Where they start.
    pub(crate) origins: &'a [Vec3],
    /// As many as there are rays.
    pub(crate) answers: &'a mut [u32],
}

impl Vectorized for LightMayPass<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        const GROUP: usize = 16;
        for (places, answers) in self.origins.chunks(GROUP).zip(self.answers.chunks_mut(GROUP)) {
            // Sixteen rays in columns.
            let mut origins = [[0.0; GROUP]; 3];
            for (lane, origin) in places.iter().enumerate() {
                [origins[0][lane], origins[1][lane], origins[2][lane]] = origin.to_array();
            }
            let mut reciprocals = [[0.0; GROUP]; 3];
            for lane in 0..GROUP {
                let origin = Vec3::new(origins[0][lane], origins[1][lane], origins[2][lane]);
                let direction = self.aim.ray_from(origin).direction;
                reciprocals[0][lane] = 1.0 / direction.x;
                reciprocals[1][lane] = 1.0 / direction.y;
                reciprocals[2][lane] = 1.0 / direction.z;
            }

            let interval = [0.0, self.aim.ray_from(Vec3::ZERO).t_max];
            let mut may_pass = [0; GROUP];
            for bounds in self.bounds {
                for lane in 0..GROUP {
                    let [origin, reciprocal] = [&origins, &reciprocals].map(|columns| {
                        Vec3::new(columns[0][lane], columns[1][lane], columns[2][lane])
                    });
                    may_pass[lane] |= u32::from(may_cross(origin, reciprocal, interval, bounds));
                }
            }
            answers.copy_from_slice(&may_pass[..answers.len()]);
        }
    }
}

/// What a shadow ray meets that lets light through.
pub(crate) struct Passage {
    /// The share of the light that is let through.
    pub(crate) share: Rgb,
    /// Where the ray goes on.
    pub(crate) origin: Vec3,
}

/// What a ray towards a light hit lets through; `None` if it is opaque.
///
/// What is transparent lets light through in a straight line, unbent. Each surface takes its Fresnel reflection and tints
/// like a filter; the inside absorbs by its thickness. Bent light would gather in bright caustics, which Whitted's method
/// does not follow; straight light at least does not make glass black. Holes let all light through. With `opaque` nothing but holes lets light
/// through.
pub(crate) fn passage(
    prepared: &PreparedScene<'_>,
    (ray, time): (&Ray, f32),
    hit: &Hit,
    opaque: bool,
) -> Option<Passage> {
    let material = prepared.material_of(hit);
    let opacity = if material.perforated { opacity_at(prepared, hit) } else { 1.0 };
    let transmissive = material.transmissive && !opaque;
    if !transmissive && opacity >= 1.0 {
        return None;
    }
    let surface = prepared.tracer().surface_point(ray, hit, time);
    let length = ray.direction.length();
    let cosine = ray.direction.dot(surface.normal) / length;
    let share = if transmissive { filter(material, cosine, hit.t * length) } else { Rgb::ZERO };
    let share = if opacity < 1.0 { Rgb::splat(1.0 - opacity) + opacity * share } else { share };
    Some(Passage { share, origin: surface.origin_towards(ray.direction) })
}

/// The ray that asks whether a light reaches a surface; `None` where the light does not shine.
pub fn shadow_ray(light: &Light, point: &SurfacePoint) -> Option<Ray> {
    let towards = match light.kind {
        LightKind::Point { position } => {
            shining(from_position(position, point.position, light.intensity))?
        }
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            let towards = shining(from_position(position, point.position, light.intensity))?;
            let share = cone_share(towards, direction, cos_inner, cos_outer);
            if share > 0.0 { towards } else { return None }
        }
        LightKind::Directional { direction, .. } => -direction,
        LightKind::Ambient => return None,
    };
    Some(Aim::at(light).ray_from(point.origin_towards(towards)))
}

/// The direction to a light that shines.
fn shining(light: Illumination) -> Option<Vec3> {
    light.shines.then_some(light.direction)
}

/// Where the rays to a light go.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Aim {
    /// To one point.
    Point(Vec3),
    /// In one direction.
    Direction(Vec3),
}

impl Aim {
    /// The aim of the rays to a light.
    #[inline(always)]
    pub(crate) fn at(light: &Light) -> Self {
        match light.kind {
            LightKind::Point { position } | LightKind::Spot { position, .. } => {
                Self::Point(position)
            }
            LightKind::Directional { direction, .. } => Self::Direction(-direction),
            // It comes from all sides; nobody asks.
            LightKind::Ambient => Self::Direction(Vec3::ZERO),
        }
    }

    /// The ray from where shadow rays start.
    #[inline(always)]
    pub(crate) fn ray_from(self, origin: Vec3) -> Ray {
        match self {
            Self::Point(target) => Ray::short_of(origin, target),
            Self::Direction(direction) => Ray::new(origin, direction),
        }
    }
}

/// What one surface lets through, and what the inside in front of it absorbed if the ray comes from there.
///
/// `cosine` is between the ray and the surface's own normal; `length` is the way since the last surface. An unbent ray
/// has the same angle inside as outside, and the true one outside: Fresnel's reflection, which is the same from
/// either side, is computed from there.
fn filter(material: &SurfaceMaterial, cosine: f32, length: f32) -> Rgb {
    let eta = if material.ior >= 1.0 { 1.0 / material.ior } else { material.ior };
    let passed = (1.0 - dielectric(cosine.abs(), eta).reflectance) * material.transmission;
    if cosine > 0.0 { passed * transmittance(material.absorption, length) } else { passed }
}

/// What is left of light after some way through what absorbs it (Beer and Lambert).
#[inline]
pub(crate) fn transmittance(absorption: Rgb, length: f32) -> Rgb {
    if absorption == Rgb::ZERO {
        return Rgb::ONE;
    }
    let left = |a: f32| if a > 0.0 { (-a * length).exp() } else { 1.0 };
    Rgb::new(left(absorption.x), left(absorption.y), left(absorption.z))
}

/// Whether a ray may meet one of some boxes; false only if it cannot.
pub(crate) fn may_meet(ray: &Ray, bounds: &[Aabb]) -> bool {
    let Vec3 { x, y, z } = ray.direction;
    let reciprocal = Vec3::new(1.0 / x, 1.0 / y, 1.0 / z);
    let interval = [ray.t_min, ray.t_max];
    bounds.iter().any(|bounds| may_cross(ray.origin, reciprocal, interval, bounds))
}

/// Whether a ray may meet a box; false only if it cannot (Kay and Kajiya 1986, with a margin for rounding).
#[inline(always)]
fn may_cross(origin: Vec3, reciprocal: Vec3, [near, far]: [f32; 2], bounds: &Aabb) -> bool {
    let low = bounds.min - origin;
    let high = bounds.max - origin;
    let reach = low.abs().max(high.abs());
    let margin = 16.0 * f32::EPSILON * reach.x.max(reach.y).max(reach.z);
    let margin = Vec3::splat(margin);
    let a = (low - margin) * reciprocal;
    let b = (high + margin) * reciprocal;
    // NaN (in the plane of a face, along it) leaves the interval as it is.
    let near = near.max(a.x.min(b.x)).max(a.y.min(b.y)).max(a.z.min(b.z));
    let far = far.min(a.x.max(b.x)).min(a.y.max(b.y)).min(a.z.max(b.z));
    near <= far
}
