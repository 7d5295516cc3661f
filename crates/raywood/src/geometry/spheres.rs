//! Analytic spheres.

use std::fmt;

use super::chord::{Chord, Line};
use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::double::{add, dot, double, scale, single, single_distance, sub};
use crate::{Aabb, Hit, Ray, Vec3};

/// Spheres given by centre and radius, hit from outside and from inside. Checked once, when made.
///
/// Of a hit, `u` and `v` are zero: the point follows from the ray. Computed in double precision, so that small
/// spheres far away stay round.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spheres {
    spheres: Vec<(Vec3, f32)>,
}

/// Why an array does not describe spheres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SpheresError {
    /// The first sphere that is wrong.
    pub sphere: usize,
    /// Its centre.
    pub center: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl fmt::Display for SpheresError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sphere, center, radius } = self;
        let [x, y, z] = center.to_array();
        write!(
            f,
            "sphere {sphere} at ({x}, {y}, {z}) has radius {radius}: the centre must be finite, the radius finite and \
             not negative"
        )
    }
}

impl std::error::Error for SpheresError {}

impl Spheres {
    /// Spheres from centres and radii. A radius of zero is legal and never hit.
    ///
    /// # Errors
    ///
    /// A centre or extent that is NaN or infinite, a radius that is negative.
    pub fn new(spheres: Vec<(Vec3, f32)>) -> Result<Self, SpheresError> {
        match spheres.iter().position(|&(center, radius)| {
            !(radius >= 0.0 && sphere_bounds(center, radius).is_finite())
        }) {
            Some(sphere) => {
                let (center, radius) = spheres[sphere];
                Err(SpheresError { sphere, center, radius })
            }
            None => Ok(Self { spheres }),
        }
    }

    /// The centres and radii.
    pub fn as_slice(&self) -> &[(Vec3, f32)] {
        &self.spheres
    }

    /// The box around all spheres.
    pub fn total_bounds(&self) -> Aabb {
        self.spheres.iter().map(|&(c, r)| sphere_bounds(c, r)).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The part of a line inside a sphere.
    #[inline]
    fn chord(&self, primitive: u32, line: &Line) -> Option<Chord> {
        let (center, radius) = self.spheres[primitive as usize];
        Chord::of_ball(line, double(center), f64::from(radius))
    }
}

/// How thick a sphere's surface is where it is asked for cells that it passes through, per unit of its coordinates: some roundings of points on it.
const OVERLAP_SLACK: f64 = 8.0 * f32::EPSILON as f64;

/// The hit at a distance.
#[inline(always)]
fn at(t: f64) -> PrimitiveHit {
    PrimitiveHit { t: single_distance(t), u: 0.0, v: 0.0 }
}

/// The box around a sphere, rounded outwards.
fn sphere_bounds(center: Vec3, radius: f32) -> Aabb {
    let down = |x: f32| (x - radius).next_down();
    let up = |x: f32| (x + radius).next_up();
    Aabb {
        min: Vec3::new(down(center.x), down(center.y), down(center.z)),
        max: Vec3::new(up(center.x), up(center.y), up(center.z)),
    }
}

impl Geometry for Spheres {
    fn len(&self) -> usize {
        self.spheres.len()
    }

    #[inline]
    fn bounds(&self, primitive: u32) -> Aabb {
        let (center, radius) = self.spheres[primitive as usize];
        sphere_bounds(center, radius)
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        Some(self.spheres[primitive as usize])
    }

    /// Whether the surface passes through the cell: it does not where the cell lies inside, or beside the sphere in a corner of its box.
    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let (center, radius) = self.spheres[primitive as usize];
        if sphere_bounds(center, radius).intersection(cell).is_empty() {
            return false;
        }
        // The nearest and the farthest point of the cell.
        let (min, max) =
            (sub(double(cell.min), double(center)), sub(double(cell.max), double(center)));
        let near = [0, 1, 2].map(|i| min[i].max(-max[i]).max(0.0));
        let far = [0, 1, 2].map(|i| max[i].max(-min[i]));
        let slack = OVERLAP_SLACK * (f64::from(center.abs().max_element()) + f64::from(radius));
        dot(near, near).sqrt() <= f64::from(radius) + slack
            && f64::from(radius) - slack <= dot(far, far).sqrt()
    }

    fn has_sound_bounds(&self) -> bool {
        // Checked when they were made.
        true
    }

    #[inline]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        Some(at(self.chord(primitive, &ray.into())?.first(ray)?))
    }

    /// The closest point of the surface, from inside too. Of points equally close, as seen from the centre, one along x.
    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let (center, radius) = self.spheres[primitive as usize];
        let (center, radius) = (double(center), f64::from(radius));
        let outwards = sub(double(point), center);
        let distance = dot(outwards, outwards).sqrt();
        let offset =
            if distance > 0.0 { scale(radius / distance, outwards) } else { [radius, 0.0, 0.0] };
        let distance = (distance - radius).abs() as f32;
        Some(PrimitivePoint { point: single(add(center, offset)), distance, u: 0.0, v: 0.0 })
    }

    /// One inside, nothing outside.
    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        let (center, radius) = self.spheres[primitive as usize];
        let outwards = sub(double(point), double(center));
        let is_inside = dot(outwards, outwards) < f64::from(radius) * f64::from(radius);
        f64::from(u8::from(is_inside))
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        if let Some(chord) = self.chord(primitive, &ray.into()) {
            chord.all(ray, found, at);
        }
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (center, radius) = self.spheres[hit.primitive as usize];
        SurfacePoint::on_sphere(center, radius, ray.origin, ray.direction, hit.t)
    }
}
