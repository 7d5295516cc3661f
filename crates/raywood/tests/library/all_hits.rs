//! All hits: each crossing once, so that crossings of closed surfaces come in pairs.

use raywood::{Bvh, Hit, Ray, SimdLevel, TriangleMesh, Vec3};
use raywood_testkit::{Rng, closed, nasty, oracle, rays, shapes};

/// A tree for each level of instructions.
fn trees(mesh: &TriangleMesh) -> Vec<Bvh<&TriangleMesh>> {
    let bvh = Bvh::build(mesh).expect("it builds");
    let at = |level| {
        let mut bvh = bvh.clone();
        bvh.set_simd_level(level);
        bvh
    };
    SimdLevel::available().map(at).collect()
}

/// Directions from a point that look for trouble: at vertices and edges, along edges and axes and in the planes of triangles; the same backwards.
fn directions(mesh: &TriangleMesh, from: Vec3, count: usize, rng: &mut Rng) -> Vec<Vec3> {
    let mut directions = Vec::with_capacity(2 * count);
    for i in 0..count {
        let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
        let (u, v) = (rng.unit(), rng.unit());
        let direction = match i % 8 {
            0 => a - from,
            1 => 0.5 * (a + b) - from,
            2 => a + u * (b - a) - from,
            3 => b - a,
            4 => u * (b - a) + v * (c - a),
            5 => [Vec3::X, Vec3::Y, Vec3::Z][rng.below(3)],
            6 => (a - from).to_array().map(f32::round).into(),
            _ => rng.direction(),
        };
        directions.extend([direction, -direction]);
    }
    directions
}

#[test]
fn closed_surfaces_are_crossed_an_even_number_of_times_from_outside() {
    let mut rng = Rng::new(1);
    let mut crossed = 0;
    for closed::Closed { name, mesh } in closed::all() {
        let bounds = mesh.total_bounds();
        let (center, size) = (bounds.center(), bounds.diagonal());
        let trees = trees(&mesh);
        for i in 0..1000 {
            // Anywhere around, on lattice points, in the planes of the box's faces and of triangles, on the lines of edges.
            let anywhere = center + 2.0 * size * rng.direction();
            let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
            let from = match i % 5 {
                0 => anywhere,
                1 => anywhere.to_array().map(f32::round).into(),
                2 => Vec3::new(anywhere.x, bounds.max.y, anywhere.z),
                3 => a + 1e3 * (b - a),
                _ => a + 500.0 * (b - a) + 300.0 * (c - a),
            };
            let is_outside = [0, 1, 2]
                .into_iter()
                .any(|axis| from[axis] < bounds.min[axis] || from[axis] > bounds.max[axis]);
            if !is_outside {
                continue;
            }
            for direction in directions(&mesh, from, 40, &mut rng) {
                let ray = Ray::new(from, direction);
                let counts: Vec<usize> = trees.iter().map(|bvh| bvh.crossings(&ray)).collect();
                assert!(counts.iter().all(|c| *c == counts[0]), "{name}: {counts:?} with {ray:?}");
                assert_eq!(counts[0] % 2, 0, "{name}: {counts:?} crossings of {ray:?}");
                crossed += counts[0] / 2;
            }
        }
    }
    assert!(crossed > 900_000, "only {crossed}");
}

#[test]
fn all_rays_from_one_point_agree_whether_it_is_inside() {
    let mut rng = Rng::new(2);
    let (mut inside, mut outside) = (0, 0);
    for closed::Closed { name, mesh } in closed::all() {
        let bounds = mesh.total_bounds();
        let bvh = Bvh::build(&mesh).expect("it builds");
        for i in 0..300 {
            let spread = 0.6 * bounds.extent() * rng.in_cube();
            let from = match i % 3 {
                // Off the lattice, where points are never on triangles of lattice meshes.
                0 => bounds.center() + spread,
                1 => bounds.center() + 0.1 * spread,
                _ => mesh.positions()[rng.below(mesh.positions().len())] + 1e-3 * spread,
            };
            let reach = bounds.center().abs().max_element() + bounds.diagonal();
            if is_near(&mesh, from, 1e-12 * f64::from(reach)) {
                continue;
            }
            let mut parities = directions(&mesh, from, 40, &mut rng)
                .into_iter()
                .map(|direction| Ray::new(from, direction))
                .filter(Ray::is_valid)
                .map(|ray| (ray, bvh.crossings(&ray) % 2));
            let (first, parity) = parities.next().expect("some rays are valid");
            for (ray, other) in parities {
                assert_eq!(other, parity, "{name}: {ray:?} and {first:?}");
            }
            *(if parity == 1 { &mut inside } else { &mut outside }) += 1;
        }
    }
    assert!(inside > 2000 && outside > 2000, "{inside} inside, {outside} outside");
}

