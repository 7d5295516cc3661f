//! The point of the geometry that is closest to a given one.
//!
//! The tree is searched nearest boxes first. In single precision the triangles of a leaf get bounds of their distances, eight at once; what remains possible at
//! the end, one triangle or the few that share the closest edge or corner, is decided in double precision, the same on every
//! [`SimdLevel`](crate::SimdLevel).

use std::ops::ControlFlow;

use crate::geometry::{Frame, TriangleBlock, closest_on_triangle};
use crate::simd::{Float, Kernel, Simd, dispatch_on};
use crate::structures::WideNode;
use crate::structures::wide::search::{Leaf, Query, SearchStack, lanes, planes};
use crate::{Bvh, Geometry, PrimitivePoint, Vec3, WideBvh, parallel};

/// The point of a geometry that is closest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Where it lies; each coordinate is right to one rounding of itself and `2^-40` of the largest coordinate involved.
    pub point: Vec3,
    /// How far it is from the given point; not negative, right as the coordinates are. Infinite where it exceeds the largest number.
    pub distance: f32,
    /// Which primitive it lies on; at exactly equal distance the lowest number wins.
    pub primitive: u32,
    /// Which instance of a scene; 0 where there are no instances.
    pub instance: u32,
    /// First surface coordinate, as that of a [`Hit`](crate::Hit).
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
}

impl<G: Geometry> Bvh<G> {
    /// The point of the geometry that is closest to `point`, no further away than `max_distance` (infinity for any). `None` if there is none, or if the point is not
    /// finite or the distance NaN or negative.
    ///
    /// Of primitives at exactly the same distance (as it is returned) the one with the lowest number is told. The answer is the same on all levels of
    /// instructions, and what comparing [`Geometry::closest_point`] of all primitives gives, whose distances count as no less than those of their boxes. So the
    /// answer's own distance as `max_distance` finds it again. Spheres are their surfaces, here as for rays. About O(log N) where the point is much closer to some primitives than to most; at the centre of a
    /// sphere of triangles O(N). A smaller `max_distance` makes it faster.
    ///
    /// ```
    /// use raywood::{Bvh, TriangleMesh};
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]])?;
    /// let bvh = Bvh::build(&mesh)?;
    ///
    /// let closest = bvh.closest_point([1.0, 2.0, 3.0], f32::INFINITY).expect("there is a triangle");
    /// assert_eq!((closest.point, closest.distance), ([1.0, 2.0, 0.0].into(), 3.0));
    /// assert_eq!((closest.u, closest.v), (0.25, 0.5));
    /// assert_eq!(bvh.closest_point([1.0, 2.0, 3.0], 2.5), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point(
        &self,
        point: impl Into<[f32; 3]>,
        max_distance: f32,
    ) -> Option<ClosestPoint> {
        let mut answer = [None];
        self.closest_points(&[Vec3::from(point.into())], max_distance, &mut answer);
        answer[0]
    }

    /// [`closest_point`](Self::closest_point) for many points, over all cores of the caller's rayon pool, with the same answers.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn closest_point_batch(
        &self,
        points: &[Vec3],
        max_distance: f32,
        answers: &mut [Option<ClosestPoint>],
    ) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            self.closest_points(points, max_distance, answers);
        });
    }

    /// The same on the calling thread.
    pub(super) fn closest_points(
        &self,
        points: &[Vec3],
        max_distance: f32,
        answers: &mut [Option<ClosestPoint>],
    ) {
        let (tree, geometry) = (&self.tree, &self.geometry);
        dispatch_on(tree.level(), ClosestPoints { tree, geometry, points, max_distance, answers });
    }
}

/// Finds the closest points of many.
struct ClosestPoints<'a, G> {
    tree: &'a WideBvh,
    geometry: &'a G,
    points: &'a [Vec3],
    max_distance: f32,
    answers: &'a mut [Option<ClosestPoint>],
}

impl<G: Geometry> Kernel for ClosestPoints<'_, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tree, geometry, points, max_distance, answers } = self;
        if max_distance.is_nan() || max_distance < 0.0 {
            return answers.fill(None);
        }
        let stack = &mut SearchStack::new(tree);
        let frame = Frame::new(Vec3::ZERO, tree.reach());
        let mut nearest = Nearest {
            geometry,
            point: Vec3::ZERO,
            frame,
            max_distance,
            limit: 0.0,
            best: None,
            candidates: Candidates::new(),
        };
        for (&point, answer) in points.iter().zip(answers) {
            *answer = None;
            if point.is_finite() {
                nearest.begin(point, Frame::new(point, tree.reach()));
                // A search for what is closest goes on to its end.
                let _ = tree.search(simd, stack, &mut nearest);
                nearest.decide();
                *answer = nearest.best;
            }
        }
    }
}

