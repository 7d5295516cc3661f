//! A mesh as a file gives it, on its way to the checked mesh of a scene.

use raywood::{TriangleMesh, Vec3};

use super::notes::{Fault, Notes};
use super::{Input, polygon};
use crate::error::{LoadError, Place};
use crate::{MaterialId, Mesh, Rgb};

/// The arrays of a mesh. Indices are in range already; positions may be NaN or infinite.
#[derive(Debug, Default)]
pub(crate) struct RawMesh {
    /// Vertex positions.
    pub(crate) positions: Vec<Vec3>,
    /// A normal per vertex of any length, zero for none; or empty.
    pub(crate) normals: Vec<Vec3>,
    /// A linear colour per vertex; or empty.
    pub(crate) colors: Vec<Rgb>,
    /// Two sets of texture coordinates per vertex, each empty if no texture reads it.
    pub(crate) texture_coordinates: [Vec<[f32; 2]>; 2],
    /// A tangent per vertex of any length with the sign of the bitangent, zero for none; or empty.
    pub(crate) tangents: Vec<[f32; 4]>,
    /// Three vertices per triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// A material per triangle; may be shorter where all the last ones have material 0.
    pub(crate) materials: Vec<MaterialId>,
    /// Where the triangles of objects begin that are shown by instances.
    pub(crate) object_starts: Vec<u32>,
}

/// A polygon that is too large for careful triangulation.
pub(crate) static TOO_MANY_CORNERS: Fault = Fault {
    one: "polygon is concave and has too many vertices",
    many: "polygons are concave and have too many vertices",
    remedy: "cut into a simple fan, which may look wrong",
};

impl RawMesh {
    /// Adds a polygon, cut into triangles.
    #[inline]
    pub(crate) fn push_polygon(
        &mut self,
        corners: &[u32],
        notes: &mut Notes,
        place: impl FnOnce() -> Place,
    ) -> Result<(), LoadError> {
        let Self { positions, triangles, .. } = self;
        let careful = polygon::triangulate(
            corners.len(),
            |i| positions[corners[i] as usize],
            |t| triangles.push(t.map(|i| corners[i])),
        );
        if careful { Ok(()) } else { notes.mend(&TOO_MANY_CORNERS, place) }
    }

    /// The checked mesh. Triangles that use a vertex which is NaN or infinite are dropped: the format has counted
    /// those vertices, or refused them.
    pub(crate) fn finish(mut self, input: &Input<'_>) -> Result<Mesh, LoadError> {
        self.drop_unplaced_triangles();

        // Normals of unit length, colours that can be light.
        for normal in &mut self.normals {
            *normal = normal.normalize_or_zero();
        }
        for tangent in &mut self.tangents {
            let [x, y, z, sign] = *tangent;
            let Vec3 { x, y, z } = Vec3::new(x, y, z).normalize_or_zero();
            *tangent = [x, y, z, if sign < 0.0 { -1.0 } else { 1.0 }];
        }
        for uv in self.texture_coordinates.iter_mut().flatten() {
            *uv = uv.map(|x| if x.is_finite() { x } else { 0.0 });
        }
        for color in &mut self.colors {
            let channel = |c: f32| if c.is_finite() { c.max(0.0) } else { 1.0 };
            *color = Rgb::new(channel(color.x), channel(color.y), channel(color.z));
        }

        let triangles = TriangleMesh::new(self.positions, self.triangles)
            .map_err(|error| LoadError::new(input.path, Place::File, error.to_string()))?;
        let Self { normals, colors, texture_coordinates, tangents, materials, .. } = self;
        Ok(Mesh { triangles, normals, colors, texture_coordinates, tangents, materials })
    }

    /// Drops the triangles with a vertex that is nowhere, if there are any, and moves those vertices to the origin, where none uses them.
    pub(crate) fn drop_unplaced_triangles(&mut self) {
        self.materials.resize(self.triangles.len(), 0);
        if self.positions.iter().all(|p| p.is_finite()) {
            return;
        }
        let positions = &self.positions;
        let placed = |t: &[u32; 3]| t.iter().all(|&i| positions[i as usize].is_finite());
        let kept: Vec<bool> = self.triangles.iter().map(placed).collect();
        for start in &mut self.object_starts {
            *start = kept[..*start as usize].iter().filter(|kept| **kept).count() as u32;
        }
        let mut keep = kept.iter();
        self.triangles.retain(|_| keep.next() == Some(&true));
        let mut keep = kept.iter();
        self.materials.retain(|_| keep.next() == Some(&true));
        for position in &mut self.positions {
            if !position.is_finite() {
                *position = Vec3::ZERO;
            }
        }
    }
}