#[test]
fn rays_that_start_very_near_a_face_know_their_side() {
    // A box, upright and slanted, with a face through zero, where small distances can be told apart. Rays run along the face, hardly turned to it or away.
    let mut rng = Rng::new(4);
    let cube = shapes::grid_box(1, Vec3::new(0.0, -1.0, -1.0), Vec3::new(2.0, 1.0, 1.0));
    for slant in [0.0, 0.5, -0.25] {
        let slanted = |p: Vec3| Vec3::new(p.x + slant * p.y, p.y, p.z);
        let mesh = shapes::mapped(&cube, slanted);
        let bvh = Bvh::build(&mesh).expect("it builds");
        for i in 0..200_000 {
            let small = |rng: &mut Rng| 10f32.powf(rng.range(-13.0, -2.0));
            let (off, tilt) = (small(&mut rng), small(&mut rng));
            let inside = i % 2 == 0;
            let off = if inside { off } else { -off };
            let flat = 1e-4 * off.abs() * rng.in_cube();
            let from = slanted(Vec3::new(off, flat.y, 1e6 * flat.z));
            let along = rng.in_cube();
            let tilt = if i % 4 < 2 { tilt } else { -tilt };
            let (y, z) = if i % 8 < 4 { (along.y, along.z) } else { (tilt * along.y, 1.0) };
            let ray = Ray::new(from, slanted(Vec3::new(tilt, y, z)));
            assert_eq!(bvh.crossings(&ray) % 2 == 1, inside, "{ray:?}");
        }
    }
}

/// Whether a point may lie on a triangle, up to a distance.
fn is_near(mesh: &TriangleMesh, point: Vec3, distance: f64) -> bool {
    let double = |p: Vec3| p.to_array().map(f64::from);
    let sub = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    (0..mesh.triangles().len() as u32).any(|triangle| {
        let corners = mesh.corners(triangle);
        let within = |axis: usize| {
            let of = |pick: fn(f64, f64) -> f64| {
                corners.map(|c| f64::from(c[axis])).into_iter().reduce(pick).expect("three")
            };
            let at = f64::from(point[axis]);
            of(f64::min) - distance <= at && at <= of(f64::max) + distance
        };
        let [a, b, c] = corners.map(double);
        let (e, f) = (sub(b, a), sub(c, a));
        let normal =
            [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let off = dot(normal, sub(double(point), a)).abs();
        (0..3).all(within) && off <= distance * dot(normal, normal).sqrt()
    })
}

#[test]
fn all_hits_agree_with_brute_force() {
    let mut found = 0;
    for (number, nasty) in nasty::all().iter().enumerate() {
        let trees = trees(&nasty.mesh);
        let (mut hits, mut others) = (Vec::new(), Vec::new());
        for ray in rays::against(&nasty.mesh, 1500, number as u64) {
            trees[0].all_hits(&ray, &mut hits);
            oracle::check_all(&nasty.mesh, &ray, &hits, usize::MAX)
                .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            for bvh in &trees[1..] {
                bvh.all_hits(&ray, &mut others);
                assert_eq!(others, hits, "{}: {ray:?}", nasty.name);
            }
            found += hits.len();
        }
    }
    assert!(found > 100_000, "only {found} hits");
}

#[test]
fn shared_edges_and_vertices_are_crossed_once() {
    // A fan around the middle of a square, and a square of two triangles, from in front and behind, at their seams.
    let square = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let fan: Vec<Vec3> = square.iter().copied().chain([[0.0; 3]]).map(Vec3::from).collect();
    let around = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    for (triangles, seams) in [
        (around, vec![[0.0, 0.0], [0.5, 0.5], [-0.25, 0.25]]),
        (vec![[0, 1, 2], [0, 2, 3]], vec![[0.0, 0.0], [0.5, 0.5]]),
    ] {
        let mesh = TriangleMesh::new(fan.clone(), triangles).expect("sound");
        let bvh = Bvh::build(&mesh).expect("it builds");
        for [x, y] in seams {
            for side in [-1.0, 1.0] {
                for slope in [0.0, 0.5, -3.0] {
                    let direction = Vec3::new(slope, 0.25, -side);
                    let ray = Ray::new(Vec3::new(x, y, 0.0) - direction, direction);
                    assert_eq!(bvh.crossings(&ray), 1, "{ray:?}");
                    // Cut in two at the surface, one of both halves has it.
                    let halves = [ray.with_interval(0.0, 1.0), ray.with_interval(1.0, 9.0)];
                    let [near, far] = halves.map(|ray| bvh.crossings(&ray));
                    assert_eq!(near + far, 1, "{ray:?}");
                }
            }
        }
        // In the plane, along edges and not: nothing is crossed.
        for direction in [Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 0.3, 0.0)] {
            assert_eq!(bvh.crossings(&Ray::new(-3.0 * direction, direction)), 0);
        }
    }
}

