//! Collects placed parts into one mesh.

use raywood::TriangleMesh;

use super::{Part, Placement};
use crate::{MaterialId, Mesh};

/// A mesh in the making: parts, each with a place and a material.
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    all: Part,
    materials: Vec<MaterialId>,
}

impl MeshBuilder {
    /// Adds a copy of a part.
    pub fn add(&mut self, part: &Part, placement: &Placement, material: MaterialId) {
        let first = self.all.positions.len() as u32;
        self.all.positions.extend(part.positions.iter().map(|&p| placement.point(p)));
        self.all.normals.extend(part.normals.iter().map(|&n| placement.direction(n)));
        self.all.triangles.extend(part.triangles.iter().map(|t| t.map(|i| i + first)));
        self.materials.resize(self.all.triangles.len(), material);
    }

    /// How many triangles there are so far.
    pub fn triangle_count(&self) -> usize {
        self.all.triangles.len()
    }

    /// The mesh.
    ///
    /// # Panics
    ///
    /// If a part names vertices that it does not have, or has positions that are not finite: a mistake in the code
    /// that made it.
    pub fn finish(self) -> Mesh {
        let triangles = TriangleMesh::new(self.all.positions, self.all.triangles)
            .expect("parts have finite positions and indices in range");
        let (normals, materials) = (self.all.normals, self.materials);
        Mesh { triangles, normals, materials, ..Mesh::default() }
    }
}
