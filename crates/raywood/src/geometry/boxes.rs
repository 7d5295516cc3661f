//! Axis-aligned boxes.

use super::around_axis::ball_around;
use super::chord::{Chord, Line};
use super::shape_error::{ShapeError, ShapeProblem, check};
use super::surface::ROUND_CLEARANCE;
use super::{Geometry, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
use crate::double::{Double3, add, dot, double, scale, single, single_distance, sub};
use crate::simd::prefetch_item;
use crate::{Aabb, Hit, Ray, Vec3};

/// Axis-aligned boxes: closed surfaces, hit from outside and from inside, such as voxels, rooms and crates. Checked once, when made.
///
/// Faces, edges and corners belong to the box, so no ray slips between boxes that share one. A box may be flat: its front and back are then hit at the same
/// distance. Of a hit, `u` and `v` are zero. Computed in double precision.
///
/// ```
/// use raywood::{Aabb, Boxes, Bvh, Ray};
///
/// let boxes = Boxes::new(vec![Aabb::new([0.0; 3], [1.0; 3]), Aabb::new([2.0, 0.0, 0.0], [3.0, 1.0, 1.0])])?;
/// let bvh = Bvh::build(&boxes)?;
/// let ray = Ray::new([5.0, 0.5, 0.5], [-1.0, 0.0, 0.0]);
/// let hit = bvh.intersect(&ray).expect("the second box");
/// assert_eq!((hit.primitive, hit.t), (1, 2.0));
/// assert_eq!(bvh.surface_point(&ray, &hit).normal, [1.0, 0.0, 0.0].into());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Boxes {
    boxes: Vec<Aabb>,
}

impl Boxes {
    /// Boxes from their corners.
    ///
    /// # Errors
    ///
    /// A coordinate that is NaN or infinite, or a box that is empty: the first such box is named.
    pub fn new(boxes: Vec<Aabb>) -> Result<Self, ShapeError> {
        check("box", &boxes, |corners| {
            let empty = || corners.is_empty().then_some(ShapeProblem::Empty);
            (!corners.is_finite()).then_some(ShapeProblem::NotFinite).or_else(empty)
        })?;
        Ok(Self { boxes })
    }

    /// The boxes.
    pub fn as_slice(&self) -> &[Aabb] {
        &self.boxes
    }

    /// The parts of a line between each pair of faces; it is inside where all of them are.
    #[inline]
    fn slabs(&self, number: u32, line: &Line) -> Option<[Chord; 3]> {
        let Aabb { min, max } = self.boxes[number as usize];
        let low = sub(double(min), line.origin);
        let high = sub(double(max), line.origin);
        let slab = |axis: usize| Chord::between(line.direction[axis], low[axis], high[axis]);
        Some([slab(0)?, slab(1)?, slab(2)?])
    }

    /// The part of a line inside.
    #[inline]
    fn chord(&self, number: u32, line: &Line) -> Option<Chord> {
        let [x, y, z] = self.slabs(number, line)?;
        x.and(y)?.and(z)
    }
}

/// The hit at a distance.
#[inline(always)]
fn hit_at(t: f64) -> PrimitiveHit {
    PrimitiveHit { t: single_distance(t), u: 0.0, v: 0.0 }
}

impl Geometry for Boxes {
    fn len(&self) -> usize {
        self.boxes.len()
    }

    #[inline]
    fn bounds(&self, primitive: u32) -> Aabb {
        self.boxes[primitive as usize]
    }

    fn has_sound_bounds(&self) -> bool {
        // Checked when they were made.
        true
    }

    /// Whether a face passes through the cell: none does where that lies inside.
    fn overlaps(&self, primitive: u32, cell: &Aabb) -> bool {
        let own = self.boxes[primitive as usize];
        let is_inside =
            (0..3).all(|axis| own.min[axis] < cell.min[axis] && cell.max[axis] < own.max[axis]);
        !is_inside && !own.intersection(cell).is_empty()
    }

    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.boxes, primitive as usize);
    }

    fn bounding_ball(&self, primitive: u32) -> Option<(Vec3, f32)> {
        let Aabb { min, max } = self.boxes[primitive as usize];
        let half = scale(0.5, sub(double(max), double(min)));
        ball_around(add(double(min), half), dot(half, half).sqrt())
    }

    #[inline]
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        Some(hit_at(self.chord(primitive, &ray.into())?.first(ray)?))
    }

    fn intersect_all(
        &self,
        primitive: u32,
        ray: &PreparedRay,
        found: &mut dyn FnMut(PrimitiveHit),
    ) {
        if let Some(chord) = self.chord(primitive, &ray.into()) {
            chord.all(ray, found, hit_at);
        }
    }

    /// The closest point of the surface, from inside too: there, of faces equally close, one along x before one along y, and that before one along z.
    fn closest_point(&self, primitive: u32, point: Vec3) -> Option<PrimitivePoint> {
        let Aabb { min, max } = self.boxes[primitive as usize];
        let mut closest = point.max(min).min(max);
        if closest == point {
            let face = |axis: usize| {
                let (to_min, to_max) = (point[axis] - min[axis], max[axis] - point[axis]);
                if to_min <= to_max { (to_min, min[axis]) } else { (to_max, max[axis]) }
            };
            let faces = [face(0), face(1), face(2)];
            let nearer = |&a: &usize, &b: &usize| faces[a].0.total_cmp(&faces[b].0);
            let axis = (0..3).min_by(nearer).unwrap_or_default();
            let mut on_face = point.to_array();
            on_face[axis] = faces[axis].1;
            closest = on_face.into();
        }
        let away = sub(double(closest), double(point));
        Some(PrimitivePoint {
            point: closest,
            distance: dot(away, away).sqrt() as f32,
            u: 0.0,
            v: 0.0,
        })
    }

    /// One inside, nothing outside.
    fn winding_number(&self, primitive: u32, point: Vec3) -> f64 {
        let Aabb { min, max } = self.boxes[primitive as usize];
        let is_inside = (0..3).all(|axis| min[axis] < point[axis] && point[axis] < max[axis]);
        f64::from(u8::from(is_inside))
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (own, line) = (self.boxes[hit.primitive as usize], Line::from(ray));

        // Computed again, as the distance of a hit does not tell which face it lies on. Of an edge, the face first in order.
        let slabs = self.slabs(hit.primitive, &line);
        let chord = self.chord(hit.primitive, &line);
        let (mut t, mut face) = (f64::from(hit.t), 0);
        let mut enters = true;
        if let (Some(slabs), Some(chord)) = (slabs, chord) {
            t = chord.end_at(hit.t);
            enters = t == chord.enter;
            let is_face =
                |&axis: &usize| t == if enters { slabs[axis].enter } else { slabs[axis].leave };
            face = (0..3).find(is_face).unwrap_or_default();
        }
        let forwards = line.direction[face] > 0.0;
        let at_max = forwards != enters;
        let point: Double3 = add(line.origin, scale(t, line.direction));
        let mut position = single(point).max(own.min).min(own.max).to_array();
        position[face] = if at_max { own.max[face] } else { own.min[face] };
        let mut normal = [0.0; 3];
        normal[face] = if at_max { 1.0 } else { -1.0 };
        SurfacePoint {
            position: position.into(),
            normal: normal.into(),
            clearance: ROUND_CLEARANCE * own.min.abs().max(own.max.abs()).max_element(),
        }
    }
}
