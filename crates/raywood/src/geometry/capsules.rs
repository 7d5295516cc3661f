//! Capsules: segments with thickness and round ends.

use super::around_axis::{ball_around, bounds_around, capsule_overlaps, clipped_bounds_around};
use super::chord::{Chord, Line};
use super::shape_error::{ShapeError, ShapeProblem, check, radius_problem};
use super::surface::ROUND_CLEARANCE;
use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::double::{
    Double3, add, dot, double, scale, share_along, single, single_distance, some_unit_across, sub,
    unit_or,
};
use crate::simd::prefetch_item;
use crate::{Aabb, Hit, Ray, Vec3};

/// All points no further than a radius from a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Where the segment starts.
    pub start: Vec3,
    /// Where it ends; the same point makes the capsule a sphere.
    pub end: Vec3,
    /// Half of its thickness; greater than zero.
    pub radius: f32,
}

impl Capsule {
    /// The capsule around the segment from `start` to `end`.
    pub fn new(start: impl Into<[f32; 3]>, end: impl Into<[f32; 3]>, radius: f32) -> Self {
        Self { start: start.into().into(), end: end.into().into(), radius }
    }

    /// The capsules along a line of points, joined roundly, one less than there are points: hair, wires, curves.
    pub fn along<P: Copy + Into<[f32; 3]>>(
        points: &[P],
        radius: f32,
    ) -> impl Iterator<Item = Self> {
        points.windows(2).map(move |pair| Self::new(pair[0], pair[1], radius))
    }

    fn axis(&self) -> Double3 {
        sub(double(self.end), double(self.start))
    }

    /// The point of the segment that is closest to another, as a share of the way and as it is.
    #[inline]
    fn foot(&self, point: Double3) -> (f64, Double3) {
        let (start, axis) = (double(self.start), self.axis());
        let share = share_along(point, start, axis);
        (share, add(start, scale(share, axis)))
    }

    /// The part of a line inside.
    #[inline]
    fn chord(&self, line: &Line) -> Option<Chord> {
        let (start, end, axis) = (double(self.start), double(self.end), self.axis());
        let radius = f64::from(self.radius);
        if dot(axis, axis) == 0.0 {
            return Chord::of_ball(line, start, radius);
        }
        // Everything lies within the cylinder without ends. Where that is entered and left between the ends nothing else matters.
        let tube = Chord::of_tube(line, start, axis, radius)?;
        let between = Chord::between_planes(line, axis, start, end);
        let side = between.and_then(|between| tube.and(between));
        if let Some(side) = side
            && side.enter == tube.enter
            && side.leave == tube.leave
        {
            return Some(side);
        }
        let balls = [start, end].map(|center| Chord::of_ball(line, center, radius));
        [side, balls[0], balls[1]].into_iter().flatten().reduce(Chord::or)
    }

    fn reach(&self) -> Double3 {
        [f64::from(self.radius); 3]
    }

    fn bounds(&self) -> Aabb {
        bounds_around(self.start, self.end, self.reach())
    }
}

/// Capsules, cylinders with round ends: line segments with thickness, hair, wires, bones. Closed surfaces, hit from outside and from inside. Checked once, when made.
///
/// Of a hit, `u` is how far along the segment its foot lies, from 0 at the start (and at all of the cap around it) to 1 at the end; `v` is zero. Computed in double
/// precision, so that thin ones far away stay round.
///
/// ```
/// use raywood::{Bvh, Capsule, Capsules, Ray};
///
/// let wire = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]];
/// let wire = Capsules::new(Capsule::along(&wire, 0.5).collect())?;
/// let bvh = Bvh::build(&wire)?;
/// let hit = bvh.intersect(&Ray::new([4.0, 3.0, 2.0], [0.0, 0.0, -1.0])).expect("the second half");
/// assert_eq!((hit.primitive, hit.t, hit.u), (1, 1.5, 0.75));
/// assert!(bvh.solid().contains([-0.4, 0.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capsules {
    capsules: Vec<Capsule>,
}

