//! Cylinders with flat ends.

use super::around_axis::{
    ball_around, bounds_around, capsule_touches, clipped_bounds_around, corners, disc_reach,
    overlap_slack,
};
use super::chord::{Chord, Line};
use super::shape_error::{ShapeError, ShapeProblem, check, radius_problem};
use super::surface::ROUND_CLEARANCE;
use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::double::{
    Double3, add, dot, double, scale, single, single_distance, some_unit_across, sub, unit_or,
};
use crate::simd::prefetch_item;
use crate::{Aabb, Hit, Ray, Vec3};

/// A cylinder with flat ends across its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// The middle of one end.
    pub start: Vec3,
    /// The middle of the other end, elsewhere.
    pub end: Vec3,
    /// The distance of the side from the axis; greater than zero.
    pub radius: f32,
}

/// A point as a cylinder sees it.
struct Seen {
    /// How far along the axis it lies: 0 at the start, 1 at the end.
    share: f64,
    /// The point of the axis' line that is closest.
    foot: Double3,
    /// The way from there to the point.
    outwards: Double3,
}

impl Cylinder {
    /// The cylinder around the segment from `start` to `end`.
    pub fn new(start: impl Into<[f32; 3]>, end: impl Into<[f32; 3]>, radius: f32) -> Self {
        Self { start: start.into().into(), end: end.into().into(), radius }
    }

    fn axis(&self) -> Double3 {
        sub(double(self.end), double(self.start))
    }

    #[inline]
    fn see(&self, point: Double3) -> Seen {
        let (start, axis) = (double(self.start), self.axis());
        let share = dot(sub(point, start), axis) / dot(axis, axis);
        let foot = add(start, scale(share, axis));
        Seen { share, foot, outwards: sub(point, foot) }
    }

    /// The parts of a line within the sides and between the ends; the line is inside where both are.
    #[inline]
    fn chords(&self, line: &Line) -> Option<[Chord; 2]> {
        let (start, end, axis) = (double(self.start), double(self.end), self.axis());
        let tube = Chord::of_tube(line, start, axis, f64::from(self.radius))?;
        Some([tube, Chord::between_planes(line, axis, start, end)?])
    }

    /// The part of a line inside.
    #[inline]
    fn chord(&self, line: &Line) -> Option<Chord> {
        let [tube, between] = self.chords(line)?;
        tube.and(between)
    }

    fn reach(&self) -> Double3 {
        disc_reach(self.axis(), f64::from(self.radius))
    }

    fn bounds(&self) -> Aabb {
        bounds_around(self.start, self.end, self.reach())
    }

    fn contains(&self, point: Double3) -> bool {
        let Seen { share, outwards, .. } = self.see(point);
        0.0 < share && share < 1.0 && dot(outwards, outwards).sqrt() < f64::from(self.radius)
    }
}

/// Cylinders with flat ends: closed surfaces, hit from outside and from inside. Checked once, when made.
///
/// Of a hit, `u` is how far along the axis it lies, from 0 at the start to 1 at the end; `v` is zero. Computed in double precision, so that thin ones far away stay
/// round. Round ends have [`Capsules`](crate::Capsules).
///
/// ```
/// use raywood::{Bvh, Cylinder, Cylinders, Ray};
///
/// let columns = Cylinders::new(vec![Cylinder::new([0.0, 0.0, 0.0], [0.0, 8.0, 0.0], 1.0)])?;
/// let bvh = Bvh::build(&columns)?;
/// let hit = bvh.intersect(&Ray::new([0.0, 2.0, 5.0], [0.0, 0.0, -1.0])).expect("its side");
/// assert_eq!((hit.t, hit.u), (4.0, 0.25));
/// let hit = bvh.intersect(&Ray::new([0.5, 9.0, 0.0], [0.0, -1.0, 0.0])).expect("its top");
/// assert_eq!((hit.t, hit.u), (1.0, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cylinders {
    cylinders: Vec<Cylinder>,
}

impl Cylinders {
    /// Cylinders from the middles of their ends.
    ///
    /// # Errors
    ///
    /// A coordinate that is NaN or infinite, both ends at the same point, a radius that is not greater than zero and finite, or an extent beyond the largest number: the
    /// first such cylinder is named.
    pub fn new(cylinders: Vec<Cylinder>) -> Result<Self, ShapeError> {
        check("cylinder", &cylinders, |cylinder| {
            if !(cylinder.start.is_finite() && cylinder.end.is_finite()) {
                return Some(ShapeProblem::NotFinite);
            }
            if cylinder.start == cylinder.end {
                return Some(ShapeProblem::NoLength);
            }
            radius_problem(cylinder.radius)
                .or((!cylinder.bounds().is_finite()).then_some(ShapeProblem::TooLarge))
        })?;
        Ok(Self { cylinders })
    }

    /// The cylinders.
    pub fn as_slice(&self) -> &[Cylinder] {
        &self.cylinders
    }
}

