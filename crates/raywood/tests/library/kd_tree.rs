//! The kD-tree's own corners: exact clipping of triangles, bounds on memory, rays in its planes.

use raywood::{
    Aabb, AccelerationStructure, BruteForce, BuildOptions, Counts, Geometry, KdTree, Ray,
    TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, rays, shapes};

fn build(mesh: &TriangleMesh) -> KdTree {
    let tree = KdTree::build(mesh, &BuildOptions::default()).expect("it builds");
    tree.validate(mesh).expect("it is valid");
    tree
}

fn assert_same_hits(mesh: &TriangleMesh, tree: &KdTree, rays: impl IntoIterator<Item = Ray>) {
    let reference = BruteForce::build(mesh, &BuildOptions::default()).expect("it builds");
    for ray in rays {
        let hit = reference.intersect(mesh, &ray, &mut ());
        assert_eq!(tree.intersect(mesh, &ray, &mut ()), hit, "{ray:?}");
        assert_eq!(tree.occluded(mesh, &ray, &mut ()), hit.is_some(), "{ray:?}");
    }
}

#[test]
fn clipped_bounds_hold_every_sampled_point_and_little_more() {
    let mut rng = Rng::new(1);
    let (mut loose, mut compared) = (0, 0);
    for scale in [1.0, 1e-30, 1e30] {
        for far in [0.0, 1000.0] {
            for _ in 0..1000 {
                let mut point = || scale * (rng.in_cube() + Vec3::splat(far));
                let corners = [point(), point(), point()];
                let cell = Aabb::of_points([point(), point()]);
                let mesh = TriangleMesh::new(corners.to_vec(), vec![[0, 1, 2]]).expect("a mesh");
                let clipped = mesh.clipped_bounds(0, &cell);
                assert!(cell.contains(&clipped) && mesh.bounds(0).contains(&clipped));

                // Samples inside the cell lie in the box, and a dense lattice of them nearly fills it.
                let mut sampled = Aabb::EMPTY;
                for i in 0..=60 {
                    for j in 0..=60 - i {
                        let (u, v) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                        let [a, b, c] = corners.map(|p| p.to_array().map(f64::from));
                        let sample = [0, 1, 2].map(|k| (1.0 - u - v) * a[k] + u * b[k] + v * c[k]);
                        let inside = |k: usize, x: f64| {
                            f64::from(cell.min[k]) <= x && x <= f64::from(cell.max[k])
                        };
                        if (0..3).all(|k| inside(k, sample[k])) {
                            let holds = |k: usize, x: f64| {
                                f64::from(clipped.min[k]) <= x && x <= f64::from(clipped.max[k])
                            };
                            assert!((0..3).all(|k| holds(k, sample[k])), "{sample:?} {clipped:?}");
                            sampled = sampled.including(Vec3::from(sample.map(|x| x as f32)));
                        }
                    }
                }
                if !sampled.is_empty() {
                    let extent = mesh.bounds(0).extent().max_element();
                    let slack = Vec3::splat(0.05 * extent + 1e-3 * far * scale);
                    let larger = Aabb::new(sampled.min - slack, sampled.max + slack);
                    compared += 1;
                    loose += usize::from(!larger.contains(&clipped));
                }
            }
        }
    }
    // Sharp corners may lie between the samples, but seldom.
    assert!(compared > 500 && 50 * loose < compared, "{loose} of {compared} boxes are loose");
}

#[test]
fn a_triangle_that_only_touches_a_cell_is_in_it() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]]).expect("a mesh");
    let touched = [
        ([1.0, -1.0, -1.0], [2.0, 1.0, 1.0]),
        ([-1.0, -1.0, 0.0], [2.0, 2.0, 1.0]),
        ([0.5, 0.5, -1.0], [1.0, 1.0, 1.0]),
        ([0.25, 0.25, 0.0], [0.25, 0.25, 0.0]),
    ];
    for (min, max) in touched {
        assert!(!mesh.clipped_bounds(0, &Aabb::new(min, max)).is_empty(), "{min:?} {max:?}");
        assert!(mesh.overlaps(0, &Aabb::new(min, max)), "{min:?} {max:?}");
    }
    // The corner of its box that the triangle does not reach.
    let beyond = Aabb::new([0.6, 0.6, -1.0], [1.0, 1.0, 1.0]);
    assert!(mesh.clipped_bounds(0, &beyond).is_empty() && !mesh.overlaps(0, &beyond));
}

