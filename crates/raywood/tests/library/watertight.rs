//! No ray gets through a closed mesh, and none that starts on a surface hits it again.

use raywood::{BuildOptions, Bvh, HitColumns, Ray, SimdLevel, TriangleMesh, Vec3};
use raywood_testkit::{Rng, rays, shapes};

/// Closed meshes around a point that is well inside of each, with their size.
fn closed_meshes() -> Vec<(&'static str, TriangleMesh, Vec3, f32)> {
    let far = Vec3::new(148376.0, 1234.0, -223423.0);
    let mut meshes = vec![];
    for (center, radius) in
        [(Vec3::ZERO, 1.0), (far, 50.0), (Vec3::splat(1e-3), 1e-6), (Vec3::splat(1e5), 1e9)]
    {
        for segments in [5, 50] {
            meshes.push(("sphere", shapes::uv_sphere(segments, center, radius), center, radius));
        }
        let half = Vec3::splat(radius);
        meshes.push(("box", shapes::grid_box(1, center - half, center + half), center, radius));
        meshes.push((
            "box of grids",
            shapes::grid_box(10, center - half, center + half),
            center,
            radius,
        ));
    }
    meshes
}

/// Points on the mesh where neighbours meet: its vertices, and points on its edges.
fn seams(mesh: &TriangleMesh, rng: &mut Rng) -> Vec<Vec3> {
    let mut points = mesh.positions().to_vec();
    for triangle in 0..mesh.triangles().len() as u32 {
        let [p0, p1, p2] = mesh.corners(triangle);
        points.extend([0.5 * (p0 + p1), p1 + rng.unit() * (p2 - p1)]);
    }
    points
}

#[test]
fn no_ray_leaks_from_inside() {
    let mut rng = Rng::new(1);
    for (name, mesh, center, radius) in closed_meshes() {
        let bvh = Bvh::build(&mesh).expect("it builds");
        let inside = |rng: &mut Rng| center + 0.5 * radius * rng.in_cube();
        let mut rays: Vec<Ray> =
            (0..50_000).map(|_| Ray::new(inside(&mut rng), rng.direction())).collect();

        // At vertices and edges, from a random point and from the very centre; along the axes, in the planes of vertices.
        for point in seams(&mesh, &mut rng) {
            let from = inside(&mut rng);
            rays.extend([Ray::new(from, point - from), Ray::new(center, point - center)]);
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for &vertex in mesh.positions().iter().take(2000) {
                let from = center + 0.5 * (vertex - center);
                rays.extend([Ray::new(from, axis), Ray::new(from, -axis), Ray::new(center, axis)]);
            }
        }

        for ray in rays.iter().filter(|ray| ray.is_valid()) {
            assert!(bvh.intersect(ray).is_some(), "{name} of size {radius}: {ray:?} leaks");
            assert!(bvh.occluded(ray), "{name} of size {radius}: {ray:?} is not blocked");
        }
    }
}

#[test]
fn no_ray_passes_through_from_outside() {
    let mut rng = Rng::new(2);
    for (name, mesh, center, radius) in closed_meshes() {
        let bvh = Bvh::build(&mesh).expect("it builds");
        for target in seams(&mesh, &mut rng) {
            let from = center + 4.0 * radius * rng.direction();
            // Rays that only graze the silhouette may miss.
            let (outwards, direction) = (target - center, target - from);
            if outwards.dot(direction) > -0.85 * outwards.length() * direction.length() {
                continue;
            }
            let ray = Ray::new(from, direction);
            let hit = bvh
                .intersect(&ray)
                .unwrap_or_else(|| panic!("{name} of size {radius}: {ray:?} passes through"));
            let reach = from.abs().max_element().max(radius);
            let tolerance = 64.0 * f32::EPSILON * reach / radius;
            assert!(
                hit.t < 1.0 + tolerance.max(1e-4),
                "{name} of size {radius}: {hit:?} with {ray:?}"
            );
        }
    }
}

