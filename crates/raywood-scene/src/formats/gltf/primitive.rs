//! The triangles of glTF meshes.

use std::collections::HashMap;
use std::ops::Add;

use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use raywood::Vec3;

use super::accessor;
use super::document::Document;
use super::node::Instance;
use crate::error::{LoadError, Place};
use crate::formats::notes::{Fault, NOT_FINITE, Notes};
use crate::formats::raw_mesh::RawMesh;
use crate::{Material, MaterialId, Rgb};

static NOT_TRIANGLES: Fault = Fault {
    one: "primitive has points or lines",
    many: "primitives have points or lines",
    remedy: "left out: only triangles are shown",
};

static NOT_WHOLE: Fault = Fault {
    one: "primitive ends within a triangle",
    many: "primitives end within a triangle",
    remedy: "that triangle is left out",
};

/// How many vertices and triangles there are, or at most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    pub(super) vertices: u64,
    pub(super) triangles: u64,
}

impl Add for Size {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.saturating_add(other.vertices),
            triangles: self.triangles.saturating_add(other.triangles),
        }
    }
}

/// The number of an attribute's accessor.
fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value())
}

/// What a material's textures read of a mesh.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reads {
    /// The sets of texture coordinates.
    sets: [bool; 2],
    tangents: bool,
}

impl Reads {
    /// What the textures of a material read.
    pub(super) fn of(material: &Material) -> Self {
        let Some(textures) = &material.textures else { return Self::default() };
        let mut reads = Self { sets: [false; 2], tangents: textures.normal.is_some() };
        for texture in textures.all() {
            if let Some(set) = reads.sets.get_mut(usize::from(texture.set)) {
                *set = true;
            }
        }
        reads
    }
}

/// The accessors of a primitive's vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct VertexArrays {
    positions: usize,
    normals: Option<usize>,
    colors: Option<usize>,
    texture_coordinates: [Option<usize>; 2],
    tangents: Option<usize>,
}

/// The vertex arrays of a primitive, if it has positions. Those that only textures read are left out where none does.
fn vertex_arrays(primitive: &Primitive, reads: &[Reads]) -> Option<VertexArrays> {
    let Reads { sets, tangents } = reads.get(material_of(primitive, reads)).copied()?;
    let wanted = |wanted: bool, semantic| wanted.then(|| attribute(primitive, semantic)).flatten();
    Some(VertexArrays {
        positions: attribute(primitive, Semantic::Positions)?,
        normals: attribute(primitive, Semantic::Normals),
        colors: attribute(primitive, Semantic::Colors(0)),
        texture_coordinates: [0, 1].map(|set| wanted(sets[set], Semantic::TexCoords(set as u32))),
        tangents: wanted(tangents, Semantic::Tangents),
    })
}

/// The number of a primitive's material: the last is for those without.
fn material_of(primitive: &Primitive, reads: &[Reads]) -> usize {
    primitive.material.map_or(reads.len() - 1, |material| material.value())
}

/// The size of all that is shown.
pub(super) fn total_size<'a>(
    document: &Document<'_>,
    instances: impl Iterator<Item = &'a Instance<'a>>,
    reads: &[Reads],
) -> Result<Size, LoadError> {
    let mut total = Size::default();
    let mut known: Vec<Option<Size>> = vec![None; document.root.meshes.len()];
    for mesh in instances.filter_map(Instance::mesh) {
        let Some(known) = known.get_mut(mesh) else { continue };
        let size = match *known {
            Some(size) => size,
            None => *known.insert(size(document, mesh, reads)?),
        };
        total = total + size;
    }
    Ok(total)
}

/// The size of a mesh, from what its accessors promise and their buffers can hold. Arrays that primitives share count once.
pub(super) fn size(
    document: &Document<'_>,
    mesh: usize,
    reads: &[Reads],
) -> Result<Size, LoadError> {
    let mut size = Size::default();
    let mut seen = HashMap::new();
    for primitive in document.root.meshes.get(mesh).iter().flat_map(|mesh| &mesh.primitives) {
        let Some(arrays) = vertex_arrays(primitive, reads) else { continue };
        let vertices = accessor::open(document, arrays.positions)?.count as u64;
        let corners = match primitive.indices {
            Some(indices) => accessor::open(document, indices.value())?.count as u64,
            None => vertices,
        };
        if seen.insert(arrays, ()).is_none() {
            size.vertices = size.vertices.saturating_add(vertices);
        }
        let triangles = match primitive.mode {
            Checked::Valid(Mode::Triangles) => corners / 3,
            Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => corners.saturating_sub(2),
            _ => 0,
        };
        size.triangles = size.triangles.saturating_add(triangles);
    }
    Ok(size)
}

