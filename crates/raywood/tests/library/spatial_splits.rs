//! Trees in which large triangles are cut: every answer as if they were not, each primitive told of once.

use std::collections::HashSet;
use std::ops::ControlFlow;

use raywood::{
    Aabb, Ball, BuildOptions, BuildPreset, Bvh, Hit, Joined, Ray, SimdLevel, Spheres, Structure,
    StructureKind, TriangleMesh, Vec3, WideBvh,
};
use raywood_testkit::{Rng, nasty, oracle, points, rays, shapes};

/// Options that cut as much as they can.
fn cutting() -> BuildOptions {
    BuildOptions { spatial_splits: 4.0, ..Default::default() }
}

fn uncut(mesh: &TriangleMesh) -> Bvh<&TriangleMesh> {
    Bvh::build(mesh).expect("it builds")
}

fn cut(mesh: &TriangleMesh) -> Bvh<&TriangleMesh> {
    let bvh = Bvh::build_with(mesh, &cutting()).expect("it builds");
    bvh.validate().expect("it is sound");
    bvh
}

/// Small triangles, and beams through them.
fn beams(offset: Vec3, scale: f32) -> TriangleMesh {
    shapes::mapped(&shapes::beams(600, 80), |p| offset + scale * p)
}

/// A room of a few large triangles with a fine sphere in it, turned so that nothing is along an axis; closed.
fn room() -> TriangleMesh {
    let turned = |p: Vec3| {
        let p = Vec3::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, p.z);
        Vec3::new(p.x, 0.28 * p.y - 0.96 * p.z, 0.96 * p.y + 0.28 * p.z)
    };
    let walls = shapes::grid_box(1, Vec3::splat(-1.0), Vec3::ONE);
    let sphere = shapes::uv_sphere(24, Vec3::new(0.3, 0.2, -0.1), 0.3);
    let mut positions = walls.positions().to_vec();
    let first = positions.len() as u32;
    positions.extend(sphere.positions());
    let mut triangles = walls.triangles().to_vec();
    triangles.extend(sphere.triangles().iter().map(|t| t.map(|vertex| vertex + first)));
    let positions = positions.into_iter().map(turned).collect();
    TriangleMesh::new(positions, triangles).expect("finite")
}

/// Meshes of which some triangles are cut for certain.
fn cuttable() -> Vec<(&'static str, TriangleMesh)> {
    vec![
        ("beams", beams(Vec3::ZERO, 1.0)),
        ("small beams far away", beams(Vec3::new(1000.0, -30.0, 2.0), 1e-2)),
        ("large beams", beams(Vec3::ZERO, 1e9)),
        ("a room", room()),
    ]
}

#[test]
fn triangles_stay_whole_where_such_trees_are_better() {
    let options = BuildOptions { spatial_splits: 4.0, ..BuildPreset::Best.options() };
    for (mesh, is_cut) in [(shapes::soup(200, 0.5, 1), false), (shapes::beams(600, 80), true)] {
        let bvh = Bvh::build_with(mesh, &options).expect("it builds");
        bvh.validate().expect("it is sound");
        assert_eq!(bvh.stats().duplication() > 1.0, is_cut);
    }
}

/// Rays that look for trouble: from the usual places, from far away, at edges and along triangles.
fn hard_rays(mesh: &TriangleMesh) -> Vec<Ray> {
    let mut rays = rays::against(mesh, 6000, 3);
    let bounds = mesh.total_bounds();
    let (center, size) = (bounds.center(), bounds.diagonal());
    let mut rng = Rng::new(11);
    for number in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.corners(number);
        let along_edge = a + rng.unit() * (b - a);
        let inside = a + rng.unit() * 0.5 * (b - a) + rng.unit() * 0.5 * (c - a);
        for distance in [0.7, 5.0, 60.0, 3000.0] {
            let from = center + distance * size * rng.direction();
            rays.extend([along_edge, inside, a].map(|target| Ray::new(from, target - from)));
        }
        // Next to the plane of the triangle.
        let across = (b - a).cross(c - a).normalize_or_zero();
        let from = inside + size * (b - a).normalize_or_zero() + 1e-4 * size * across;
        rays.push(Ray::new(from, inside - from));
        rays.push(Ray { t_max: 1.0, ..Ray::new(from, along_edge - from) });
    }
    rays
}