#[test]
fn spawned_rays_leave_their_surface() {
    let mut rng = Rng::new(3);
    let mut spawned = 0;
    for exponent in -6..=9 {
        let scale = 10f32.powi(exponent);
        for offset in [Vec3::ZERO, Vec3::new(0.3, 7.0, -2.0), Vec3::new(1000.0, 10.0, -700.0)] {
            let center = scale * offset;
            let half = Vec3::splat(scale);
            for mesh in [
                shapes::grid_box(1, center - half, center + half),
                shapes::grid_box(7, center - half, center + half),
                shapes::uv_sphere(24, center, scale),
            ] {
                let bvh = Bvh::build(&mesh).expect("it builds");
                for _ in 0..2000 {
                    let from = center + 4.0 * scale * rng.direction();
                    let ray = Ray::new(from, center + 0.5 * scale * rng.in_cube() - from);
                    let hit = bvh.intersect(&ray).expect("the centre is inside");
                    let point = bvh.surface_point(&ray, &hit);

                    // Convex, so a ray outwards is free, all the way to a light, and one inwards hits the other side.
                    let direction = rng.direction();
                    let out =
                        if direction.dot(point.normal) < 0.0 { -direction } else { direction };
                    let away = point.spawn(out);
                    assert!(
                        !bvh.occluded(&away),
                        "scale {scale}: {away:?} hits {:?}",
                        bvh.intersect(&away)
                    );
                    let light = point.position + 3.0 * scale * out;
                    assert!(
                        !bvh.occluded(&point.spawn_towards(light)),
                        "scale {scale}: no light at {point:?}"
                    );
                    let inwards = point.spawn(-out);
                    assert!(bvh.occluded(&inwards), "scale {scale}: {inwards:?} leaks");
                    spawned += 1;
                }
            }
        }
    }
    assert!(spawned > 100_000, "only {spawned} rays");
}

#[test]
fn spawned_rays_leave_slivers() {
    let mut rng = Rng::new(4);
    let mut spawned = 0;
    for aspect in [1.0, 1e2, 1e4] {
        for distance in [0.0, 10.0, 1e5] {
            for _ in 0..10_000 {
                let center = distance * rng.direction();
                let along = rng.direction();
                let across = along.orthonormal_basis().0 / aspect;
                let p0 = center + 0.5 * along;
                let p1 = center - 0.5 * along;
                let p2 = center + rng.range(-0.5, 0.5) * along + across;
                let mesh =
                    TriangleMesh::new(vec![p0, p1, p2], vec![[0, 1, 2]]).expect("a triangle");
                let bvh = Bvh::build(&mesh).expect("it builds");

                let (u, v) = (rng.unit(), rng.unit());
                let target = (1.0 - u) * p0 + u * (1.0 - v) * p1 + u * v * p2;
                let from = target + rng.range(0.01, 10.0) * rng.direction();
                let ray = Ray::new(from, target - from);
                let Some(hit) = bvh.intersect(&ray) else { continue };
                let point = bvh.surface_point(&ray, &hit);
                for _ in 0..4 {
                    let away = point.spawn(rng.direction());
                    assert!(!bvh.occluded(&away), "aspect {aspect}: {:?}", bvh.intersect(&away));
                    spawned += 1;
                }
            }
        }
    }
    assert!(spawned > 200_000, "only {spawned} rays");
}

#[test]
fn no_ray_leaks_beside_an_edge_of_large_triangles() {
    let mut rng = Rng::new(5);
    for length in [1.0, 10.0, 1e3, 1e6] {
        let half = Vec3::new(1.0, 1.0, length);
        for cells in [1, 10] {
            let mesh = shapes::grid_box(cells, -half, half);
            let trees = [1, 8, 10_000].map(|max_leaf_size| {
                let options = BuildOptions { max_leaf_size, ..Default::default() };
                Bvh::build_with(&mesh, &options).expect("it builds")
            });
            for nearness in [1.5, 0.1, 1e-3, 1e-5] {
                for _ in 0..4000 {
                    let ray = rays::towards_an_edge(&mut rng, half, nearness);
                    let hit = trees[0].intersect(&ray);
                    assert!(hit.is_some(), "length {length}, {cells} cells: {ray:?} leaks");
                    for tree in &trees {
                        assert_eq!(tree.intersect(&ray), hit, "length {length}: {ray:?}");
                        assert!(tree.occluded(&ray), "length {length}: {ray:?}");
                    }
                }
            }
        }
    }
}

/// A closed sphere, or a plane with a frame of a tenth around what is aimed at.
struct Wall {
    name: String,
    mesh: TriangleMesh,
    /// Where rays start from: around a point, so far.
    from: (Vec3, f32),
    /// Which triangles are aimed at.
    is_target: fn([Vec3; 3], Vec3) -> bool,
    center: Vec3,
}