/// Adds the triangles that a node shows.
pub(super) fn add(
    document: &Document<'_>,
    instance: &Instance<'_>,
    reads: &[Reads],
    raw: &mut RawMesh,
    notes: &mut Notes,
) -> Result<(), LoadError> {
    let Some(mesh_index) = instance.mesh() else { return Ok(()) };
    let Some(mesh) = document.root.meshes.get(mesh_index) else { return Ok(()) };
    if instance.node.skin.is_some() {
        notes.say("skinned meshes are shown as stored, in their bind pose");
    }
    let morphs = instance.node.weights.as_ref().or(mesh.weights.as_ref());
    if morphs.is_some_and(|weights| weights.iter().any(|&weight| weight != 0.0)) {
        notes.say("morph targets are left out: shown as stored");
    }

    let mut shared: HashMap<VertexArrays, u32> = HashMap::new();
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        let place = || format!("meshes[{mesh_index}].primitives[{p}]");
        let Some(arrays) = vertex_arrays(primitive, reads) else { continue };
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => {
                mode
            }
            _ => {
                notes.leave_out(&NOT_TRIANGLES, || Place::Json(place()));
                continue;
            }
        };
        let first = match shared.get(&arrays) {
            Some(&first) => first,
            None => {
                let first = raw.positions.len() as u32;
                add_vertices(document, instance, arrays, raw, notes)?;
                shared.insert(arrays, first);
                first
            }
        };

        // The corners, in range.
        let count = accessor::open(document, arrays.positions)?.count;
        let corners = match primitive.indices {
            None => (0..count as u32).collect(),
            Some(indices) => {
                let index = indices.value();
                let wrong = || {
                    let message =
                        "is of a type that indices cannot have, expected unsigned integers";
                    document.error(format!("accessors[{index}]"), message)
                };
                let corners = accessor::open(document, index)?.indices().ok_or_else(wrong)?;
                if let Some(at) = corners.iter().position(|&corner| corner as usize >= count) {
                    let message = format!(
                        "index {at} is {}, but {} has {count} vertices",
                        corners[at],
                        place()
                    );
                    return Err(document.error(format!("accessors[{index}]"), message));
                }
                corners
            }
        };
        let whole = match mode {
            Mode::Triangles => corners.len().is_multiple_of(3),
            _ => corners.is_empty() || corners.len() >= 3,
        };
        if !whole {
            notes.mend(&NOT_WHOLE, || Place::Json(place()))?;
        }

        // The triangles. A mirrored one keeps its outside by turning round.
        let flip = instance.to_world.mirrors();
        let mut push = |[a, b, c]: [u32; 3]| {
            let [b, c] = if flip { [c, b] } else { [b, c] };
            raw.triangles.push([a, b, c].map(|corner| first + corner));
        };
        match mode {
            Mode::TriangleStrip => {
                for (i, c) in corners.windows(3).enumerate() {
                    push(if i % 2 == 0 { [c[0], c[1], c[2]] } else { [c[1], c[0], c[2]] });
                }
            }
            Mode::TriangleFan => {
                corners.windows(2).skip(1).for_each(|c| push([corners[0], c[0], c[1]]));
            }
            _ => corners.chunks_exact(3).for_each(|c| push([c[0], c[1], c[2]])),
        }
        let material = material_of(primitive, reads);
        raw.materials.resize(raw.triangles.len(), material as MaterialId);
    }
    Ok(())
}

/// Adds the vertices of a primitive in world space.
fn add_vertices(
    document: &Document<'_>,
    instance: &Instance<'_>,
    arrays: VertexArrays,
    raw: &mut RawMesh,
    notes: &mut Notes,
) -> Result<(), LoadError> {
    let VertexArrays { positions, normals, colors, texture_coordinates, tangents } = arrays;
    let to_world = instance.to_world;
    let first = raw.positions.len();
    let open = |index: usize, components: &[usize], count: Option<usize>| {
        let reader = accessor::open(document, index)?;
        let place = || format!("accessors[{index}]");
        if !components.contains(&reader.components) {
            let (found, expected) = (reader.components, components[0]);
            let message = format!("has {found} numbers an element, expected {expected}");
            return Err(document.error(place(), message));
        }
        match count {
            Some(count) if count != reader.count => {
                let message = format!("has {} elements, but POSITION has {count}", reader.count);
                Err(document.error(place(), message))
            }
            _ => Ok(reader),
        }
    };

    let reader = open(positions, &[3], None)?;
    let count = reader.count;
    reader.read::<3>(|p| raw.positions.push(to_world.point(p)));
    for (i, position) in raw.positions[first..].iter().enumerate() {
        if !position.is_finite() {
            let (node, place) = (instance.index, format!("accessors[{positions}]"));
            notes.mend(&NOT_FINITE, || {
                Place::Json(format!("{place}, element {i}, in nodes[{node}]"))
            })?;
        }
    }

    if let Some(normals) = normals {
        let normal_transform = to_world.for_normals();
        raw.normals.resize(first, Vec3::ZERO);
        open(normals, &[3], Some(count))?
            .read::<3>(|n| raw.normals.push(normal_transform.direction(n)));
    } else if !raw.normals.is_empty() {
        raw.normals.resize(first + count, Vec3::ZERO);
    }
    if let Some(colors) = colors {
        raw.colors.resize(first, Rgb::ONE);
        open(colors, &[3, 4], Some(count))?.read::<3>(|c| raw.colors.push(Rgb::from(c)));
    } else if !raw.colors.is_empty() {
        raw.colors.resize(first + count, Rgb::ONE);
    }

    for (coordinates, accessor) in raw.texture_coordinates.iter_mut().zip(texture_coordinates) {
        if let Some(accessor) = accessor {
            coordinates.resize(first, [0.0; 2]);
            open(accessor, &[2], Some(count))?.read::<2>(|uv| coordinates.push(uv));
        } else if !coordinates.is_empty() {
            coordinates.resize(first + count, [0.0; 2]);
        }
    }
    if let Some(tangents) = tangents {
        // Where a node mirrors, what was to the left of the tangent is to its right.
        let turn = if to_world.mirrors() { -1.0 } else { 1.0 };
        raw.tangents.resize(first, [0.0; 4]);
        open(tangents, &[4], Some(count))?.read::<4>(|[x, y, z, sign]| {
            let Vec3 { x, y, z } = to_world.direction([x, y, z]);
            raw.tangents.push([x, y, z, turn * sign]);
        });
    } else if !raw.tangents.is_empty() {
        raw.tangents.resize(first + count, [0.0; 4]);
    }
    Ok(())
}
