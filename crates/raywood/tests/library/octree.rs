//! The octree where it could go wrong: cells that cannot be divided, primitives that divide badly, bounded memory.

use raywood::{Aabb, Hit, PreparedRay, PrimitiveHit, Ray, StructureStats, SurfacePoint};
use std::sync::atomic::{AtomicUsize, Ordering};

use raywood::{AccelerationStructure, BuildError, BuildOptions, Counts, Geometry, Octree};
use raywood::{TriangleMesh, Vec3};
use raywood_testkit::{Rng, nasty, rays, shapes};

/// How many references a primitive may have on average.
const MAX_REFERENCES: usize = 8;

fn mesh(corners: Vec<[Vec3; 3]>) -> TriangleMesh {
    let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(corners.into_flattened(), triangles).expect("finite corners")
}

/// Builds and checks an octree, and returns its statistics with it.
fn build(mesh: &TriangleMesh, options: &BuildOptions) -> (Octree, StructureStats) {
    let octree = Octree::build(mesh, options).expect("it builds");
    octree.validate(mesh).expect("a valid octree");
    let stats = octree.stats();
    assert!(stats.references <= MAX_REFERENCES * mesh.len(), "{stats}");
    assert!(stats.bytes <= 50 * stats.references, "{stats}");
    (octree, stats)
}

#[test]
fn nothing_is_an_octree_without_nodes() {
    let (octree, stats) = build(&mesh(vec![]), &BuildOptions::default());
    assert!(octree.bounds().is_empty());
    assert_eq!((stats.nodes, stats.depth, stats.bytes), (0, 0, 0));
}

#[test]
fn any_options_give_the_same_hits() {
    for (number, nasty) in nasty::all().iter().enumerate() {
        let rays = rays::against(&nasty.mesh, 300, 77 + number as u64);
        let (reference, _) = build(&nasty.mesh, &BuildOptions::default());
        for (octree_leaf_size, octree_max_depth) in
            [(0, 0), (1, usize::MAX), (1, 3), (2, 9), (usize::MAX, 24)]
        {
            let options = BuildOptions { octree_leaf_size, octree_max_depth, ..Default::default() };
            let octree = Octree::build(&nasty.mesh, &options).expect("it builds");
            octree.validate(&nasty.mesh).expect("a valid octree");
            let stats = octree.stats();
            assert!(stats.depth <= octree_max_depth.max(1), "{}: {stats}", nasty.name);
            for ray in &rays {
                let hit = |octree: &Octree| octree.intersect(&nasty.mesh, ray, &mut ());
                assert_eq!(hit(&octree), hit(&reference), "{}: {ray:?}", nasty.name);
            }
        }
    }
}

#[test]
fn a_flat_scene_is_divided_in_four() {
    let at = |i: u32, j: u32| Vec3::new(i as f32 / 32.0, 0.25, j as f32 / 32.0);
    let mut corners = Vec::new();
    for (i, j) in (0..32).flat_map(|i| (0..32).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        corners.extend([[a, b, c], [a, c, d]]);
    }
    let floor = mesh(corners);
    let (_, stats) = build(&floor, &BuildOptions::default());
    // A triangle that touches the plane between two cells belongs to one of them.
    assert_eq!(stats.references, stats.primitives, "{stats}");
    assert_eq!((stats.depth, stats.max_leaf_primitives), (5, 8), "{stats}");
}

#[test]
fn small_things_in_a_wide_and_flat_scene_get_small_leaves() {
    // A fine ball on a floor a thousand times as wide: cells as flat as the scene would cut the ball's triangles to pieces.
    let at = |x: f32, z: f32| Vec3::new(x, -1.0, z);
    let mut corners = vec![[at(-1e3, -1e3), at(1e3, -1e3), at(0.0, 1e3)]];
    let ball = shapes::uv_sphere(60, Vec3::ZERO, 1.0);
    corners.extend((0..ball.len() as u32).map(|triangle| ball.corners(triangle)));
    let (_, stats) = build(&mesh(corners), &BuildOptions::default());
    assert!(stats.references < 5 * stats.primitives, "{stats}");
    assert!(stats.references < 10 * stats.leaves, "{stats}");
}

#[test]
fn identical_triangles_do_not_multiply() {
    let (_, stats) = build(&mesh(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1000]), &Default::default());
    assert_eq!((stats.references, stats.nodes, stats.depth), (1000, 1, 1), "{stats}");
}

