//! Triangles with what belongs to them: shading normals, colours, texture coordinates, materials.

use raywood::{TriangleMesh, Vec3};

use crate::{MaterialId, Rgb};

/// All triangles of a scene: in world space, those of [objects](crate::Instances) in their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions and indices.
    pub triangles: TriangleMesh,
    /// A shading normal per vertex, unit length; zero where there is none and the triangle's own normal serves. Empty if no vertex
    /// has one, else as many as positions.
    pub normals: Vec<Vec3>,
    /// A colour per vertex that multiplies the diffuse colour. Empty if no vertex has one, else as many as positions.
    pub colors: Vec<Rgb>,
    /// Two sets of texture coordinates per vertex: (0, 0) is an image's upper left corner, (1, 1) its lower right one. Each empty if no texture
    /// reads it, else as many as positions.
    pub texture_coordinates: [Vec<[f32; 2]>; 2],
    /// A tangent per vertex for normal maps, along u, unit length, and the sign of the bitangent `sign * normal x tangent`. Zero, or all of it empty, where
    /// texture coordinates give the tangent.
    pub tangents: Vec<[f32; 4]>,
    /// The material of each triangle.
    pub materials: Vec<MaterialId>,
}
