//! The indexed triangle mesh.

use std::fmt;

use super::Geometry;
use super::of_triangles::methods_of_triangles;
use crate::simd::prefetch_item;
use crate::storage::Array;
use crate::{Aabb, Vec3};

/// Triangles as triples of indices into an array of vertex positions. Checked once, when made: every index is in
/// range and every position finite, so no query has to ask again.
///
/// Triangles are hit from both sides, edges and vertices included, and no ray slips between two that share an edge
/// (Woop, Benthin and Wald 2013). Degenerate triangles are legal: with a repeated vertex they are never hit, with three
/// corners in a row only by rays that pass within rounding of that line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    positions: Array<Vec3>,
    triangles: Array<[u32; 3]>,
}

/// Why arrays are not a triangle mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// An index points past the end of the positions.
    IndexOutOfRange {
        /// The first such triangle.
        triangle: usize,
        /// Its offending index.
        index: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// A quad's index points past the end of the positions.
    QuadIndexOutOfRange {
        /// The first such quad.
        quad: usize,
        /// Its offending index.
        index: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// Indices or vertices that are three to a triangle, but whose number is no multiple of three.
    LeftOver {
        /// How many there are.
        count: usize,
        /// Whether they are indices, not vertices.
        indices: bool,
    },
    /// Some positions are NaN or infinite.
    NotFinite {
        /// The first such position.
        first: usize,
        /// How many there are in all.
        count: usize,
    },
    /// Some positions of a mesh of double precision are beyond [`Ray64::GREATEST`](crate::Ray64::GREATEST).
    TooFar {
        /// The first such position.
        first: usize,
        /// How many there are in all.
        count: usize,
    },
    /// Another number of positions than the mesh has whose triangles are kept.
    PositionCount {
        /// How many it has.
        before: usize,
        /// How many there are now.
        now: usize,
    },
    /// More than 2^31 triangles.
    TooManyTriangles {
        /// How many there are.
        triangles: usize,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { triangle, index, positions } => {
                write!(
                    f,
                    "triangle {triangle} uses vertex {index}, but there are {positions} vertices (0 is the first)"
                )
            }
            Self::QuadIndexOutOfRange { quad, index, positions } => {
                write!(
                    f,
                    "quad {quad} uses vertex {index}, but there are {positions} vertices (0 is the first)"
                )
            }
            Self::LeftOver { count, indices } => {
                let what = if *indices { "indices" } else { "vertices" };
                write!(f, "{count} {what}, but three make a triangle and none may be left over")
            }
            Self::NotFinite { first, count } => {
                write!(
                    f,
                    "{count} vertices are NaN or infinite, the first of them is vertex {first}"
                )
            }
            Self::TooFar { first, count } => {
                write!(
                    f,
                    "{count} vertices have coordinates beyond 1e45, the first of them is vertex {first}"
                )
            }
            Self::PositionCount { before, now } => {
                write!(f, "{now} positions for a mesh of {before} vertices")
            }
            Self::TooManyTriangles { triangles } => {
                write!(f, "{triangles} triangles, but a mesh holds at most 2147483648")
            }
        }
    }
}

impl std::error::Error for MeshError {}

impl TriangleMesh {
    /// A mesh from vertex positions and, per triangle, three indices into them.
    ///
    /// Positions are of any type that turns into `[f32; 3]`, as points of `glam`, `nalgebra` and `mint` do. Arrays and [`Vec3`] are taken over without being
    /// copied. Of vertices or indices that lie otherwise in memory a [`MeshView`](crate::MeshView) can be made.
    ///
    /// # Errors
    ///
    /// An index out of range, a position that is NaN or infinite, or more than 2^31 triangles.
    pub fn new<P: Into<[f32; 3]>>(
        positions: Vec<P>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        let positions: Vec<Vec3> = positions.into_iter().map(|p| Vec3::from(p.into())).collect();
        Self::of_arrays(positions.into(), triangles.into())
    }

    /// The same of what was checked before: [`are_finite`], [`are_below`], not too many.
    pub(crate) fn of_sound(
        positions: impl Into<Array<Vec3>>,
        triangles: impl Into<Array<[u32; 3]>>,
    ) -> Self {
        Self { positions: positions.into(), triangles: triangles.into() }
    }