#[test]
fn crossing_diagonals_keep_within_the_limit() {
    let mut rng = Rng::new(5);
    let diagonals = (0..20_000).map(|_| {
        let [a, b] = [rng.in_cube(), rng.in_cube()];
        let from = Vec3::new(-1.0, a.y, a.z);
        [from, Vec3::new(1.0, b.y, b.z), from + Vec3::splat(1e-4)]
    });
    build(&mesh(diagonals.collect()), &BuildOptions::default());
}

#[test]
fn a_huge_triangle_among_a_million_tiny_ones_costs_little() {
    let mut rng = Rng::new(6);
    let mut corners = vec![[Vec3::splat(-1e4), Vec3::new(1e4, -1e4, 1e4), Vec3::splat(1e4)]];
    corners.extend((0..1_000_000).map(|_| {
        let center = rng.in_cube();
        [(); 3].map(|()| center + 1e-3 * rng.in_cube())
    }));
    let mesh = mesh(corners);
    let octree = Octree::build(&mesh, &BuildOptions::default()).expect("it builds");
    let stats = octree.stats();
    assert!(stats.references <= 3 * stats.primitives, "{stats}");
    assert!(stats.bytes < 50 << 20, "{stats}");
}

/// A mesh that counts how often its first triangle is tested.
struct Watched(TriangleMesh, AtomicUsize);

impl Geometry for Watched {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn bounds(&self, primitive: u32) -> Aabb {
        self.0.bounds(primitive)
    }
    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.1.fetch_add(usize::from(primitive == 0), Ordering::Relaxed);
        self.0.intersect(primitive, ray)
    }
    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

#[test]
fn a_primitive_of_many_cells_is_seldom_tested_again() {
    // One triangle whose bounds hold a fine cloud is in every leaf; the ray passes it by.
    let mut rng = Rng::new(9);
    let mut corners = vec![[Vec3::splat(-1.0), Vec3::ONE, Vec3::new(1.0, 1.0, 0.9)]];
    corners.extend((0..50_000).map(|_| {
        let center = rng.in_cube();
        [(); 3].map(|()| center + 1e-4 * rng.in_cube())
    }));
    let watched = Watched(mesh(corners), AtomicUsize::new(0));
    let octree = Octree::build(&watched, &BuildOptions::default()).expect("it builds");
    let mut counts = Counts::default();
    let ray = Ray::new([-2.0, -2.3, -2.1], [1.0, 1.1, 1.05]);
    assert_eq!(octree.intersect(&watched, &ray, &mut counts), None);
    let tests = watched.1.into_inner();
    assert!(counts.primitives > 100 && tests < 20, "{tests} of {counts:?}");
}

#[test]
fn far_cells_are_not_looked_into() {
    // Behind the first wall of many nothing is tested.
    let walls = (0..4000).map(|i| {
        let x = i as f32;
        [Vec3::new(x, -2e3, -2e3), Vec3::new(x, 6e3, -2e3), Vec3::new(x, -2e3, 6e3)]
    });
    let mesh = mesh(walls.collect());
    let (octree, stats) = build(&mesh, &BuildOptions::default());
    let mut counts = Counts::default();
    let ray = Ray::new([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
    let hit = octree.intersect(&mesh, &ray, &mut counts);
    assert_eq!(hit.map(|hit| hit.primitive), Some(0));
    assert!(counts.primitives as usize <= 2 * stats.max_leaf_primitives, "{counts:?} {stats}");
}

/// Geometry that denies every part of its primitives, or whose boxes are not finite.
struct Odd(Aabb);

impl Geometry for Odd {
    fn len(&self) -> usize {
        100
    }
    fn bounds(&self, _: u32) -> Aabb {
        self.0
    }
    fn clipped_bounds(&self, _: u32, _: &Aabb) -> Aabb {
        Aabb::EMPTY
    }
    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }
    fn surface_point(&self, ray: &Ray, _: &Hit) -> SurfacePoint {
        SurfacePoint { position: ray.origin, normal: Vec3::Y, clearance: 0.0 }
    }
}

#[test]
fn odd_geometry_is_no_trouble() {
    let odd = Odd(Aabb::new([0.0; 3], [1.0; 3]));
    let octree = Octree::build(&odd, &BuildOptions::default()).expect("it builds");
    octree.validate(&odd).expect("a valid octree");
    assert_eq!(octree.stats().nodes, 1);

    let broken = Odd(Aabb::new([0.0; 3], [f32::INFINITY; 3]));
    let result = Octree::build(&broken, &BuildOptions::default());
    assert!(matches!(result, Err(BuildError::BadBounds { primitive: 0, .. })));
}
