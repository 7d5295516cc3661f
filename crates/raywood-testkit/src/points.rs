//! Points that look for trouble in a mesh.

use raywood::{TriangleMesh, Vec3};

use crate::Rng;

/// Points around a mesh, far from it, on it and a little beside it: at corners, on edges, in faces.
pub fn around(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Vec3> {
    let mut rng = Rng::new(seed);
    let bounds = mesh.total_bounds();
    let empty = mesh.triangles().is_empty();
    let (center, size) =
        if empty { (Vec3::ZERO, 1.0) } else { (bounds.center(), bounds.extent().max_element()) };
    let one = |number: usize| {
        let far = center + 100.0 * size * rng.in_cube();
        let near = center + 0.7 * size * rng.in_cube();
        if empty {
            return near;
        }
        let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
        let (s, t) = (rng.unit(), rng.unit());
        match number % 8 {
            0 => far,
            1 => a,
            2 => (1.0 - s) * a + s * b,
            3 => 0.5 * (1.0 - s) * a + 0.5 * s * b + 0.5 * c,
            4 => a + 1e-6 * size * rng.in_cube(),
            5 => (1.0 - s) * b + s * c + 1e-3 * size * t * rng.in_cube(),
            _ => near,
        }
    };
    (0..count).map(one).filter(|point| point.is_finite()).collect()
}