    /// The same of arrays that may lie elsewhere.
    pub(crate) fn of_arrays(
        positions: Array<Vec3>,
        triangles: Array<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        check_count(triangles.len())?;
        if !are_finite(&positions) {
            check_finite(positions.iter().copied())?;
        }

        let in_range = |index: u32| (index as usize) < positions.len();
        if !are_below(&triangles, positions.len())
            && let Some(triangle) = triangles.iter().position(|t| !t.iter().all(|&i| in_range(i)))
        {
            let index = triangles[triangle].into_iter().find(|&i| !in_range(i)).unwrap_or_default();
            return Err(MeshError::IndexOutOfRange { triangle, index, positions: positions.len() });
        }
        Ok(Self { positions, triangles })
    }

    /// The same triangles with their vertices elsewhere, for [`Bvh::refit`](crate::Bvh::refit). O(vertices): indices are shared with this mesh and not looked at again.
    ///
    /// # Errors
    ///
    /// Another number of positions, or one that is NaN or infinite.
    pub fn with_positions<P: Into<[f32; 3]>>(&self, positions: Vec<P>) -> Result<Self, MeshError> {
        let (before, now) = (self.positions.len(), positions.len());
        if before != now {
            return Err(MeshError::PositionCount { before, now });
        }
        let positions: Vec<Vec3> = positions.into_iter().map(|p| Vec3::from(p.into())).collect();
        check_finite(positions.iter().copied())?;
        Ok(Self { positions: positions.into(), triangles: self.triangles.clone() })
    }

    /// Positions and triangles as the bytes that they are in memory.
    pub(crate) fn saved_arrays(&self) -> [&[u8]; 2] {
        [self.positions.as_bytes(), self.triangles.as_bytes()]
    }

    /// The vertex positions.
    pub fn positions(&self) -> &[Vec3] {
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
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        // Not `map`, which the compiler does not always inline.
        let [a, b, c] = self.triangles[triangle as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The box around all triangles (vertices that no triangle uses do not count).
    pub fn total_bounds(&self) -> Aabb {
        Aabb::of_points(
            self.triangles.iter().flatten().map(|&index| self.positions[index as usize]),
        )
    }
}

/// Refuses more triangles than can be numbered.
pub(crate) fn check_count(triangles: usize) -> Result<(), MeshError> {
    if triangles > 1 << 31 { Err(MeshError::TooManyTriangles { triangles }) } else { Ok(()) }
}

/// Whether all positions are numbers.
pub(crate) fn are_finite(positions: &[Vec3]) -> bool {
    // Without a branch each: the bits of what is not finite are the largest but for the sign.
    let larger = |most: u32, x: f32| most.max(x.to_bits() << 1);
    let most = positions
        .iter()
        .fold([0; 3], |[x, y, z], p| [larger(x, p.x), larger(y, p.y), larger(z, p.z)]);
    most.iter().all(|&most| most < f32::INFINITY.to_bits() << 1)
}

/// Whether all vertices of triangles have numbers below this.
pub(crate) fn are_below(triangles: &[[u32; 3]], positions: usize) -> bool {
    let most = triangles.as_flattened().iter().fold(0, |most, &index| index.max(most));
    triangles.is_empty() || (most as usize) < positions
}

/// Refuses positions that are NaN or infinite.
pub(super) fn check_finite(positions: impl Iterator<Item = Vec3> + Clone) -> Result<(), MeshError> {
    match positions.clone().filter(|p| !p.is_finite()).count() {
        0 => Ok(()),
        count => {
            let first = positions.into_iter().position(|p| !p.is_finite()).unwrap_or_default();
            Err(MeshError::NotFinite { first, count })
        }
    }
}

impl Geometry for TriangleMesh {
    fn len(&self) -> usize {
        self.triangles.len()
    }

    methods_of_triangles!();

    #[inline(always)]
    fn prefetch(&self, primitive: u32) {
        prefetch_item(&self.triangles, primitive as usize);
    }

    #[inline(always)]
    fn prefetch_rest(&self, primitive: u32) {
        if let Some(corners) = self.triangles.get(primitive as usize) {
            corners.iter().for_each(|&corner| prefetch_item(&self.positions, corner as usize));
        }
    }
}