#[test]
fn triangles_are_cut_within_the_room_there_is_for_it() {
    for (name, mesh) in cuttable() {
        let count = mesh.triangles().len();
        for share in [0.05, 0.5] {
            let options = BuildOptions { spatial_splits: share, ..Default::default() };
            let bvh = Bvh::build_with(&mesh, &options).expect("it builds");
            bvh.validate().expect("it is sound");
            let references = (bvh.stats().duplication() * count as f64).round() as usize;
            assert!(references > count, "{name}: nothing is cut");
            let most = count + (f64::from(share) * count as f64) as usize;
            assert!(references <= most, "{name}: {references} references of {most}");
        }
        assert!((uncut(&mesh).stats().duplication() - 1.0).abs() < 1e-9, "{name}");
    }
}

#[test]
fn hits_are_the_same_to_the_bit() {
    let meshes = cuttable().into_iter();
    let nasty = nasty::all().into_iter().map(|nasty| (nasty.name, nasty.mesh));
    for (name, mesh) in meshes.chain(nasty) {
        let (reference, mut bvh) = (uncut(&mesh), cut(&mesh));
        let rays: Vec<Ray> = hard_rays(&mesh).into_iter().filter(Ray::is_valid).collect();
        // In no order, so that no packets are made.
        let mut rng = Rng::new(1);
        let shuffled: Vec<Ray> = rays.iter().map(|_| rays[rng.below(rays.len())]).collect();
        let expected: Vec<_> = shuffled.iter().map(|ray| reference.intersect(ray)).collect();
        for level in SimdLevel::available() {
            bvh.set_simd_level(level);
            let mut hits = vec![None; shuffled.len()];
            bvh.intersect_batch(&shuffled, &mut hits);
            let mut blocked = vec![false; shuffled.len()];
            bvh.occluded_batch(&shuffled, &mut blocked);
            let answers = hits.into_iter().zip(blocked);
            for ((ray, expected), (hit, blocked)) in shuffled.iter().zip(&expected).zip(answers) {
                assert_eq!(bvh.intersect(ray), *expected, "{name}: {ray:?}");
                let agrees = match (&hit, expected) {
                    (Some(hit), Some(expected)) => hit.agrees_with(expected),
                    (hit, expected) => hit == expected,
                };
                assert!(agrees, "{name}: {hit:?}, not {expected:?}: {ray:?}");
                assert_eq!(bvh.occluded(ray), expected.is_some(), "{name}: {ray:?}");
                assert_eq!(blocked, expected.is_some(), "{name}: {ray:?}");
            }
        }
    }
}

#[test]
fn no_ray_leaks_where_triangles_are_cut() {
    let mesh = room();
    let bvh = cut(&mesh);
    assert!(bvh.stats().duplication() > 1.0);
    let mut rng = Rng::new(2);
    for number in 0..mesh.triangles().len() as u32 {
        let [a, b, _] = mesh.corners(number);
        for _ in 0..200 {
            // From the middle of the room, which is outside of the sphere, at edges.
            let from = 0.05 * rng.in_cube() - Vec3::splat(0.3);
            let target = a + rng.unit() * (b - a);
            let ray = Ray::new(from, target - from);
            assert!(bvh.intersect(&ray).is_some() && bvh.occluded(&ray), "{ray:?}");
        }
    }
}