#[test]
fn intervals_that_follow_each_other_share_out_the_hits() {
    let mut rng = Rng::new(3);
    let (mut all, mut near, mut far) = (Vec::new(), Vec::new(), Vec::new());
    let mut cuts = 0;
    // Among faces along the axes, the box around a triangle says more of distances than the triangle itself.
    for mesh in [shapes::soup(3000, 0.2, 5), shapes::grid_box(7, Vec3::splat(-0.9), Vec3::ONE)] {
        let bvh = Bvh::build(&mesh).expect("it builds");
        for _ in 0..100_000 {
            let ray = Ray::new(3.0 * rng.in_cube(), rng.direction());
            bvh.all_hits(&ray, &mut all);
            if all.is_empty() {
                continue;
            }
            // At a hit, and right behind it.
            let at = all[rng.below(all.len())].t;
            for at in [at, at.next_up(), 1.01 * at] {
                bvh.all_hits(&ray.with_interval(0.0, at), &mut near);
                bvh.all_hits(&ray.with_interval(at, f32::INFINITY), &mut far);
                assert_eq!([&near[..], &far[..]].concat(), all, "{ray:?} at {at}");
                cuts += 1;
            }
        }
    }
    assert!(cuts > 50_000, "only {cuts} cuts");
}

#[test]
fn invalid_rays_cross_nothing_and_answers_are_emptied() {
    let mesh = shapes::grid_box(2, Vec3::splat(-1.0), Vec3::ONE);
    let bvh = Bvh::build(&mesh).expect("it builds");
    let good = Ray::new([0.1, 0.2, 0.3], [0.0, 0.0, 1.0]);
    let nan = Vec3::new(f32::NAN, 0.0, 0.0);
    for bad in [
        Ray::new(nan, good.direction),
        Ray::new(good.origin, nan),
        Ray::new(good.origin, Vec3::ZERO),
        good.with_interval(f32::NAN, 1.0),
        good.with_interval(0.0, f32::NAN),
        good.with_interval(1.0, 0.0),
    ] {
        let mut hits = vec![Hit { t: 1.0, u: 0.0, v: 0.0, primitive: 0, instance: 0 }];
        bvh.all_hits(&bad, &mut hits);
        assert_eq!((hits.len(), bvh.crossings(&bad)), (0, 0), "{bad:?}");
        assert!(bvh.all_hits_batch(&[bad, good]).iter().map(<[_]>::len).eq([0, 1]));
    }
}
