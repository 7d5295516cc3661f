//! Triangle meshes in memory of the caller's own, read where and as they lie there.

use super::of_triangles::methods_of_triangles;
use super::triangle_mesh::{check_count, check_finite};
use super::{Geometry, Indices, MeshError, Vertices};
use crate::Vec3;

/// Triangles whose vertices and indices are read where they lie, borrowed or owned, whatever they are made of.
///
/// - [`Vertices`] are slices, vectors or arrays of anything that turns into `[f32; 3]` (arrays, points of `glam`, `nalgebra` or `mint`, a vertex type of one's own), or
///   [`Strided`](crate::Strided) bytes or numbers, such as a buffer with vertices for the graphics card.
/// - [`Indices`] are slices, vectors or arrays of `u8`, `u16` or `u32`, three in a row to a triangle, or of triples of these. Without indices
///   every three vertices make a triangle: [`soup`](Self::soup).
///
/// Checked once, when made, as a [`TriangleMesh`](crate::TriangleMesh), and hit as one is. Trees keep the triangles in a form of their own, so rays are as fast; builds
/// and [surface points](crate::SurfacePoint) read the memory itself, which must not change meanwhile.
///
/// ```
/// use raywood::{Bvh, MeshView, Ray, Strided};
///
/// // A buffer for the graphics card: position and texture coordinates, one vertex after the other.
/// let buffer: Vec<f32> = vec![
///     0.0, 0.0, 0.0, /* u, v */ 0.0, 0.0,
///     1.0, 0.0, 0.0, /* u, v */ 1.0, 0.0,
///     0.0, 1.0, 0.0, /* u, v */ 0.0, 1.0,
/// ];
/// let indices: [u16; 3] = [0, 1, 2];
/// let mesh = MeshView::new(Strided::of_floats(&buffer, 0, 5)?, &indices)?;
/// let bvh = Bvh::build(&mesh)?;
/// assert!(bvh.occluded(&Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0])));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeshView<V, I> {
    vertices: V,
    indices: I,
}

/// The indices of triangles that have none: one vertex after the other, three to a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Consecutive {
    triangles: usize,
}

impl Indices for Consecutive {
    fn len(&self) -> usize {
        3 * self.triangles
    }

    #[inline(always)]
    fn triangle(&self, triangle: usize) -> [u32; 3] {
        [0, 1, 2].map(|corner| (3 * triangle + corner) as u32)
    }
}

impl<V: Vertices, I: Indices> MeshView<V, I> {
    /// The triangles that the indices make of the vertices.
    ///
    /// # Errors
    ///
    /// An index out of range, a position that is NaN or infinite, one or two indices left over, or more than 2^31 triangles.
    pub fn new(vertices: V, indices: I) -> Result<Self, MeshError> {
        let (count, positions) = (indices.len(), vertices.len());
        if !count.is_multiple_of(3) {
            return Err(MeshError::LeftOver { count, indices: true });
        }
        check_count(count / 3)?;
        check_finite((0..positions).map(|vertex| vertices.position(vertex)))?;
        let stray = |&index: &u32| index as usize >= positions;
        for triangle in 0..count / 3 {
            if let Some(index) = indices.triangle(triangle).into_iter().find(stray) {
                return Err(MeshError::IndexOutOfRange { triangle, index, positions });
            }
        }
        Ok(Self { vertices, indices })
    }

    /// What it reads vertices from.
    pub fn vertices(&self) -> &V {
        &self.vertices
    }

    /// What it reads indices from.
    pub fn indices(&self) -> &I {
        &self.indices
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline(always)]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        // Not `map`, which the compiler does not always inline.
        let [a, b, c] = self.indices.triangle(triangle as usize);
        let position = |vertex: u32| self.vertices.position(vertex as usize);
        [position(a), position(b), position(c)]
    }
}

impl<V: Vertices> MeshView<V, Consecutive> {
    /// A triangle of every three vertices.
    ///
    /// # Errors
    ///
    /// A position that is NaN or infinite, one or two vertices left over, or more than 2^30 triangles.
    pub fn soup(vertices: V) -> Result<Self, MeshError> {
        let count = vertices.len();
        if !count.is_multiple_of(3) {
            return Err(MeshError::LeftOver { count, indices: false });
        }
        // So that vertices are numbered by 32 bits.
        check_count(2 * (count / 3))?;
        Self::new(vertices, Consecutive { triangles: count / 3 })
    }
}

impl<V: Vertices, I: Indices> Geometry for MeshView<V, I> {
    fn len(&self) -> usize {
        self.indices.len() / 3
    }

    methods_of_triangles!();

    #[inline(always)]
    fn prefetch(&self, primitive: u32) {
        self.indices.prefetch(primitive as usize);
    }

    #[inline(always)]
    fn prefetch_rest(&self, primitive: u32) {
        if (primitive as usize) < self.len() {
            let corners = self.indices.triangle(primitive as usize);
            corners.iter().for_each(|&corner| self.vertices.prefetch(corner as usize));
        }
    }
}
