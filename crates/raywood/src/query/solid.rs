//! What is inside: signed distances from closed surfaces, and from those that are nearly so.

use crate::double::double;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::wide::winding::Winding;
use crate::{Bvh, Geometry, Vec3, parallel};

/// A geometry as the surface of a solid: made by [`Bvh::solid`].
///
/// Inside is where the surface winds around a point: where its winding number, the sum of the solid angles of all triangles over `4 pi`, is a half at
/// least (Jacobson, Kavan and Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding Numbers", SIGGRAPH 2013). Around a closed surface it
/// is a whole number, of which nothing but the orientation decides: normals point outwards. It needs no neighbours of triangles, no order and no shared vertices, and where
/// there are holes, overlaps or triangles too many it changes smoothly from 1 to 0 across the gap: so a soup that looks like a solid is one. (A sign told by the normal
/// at the closest point is right for closed surfaces alone; one told by counting crossings of a ray is wrong behind every hole.)
///
/// What is far away is seen as one piece (Barill et al., "Fast Winding Numbers for Soups and Clouds", 2018), which is off by a few hundredths at most; around closed
/// surfaces that never matters.
#[derive(Clone, Debug)]
pub struct Solid<'a, G> {
    bvh: &'a Bvh<G>,
    winding: Winding,
}

impl<G: Geometry> Bvh<G> {
    /// The geometry as the surface of a solid, for questions about its inside. O(N), and about as much memory as the tree's nodes.
    ///
    /// ```
    /// use raywood::{Bvh, TriangleMesh};
    ///
    /// // A tetrahedron, its normals outwards.
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    /// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let bvh = Bvh::build(&mesh)?;
    ///
    /// let solid = bvh.solid();
    /// assert!(solid.contains([1.0, 1.0, 0.5]) && !solid.contains([1.0, 1.0, -0.5]));
    /// assert_eq!(solid.signed_distance([1.0, 1.0, 0.5]), Some(-0.5));
    /// assert_eq!(solid.signed_distance([1.0, 1.0, -0.5]), Some(0.5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solid(&self) -> Solid<'_, G> {
        Solid { bvh: self, winding: Winding::new(&self.tree, &self.geometry) }
    }
}

impl<G: Geometry> Solid<'_, G> {
    /// How often the surface goes around a point: 1 inside, 0 outside of a closed surface, between these near holes; negative where normals point inwards. Right
    /// to a few hundredths; on the surface itself anything between the numbers on both sides. 0 if the point is not finite.
    ///
    /// The same on all levels of instructions.
    pub fn winding_number(&self, point: impl Into<[f32; 3]>) -> f32 {
        let mut answer = [0.0];
        self.winding_numbers(&[Vec3::from(point.into())], &mut answer);
        answer[0]
    }

    /// [`winding_number`](Self::winding_number) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn winding_number_batch(&self, points: &[Vec3], answers: &mut [f32]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            self.winding_numbers(points, answers);
        });
    }

    /// Whether a point is inside: its [winding number](Self::winding_number) is a half at least. On the surface itself it may be told either way.
    ///
    /// However near the surface a point is, it is told right where double precision sees on which side of the nearest triangle it lies.
    pub fn contains(&self, point: impl Into<[f32; 3]>) -> bool {
        self.winding_number(point) >= 0.5
    }

    /// The distance from the surface, negative inside. `None` if there is no surface or the point is not finite. It costs what
    /// [`closest_point`](Bvh::closest_point) and [`contains`](Self::contains) cost, and is as right.
    pub fn signed_distance(&self, point: impl Into<[f32; 3]>) -> Option<f32> {
        let mut answer = [None];
        self.signed_distance_batch(&[Vec3::from(point.into())], &mut answer);
        answer[0]
    }

    /// [`signed_distance`](Self::signed_distance) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn signed_distance_batch(&self, points: &[Vec3], answers: &mut [Option<f32>]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            let mut closest = vec![None; points.len()];
            self.bvh.closest_points(points, f32::INFINITY, &mut closest);
            let mut winding = vec![0.0; points.len()];
            self.winding_numbers(points, &mut winding);
            for ((answer, closest), winding) in answers.iter_mut().zip(closest).zip(winding) {
                let side = if winding >= 0.5 { -1.0 } else { 1.0 };
                *answer = closest.map(|closest| side * closest.distance);
            }
        });
    }

    /// Winding numbers on the calling thread.
    fn winding_numbers(&self, points: &[Vec3], answers: &mut [f32]) {
        let (solid, level) = (self, self.bvh.tree.level());
        dispatch_on(level, WindingNumbers { solid, points, answers });
    }
}

/// Finds winding numbers.
struct WindingNumbers<'a, G> {
    solid: &'a Solid<'a, G>,
    points: &'a [Vec3],
    answers: &'a mut [f32],
}

impl<G: Geometry> Kernel for WindingNumbers<'_, G> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) {
        let Self { solid: Solid { bvh, winding }, points, answers } = self;
        let mut stack = Vec::new();
        for (&point, answer) in points.iter().zip(answers) {
            *answer = match point.is_finite() {
                true => winding.around(&bvh.tree, &bvh.geometry, double(point), &mut stack) as f32,
                false => 0.0,
            };
        }
    }
}
