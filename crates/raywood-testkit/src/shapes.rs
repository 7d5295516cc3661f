//! Closed meshes with known properties.

use raywood::{TriangleMesh, Vec3};

/// A mesh from parts that are known to be sound.
fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh::new(positions, triangles).expect("a sound mesh")
}

/// A sphere of `segments` by `2 * segments` patches with poles on the y axis, normals outwards. Closed: neighbours share vertices.
pub fn uv_sphere(segments: u32, center: Vec3, radius: f32) -> TriangleMesh {
    let (rings, sectors) = (segments.max(2), 2 * segments.max(2));
    let mut positions = vec![center + radius * Vec3::Y];
    for ring in 1..rings {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        for sector in 0..sectors {
            let azimuth = std::f32::consts::TAU * sector as f32 / sectors as f32;
            let direction =
                Vec3::new(polar.sin() * azimuth.cos(), polar.cos(), -polar.sin() * azimuth.sin());
            positions.push(center + radius * direction);
        }
    }
    let bottom = positions.len() as u32;
    positions.push(center - radius * Vec3::Y);

    let vertex = |ring: u32, sector: u32| 1 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, vertex(1, sector), vertex(1, sector + 1)]);
        for ring in 1..rings - 1 {
            let [a, b] = [vertex(ring, sector), vertex(ring + 1, sector)];
            let [c, d] = [vertex(ring + 1, sector + 1), vertex(ring, sector + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([bottom, vertex(rings - 1, sector + 1), vertex(rings - 1, sector)]);
    }
    mesh(positions, triangles)
}

/// An axis-aligned box whose faces are grids of `cells` by `cells` quads, normals outwards. Closed.
pub fn grid_box(cells: u32, min: Vec3, max: Vec3) -> TriangleMesh {
    let mut positions = Vec::new();
    let mut numbers = std::collections::HashMap::new();
    let mut vertex = |p: [u32; 3]| {
        *numbers.entry(p).or_insert_with(|| {
            // Weights that are exact at both ends keep the faces flat.
            let at = |axis: usize| {
                let weight = p[axis] as f32 / cells as f32;
                (1.0 - weight) * min[axis] + weight * max[axis]
            };
            positions.push(Vec3::new(at(0), at(1), at(2)));
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for (layer, outwards) in [(0, false), (cells, true)] {
            for i in 0..cells {
                for j in 0..cells {
                    let mut corner = |u: u32, v: u32| {
                        let mut p = [0; 3];
                        p[axis] = layer;
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        vertex(p)
                    };
                    let (a, b, c, d) =
                        (corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
                    let quad =
                        if outwards { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                    triangles.extend(quad);
                }
            }
        }
    }
    mesh(positions, triangles)
}

/// The same mesh with every vertex mapped.
pub fn mapped(original: &TriangleMesh, mut map: impl FnMut(Vec3) -> Vec3) -> TriangleMesh {
    mesh(original.positions().iter().map(|&p| map(p)).collect(), original.triangles().to_vec())
}

/// Small random triangles, and beams that run through all of them askew: trees that may cut triangles cut some.
pub fn beams(small: usize, beams: usize) -> TriangleMesh {
    let mut rng = crate::Rng::new(5);
    let small = soup(small, 0.05, 9);
    let mut positions = small.positions().to_vec();
    for _ in 0..beams {
        let (from, to) = (1.2 * rng.in_cube(), 1.2 * rng.in_cube());
        positions.extend([from, to, to + 0.02 * rng.in_cube()]);
    }
    let first = small.positions().len() as u32;
    let beams = (0..beams as u32).map(|i| [first + 3 * i, first + 3 * i + 1, first + 3 * i + 2]);
    mesh(positions, small.triangles().iter().copied().chain(beams).collect())
}

/// Random triangles of edge length about `size` in the cube from -1 to 1.
pub fn soup(count: usize, size: f32, seed: u64) -> TriangleMesh {
    let mut rng = crate::Rng::new(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = rng.in_cube();
        positions.extend([(); 3].map(|()| center + size * rng.in_cube()));
    }
    mesh(positions, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}
