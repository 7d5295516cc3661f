//! Quads: faces of four corners, as two triangles each.

use super::of_triangles::methods_of_triangles;
use super::triangle_mesh::{check_count, check_finite};
use super::{Geometry, MeshError};
use crate::simd::prefetch_item;
use crate::{Hit, Vec3};

/// Faces of four corners, given by indices into an array of vertex positions. Checked once, when made.
///
/// The surface of a quad with the corners `a`, `b`, `c` and `d`, one after the other around it, is that of the two triangles `a b d` and `c d b`, flat or not: it is creased along the
/// diagonal from `b` to `d` (as that of Embree is). Each of them is a primitive, `2 q` and `2 q + 1` of quad `q`, so quads are as fast and as watertight as a
/// [`TriangleMesh`](crate::TriangleMesh) and answer every query as one does. [`quad`](Self::quad) tells which quad a hit is on, and where. One whose last corner is given twice is a triangle.
///
/// ```
/// use raywood::{Bvh, Quads, Ray};
///
/// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let bvh = Bvh::build(Quads::new(corners, vec![[0, 1, 2, 3]])?)?;
/// let hit = bvh.intersect(&Ray::new([3.0, 1.5, 1.0], [0.0, 0.0, -1.0])).expect("the quad");
/// assert_eq!(bvh.geometry().quad(&hit), (0, [0.75, 0.75]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quads {
    positions: Vec<Vec3>,
    quads: Vec<[u32; 4]>,
}

impl Quads {
    /// Quads from vertex positions and, per quad, four indices into them.
    ///
    /// # Errors
    ///
    /// An index out of range, a position that is NaN or infinite, or more than 2^30 quads.
    pub fn new<P: Into<[f32; 3]>>(
        positions: Vec<P>,
        quads: Vec<[u32; 4]>,
    ) -> Result<Self, MeshError> {
        check_count(quads.len().saturating_mul(2))?;
        let positions: Vec<Vec3> = positions.into_iter().map(|p| Vec3::from(p.into())).collect();
        check_finite(positions.iter().copied())?;
        let stray = |&index: &u32| index as usize >= positions.len();
        for (quad, corners) in quads.iter().enumerate() {
            if let Some(index) = corners.iter().copied().find(stray) {
                return Err(MeshError::QuadIndexOutOfRange {
                    quad,
                    index,
                    positions: positions.len(),
                });
            }
        }
        Ok(Self { positions, quads })
    }

    /// The vertex positions.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The quads: four indices into the positions each.
    pub fn quads(&self) -> &[[u32; 4]] {
        &self.quads
    }

    /// Which quad a hit is on, and where: `[u, v]` is (0, 0) at its first corner, (1, 0), (1, 1) and (0, 1) at those that follow, and linear in between on each of the
    /// two triangles.
    pub fn quad(&self, hit: &Hit) -> (u32, [f32; 2]) {
        let place =
            if hit.primitive & 1 == 0 { [hit.u, hit.v] } else { [1.0 - hit.u, 1.0 - hit.v] };
        (hit.primitive / 2, place)
    }

    /// The corners of a triangle.
    #[inline(always)]
    fn corners(&self, triangle: u32) -> [Vec3; 3] {
        let [a, b, c, d] = self.quads[triangle as usize / 2];
        let [a, b, c] = if triangle & 1 == 0 { [a, b, d] } else { [c, d, b] };
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }
}

impl Geometry for Quads {
    fn len(&self) -> usize {
        2 * self.quads.len()
    }

    methods_of_triangles!();

    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.quads, primitive as usize / 2);
    }

    fn prefetch_rest(&self, primitive: u32) {
        if let Some(corners) = self.quads.get(primitive as usize / 2) {
            corners.iter().for_each(|&corner| prefetch_item(&self.positions, corner as usize));
        }
    }
}
