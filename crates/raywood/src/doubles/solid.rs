//! What is inside of a mesh of double precision, and signed distances from it.

use super::{Bvh64, Ray64};
use crate::double::largest_magnitude;
use crate::parallel;
use crate::simd::{Kernel, Simd, dispatch_on};
use crate::structures::wide::winding::Winding;

/// A mesh of double precision as the surface of a solid, by winding numbers as [`Solid`](crate::Solid): made by [`Bvh64::solid`].
#[derive(Clone, Debug)]
pub struct Solid64<'a> {
    bvh: &'a Bvh64,
    winding: Winding,
}

impl Bvh64 {
    /// The mesh as the surface of a solid, for questions about its inside. O(N), and about as much memory as the tree's nodes.
    ///
    /// (Who knows that the mesh is closed can count [`crossings`](Self::crossings) of any ray from a point instead, which are exact; behind a hole they are wrong.)
    ///
    /// ```
    /// use raywood::{Bvh64, TriangleMesh64};
    ///
    /// // A tetrahedron of a few micrometres, a million metres away, its normals outwards.
    /// let [x, e] = [1e6, 1e-6];
    /// let corners = vec![[x, 0.0, 0.0], [x + 4.0 * e, 0.0, 0.0], [x, 4.0 * e, 0.0], [x, 0.0, 4.0 * e]];
    /// let mesh = TriangleMesh64::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
    /// let bvh = Bvh64::build(mesh)?;
    ///
    /// let solid = bvh.solid();
    /// assert!(solid.contains([x + e, e, 0.5 * e]) && !solid.contains([x + e, e, -0.5 * e]));
    /// assert_eq!(solid.signed_distance([x + e, e, -0.5 * e]), Some(0.5 * e));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn solid(&self) -> Solid64<'_> {
        Solid64 { bvh: self, winding: Winding::new(&self.tree, &self.frame.mesh(&self.mesh)) }
    }
}

impl Solid64<'_> {
    /// How often the surface goes around a point: 1 inside, 0 outside of a closed surface, between these near holes; negative where normals point inwards. Right
    /// to a few hundredths; on the surface itself anything between the numbers on both sides. 0 if the point is not finite.
    pub fn winding_number(&self, point: [f64; 3]) -> f64 {
        let mut answer = [0.0];
        self.winding_numbers(&[point], &mut answer);
        answer[0]
    }

    /// [`winding_number`](Self::winding_number) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn winding_number_batch(&self, points: &[[f64; 3]], answers: &mut [f64]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            self.winding_numbers(points, answers);
        });
    }

    /// Whether a point is inside: its [winding number](Self::winding_number) is a half at least. On the surface itself it may be told either way.
    ///
    /// However near the surface a point is, it is told right where double precision sees on which side of the nearest triangle it lies: triangles that are near are seen as they are, not as single precision
    /// has them.
    pub fn contains(&self, point: [f64; 3]) -> bool {
        self.winding_number(point) >= 0.5
    }

    /// The distance from the surface, negative inside. `None` if there is no surface or the point is not finite. It costs what [`closest_point`](Bvh64::closest_point) and
    /// [`contains`](Self::contains) cost, and is as right.
    pub fn signed_distance(&self, point: [f64; 3]) -> Option<f64> {
        let mut answer = [None];
        self.signed_distances(&[point], &mut answer);
        answer[0]
    }

    /// [`signed_distance`](Self::signed_distance) for many points, over all cores of the caller's rayon pool.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn signed_distance_batch(&self, points: &[[f64; 3]], answers: &mut [Option<f64>]) {
        assert_eq!(points.len(), answers.len(), "as many answers as points");
        parallel::fill_pieces(points, answers, |points, answers| {
            self.signed_distances(points, answers);
        });
    }

    /// Signed distances on the calling thread.
    fn signed_distances(&self, points: &[[f64; 3]], answers: &mut [Option<f64>]) {
        let mut windings = vec![0.0; points.len()];
        self.winding_numbers(points, &mut windings);
        for ((&point, winding), answer) in points.iter().zip(windings).zip(answers) {
            let side = if winding >= 0.5 { -1.0 } else { 1.0 };
            let closest = self.bvh.closest_point(point, f64::INFINITY);
            *answer = closest.map(|closest| side * closest.distance);
        }
    }

    /// Winding numbers on the calling thread.
    fn winding_numbers(&self, points: &[[f64; 3]], answers: &mut [f64]) {
        dispatch_on(self.bvh.tree.level(), WindingNumbers { solid: self, points, answers });
    }
}

/// From so many sizes of the mesh away nothing of it is seen: its solid angle is less than that of all triangles side by side.
const TOO_FAR: f64 = (1u64 << 40) as f64;

/// Finds winding numbers.
struct WindingNumbers<'a> {
    solid: &'a Solid64<'a>,
    points: &'a [[f64; 3]],
    answers: &'a mut [f64],
}

impl Kernel for WindingNumbers<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) {
        let Self { solid: Solid64 { bvh, winding }, points, answers } = self;
        let mut stack = Vec::new();
        for (&point, answer) in points.iter().zip(answers) {
            let in_frame = bvh.frame.point(point);
            let is_usual = |x: &f64| x.abs() <= Ray64::GREATEST;
            *answer = match point.iter().all(is_usual) && largest_magnitude(in_frame) < TOO_FAR {
                true => {
                    let corners = |triangle| bvh.mesh.corners(triangle);
                    winding.around_in_double(&bvh.tree, (point, in_frame), &mut stack, corners)
                }
                false => 0.0,
            };
        }
    }
}