impl Capsules {
    /// Capsules; those without length are spheres.
    ///
    /// # Errors
    ///
    /// A coordinate that is NaN or infinite, a radius that is not greater than zero and finite, or an extent beyond the largest number: the first such capsule is named.
    pub fn new(capsules: Vec<Capsule>) -> Result<Self, ShapeError> {
        check("capsule", &capsules, |capsule| {
            if !(capsule.start.is_finite() && capsule.end.is_finite()) {
                return Some(ShapeProblem::NotFinite);
            }
            radius_problem(capsule.radius)
                .or((!capsule.bounds().is_finite()).then_some(ShapeProblem::TooLarge))
        })?;
        Ok(Self { capsules })
    }

    /// The capsules.
    pub fn as_slice(&self) -> &[Capsule] {
        &self.capsules
    }
}

/// The hit at a distance.
#[inline]
fn hit_at(capsule: &Capsule, line: &Line, t: f64) -> PrimitiveHit {
    let (share, _) = capsule.foot(add(line.origin, scale(t, line.direction)));
    PrimitiveHit { t: single_distance(t), u: share as f32, v: 0.0 }
}

impl Geometry for Capsules {
    fn len(&self) -> usize {
        self.capsules.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.capsules[primitive as usize].bounds()
    }

    fn has_sound_bounds(&self) -> bool {
        // Checked when they were made.
        true
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        let capsule = &self.capsules[primitive as usize];
        clipped_bounds_around(capsule.start, capsule.end, capsule.reach(), cell)
    }

    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let Capsule { start, end, radius } = self.capsules[primitive as usize];
        !self.bounds(primitive).intersection(cell).is_empty()
            && capsule_overlaps(start, end, radius, cell)
    }

    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.capsules, primitive as usize);
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let capsule = &self.capsules[primitive as usize];
        let half = scale(0.5, capsule.axis());
        let reach = dot(half, half).sqrt() + f64::from(capsule.radius);
        ball_around(add(double(capsule.start), half), reach)
    }

    #[inline]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        let (capsule, line) = (&self.capsules[primitive as usize], Line::from(ray));
        Some(hit_at(capsule, &line, capsule.chord(&line)?.first(ray)?))
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        let (capsule, line) = (&self.capsules[primitive as usize], Line::from(ray));
        if let Some(chord) = capsule.chord(&line) {
            chord.all(ray, found, |t| hit_at(capsule, &line, t));
        }
    }

    /// The closest point of the surface, from inside too. Of points equally close, as seen from the segment, any.
    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let capsule = &self.capsules[primitive as usize];
        let point = double(point);
        let (share, foot) = capsule.foot(point);
        let outwards = sub(point, foot);
        let radius = f64::from(capsule.radius);
        let normal = unit_or(outwards, some_unit_across(capsule.axis()));
        Some(PrimitivePoint {
            point: single(add(foot, scale(radius, normal))),
            distance: (dot(outwards, outwards).sqrt() - radius).abs() as f32,
            u: share as f32,
            v: 0.0,
        })
    }

    /// One inside, nothing outside.
    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        let capsule = &self.capsules[primitive as usize];
        let point = double(point);
        let outwards = sub(point, capsule.foot(point).1);
        let is_inside = dot(outwards, outwards).sqrt() < f64::from(capsule.radius);
        f64::from(u8::from(is_inside))
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (capsule, line) = (&self.capsules[hit.primitive as usize], Line::from(ray));
        // Computed again, as the distance of a hit is as wrong as the ray is long.
        let t = capsule.chord(&line).map_or(f64::from(hit.t), |chord| chord.end_at(hit.t));
        let point = add(line.origin, scale(t, line.direction));
        let (_, foot) = capsule.foot(point);
        let normal = unit_or(sub(point, foot), some_unit_across(capsule.axis()));
        let largest = capsule.start.abs().max(capsule.end.abs()).max_element();
        SurfacePoint {
            position: single(add(foot, scale(f64::from(capsule.radius), normal))),
            normal: single(normal),
            clearance: ROUND_CLEARANCE * (largest + capsule.radius),
        }
    }
}
