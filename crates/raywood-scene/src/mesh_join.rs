//! Meshes put together: triangles of one or several meshes, at other places than they had, as one mesh.

use std::ops::Range;

use raywood::{MeshError, Transform, TriangleMesh, Vec3};

use crate::{MaterialId, Mesh, Rgb};

/// A mesh that grows. What belongs to vertices is there for all of them or for none: where one mesh has it and another has not, the latter gets what changes nothing.
#[derive(Default)]
pub(crate) struct MeshJoin {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// All but positions and triangles. What belongs to vertices may be shorter than these, until the end.
    rest: Mesh,
    /// The new number of each vertex of the mesh that is being added; [`NOT_YET`] where it is not.
    numbers: Vec<u32>,
}

const NOT_YET: u32 = u32::MAX;

/// Values that so many vertices before have none of are first filled up by one that changes nothing.
fn push_after<T: Copy>(values: &mut Vec<T>, vertices: usize, neutral: T, value: T) {
    values.resize(vertices, neutral);
    values.push(value);
}

impl MeshJoin {
    /// How many triangles there are.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Adds triangles of a mesh, and of its vertices those that they use. They are transformed, their colours multiplied by `tint`, and `material` says which of the material that the
    /// mesh names for a triangle. Mirrored triangles have their corners in the other order, so that they face the same way.
    ///
    /// All triangles together must have less than 2^32 vertices.
    pub(crate) fn add(
        &mut self,
        mesh: &Mesh,
        triangles: Range<u32>,
        (to_world, tint): (&Transform, Rgb),
        material: impl Fn(Option<MaterialId>) -> Option<MaterialId>,
    ) {
        let positions = mesh.triangles.positions();
        if self.numbers.len() < positions.len() {
            self.numbers.resize(positions.len(), NOT_YET);
        }
        // What stays in its place stays the same to the bit.
        let moves = *to_world != Transform::IDENTITY;
        let normals = to_world.for_normals();
        let normal_there = |normal: Vec3| match moves {
            true => normals.vector(normal).normalize_or_zero(),
            false => normal,
        };
        let mirrored = to_world.mirrors();
        let tangent_there = |[x, y, z, sign]: [f32; 4]| {
            if !moves {
                return [x, y, z, sign];
            }
            let along = to_world.vector([x, y, z]).normalize_or_zero();
            [along.x, along.y, along.z, if mirrored { -sign } else { sign }]
        };

        let Self { positions: all, rest, numbers, triangles: joined } = self;
        let mut materials = std::mem::take(&mut rest.materials);
        let mut copied = Vec::new();
        let mut copy = |vertex: u32| {
            let place = vertex as usize;
            if numbers[place] != NOT_YET {
                return numbers[place];
            }
            let number = all.len();
            numbers[place] = number as u32;
            copied.push(vertex);
            all.push(to_world.point(positions[place]));
            if let Some(&normal) = mesh.normals.get(place) {
                push_after(&mut rest.normals, number, Vec3::ZERO, normal_there(normal));
            }
            let color = mesh.colors.get(place).copied();
            if color.is_some() || tint != Rgb::ONE {
                let color = color.unwrap_or(Rgb::ONE) * tint;
                push_after(&mut rest.colors, number, Rgb::ONE, color);
            }
            for (all, own) in rest.texture_coordinates.iter_mut().zip(&mesh.texture_coordinates) {
                if let Some(&uv) = own.get(place) {
                    push_after(all, number, [0.0; 2], uv);
                }
            }
            if let Some(&tangent) = mesh.tangents.get(place) {
                push_after(&mut rest.tangents, number, [0.0; 4], tangent_there(tangent));
            }
            number as u32
        };
        for triangle in triangles {
            let Some(corners) = mesh.triangles.triangles().get(triangle as usize) else { break };
            let mut corners = corners.map(&mut copy);
            if mirrored {
                corners.swap(1, 2);
            }
            joined.push(corners);
            let own = mesh.materials.get(triangle as usize).copied();
            materials.extend(material(own));
        }
        self.rest.materials = materials;
        for vertex in copied {
            self.numbers[vertex as usize] = NOT_YET;
        }
    }

    /// The mesh. Vertices that were moved beyond the largest number are at the origin: rays do not see them there either.
    ///
    /// # Errors
    ///
    /// More triangles than a mesh can have.
    pub(crate) fn finish(self) -> Result<Mesh, MeshError> {
        let Self { mut positions, triangles, rest: mut mesh, .. } = self;
        for position in &mut positions {
            if !position.is_finite() {
                *position = Vec3::ZERO;
            }
        }
        fill_up(&mut mesh.normals, positions.len(), Vec3::ZERO);
        fill_up(&mut mesh.colors, positions.len(), Rgb::ONE);
        for coordinates in &mut mesh.texture_coordinates {
            fill_up(coordinates, positions.len(), [0.0; 2]);
        }
        fill_up(&mut mesh.tangents, positions.len(), [0.0; 4]);
        mesh.triangles = TriangleMesh::new(positions, triangles)?;
        Ok(mesh)
    }
}

/// As many values as vertices, unless there are none at all.
fn fill_up<T: Copy>(values: &mut Vec<T>, vertices: usize, neutral: T) {
    if !values.is_empty() {
        values.resize(vertices, neutral);
    }
}
