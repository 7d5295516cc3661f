//! The sections of a tree and its geometry: what stands in each, written and read.

use std::borrow::Cow;

use super::SavedTreeError;
use super::container::{Container, array, invalid};
use crate::checksum::checksum_and;
use crate::geometry::{are_below, are_finite, check_count};
use crate::simd::Arena;
use crate::storage::Array;
use crate::structures::{SavedWide, Unsound};
use crate::{Aabb, Spheres, TriangleMesh, TriangleTest, Vec3, WideBvh, parallel};

/// What is known of the tree but its memory.
pub(super) const TREE: &str = "tree";
/// Nodes and blocks.
pub(super) const NODES: &str = "nodes";
/// Which primitives lie in several leaves.
pub(super) const PARTS: &str = "parts";
/// The vertices of triangles.
pub(super) const POSITIONS: &str = "positions";
/// Three vertices for each triangle.
pub(super) const TRIANGLES: &str = "triangles";
/// Centres and radii.
pub(super) const SPHERES: &str = "spheres";

/// All that are the library's own.
pub(super) const OWN: [&str; 6] = [TREE, NODES, PARTS, POSITIONS, TRIANGLES, SPHERES];

/// Those large ones of which [`read`] computes the checksum while it looks at what they hold: so memory is read once.
pub(super) const VERIFIED_WHILE_READ: [&str; 3] = [NODES, POSITIONS, TRIANGLES];

/// Bytes of the section `tree`.
const TREE_BYTES: usize = 64;

/// The kinds of triangle tests in the order of their numbers.
const TRIANGLE_TESTS: [TriangleTest; 2] = [TriangleTest::Watertight, TriangleTest::Fast];

/// A section's name and bytes.
pub(super) type NamedBytes<'a> = (&'a str, Cow<'a, [u8]>);

/// The sections of a tree and what it is over.
pub(super) fn sections<'a>(
    tree: &'a WideBvh,
    (mesh, spheres): (Option<&'a TriangleMesh>, Option<&'a Spheres>),
) -> Vec<NamedBytes<'a>> {
    let (bounds, primitives, triangle_test, root) = tree.saved_root();
    let mut header = Vec::with_capacity(TREE_BYTES);
    for corner in [bounds.min, bounds.max] {
        header.extend(corner.to_array().into_iter().flat_map(f32::to_le_bytes));
    }
    let test = TRIANGLE_TESTS.iter().position(|&test| test == triangle_test).unwrap_or_default();
    header.extend([primitives, root, test as u32].into_iter().flat_map(u32::to_le_bytes));
    header.resize(TREE_BYTES, 0);

    let mut sections = vec![(TREE, header.into()), (NODES, tree.saved_lines().into())];
    if !tree.saved_parts().is_empty() {
        let bits = tree.saved_parts().iter().flat_map(|bits| bits.to_le_bytes());
        sections.push((PARTS, bits.collect::<Vec<_>>().into()));
    }
    if let Some(mesh) = mesh {
        let [positions, triangles] = mesh.saved_arrays();
        sections.extend([(POSITIONS, positions.into()), (TRIANGLES, triangles.into())]);
    }
    if let Some(spheres) = spheres {
        let numbers = spheres.as_slice().iter().flat_map(|&(c, radius)| [c.x, c.y, c.z, radius]);
        sections.push((SPHERES, numbers.flat_map(f32::to_le_bytes).collect::<Vec<_>>().into()));
    }
    sections
}

/// A tree and its geometry. Arrays that lie well are not copied. What it takes from sections that are not [`VERIFIED_WHILE_READ`] may be damaged.
pub(super) fn read(file: &Container) -> Result<(WideBvh, TriangleMesh, Spheres), SavedTreeError> {
    let (mesh, spheres) = (mesh_arrays(file)?, read_spheres(file)?);
    let triangles = mesh.as_ref().map_or(0, |(_, triangles)| triangles.len());
    let (mesh, tree) = parallel::join_if(
        true,
        || mesh.map_or_else(|| Ok(TriangleMesh::default()), |mesh| read_mesh(file, mesh)),
        || read_tree(file, triangles, spheres.as_slice().len()),
    );
    let mesh = mesh?;
    Ok((tree?, mesh, spheres))
}

/// Positions and triangles as they are in the file.
type MeshArrays = (Array<Vec3>, Array<[u32; 3]>);

/// Finds positions and triangles, if there are any.
fn mesh_arrays(file: &Container) -> Result<Option<MeshArrays>, SavedTreeError> {
    let (positions, triangles) = match (file.range(POSITIONS), file.range(TRIANGLES)) {
        (Some(positions), Some(triangles)) => (positions, triangles),
        (None, None) => return Ok(None),
        (None, _) => return Err(missing(POSITIONS)),
        (_, None) => return Err(missing(TRIANGLES)),
    };
    whole_items(POSITIONS, &positions, 12)?;
    whole_items(TRIANGLES, &triangles, 12)?;
    Ok(Some((file.bytes().within(positions), file.bytes().within(triangles))))
}