/// A search for the closest point.
struct Nearest<'a, 't, G> {
    geometry: &'a G,
    point: Vec3,
    frame: Frame,
    max_distance: f32,
    /// The square of the distance beyond which nothing counts, in scaled coordinates.
    limit: f32,
    /// The closest of what was decided in double precision.
    best: Option<ClosestPoint>,
    candidates: Candidates<'t>,
}

impl<'t, G: Geometry> Nearest<'_, 't, G> {
    /// Begins the search for another point.
    #[inline(always)]
    fn begin(&mut self, point: Vec3, frame: Frame) {
        (self.point, self.frame) = (point, frame);
        (self.limit, self.best) = (frame.square(self.max_distance), None);
        self.candidates.count = 0;
    }

    /// Compares a primitive that is no triangle.
    #[inline]
    fn test(&mut self, primitive: u32) {
        if let Some(mut found) = self.geometry.closest_point(primitive, self.point) {
            // Rounding of what is large, such as a radius, takes it no nearer than any box around it, which may have been left out for that.
            let beside = self.geometry.bounds(primitive).distance(self.point);
            found.distance = found.distance.max(beside);
            self.offer(primitive, found);
        }
    }

    #[inline]
    fn offer(&mut self, primitive: u32, found: PrimitivePoint) {
        let PrimitivePoint { point, distance, u, v } = found;
        let is_better = match &self.best {
            None => distance <= self.max_distance,
            Some(best) => {
                distance < best.distance || distance == best.distance && primitive < best.primitive
            }
        };
        if is_better {
            self.best = Some(ClosestPoint { point, distance, primitive, instance: 0, u, v });
            self.limit = self.limit.min(self.frame.square(distance));
        }
    }

    /// Compares all candidates in double precision.
    fn decide(&mut self) {
        for number in 0..self.candidates.count {
            let Candidate { lower, block, lane } = self.candidates.list[number];
            if let Some(block) = block
                && lower <= self.limit
            {
                let lane = lane as usize;
                let found = closest_on_triangle(self.point, block.corners(lane));
                self.offer(block.primitives[lane], found);
            }
        }
        self.candidates.count = 0;
    }

    /// Makes room for the candidates of another leaf.
    #[cold]
    #[inline(never)]
    fn make_room(&mut self) {
        self.candidates.keep_up_to(self.limit);
        if !self.candidates.has_room() {
            self.decide();
        }
    }
}

impl<'t, G: Geometry> Query<'t> for Nearest<'_, 't, G> {
    #[inline(always)]
    fn children<S: Simd>(&mut self, simd: S, node: &WideNode) -> (u32, S::F16) {
        let keys = self.frame.boxes(simd, planes(node));
        let end = self.limit + self.limit * (8.0 * f32::EPSILON);
        (keys.less_or_equal(simd.splat16(end.min(f32::MAX))), keys)
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn leaf<S: Simd>(&mut self, simd: S, leaf: Leaf<'t>) -> ControlFlow<()> {
        let (lower, upper) = leaf.block.squared_distances(simd, &self.frame);
        let near = leaf.triangles & lower.less_or_equal(simd.splat8(self.limit));
        if near != 0 {
            let (least, _) = simd.least8(near, upper);
            self.limit = self.limit.min(least);
            let near = near & lower.less_or_equal(simd.splat8(self.limit));
            if !self.candidates.has_room() {
                self.make_room();
            }
            self.candidates.push(leaf.block, near, lower.to_array());
        }
        if leaf.others != 0 {
            for primitive in leaf.others() {
                self.test(primitive);
            }
        }
        ControlFlow::Continue(())
    }
}

/// How many candidates wait at most.
const ROOM: usize = 32;

/// A triangle that may be the closest.
#[derive(Clone, Copy)]
struct Candidate<'t> {
    /// The square of its distance is not less.
    lower: f32,
    /// The block that holds it; `None` where there is no candidate.
    block: Option<&'t TriangleBlock>,
    lane: u32,
}

/// The triangles that may be the closest: those of the last few leaves, and earlier ones that still count.
struct Candidates<'t> {
    list: [Candidate<'t>; ROOM],
    count: usize,
}

impl<'t> Candidates<'t> {
    fn new() -> Self {
        Self { list: [Candidate { lower: 0.0, block: None, lane: 0 }; ROOM], count: 0 }
    }

    /// Whether a whole leaf finds room.
    #[inline(always)]
    fn has_room(&self) -> bool {
        self.count + crate::geometry::LANES <= ROOM
    }

    #[inline(always)]
    fn push(&mut self, block: &'t TriangleBlock, chosen: u32, lower: [f32; 8]) {
        for lane in lanes(chosen) {
            self.list[self.count] =
                Candidate { lower: lower[lane], block: Some(block), lane: lane as u32 };
            self.count += 1;
        }
    }

    /// Drops those that are further away.
    fn keep_up_to(&mut self, limit: f32) {
        let mut kept = 0;
        for number in 0..self.count {
            self.list[kept] = self.list[number];
            kept += usize::from(self.list[kept].lower <= limit);
        }
        self.count = kept;
    }
}
