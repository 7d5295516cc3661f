//! Flat discs.

use super::around_axis::{bounds_around, clipped_bounds_around, disc_reach, overlap_slack};
use super::chord::Line;
use super::shape_error::{ShapeError, ShapeProblem, check, radius_problem};
use super::surface::ROUND_CLEARANCE;
use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::double::{Double3, add, dot, double, scale, single, single_distance, sub};
use crate::simd::prefetch_item;
use crate::{Aabb, Hit, Ray, Vec3};

/// A flat, round disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its middle.
    pub center: Vec3,
    /// The direction that it faces, of any length but zero.
    pub normal: Vec3,
    /// How far it reaches from the middle; greater than zero.
    pub radius: f32,
}

impl Disc {
    /// The disc around a centre that faces along a normal, which need not be of unit length.
    pub fn new(center: impl Into<[f32; 3]>, normal: impl Into<[f32; 3]>, radius: f32) -> Self {
        Self { center: center.into().into(), normal: normal.into().into(), radius }
    }
}

/// Flat discs, hit from both sides: splats of point clouds, wheels, lids. Checked once, when made.
///
/// A disc is what lies in the plane through its centre across its normal, as that is rounded to unit length, no further than the radius from the centre. A ray
/// in the plane does not hit it. Of a hit, `u` is the distance from the centre as a share of the radius, `v` is zero. The [front](crate::Face::Front) is
/// the side that the normal points to. Computed in double precision.
///
/// ```
/// use raywood::{Bvh, Disc, Discs, Ray};
///
/// let discs = Discs::new(vec![Disc::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0], 2.0)])?;
/// let bvh = Bvh::build(&discs)?;
/// let hit = bvh.intersect(&Ray::new([0.0, 1.0, 0.0], [0.0, 0.0, 1.0])).expect("it is in the way");
/// assert_eq!((hit.t, hit.u), (5.0, 0.5));
/// assert!(!bvh.occluded(&Ray::new([0.0, 2.1, 0.0], [0.0, 0.0, 1.0])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Discs {
    discs: Vec<Disc>,
}

impl Discs {
    /// Discs, their normals brought to unit length.
    ///
    /// # Errors
    ///
    /// A coordinate that is NaN or infinite, a normal that is zero, a radius that is not greater than zero and finite, or an extent beyond the largest number: the
    /// first such disc is named.
    pub fn new(mut discs: Vec<Disc>) -> Result<Self, ShapeError> {
        check("disc", &discs, |disc| {
            if !(disc.center.is_finite() && disc.normal.is_finite()) {
                return Some(ShapeProblem::NotFinite);
            }
            if disc.normal == Vec3::ZERO {
                return Some(ShapeProblem::NoDirection);
            }
            radius_problem(disc.radius)
                .or((!bounds(disc).is_finite()).then_some(ShapeProblem::TooLarge))
        })?;
        discs.iter_mut().for_each(|disc| disc.normal = disc.normal.normalize_or_zero());
        Ok(Self { discs })
    }

    /// The discs, their normals of unit length.
    pub fn as_slice(&self) -> &[Disc] {
        &self.discs
    }

    /// Where a line meets the plane of a disc: how far along it, and the point seen from the centre.
    #[inline]
    fn on_plane(&self, disc: u32, line: &Line) -> Option<(f64, Double3)> {
        let Disc { center, normal, .. } = self.discs[disc as usize];
        let (to_center, normal) = (sub(double(center), line.origin), double(normal));
        let speed = dot(line.direction, normal);
        if speed == 0.0 {
            return None;
        }
        let t = dot(to_center, normal) / speed;
        Some((t, sub(scale(t, line.direction), to_center)))
    }

    /// A point, seen from the centre of a disc, moved into its plane.
    fn flattened(&self, disc: u32, offset: Double3) -> Double3 {
        let normal = double(self.discs[disc as usize].normal);
        sub(offset, scale(dot(offset, normal) / dot(normal, normal), normal))
    }
}

fn reach(disc: &Disc) -> Double3 {
    disc_reach(double(disc.normal), f64::from(disc.radius))
}

fn bounds(disc: &Disc) -> Aabb {
    bounds_around(disc.center, disc.center, reach(disc))
}

impl Geometry for Discs {
    fn len(&self) -> usize {
        self.discs.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        bounds(&self.discs[primitive as usize])
    }

    fn has_sound_bounds(&self) -> bool {
        // Checked when they were made.
        true
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        let disc = &self.discs[primitive as usize];
        clipped_bounds_around(disc.center, disc.center, reach(disc), cell)
    }

    /// Whether its plane and the ball around it both meet the cell, and its box.
    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let disc = &self.discs[primitive as usize];
        let shared = bounds(disc).intersection(cell);
        if shared.is_empty() {
            return false;
        }
        let (center, normal) = (double(disc.center), double(disc.normal));
        let slack = overlap_slack(disc.center, disc.center, disc.radius);
        let (min, max) = (sub(double(shared.min), center), sub(double(shared.max), center));
        let near = [0, 1, 2].map(|i| min[i].max(-max[i]).max(0.0));
        let [mut lowest, mut highest] = [-slack, slack];
        for i in 0..3 {
            let (a, b) = (min[i] * normal[i], max[i] * normal[i]);
            (lowest, highest) = (lowest + a.min(b), highest + a.max(b));
        }
        lowest <= 0.0 && 0.0 <= highest && dot(near, near).sqrt() <= f64::from(disc.radius) + slack
    }

    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.discs, primitive as usize);
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let Disc { center, radius, .. } = self.discs[primitive as usize];
        Some((center, radius))
    }

    #[inline]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        let (t, offset) = self.on_plane(primitive, &ray.into())?;
        let share = dot(offset, offset).sqrt() / f64::from(self.discs[primitive as usize].radius);
        let t = single_distance(t);
        (share <= 1.0 && ray.accepts(t)).then_some(PrimitiveHit { t, u: share as f32, v: 0.0 })
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        self.intersect(primitive, ray).into_iter().for_each(found);
    }

    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let Disc { center, radius, .. } = self.discs[primitive as usize];
        let (center, radius) = (double(center), f64::from(radius));
        let to_point = sub(double(point), center);
        let across = self.flattened(primitive, to_point);
        let share = dot(across, across).sqrt() / radius;
        let across = if share > 1.0 { scale(1.0 / share, across) } else { across };
        let away = sub(to_point, across);
        Some(PrimitivePoint {
            point: single(add(center, across)),
            distance: dot(away, away).sqrt() as f32,
            u: share.min(1.0) as f32,
            v: 0.0,
        })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let Disc { center, normal, radius } = self.discs[hit.primitive as usize];
        // Computed again, as the distance of a hit is as wrong as the ray is long.
        let (_, offset) = self.on_plane(hit.primitive, &ray.into()).unwrap_or_default();
        SurfacePoint {
            position: single(add(double(center), self.flattened(hit.primitive, offset))),
            normal,
            clearance: ROUND_CLEARANCE * (center.abs().max_element() + radius),
        }
    }
}
