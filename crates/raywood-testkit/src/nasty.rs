//! Meshes that break careless builders and intersection tests.

use raywood::{TriangleMesh, Vec3};

use crate::{Rng, shapes};

/// A named mesh.
pub struct Nasty {
    /// What is nasty about it.
    pub name: &'static str,
    /// The mesh.
    pub mesh: TriangleMesh,
}

/// Separate triangles.
fn triangles(corners: Vec<[Vec3; 3]>) -> TriangleMesh {
    let indices = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(corners.into_flattened(), indices).expect("finite corners")
}

/// All of them, small enough for brute force.
pub fn all() -> Vec<Nasty> {
    let mut rng = Rng::new(7);
    let mut random = move || [(); 3].map(|()| rng.in_cube());
    let unit = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let moved = |t: [Vec3; 3], by: Vec3| t.map(|p| p + by);
    let scaled = |t: [Vec3; 3], by: f32| t.map(|p| by * p);
    let entry = |name, mesh| Nasty { name, mesh };

    vec![
        entry("nothing", triangles(vec![])),
        entry("a single triangle", triangles(vec![unit])),
        entry(
            "points: all corners equal",
            triangles((0..50).map(|i| [Vec3::splat(i as f32); 3]).collect()),
        ),
        entry(
            "lines: two corners equal or all in a row",
            triangles(
                (0..50)
                    .map(|i| {
                        let [a, b, _] = random();
                        if i % 2 == 0 { [a, b, b] } else { [a, 0.5 * (a + b), b] }
                    })
                    .collect(),
            ),
        ),
        entry("degenerate ones among good ones", {
            let mut corners: Vec<_> = (0..200).map(|_| random()).collect();
            for t in corners.iter_mut().step_by(3) {
                t[2] = t[0];
            }
            triangles(corners)
        }),
        entry("the same triangle a thousand times", triangles(vec![unit; 1000])),
        entry("every triangle five times", {
            let base: Vec<_> = (0..60).map(|_| random()).collect();
            triangles((0..300).map(|i| base[(i * 7) % 60]).collect())
        }),
        entry(
            "overlapping in one plane",
            triangles((0..300).map(|_| random().map(|p| Vec3::new(p.x, 0.25, p.z))).collect()),
        ),
        entry("huge", triangles((0..200).map(|_| scaled(random(), 1e18)).collect())),
        entry("tiny", triangles((0..200).map(|_| scaled(random(), 1e-18)).collect())),
        entry(
            "nearly too small for numbers",
            triangles((0..200).map(|_| scaled(random(), 1e-36)).collect()),
        ),
        entry("one huge and many tiny", {
            let mut corners = vec![scaled([Vec3::new(-1.0, -1.0, 0.3), Vec3::X, Vec3::Y], 1e4)];
            corners.extend((0..500).map(|_| {
                let [center, ..] = random();
                random().map(|p| center + 1e-3 * p)
            }));
            triangles(corners)
        }),
        entry(
            "far from the origin",
            triangles(
                (0..300)
                    .map(|_| moved(scaled(random(), 10.0), Vec3::new(148376.0, 1234.0, -223423.0)))
                    .collect(),
            ),
        ),
        entry(
            "a geometric series",
            triangles(
                (0..120)
                    .map(|i| {
                        let s = 0.5f32.powi(i);
                        moved(scaled(unit, s), Vec3::splat(s))
                    })
                    .collect(),
            ),
        ),
        entry(
            "a geometric series towards infinity",
            triangles(
                (0..60)
                    .map(|i| {
                        let s = 4f32.powi(i - 8);
                        moved(scaled(unit, s), Vec3::new(s, 0.0, 0.0))
                    })
                    .collect(),
            ),
        ),
        entry(
            "slivers",
            triangles(
                (0..300)
                    .map(|_| {
                        let [a, b, c] = random();
                        [a, b, 0.5 * (a + b) + 1e-5 * c]
                    })
                    .collect(),
            ),
        ),
        entry(
            "a flat grid",
            shapes::mapped(&shapes::grid_box(12, Vec3::ZERO, Vec3::ONE), |p| {
                Vec3::new(p.x, 0.0, p.z)
            }),
        ),
        entry("a box of grids", shapes::grid_box(8, Vec3::splat(-1.0), Vec3::ONE)),
        entry("a sphere", shapes::uv_sphere(16, Vec3::new(0.5, -0.25, 2.0), 1.5)),
        entry(
            "one centroid for all",
            triangles(
                (1..300)
                    .map(|i| {
                        let s = i as f32;
                        [
                            Vec3::new(-s, -s, 0.0),
                            Vec3::new(2.0 * s, -s, 0.0),
                            Vec3::new(-s, 2.0 * s, 0.0),
                        ]
                    })
                    .collect(),
            ),
        ),
        entry(
            "long thin diagonals",
            triangles(
                (0..200)
                    .map(|i| {
                        let y = 0.01 * i as f32;
                        [
                            Vec3::new(-1.0, y, -1.0),
                            Vec3::new(1.0, y + 1.0, 1.0),
                            Vec3::new(1.0, y + 1.001, 1.0),
                        ]
                    })
                    .collect(),
            ),
        ),
        entry("a soup", shapes::soup(1500, 0.2, 3)),
    ]
}
