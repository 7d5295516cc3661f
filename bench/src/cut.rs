//! Meshes cut into finer ones of the same shape.

use std::collections::HashMap;

use raywood::{TriangleMesh, Vec3};

/// The mesh with each triangle cut in four at the middles of its edges, so many times over. Triangles with a common edge have its middle in common, so what is
/// closed stays so.
///
/// # Errors
///
/// It has more vertices or triangles than a mesh can have.
pub(crate) fn cut(mesh: TriangleMesh, times: u32) -> Result<TriangleMesh, String> {
    let mut positions: Vec<Vec3> = mesh.positions().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    for _ in 0..times {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let number = positions.len() as u32;
                positions.push(0.5 * (positions[a as usize] + positions[b as usize]));
                number
            })
        };
        let parts = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.iter().flat_map(parts).collect();
    }
    TriangleMesh::new(positions, triangles).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_becomes_a_grid() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]];
        let square = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        assert_eq!(cut(square.clone(), 0).unwrap().triangles(), square.triangles());
        let grid = cut(square, 2).unwrap();
        assert_eq!((grid.triangles().len(), grid.positions().len()), (32, 25));
        for &[a, b, c] in grid.triangles() {
            let [a, b, c] = [a, b, c].map(|corner| grid.positions()[corner as usize]);
            assert_eq!((b - a).cross(c - a), Vec3::new(0.0, 0.0, 1.0));
        }
    }
}
