//! The indexed triangle mesh in double precision.

use super::Ray64;
use crate::MeshError;
use crate::double::{Double3, largest_magnitude};
use crate::simd::prefetch_item;

/// Triangles as triples of indices into an array of vertex positions in double precision. Checked once, when made, as a
/// [`TriangleMesh`](crate::TriangleMesh) is.
///
/// Triangles are hit from both sides, edges and vertices included, and no ray slips between two that share an edge. Degenerate triangles are legal and
/// never hit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh64 {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh64 {
    /// A mesh from vertex positions and, per triangle, three indices into them.
    ///
    /// # Errors
    ///
    /// An index out of range, a position that is NaN, infinite or beyond [`Ray64::GREATEST`], or more than 2^31 triangles.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        if triangles.len() > 1 << 31 {
            return Err(MeshError::TooManyTriangles { triangles: triangles.len() });
        }
        let not_finite = |p: &Double3| !p.iter().all(|x| x.is_finite());
        if let Some((first, count)) = first_and_count(&positions, not_finite) {
            return Err(MeshError::NotFinite { first, count });
        }
        let too_far = |p: &Double3| largest_magnitude(*p) > Ray64::GREATEST;
        if let Some((first, count)) = first_and_count(&positions, too_far) {
            return Err(MeshError::TooFar { first, count });
        }
        let in_range = |index: u32| (index as usize) < positions.len();
        if let Some(triangle) = triangles.iter().position(|t| !t.iter().all(|&i| in_range(i))) {
            let index = triangles[triangle].into_iter().find(|&i| !in_range(i)).unwrap_or_default();
            return Err(MeshError::IndexOutOfRange { triangle, index, positions: positions.len() });
        }
        Ok(Self { positions, triangles })
    }

    /// The vertex positions.
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The triangles: three indices into the positions each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: u32) -> [[f64; 3]; 3] {
        // Not `map`, which the compiler does not always inline.
        let [a, b, c] = self.triangles[triangle as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// Asks for the memory of a triangle's numbers, or `SECOND` for that of its corners.
    #[inline(always)]
    pub(crate) fn prefetch<const SECOND: bool>(&self, triangle: u32) {
        let place = triangle as usize;
        match self.triangles.get(place) {
            Some(corners) if SECOND => {
                corners.iter().for_each(|&corner| prefetch_item(&self.positions, corner as usize));
            }
            _ => prefetch_item(&self.triangles, place),
        }
    }

    /// The largest coordinate of a triangle.
    pub(super) fn largest(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.corners(triangle).map(largest_magnitude);
        a.max(b).max(c)
    }

    /// The smallest and the largest coordinates of all triangles (vertices that no triangle uses do not count); `None` if there are none.
    pub fn total_bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut corners = self.triangles.iter().flatten().map(|&i| self.positions[i as usize]);
        let first = corners.next()?;
        let grown = |[min, max]: [Double3; 2], p: Double3| {
            [[0, 1, 2].map(|i| min[i].min(p[i])), [0, 1, 2].map(|i| max[i].max(p[i]))]
        };
        Some(corners.fold([first, first], grown))
    }
}

/// The place of the first position that is bad, and how many are; `None` if none is.
fn first_and_count(
    positions: &[Double3],
    is_bad: impl Fn(&Double3) -> bool,
) -> Option<(usize, usize)> {
    let first = positions.iter().position(&is_bad)?;
    Some((first, positions[first..].iter().filter(|p| is_bad(p)).count()))
}
