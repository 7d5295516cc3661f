//! Closed meshes for whoever counts crossings: of every shape, size and place, some of them flat, folded or full of slivers.

use raywood::{TriangleMesh, Vec3};

use crate::{Rng, shapes};

/// A named closed mesh: every edge belongs to an even number of triangles.
pub struct Closed {
    /// What it is.
    pub name: String,
    /// The mesh.
    pub mesh: TriangleMesh,
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh::new(positions, triangles).expect("a sound mesh")
}

/// An icosahedron, each triangle divided in four `subdivisions` times and moved onto the sphere; normals outwards.
pub fn icosphere(subdivisions: u32, center: Vec3, radius: f32) -> TriangleMesh {
    let golden = 0.5 * (1.0 + 5f32.sqrt());
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend(
            [[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(|p| Vec3::from(p).normalize_or_zero()),
        );
    }
    // The faces are the triples of neighbours, counter-clockwise seen from outside.
    let is_edge = |a: usize, b: usize| points[a].dot(points[b]) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    let outwards = (points[b] - points[a]).cross(points[c] - points[a]);
                    let [b, c] = if outwards.dot(points[a]) > 0.0 { [b, c] } else { [c, b] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize_or_zero());
                points.len() as u32 - 1
            })
        };
        let quarters = |&[a, b, c]: &[u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        triangles = triangles.iter().flat_map(quarters).collect();
    }
    mesh(points.iter().map(|&p| center + radius * p).collect(), triangles)
}

/// A torus around the y axis of `segments` by `segments` quads, its tube of the given share of its radius; normals outwards.
pub fn torus(segments: u32, center: Vec3, radius: f32, tube: f32) -> TriangleMesh {
    let mut positions = Vec::new();
    for i in 0..segments {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / segments as f32).sin_cos();
        for j in 0..segments {
            let (up, out) = (std::f32::consts::TAU * j as f32 / segments as f32).sin_cos();
            let ring = 1.0 + tube * out;
            positions.push(center + radius * Vec3::new(ring * cos, tube * up, ring * sin));
        }
    }
    let vertex = |i: u32, j: u32| i % segments * segments + j % segments;
    let quads = (0..segments * segments).map(|n| (n / segments, n % segments));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b] = [vertex(i, j), vertex(i, j + 1)];
        let [c, d] = [vertex(i + 1, j + 1), vertex(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    mesh(positions, triangles.collect())
}

/// The same mesh with its triangles and their corners in another order, turned over or not; neighbours still share vertices.
fn shuffled(original: &TriangleMesh, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let mut triangles = original.triangles().to_vec();
    for place in (1..triangles.len()).rev() {
        triangles.swap(place, rng.below(place + 1));
        let [a, b, c] = triangles[place];
        triangles[place] = [[a, b, c], [b, c, a], [c, a, b], [a, c, b]][rng.below(4)];
    }
    mesh(original.positions().to_vec(), triangles)
}

/// Both meshes as one.
fn together(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let first = a.positions().len() as u32;
    let moved = b.triangles().iter().map(|t| t.map(|vertex| vertex + first));
    let triangles = a.triangles().iter().copied().chain(moved).collect();
    mesh([a.positions(), b.positions()].concat(), triangles)
}

/// All of them.
pub fn all() -> Vec<Closed> {
    let mut all = Vec::new();
    let mut add = |name: String, mesh: TriangleMesh| all.push(Closed { name, mesh });
    let far = Vec3::new(148376.0, 1234.0, -223423.0);
    for (place, center, radius) in [
        ("at zero", Vec3::ZERO, 1.0),
        ("far away", far, 50.0),
        ("small and far away", far, 0.5),
        ("tiny", Vec3::splat(1e-3), 1e-6),
        ("huge", Vec3::splat(1e5), 1e9),
    ] {
        for subdivisions in [0, 1, 4] {
            let mesh = icosphere(subdivisions, center, radius);
            add(format!("icosphere {subdivisions} {place}"), mesh);
        }
        let half = Vec3::splat(radius);
        add(format!("box {place}"), shapes::grid_box(1, center - half, center + half));
        add(format!("box of grids {place}"), shapes::grid_box(8, center - half, center + half));
        add(format!("sphere {place}"), shapes::uv_sphere(12, center, radius));
        add(format!("torus {place}"), torus(20, center, 0.7 * radius, 0.4));
    }

    let sphere = icosphere(3, Vec3::ZERO, 1.0);
    let boxes = shapes::grid_box(4, Vec3::splat(-4.0), Vec3::splat(4.0));
    let squashed = |by: f32| move |p: Vec3| Vec3::new(p.x, by * p.y, p.z);
    add("every triangle twice".into(), together(&boxes, &boxes));
    add("one in another".into(), together(&sphere, &boxes));
    add("turned over at random".into(), shuffled(&sphere, 1));
    add("slivers".into(), shapes::mapped(&sphere, squashed(1e-6)));
    add("a needle".into(), shapes::mapped(&sphere, |p| Vec3::new(1e-4 * p.x, 1e4 * p.y, p.z)));
    add("flat".into(), shapes::mapped(&sphere, squashed(0.0)));
    add("a flat box".into(), shapes::mapped(&boxes, squashed(0.0)));
    add("folded onto a lattice".into(), {
        shapes::mapped(&sphere, |p| (4.0 * p).to_array().map(f32::round).into())
    });
    add("a tangle".into(), {
        // Only the connections are those of a box; many triangles lie in planes of the lattice, many are lines.
        let mut rng = Rng::new(2);
        shapes::mapped(&boxes, |_| (3.0 * rng.in_cube()).to_array().map(f32::round).into())
    });
    all
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_edge_belongs_to_an_even_number_of_triangles() {
        for super::Closed { name, mesh } in super::all() {
            let mut uses = std::collections::HashMap::new();
            for [a, b, c] in mesh.triangles() {
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    *uses.entry((p.min(q), p.max(q))).or_insert(0) += 1;
                }
            }
            assert!(uses.values().all(|uses| uses % 2 == 0), "{name} is open");
        }
    }

    #[test]
    fn an_icosphere_has_twenty_triangles_times_four_and_faces_outwards() {
        let mesh = super::icosphere(2, raywood::Vec3::ZERO, 1.0);
        assert_eq!(mesh.triangles().len(), 20 * 16);
        for triangle in 0..320 {
            let [a, b, c] = mesh.corners(triangle);
            assert!((b - a).cross(c - a).dot(a) > 0.0);
        }
    }
}
