//! Triangles with what belongs to them: shading normals, colours, materials.

use raywood::{TriangleMesh, Vec3};

use crate::{MaterialId, Rgb};

/// All triangles of a scene, in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions and indices.
    pub triangles: TriangleMesh,
    /// A shading normal per vertex, unit length; zero where there is none and the triangle's own normal serves. Empty if no vertex
    /// has one, else as many as positions.
    pub normals: Vec<Vec3>,
    /// A colour per vertex that multiplies the diffuse colour. Empty if no vertex has one, else as many as positions.
    pub colors: Vec<Rgb>,
    /// The material of each triangle.
    pub materials: Vec<MaterialId>,
}