fn read_mesh(
    file: &Container,
    (positions, triangles): MeshArrays,
) -> Result<TriangleMesh, SavedTreeError> {
    let (sum, finite) = checksum_and(&positions, are_finite);
    file.compare(POSITIONS, sum)?;
    let (sum, below) = checksum_and(&triangles, |piece| are_below(piece, positions.len()));
    file.compare(TRIANGLES, sum)?;
    if finite && below && check_count(triangles.len()).is_ok() {
        return Ok(TriangleMesh::of_sound(positions, triangles));
    }
    let start = file.range(TRIANGLES).map_or(0, |range| range.start);
    TriangleMesh::of_arrays(positions, triangles)
        .map_err(|error| invalid(TRIANGLES, start, error.to_string()))
}

fn read_spheres(file: &Container) -> Result<Spheres, SavedTreeError> {
    let Some(range) = file.range(SPHERES) else { return Ok(Spheres::default()) };
    whole_items(SPHERES, &range, 16)?;
    let start = range.start;
    let sphere = |bytes: &[u8]| {
        let [x, y, z, radius] = [0, 4, 8, 12].map(|at| f32::from_le_bytes(array(bytes, at)));
        (Vec3::new(x, y, z), radius)
    };
    let spheres = file.bytes()[range].chunks_exact(16).map(sphere).collect();
    Spheres::new(spheres)
        .map_err(|error| invalid(SPHERES, start + 16 * error.sphere, error.to_string()))
}

fn read_tree(
    file: &Container,
    triangles: usize,
    spheres: usize,
) -> Result<WideBvh, SavedTreeError> {
    let header = file.range(TREE).ok_or_else(|| missing(TREE))?;
    let nodes = file.range(NODES).ok_or_else(|| missing(NODES))?;
    if header.len() != TREE_BYTES {
        let problem = format!("{} bytes, expected {TREE_BYTES}", header.len());
        return Err(invalid(TREE, header.start, problem));
    }
    whole_items(NODES, &nodes, 64)?;
    let bytes = &file.bytes()[header.clone()];
    let number = |at: usize| u32::from_le_bytes(array(bytes, at));
    let [min, max] = [0, 12].map(|start| {
        let [x, y, z] = [0, 4, 8].map(|at| f32::from_bits(number(start + at)));
        Vec3::new(x, y, z)
    });
    let (primitives, root) = (number(24), number(28));
    if primitives as usize != triangles + spheres {
        let problem = format!(
            "{primitives} primitives, but there are {triangles} triangles and {spheres} spheres"
        );
        return Err(invalid(TREE, header.start + 24, problem));
    }
    let Some(&triangle_test) = TRIANGLE_TESTS.get(number(32) as usize) else {
        let problem = format!("triangle test {}, expected 0 or 1", number(32));
        return Err(invalid(TREE, header.start + 32, problem));
    };
    if let Some(at) = (36..TREE_BYTES).find(|&at| bytes[at] != 0) {
        return Err(invalid(TREE, header.start + at, "expected zeros"));
    }

    let saved = SavedWide {
        bounds: Aabb { min, max },
        primitives,
        triangle_test,
        root,
        arena: Arena::within(file.bytes(), nodes.clone()),
        parts: read_parts(file, primitives as usize)?,
    };
    let tree = WideBvh::from_saved(saved, triangles as u32);
    let (tree, sum) = tree.map_err(|Unsound { line, problem }| match line {
        Some(line) => invalid(NODES, nodes.start + 64 * line, problem),
        None => invalid(TREE, header.start, problem),
    })?;
    file.compare(NODES, sum)?;
    Ok(tree)
}

/// A bit for each primitive, or nothing.
fn read_parts(file: &Container, primitives: usize) -> Result<Vec<u64>, SavedTreeError> {
    let Some(range) = file.range(PARTS) else { return Ok(Vec::new()) };
    let expected = 8 * primitives.div_ceil(64);
    if range.len() != expected || expected == 0 {
        let problem = format!("{} bytes, but {primitives} primitives have {expected}", range.len());
        return Err(invalid(PARTS, range.start, problem));
    }
    let words = file.bytes()[range.clone()].chunks_exact(8);
    let words: Vec<u64> = words.map(|word| u64::from_le_bytes(array(word, 0))).collect();
    let used = primitives - 64 * (words.len() - 1);
    if used < 64 && words[words.len() - 1] >> used != 0 {
        return Err(invalid(PARTS, range.end - 8, "bits of primitives that are not there"));
    }
    Ok(words)
}

/// Whether a section consists of items of such a size.
fn whole_items(
    name: &str,
    range: &std::ops::Range<usize>,
    size: usize,
) -> Result<(), SavedTreeError> {
    match range.len() % size {
        0 => Ok(()),
        _ => {
            let problem = format!("{} bytes, expected a multiple of {size}", range.len());
            Err(invalid(name, range.start, problem))
        }
    }
}

fn missing(section: &str) -> SavedTreeError {
    SavedTreeError::Missing { section: section.to_owned() }
}