#[test]
fn overlap_and_clipping_agree_but_for_rounding() {
    let mut rng = Rng::new(11);
    let (mut overlapping, mut apart) = (0, 0);
    for scale in [1.0, 1e-30, 1e30] {
        for (far, length) in [(0.0, 1.0), (1000.0, 1.0), (0.0, 1e-4), (10.0, 1e3)] {
            for i in 0..2000 {
                let center = rng.in_cube() + Vec3::splat(far);
                let mut corner = |length: f32| scale * (center + length * rng.in_cube());
                // Every other triangle is a sliver.
                let (a, b) = (corner(length), corner(length));
                let c = if i % 2 == 0 { corner(length) } else { a + 0.3 * (b - a) };
                let cell = Aabb::of_points([corner(1.0), corner(1.0)]);
                let mesh = TriangleMesh::new(vec![a, b, c], vec![[0, 1, 2]]).expect("a mesh");
                let wider = |by: f32| {
                    let by = Vec3::splat(by * scale * (far + length + 1.0));
                    Aabb { min: cell.min - by, max: cell.max + by }
                };
                let clipped = |cell: &Aabb| !mesh.clipped_bounds(0, cell).is_empty();
                if mesh.overlaps(0, &cell) {
                    overlapping += 1;
                    assert!(clipped(&wider(1e-6)), "{a:?} {b:?} {c:?} {cell:?}");
                } else {
                    apart += 1;
                    assert!(!clipped(&wider(-1e-6)), "{a:?} {b:?} {c:?} {cell:?}");
                }
            }
        }
    }
    assert!(overlapping > 3000 && apart > 3000, "{overlapping} {apart}");
}

#[test]
fn rays_in_planes_hit_what_they_hit_elsewhere() {
    // A lattice of walls: every plane of the tree holds triangles, edges and vertices.
    let mesh = shapes::grid_box(8, Vec3::ZERO, Vec3::splat(8.0));
    let tree = build(&mesh);
    let mut rays = Vec::new();
    for i in 0..=8 {
        for j in 0..=8 {
            let (a, b) = (i as f32, j as f32);
            for zero in [0.0, -0.0] {
                rays.extend([
                    Ray::new([a, b, -1.0], [zero, zero, 1.0]),
                    Ray::new([a, 4.5, b], [zero, -1.0, zero]),
                    Ray::new([9.0, a, b], [-1.0, zero, zero]),
                    Ray::new([a, b, -1.0], [0.5, zero, 1.0]),
                    Ray::new([a, -1.0, -1.0], [zero, 1.0, 1.0]),
                ]);
            }
        }
    }
    assert_same_hits(&mesh, &tree, rays);
}

#[test]
fn references_are_bounded_on_adversarial_scenes() {
    let mut rng = Rng::new(4);
    let strip = |a: Vec3, b: Vec3| [a, b, b + Vec3::new(1e-4, 0.0, 0.0)];
    let diagonals: Vec<_> = (0..20_000)
        .map(|i| {
            let shift = Vec3::new(0.0, 1e-4 * i as f32, 0.0);
            strip(-Vec3::ONE + shift, Vec3::ONE + shift)
        })
        .collect();
    let crossing: Vec<_> = (0..20_000).map(|_| strip(rng.in_cube(), rng.in_cube())).collect();
    let mut huge_and_tiny = vec![[Vec3::splat(-9.0), 9.0 * Vec3::X, 9.0 * Vec3::Y]; 10];
    huge_and_tiny.extend((0..50_000).map(|_| {
        let center = rng.in_cube();
        [(); 3].map(|()| center + 1e-4 * rng.in_cube())
    }));
    let large: Vec<_> = (0..5_000).map(|_| [(); 3].map(|()| rng.in_cube())).collect();
    for corners in [diagonals, crossing, huge_and_tiny, large] {
        let count = corners.len();
        let indices = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriangleMesh::new(corners.into_flattened(), indices).expect("a mesh");
        let tree = build(&mesh);
        let stats = tree.stats();
        assert!(stats.references <= 6 * count + 64, "{stats}");
        assert!(stats.nodes < 12 * count + 128, "{stats}");
        assert!(stats.depth <= 60, "{stats}");
        assert_same_hits(&mesh, &tree, rays::against(&mesh, 50, 5));
    }
}

#[test]
fn empty_space_is_cut_off_and_few_triangles_are_tested() {
    let mesh = shapes::uv_sphere(100, Vec3::ZERO, 1.0);
    let tree = build(&mesh);
    let mut counts = Counts::default();
    for ray in rays::against(&mesh, 1000, 6) {
        tree.intersect(&mesh, &ray, &mut counts);
    }
    assert!(counts.primitives < 20 * 1000, "{counts:?}");
    assert!(counts.boxes < 100 * 1000, "{counts:?}");
}

#[test]
fn nothing_makes_no_node() {
    let mesh = TriangleMesh::default();
    let tree = build(&mesh);
    assert!(tree.nodes().is_empty() && tree.bounds().is_empty());
    assert_eq!(tree.intersect(&mesh, &Ray::new(Vec3::ZERO, Vec3::X), &mut ()), None);
}