/// The hit at a distance.
#[inline]
fn hit_at(cylinder: &Cylinder, line: &Line, t: f64) -> PrimitiveHit {
    let Seen { share, .. } = cylinder.see(add(line.origin, scale(t, line.direction)));
    PrimitiveHit { t: single_distance(t), u: share.clamp(0.0, 1.0) as f32, v: 0.0 }
}

impl Geometry for Cylinders {
    fn len(&self) -> usize {
        self.cylinders.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.cylinders[primitive as usize].bounds()
    }

    fn has_sound_bounds(&self) -> bool {
        // Checked when they were made.
        true
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        let cylinder = &self.cylinders[primitive as usize];
        clipped_bounds_around(cylinder.start, cylinder.end, cylinder.reach(), cell)
    }

    /// Whether the capsule around the same segment and the box of the part touch the cell, which is not inside. Cells a little beside the rims may be told of too.
    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let cylinder = &self.cylinders[primitive as usize];
        let Cylinder { start, end, radius } = *cylinder;
        if self.clipped_bounds(primitive, cell).is_empty()
            || !capsule_touches(start, end, radius, cell)
        {
            return false;
        }
        let slack = overlap_slack(start, end, radius);
        let length = dot(cylinder.axis(), cylinder.axis()).sqrt();
        let is_inside = |corner: Double3| {
            let Seen { share, outwards, .. } = cylinder.see(corner);
            let to_ends = share.min(1.0 - share) * length;
            to_ends > slack && dot(outwards, outwards).sqrt() < f64::from(radius) - slack
        };
        !corners(cell).all(is_inside)
    }

    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.cylinders, primitive as usize);
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let cylinder = &self.cylinders[primitive as usize];
        let half = scale(0.5, cylinder.axis());
        let reach = dot(half, half).sqrt().hypot(f64::from(cylinder.radius));
        ball_around(add(double(cylinder.start), half), reach)
    }

    #[inline]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        let (cylinder, line) = (&self.cylinders[primitive as usize], Line::from(ray));
        Some(hit_at(cylinder, &line, cylinder.chord(&line)?.first(ray)?))
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        let (cylinder, line) = (&self.cylinders[primitive as usize], Line::from(ray));
        if let Some(chord) = cylinder.chord(&line) {
            chord.all(ray, found, |t| hit_at(cylinder, &line, t));
        }
    }

    /// The closest point of the surface, from inside too. Of points equally close any.
    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let cylinder = &self.cylinders[primitive as usize];
        let (point, axis, radius) = (double(point), cylinder.axis(), f64::from(cylinder.radius));
        let Seen { share, outwards, .. } = cylinder.see(point);
        let (height, aside) = (dot(axis, axis).sqrt(), dot(outwards, outwards).sqrt());
        let normal = unit_or(outwards, some_unit_across(axis));

        // From outside both the height and the distance from the axis are brought into their ranges; from inside one of them goes to the nearest end of its own.
        let (mut at_height, mut at_side) = (share.clamp(0.0, 1.0), aside.min(radius));
        if cylinder.contains(point) {
            let to_end = share.min(1.0 - share) * height;
            if radius - aside <= to_end {
                at_side = radius;
            } else {
                at_height = if share < 0.5 { 0.0 } else { 1.0 };
            }
        }
        let foot = add(double(cylinder.start), scale(at_height, axis));
        let away = [(at_height - share) * height, at_side - aside, 0.0];
        Some(PrimitivePoint {
            point: single(add(foot, scale(at_side, normal))),
            distance: dot(away, away).sqrt() as f32,
            u: at_height as f32,
            v: 0.0,
        })
    }

    /// One inside, nothing outside.
    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        f64::from(u8::from(self.cylinders[primitive as usize].contains(double(point))))
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (cylinder, line) = (&self.cylinders[hit.primitive as usize], Line::from(ray));
        let axis = cylinder.axis();

        // Computed again, as the distance of a hit is as wrong as the ray is long, and whether it is on the side or on an end is not told by it.
        let mut t = f64::from(hit.t);
        let mut end = None;
        if let Some([tube, between]) = cylinder.chords(&line)
            && let Some(chord) = tube.and(between)
        {
            t = chord.end_at(hit.t);
            let enters = t == chord.enter;
            let through_end =
                if enters { between.enter > tube.enter } else { between.leave < tube.leave };
            let at_start = (dot(line.direction, axis) > 0.0) == enters;
            end = through_end.then_some(at_start);
        }
        let Seen { foot, outwards, .. } = cylinder.see(add(line.origin, scale(t, line.direction)));
        let (position, normal) = match end {
            Some(at_start) => {
                let (center, sign) =
                    if at_start { (cylinder.start, -1.0) } else { (cylinder.end, 1.0) };
                (add(double(center), outwards), unit_or(scale(sign, axis), axis))
            }
            None => {
                let normal = unit_or(outwards, some_unit_across(axis));
                (add(foot, scale(f64::from(cylinder.radius), normal)), normal)
            }
        };
        let largest = cylinder.start.abs().max(cylinder.end.abs()).max_element();
        SurfacePoint {
            position: single(position),
            normal: single(normal),
            clearance: ROUND_CLEARANCE * (largest + cylinder.radius),
        }
    }
}