/// Spheres of so many subdivisions and planes, at the origin and far from it.
fn walls(subdivisions: &[u32]) -> Vec<Wall> {
    let mut walls = Vec::new();
    for center in [Vec3::ZERO, Vec3::new(148376.0, 1234.0, -223423.0)] {
        for &count in subdivisions {
            walls.push(Wall {
                name: format!("a sphere of {count} at {center:?}"),
                mesh: shapes::uv_sphere(count, center, 2.0),
                from: (center, 0.5),
                is_target: |_, _| true,
                center,
            });
            // Askew, so that no coordinate is the same for all.
            let place = |i: u32| 4.0 * (i as f32 / count as f32 - 0.5);
            let corner = |k: u32| {
                let (x, z) = (place(k % (count + 1)), place(k / (count + 1)));
                center + Vec3::new(x, 0.25 * z - 0.125 * x, z)
            };
            let positions: Vec<_> = (0..(count + 1) * (count + 1)).map(corner).collect();
            let triangles = (0..count * count).flat_map(|k| {
                let a = k / count * (count + 1) + k % count;
                let [b, c, d] = [a + 1, a + count + 1, a + count + 2];
                [[a, b, c], [b, d, c]]
            });
            let triangles = triangles.collect();
            walls.push(Wall {
                name: format!("a plane of {count} at {center:?}"),
                mesh: TriangleMesh::new(positions, triangles).expect("a plane"),
                from: (center + 3.0 * Vec3::Y, 0.5),
                is_target: |corners, center| {
                    corners.iter().all(|&p| (p - center).abs().max_element() < 1.8)
                },
                center,
            });
        }
    }
    walls
}

/// Aims so many rays at every wall, on every level of instructions and in every way to trace; returns how many there were.
fn aim_at_walls(subdivisions: &[u32], count: usize) -> usize {
    let mut rng = Rng::new(8);
    let mut traced = 0;
    for Wall { name, mesh, from: (start, reach), is_target, center } in walls(subdivisions) {
        let targets: Vec<_> = (0..mesh.triangles().len() as u32)
            .map(|triangle| mesh.corners(triangle))
            .filter(|&corners| is_target(corners, center))
            .collect();
        let mut target = |number: usize| {
            let [a, b, c] = targets[rng.below(targets.len())];
            let (u, v) = (rng.unit(), rng.unit());
            match number % 4 {
                0 => a,
                1 => 0.5 * (b + c),
                2 => c + u * (a - c),
                _ => (1.0 - u) * a + u * (1.0 - v) * b + u * v * c,
            }
        };
        let aims: Vec<_> = (0..count).map(&mut target).collect();
        // One half from one point, which travel as packets, the other from anywhere inside.
        let mut origin = |number: usize| {
            if number < count / 2 { start } else { start + reach * rng.in_cube() }
        };
        let rays: Vec<_> = aims
            .iter()
            .enumerate()
            .map(|(number, &aim)| {
                let from = origin(number);
                // Some end, well behind the wall.
                let ray = Ray::new(from, aim - from);
                if number % 5 == 0 { ray.with_interval(0.0, 1.5) } else { ray }
            })
            .collect();
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
            bvh.set_simd_level(level);
            let (mut hits, mut occluded) = (vec![None; count], vec![false; count]);
            bvh.intersect_batch(&rays, &mut hits);
            bvh.occluded_batch(&rays, &mut occluded);
            let directions: Vec<_> = rays[..count / 2].iter().map(|ray| ray.direction).collect();
            let mut columns = HitColumns::default();
            bvh.intersect_from(start, &directions, &mut columns);
            for (number, ray) in rays.iter().enumerate() {
                let in_packet = columns.get(number.min(count / 2 - 1));
                let is_hit = hits[number].is_some() && occluded[number] && in_packet.is_some();
                assert!(is_hit, "{level:?}, {name}: {ray:?} leaks");
                if number % 8 == 0 {
                    assert!(bvh.intersect(ray).is_some(), "{level:?}, {name}: {ray:?} leaks");
                    assert!(bvh.occluded(ray), "{level:?}, {name}: {ray:?} is not blocked");
                    // Vertices so far away are rounded to a lattice: the surface may be folded.
                    assert_eq!(bvh.crossings(ray) % 2, 1, "{level:?}, {name}: {ray:?}");
                }
            }
            traced += 2 * count;
        }
    }
    traced
}

#[test]
fn no_ray_leaks_through_spheres_and_planes_on_any_level() {
    assert!(aim_at_walls(&[50, 100], 12_000) > 100_000);
}

#[test]
#[ignore = "takes minutes: cargo test --release --test library -- --ignored millions_of_rays"]
fn millions_of_rays_leak_through_no_sphere_or_plane_on_any_level() {
    assert!(aim_at_walls(&[50, 75, 100, 150, 200], 500_000) > 10_000_000);
}