#[test]
fn packets_answer_as_single_rays_do() {
    for (name, mesh) in cuttable() {
        let reference = uncut(&mesh);
        let mut structure =
            Structure::build(StructureKind::BvhWide, &mesh, &cutting()).expect("ok");
        let bounds = mesh.total_bounds();
        let (center, size) = (bounds.center(), bounds.diagonal());
        let mut rng = Rng::new(4);
        for level in SimdLevel::available() {
            structure.set_simd_level(level);
            for distance in [0.01, 0.6, 3.0, 20.0, 500.0] {
                let eye = center + distance * size * rng.direction();
                let targets: Vec<Vec3> = (0..2048)
                    .map(|i| {
                        let [a, b, c] = mesh.corners((i * 7 % mesh.triangles().len()) as u32);
                        let (u, v) = (0.5 * rng.unit(), 0.5 * rng.unit());
                        if i % 3 == 0 { a + u * (b - a) } else { a + u * (b - a) + v * (c - a) }
                    })
                    .collect();
                let out: Vec<Ray> = targets.iter().map(|&p| Ray::new(eye, p - eye)).collect();
                let shadow = |&p: &Vec3| Ray { t_max: 0.999, ..Ray::new(p, eye - p) };
                let back: Vec<Ray> = targets.iter().map(shadow).collect();
                let sun = eye - center;
                let parallel: Vec<Ray> = targets.iter().map(|&p| Ray::new(p, sun)).collect();
                // As if from a mirror behind the eye.
                let mirrored = targets.iter().map(|&p| {
                    let d = p - eye;
                    Ray::new(eye + 0.1 * d, d)
                });
                for rays in [out, back, parallel, mirrored.collect()] {
                    let mut hits = vec![None; rays.len()];
                    structure.intersect_batch(&rays, &mut hits);
                    let mut blocked = vec![false; rays.len()];
                    structure.occluded_batch(&rays, &mut blocked);
                    for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
                        let expected = reference.intersect(ray);
                        let agree = match (hit, &expected) {
                            (Some(hit), Some(expected)) => hit.agrees_with(expected),
                            (hit, expected) => hit == expected,
                        };
                        assert!(
                            agree,
                            "{name} from {distance}: {hit:?}, not {expected:?}: {ray:?}"
                        );
                        assert_eq!(blocked, expected.is_some(), "{name} from {distance}: {ray:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn each_hit_is_told_once() {
    for (name, mesh) in cuttable() {
        let (reference, bvh) = (uncut(&mesh), cut(&mesh));
        let (mut expected, mut found) = (Vec::new(), Vec::new());
        let mut several = 0;
        for ray in hard_rays(&mesh).iter().filter(|ray| ray.is_valid()).step_by(3) {
            reference.all_hits(ray, &mut expected);
            bvh.all_hits(ray, &mut found);
            assert_eq!(found, expected, "{name}: {ray:?}");
            oracle::check_all(&mesh, ray, &found, found.len()).unwrap();
            several += usize::from(found.len() > 1);
            let nearest = |bvh: &Bvh<_>, hits: &mut Vec<Hit>| bvh.nearest_hits(ray, 3, hits);
            nearest(&reference, &mut expected);
            nearest(&bvh, &mut found);
            assert_eq!(found, expected, "{name}: {ray:?}");
        }
        assert!(several > 100, "{name}");
    }
}

#[test]
fn what_overlaps_is_told_once() {
    for (name, mesh) in cuttable() {
        let (reference, bvh) = (uncut(&mesh), cut(&mesh));
        let bounds = mesh.total_bounds();
        let mut rng = Rng::new(6);
        for _ in 0..200 {
            let center = bounds.center() + 0.5 * bounds.diagonal() * rng.in_cube();
            let half = Vec3::splat(0.2 * rng.unit() * bounds.diagonal());
            let cell = Aabb::new(center - half, center + half);
            let ball = Ball::new(center, half.x);
            let told = |bvh: &Bvh<&TriangleMesh>, in_ball: bool| {
                let mut all = Vec::new();
                let mut visit = |primitive| {
                    all.push(primitive);
                    ControlFlow::Continue(())
                };
                let _ = match in_ball {
                    true => bvh.overlapping(&ball, &mut visit),
                    false => bvh.overlapping(&cell, &mut visit),
                };
                all.sort_unstable();
                all
            };
            for in_ball in [false, true] {
                assert_eq!(told(&bvh, in_ball), told(&reference, in_ball), "{name}");
            }
        }

        // Everything, by a walk of one's own, and in pairs.
        let mut visited = Vec::new();
        let _ = bvh.visit(
            |_| Some(0.0),
            |primitive| {
                visited.push(primitive);
                ControlFlow::Continue(0.0)
            },
        );
        visited.sort_unstable();
        assert!(visited.into_iter().eq(0..mesh.triangles().len() as u32), "{name}");
        let pairs = |one: &Bvh<&TriangleMesh>, other: &Bvh<&TriangleMesh>| {
            let (mut all, mut count) = (HashSet::new(), 0);
            let _ = one.overlapping_pairs(other, |a, b| {
                all.insert((a, b));
                count += 1;
                ControlFlow::Continue(())
            });
            assert_eq!(all.len(), count, "{name}: a pair is told twice");
            all
        };
        let expected = pairs(&reference, &reference);
        assert!(expected.len() > mesh.triangles().len());
        assert_eq!(pairs(&bvh, &bvh), expected, "{name}");
        assert_eq!(pairs(&reference, &bvh), expected, "{name}");
    }
}

#[test]
fn what_is_near_is_the_same() {
    for (name, mesh) in cuttable() {
        let (reference, bvh) = (uncut(&mesh), cut(&mesh));
        let solids = (reference.solid(), bvh.solid());
        let size = mesh.total_bounds().diagonal();
        for point in points::around(&mesh, 600, 8) {
            assert_eq!(
                bvh.closest_point(point, f32::INFINITY),
                reference.closest_point(point, f32::INFINITY),
                "{name}: {point:?}"
            );
            let winding = (solids.0.winding_number(point), solids.1.winding_number(point));
            let near = reference
                .closest_point(point, f32::INFINITY)
                .is_none_or(|p| p.distance < 1e-5 * size);
            assert!(
                near || (winding.0 - winding.1).abs() < 0.06,
                "{name}: {winding:?} at {point:?}"
            );
        }
        let mut rng = Rng::new(12);
        for ray in rays::against(&mesh, 500, 13).iter().filter(|ray| ray.is_valid()) {
            let radius = 0.05 * size * rng.unit();
            let touch = bvh.sphere_cast(ray, radius);
            assert_eq!(touch, reference.sphere_cast(ray, radius), "{name}: {radius}, {ray:?}");
        }
    }
}

#[test]
fn the_same_tree_on_any_number_of_threads() {
    // Enough for subtrees in parallel.
    let mesh = shapes::soup(20_000, 0.3, 4);
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let options = BuildOptions { spatial_splits: 0.5, ..Default::default() };
        pool.install(|| WideBvh::build(&mesh, &options).expect("it builds"))
    };
    let one = build(1);
    assert!(one == build(2) && one == build(3));
}

#[test]
fn spheres_are_never_cut() {
    let mesh = room();
    let count = 50;
    let mut rng = Rng::new(14);
    let spheres = (0..count).map(|_| (rng.in_cube(), 0.3 * rng.unit())).collect();
    let spheres = Spheres::new(spheres).expect("finite");
    let joined = Joined { first: &mesh, second: &spheres };
    let bvh = Bvh::build_with(joined, &cutting()).expect("it builds");
    bvh.validate().expect("it is sound");
    let reference = Bvh::build(joined).expect("it builds");
    let mut times = vec![0; mesh.triangles().len() + count];
    let _ = bvh.visit(
        |_| Some(0.0),
        |primitive| {
            times[primitive as usize] += 1;
            ControlFlow::Continue(0.0)
        },
    );
    assert!(times.iter().all(|&times| times == 1));
    for ray in rays::against(&mesh, 5000, 15).iter().filter(|ray| ray.is_valid()) {
        assert_eq!(bvh.intersect(ray), reference.intersect(ray), "{ray:?}");
    }
}
