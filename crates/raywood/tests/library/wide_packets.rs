//! Rays that share their origin, go to one point or run in one direction: packets of every size and shape answer as single rays do.

use raywood::{
    BuildOptions, Geometry, Hit, HitColumns, Joined, Ray, SimdLevel, Spheres, Structure,
    StructureKind, TriangleMesh, TriangleTest, Vec3,
};
use raywood_testkit::{Rng, nasty, oracle, shapes};

fn build<G: Geometry>(geometry: G) -> Structure<G> {
    Structure::build(StructureKind::BvhWide, geometry, &BuildOptions::default()).expect("it builds")
}

/// Holds batches against single rays: the same hits but for the last digits of the distance, exactly the same shadows.
fn check<G: Geometry>(structure: &mut Structure<G>, rays: &[Ray], what: &str) {
    for level in SimdLevel::available() {
        structure.set_simd_level(level);
        let what = format!("{what}, {} rays, {}", rays.len(), level.name());
        let mut hits =
            vec![Some(Hit { t: -1.0, u: 0.0, v: 0.0, primitive: 9, instance: 9 }); rays.len()];
        structure.intersect_batch_serial(rays, &mut hits);
        let mut blocked = vec![true; rays.len()];
        structure.occluded_batch_serial(rays, &mut blocked);
        for ((ray, hit), blocked) in rays.iter().zip(hits).zip(blocked) {
            let expected = structure.intersect(ray);
            assert_agree(&hit, &expected, ray, &what);
            assert_eq!(blocked, expected.is_some(), "{what}: {ray:?}");
        }
    }
}

/// Holds the hit of a ray in a packet against that of the ray alone.
fn assert_agree(hit: &Option<Hit>, expected: &Option<Hit>, ray: &Ray, what: &str) {
    let agree = match (hit, expected) {
        (Some(hit), Some(expected)) => {
            let near = |a: f32, b: f32| (a - b).abs() <= 1.0 / 256.0;
            let same = hit.primitive == expected.primitive;
            let weights = near(hit.u, expected.u) && near(hit.v, expected.v);
            hit.agrees_with(expected)
                && ray.t_min <= hit.t
                && hit.t < ray.t_max
                && (weights || !same)
        }
        (hit, expected) => hit == expected,
    };
    assert!(agree, "{what}: {hit:?}, alone {expected:?}: {ray:?}");
}

/// Holds rays given by their common point against single rays, from there and to there.
fn check_point<G: Geometry>(
    structure: &mut Structure<G>,
    point: Vec3,
    vectors: &[Vec3],
    what: &str,
) {
    // As many as of another call, which must leave no trace.
    let mut hits = HitColumns::new(7);
    hits.primitive.fill(3);
    for level in SimdLevel::available() {
        structure.set_simd_level(level);
        let what = format!("{what}, {} rays from a point, {}", vectors.len(), level.name());
        structure.intersect_from(point, vectors, &mut hits);
        assert_eq!(hits.len(), vectors.len(), "{what}");
        for (number, &direction) in vectors.iter().enumerate() {
            let ray = Ray::new(point, direction);
            assert_agree(&hits.get(number), &structure.intersect(&ray), &ray, &what);
            if hits.primitive[number] == HitColumns::NONE {
                let rest = (hits.t[number], hits.u[number], hits.v[number]);
                assert_eq!(rest, (f32::INFINITY, 0.0, 0.0), "{what}: {ray:?}");
            }
        }
        for end in [1.0, 1.0 - 1.0 / 4096.0, 0.5, 0.0] {
            let mut blocked = vec![true; vectors.len()];
            structure.occluded_towards(point, end, vectors, &mut blocked);
            for (&from, blocked) in vectors.iter().zip(blocked) {
                let ray = Ray::between(from, point).with_interval(0.0, end);
                assert_eq!(blocked, structure.occluded(&ray), "{what}, to {end}: {ray:?}");
            }
        }
    }
}

/// Rays from a point through a rectangle of directions.
fn pinhole(origin: Vec3, towards: Vec3, width: f32, count: usize) -> Vec<Ray> {
    let forward = (towards - origin).normalize_or_zero();
    let side = forward.cross(Vec3::new(0.3, 0.9, 0.1)).normalize_or_zero();
    let up = side.cross(forward);
    let columns = (count as f32).sqrt().ceil().max(1.0);
    let ray = |number: usize| {
        let x = (number as f32 % columns + 0.5) / columns - 0.5;
        let y = ((number as f32 / columns).floor() + 0.5) / columns - 0.5;
        Ray::new(origin, forward + width * (x * side + y * up))
    };
    (0..count).map(ray).collect()
}

/// Rays from points on such rays to where these start.
fn returning(rays: &[Ray], rng: &mut Rng) -> Vec<Ray> {
    rays.iter().map(|ray| Ray::between(ray.at(rng.range(0.2, 3.0)), ray.origin)).collect()
}

#[test]
fn packets_of_every_size_agree_with_single_rays() {
    let mesh = shapes::uv_sphere(40, Vec3::ZERO, 1.0);
    let mut structure = build(&mesh);
    let mut rng = Rng::new(1);
    let sizes =
        [1, 2, 15, 16, 17, 31, 32, 33, 47, 64, 100, 200, 255, 256, 257, 300, 511, 513, 1000];
    for size in sizes {
        let rays = pinhole(Vec3::new(1.9, 0.7, -2.1), Vec3::ZERO, 0.9, size);
        check(&mut structure, &rays, "pinhole");
        check(&mut structure, &returning(&rays, &mut rng), "returning");
        let direction = Vec3::new(0.3, -1.0, 0.4);
        check(&mut structure, &parallel(&mut rng, Vec3::ZERO, 1.5, direction, size), "parallel");
        let point = rays[0].origin;
        let directions: Vec<_> = rays.iter().map(|ray| ray.direction).collect();
        check_point(&mut structure, point, &directions, "directions");
        let points: Vec<_> = rays.iter().map(|ray| ray.at(rng.range(0.2, 3.0))).collect();
        check_point(&mut structure, point, &points, "points");
    }
}

#[test]
fn a_common_point_may_be_anything_and_so_may_the_rest() {
    let mesh = shapes::soup(2000, 0.3, 5);
    let mut structure = build(&mesh);
    let mut rng = Rng::new(6);
    let plain: Vec<_> = (0..600).map(|_| Vec3::new(0.0, 0.0, 1.5) + 0.4 * rng.in_cube()).collect();
    let mut strange = plain.clone();
    for (number, vector) in strange.iter_mut().enumerate() {
        match number % 40 {
            3 => *vector = Vec3::ZERO,
            7 => vector.x = f32::NAN,
            12 => vector.y = f32::NEG_INFINITY,
            18 => *vector = 1e30 * *vector,
            23 => *vector = 1e-35 * *vector,
            31 => *vector = -*vector,
            _ => {}
        }
    }
    let points = [
        Vec3::new(0.1, 0.2, -3.0),
        Vec3::ZERO,
        plain[0],
        Vec3::new(f32::NAN, 0.0, 0.0),
        Vec3::splat(f32::INFINITY),
        Vec3::new(0.0, 1e7, 0.0),
    ];
    for point in points {
        check_point(&mut structure, point, &plain, "plain");
        check_point(&mut structure, point, &strange, "strange");
    }
}

#[test]
fn packets_over_nasty_meshes_agree_with_single_rays_and_with_the_oracle() {
    let mut rng = Rng::new(2);
    for nasty in nasty::all() {
        let bounds = nasty.mesh.bounds_of_all();
        let (center, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
        let size = half.max_element().max(1e-30);
        let mut structure = build(&nasty.mesh);
        for distance in [0.0, 0.5, 1.2, 4.0] {
            let origin = center + distance * size * rng.direction();
            for width in [0.02, 0.5, 2.0] {
                let rays = pinhole(origin, center + 0.3 * size * rng.in_cube(), width, 290);
                check(&mut structure, &rays, nasty.name);
                check(&mut structure, &returning(&rays, &mut rng), nasty.name);
                let directions: Vec<_> = rays.iter().map(|ray| ray.direction).collect();
                check_point(&mut structure, origin, &directions, nasty.name);
                let points: Vec<_> = rays.iter().map(|ray| ray.at(size)).collect();
                check_point(&mut structure, origin, &points, nasty.name);
                let mut hits = vec![None; rays.len()];
                structure.intersect_batch(&rays, &mut hits);
                for (ray, hit) in rays.iter().zip(hits).step_by(17) {
                    if hit.is_none() {
                        oracle::check_closest(&nasty.mesh, ray, hit)
                            .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
                    }
                }
            }
        }
    }
}

/// Parallel rays from points of a box around another point.
fn parallel(rng: &mut Rng, center: Vec3, size: f32, direction: Vec3, count: usize) -> Vec<Ray> {
    (0..count).map(|_| Ray::new(center + size * rng.in_cube(), direction)).collect()
}

#[test]
fn parallel_rays_over_nasty_meshes_agree_with_single_rays() {
    let mut rng = Rng::new(21);
    for nasty in nasty::all() {
        let bounds = nasty.mesh.bounds_of_all();
        let (center, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
        let size = half.max_element().max(1e-30);
        let is_empty = nasty.mesh.len() == 0;
        let along = (!is_empty).then(|| nasty.mesh.triangle(0)).flatten();
        let along = along.map_or(Vec3::X, |[a, b, _]| b - a);
        let mut structure = build(&nasty.mesh);
        let (grazing, slanted) = (rng.direction(), rng.direction());
        for direction in [
            Vec3::X,
            -Vec3::Y,
            3.0 * Vec3::Z,
            Vec3::new(1.0, 0.0, -1.0),
            Vec3::new(1e-20, -1.0, 1e-7),
            along,
            grazing,
            slanted,
        ] {
            for spread in [0.01, 0.3, 2.0] {
                let around = center + size * rng.in_cube();
                let mut rays = parallel(&mut rng, around, spread * size, direction, 290);
                // Some of them start on the mesh itself, where rounding decides.
                for number in (0..rays.len()).step_by(3).filter(|_| !is_empty) {
                    let corners = nasty.mesh.triangle(rng.below(nasty.mesh.len()) as u32);
                    if let Some([a, b, c]) = corners {
                        let (u, v) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
                        rays[number].origin = a + u * (b - a) + v * (c - a);
                    }
                }
                check(&mut structure, &rays, nasty.name);
            }
        }
    }
}

/// Rays whose lines meet in `image`, as those of a pinhole there that a plane mirror has turned: they start where the plane is, a little beside it.
fn reflected(image: Vec3, towards: Vec3, width: f32, plane: [Vec3; 2], count: usize) -> Vec<Ray> {
    let [point, normal] = plane;
    let mut rays = pinhole(image, towards, width, count);
    for ray in &mut rays {
        let t = normal.dot(point - ray.origin) / normal.dot(ray.direction);
        let beside = 1e-5 * ray.direction.dot(normal).signum() * (ray.at(t) - image).length();
        ray.origin = ray.at(t.abs()) + beside * normal;
    }
    rays
}

#[test]
fn reflected_rays_over_nasty_meshes_agree_with_single_rays() {
    let mut rng = Rng::new(31);
    for nasty in nasty::all() {
        let bounds = nasty.mesh.bounds_of_all();
        let (center, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
        let size = half.max_element().max(1e-30);
        let is_empty = nasty.mesh.len() == 0;
        let mut structure = build(&nasty.mesh);
        for turn in 0..18 {
            let width = [0.02, 0.3, 1.5][turn % 3];
            let image = center + 2.0 * size * rng.direction();
            let towards = center + 0.3 * size * rng.in_cube();

            // The mirror may be a triangle of the mesh, where the rays start.
            let corners = (!is_empty && turn % 2 == 0)
                .then(|| nasty.mesh.triangle(rng.below(nasty.mesh.len()) as u32))
                .flatten();
            let (point, normal) = match corners {
                Some([a, b, c]) => (a, (b - a).cross(c - a).normalize_or_zero()),
                None => (center + 0.5 * size * rng.in_cube(), rng.direction()),
            };
            let mut rays = reflected(image, towards, width, [point, normal], 290);
            match turn / 6 {
                // Exactly on the mesh; or passing by the image, some more and some less.
                1 => {
                    for number in (0..rays.len()).step_by(3).filter(|_| !is_empty) {
                        let corners = nasty.mesh.triangle(rng.below(nasty.mesh.len()) as u32);
                        if let Some([a, b, c]) = corners {
                            let (u, v) = (rng.range(0.0, 0.5), rng.range(0.0, 0.5));
                            let on_mesh = a + u * (b - a) + v * (c - a);
                            rays[number] = Ray::new(on_mesh, on_mesh - image);
                        }
                    }
                }
                2 => {
                    for ray in &mut rays {
                        ray.origin += 1e-6 * size * rng.in_cube();
                    }
                }
                _ => {}
            }
            check(&mut structure, &rays, nasty.name);
        }
    }
}

#[test]
fn reflected_rays_meet_what_is_close_to_the_mirror() {
    // A floor under fine soup: hits at all distances from the start, the nearest of them far below what depths from the image can tell.
    let mut rng = Rng::new(33);
    let floor = [Vec3::new(-3.0, 0.0, -3.0), Vec3::new(9.0, 0.0, -3.0), Vec3::new(-3.0, 0.0, 9.0)];
    let mut corners = floor.to_vec();
    for _ in 0..3000 {
        let above = 10f32.powf(rng.range(-7.0, 0.0));
        let at = Vec3::new(rng.range(-2.0, 2.0), above, rng.range(-2.0, 2.0));
        corners.extend([0, 1, 2].map(|_| at + 0.1 * rng.in_cube()));
        corners.extend([0, 1, 2].map(|_| at + 0.1 * above.min(1.0) * rng.in_cube()));
    }
    let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = TriangleMesh::new(corners, triangles).expect("a mesh");
    let mut structure = build(&mesh);
    for image in [Vec3::new(0.3, -1.5, -2.0), Vec3::new(0.0, -40.0, 3.0)] {
        for towards in [Vec3::ZERO, Vec3::new(1.0, 0.5, 1.0)] {
            let mut rays = reflected(image, towards, 1.2, [Vec3::ZERO, Vec3::Y], 2000);
            check(&mut structure, &rays, "floor");
            // Above the floor already, where things are.
            for ray in &mut rays {
                ray.origin = ray.at(10f32.powf(rng.range(-6.0, -0.5)));
            }
            check(&mut structure, &rays, "above the floor");
        }
    }
}

#[test]
fn rays_of_several_packets_in_turn_agree_with_single_rays() {
    let mesh = shapes::soup(3000, 0.2, 12);
    let mut structure = build(&mesh);
    let mut rng = Rng::new(13);
    let lights = [Vec3::new(0.0, 3.0, 1.0), Vec3::new(-2.0, 2.0, 0.0), Vec3::new(2.0, 0.0, 2.0)];
    let eyes = [Vec3::new(0.0, 0.1, -3.0), Vec3::new(0.2, 0.0, -3.0)];
    let mirror = [Vec3::new(0.0, -0.8, 0.0), Vec3::Y];
    let image = Vec3::new(0.1, -2.0, -2.5);
    let seen = eyes.map(|eye| pinhole(eye, Vec3::ZERO, 0.6, 1000));
    let mirrored = reflected(image, Vec3::ZERO, 0.5, mirror, 1000);
    let mut rays = Vec::new();
    for number in 0..1000 {
        let from = rng.in_cube();
        let other = match number % 7 {
            0 | 3 => seen[number / 7 % 2][number],
            1 | 4 | 5 => Ray::between(from, lights[number % 3]),
            2 => Ray::new(from, Vec3::new(0.2, 1.0, -0.3)),
            _ => mirrored[number],
        };
        rays.push(other);
    }
    check(&mut structure, &rays, "of all kinds in turn");
    let (_, apart): (Vec<_>, Vec<_>) = rays.iter().partition(|ray| ray.t_max < 2.0);
    check(&mut structure, &apart, "without those to lights");
    rays.sort_by(|a, b| a.direction.x.total_cmp(&b.direction.x));
    check(&mut structure, &rays, "in another order");
}

/// Rays from all over two or three small patches to a light, behind a wall of small triangles with holes: a group of both meets all triangles between.
#[test]
fn rays_in_bunches_agree_with_single_rays() {
    let mut rng = Rng::new(31);
    let wall = shapes::soup(3000, 0.06, 8);
    let light = Vec3::new(0.1, 0.2, 6.0);
    let mut structure = build(&wall);
    let patches =
        [Vec3::new(-0.9, -0.8, -4.0), Vec3::new(0.9, 0.7, -4.0), Vec3::new(0.8, -0.9, -4.0)];
    for (patches, size) in [(&patches[..2], 0.02), (&patches[..], 0.1), (&patches[1..], 0.5)] {
        // Mostly the first patch, as beside the edge of something, or each in turn.
        for share in [0.06, 0.4] {
            let ends: Vec<Vec3> = (0..1000)
                .map(|_| {
                    let others = 1 + rng.below(patches.len() - 1);
                    let patch = patches[if rng.unit() < share { others } else { 0 }];
                    patch + size * rng.in_cube()
                })
                .collect();
            let to_light: Vec<_> = ends.iter().map(|&end| Ray::between(end, light)).collect();
            let from_light: Vec<_> = ends.iter().map(|&end| Ray::new(light, end - light)).collect();
            check(&mut structure, &to_light, "to the light");
            check(&mut structure, &from_light, "from the light");
            let down: Vec<_> =
                ends.iter().map(|&end| Ray::new(end, Vec3::new(0.01, 0.02, 1.0))).collect();
            check(&mut structure, &down, "parallel");
        }
    }
}

#[test]
fn rays_of_any_kind_among_others_change_nothing_for_these() {
    let mesh = shapes::soup(3000, 0.2, 3);
    let mut structure = build(&mesh);
    let mut rng = Rng::new(4);
    let origin = Vec3::new(0.1, 0.2, -3.0);
    let plain = pinhole(origin, Vec3::ZERO, 0.8, 512);
    let strange: &[fn(&mut Rng, &mut Ray)] = &[
        |_, ray| ray.direction = Vec3::ZERO,
        |_, ray| ray.direction.x = f32::NAN,
        |_, ray| ray.origin.y = f32::NAN,
        |_, ray| ray.origin.z = f32::INFINITY,
        |_, ray| ray.t_max = f32::NAN,
        |_, ray| ray.t_max = -1.0,
        |_, ray| ray.t_min = f32::NAN,
        |rng, ray| ray.t_min = rng.range(0.5, 4.0),
        |rng, ray| ray.t_max = rng.range(0.5, 4.0),
        |rng, ray| ray.direction = rng.direction(),
        |rng, ray| ray.direction = -1e-20 * rng.direction(),
        |rng, ray| ray.origin = 2.0 * rng.in_cube(),
        |_, ray| ray.direction = -ray.direction,
        |_, ray| (ray.direction, ray.t_max) = (1e20 * ray.direction, 1e-20),
    ];
    for every in [2, 7, 40, 1000] {
        let mut rays = plain.clone();
        for (number, ray) in rays.iter_mut().enumerate() {
            if number % every == every / 2 {
                strange[number / every % strange.len()](&mut rng, ray);
            }
        }
        check(&mut structure, &rays, "with strange ones");
    }
    for change in strange {
        let mut rays = plain.clone();
        rays.iter_mut().for_each(|ray| change(&mut rng, ray));
        check(&mut structure, &rays, "all strange");
    }

    // All directions from one point; lengths of all sizes; ends of all kinds.
    let rays: Vec<_> = (0..600).map(|_| Ray::new(0.1 * origin, rng.direction())).collect();
    check(&mut structure, &rays, "all directions");
    let rays: Vec<_> = plain
        .iter()
        .map(|ray| {
            let length = 10f32.powf(rng.range(-12.0, 12.0));
            Ray { direction: length * ray.direction, t_max: rng.range(0.5, 8.0) / length, ..*ray }
        })
        .collect();
    check(&mut structure, &rays, "of all lengths");
    let spawned: Vec<_> = returning(&plain, &mut rng)
        .into_iter()
        .map(|ray| ray.with_interval(0.0, 1.0 - 1.0 / 4096.0))
        .collect();
    check(&mut structure, &spawned, "ending a little before");
}

#[test]
fn packets_do_not_slip_through_edges() {
    let mesh = shapes::uv_sphere(64, Vec3::new(0.3, -0.2, 0.1), 1.0);
    let structure = build(&mesh);
    for seed in 0..40 {
        // Through vertices and points of edges, from the inside.
        let mut rng = Rng::new(seed);
        let origin = Vec3::new(0.3, -0.2, 0.1) + 0.5 * rng.in_cube();
        let towards = rng.direction();
        let mut rays = Vec::new();
        for triangle in 0..mesh.len() as u32 {
            let [a, b, _] = mesh.triangle(triangle).expect("a triangle");
            let target = if triangle % 2 == 0 { a } else { a + rng.unit() * (b - a) };
            if (target - origin).normalize_or_zero().dot(towards) > 0.7 {
                rays.push(Ray::new(origin, target - origin));
            }
        }
        // The same from farther on, as if that point were an image of it.
        let late: Vec<_> =
            rays.iter().map(|ray| Ray { origin: ray.at(rng.range(0.1, 0.6)), ..*ray }).collect();
        for rays in [rays, late] {
            let mut hits = vec![None; rays.len()];
            structure.intersect_batch(&rays, &mut hits);
            let mut blocked = vec![false; rays.len()];
            structure.occluded_batch(&rays, &mut blocked);
            for ((ray, hit), blocked) in rays.iter().zip(hits).zip(blocked) {
                assert!(hit.is_some() && blocked, "{ray:?} slips through");
            }
        }
    }
}

#[test]
fn packets_meet_what_is_no_triangle() {
    let mut rng = Rng::new(5);
    let spheres: Vec<_> = (0..200).map(|_| (rng.in_cube(), 0.1)).collect();
    let spheres = Spheres::new(spheres).expect("spheres");
    let mut structure = build(&spheres);
    let rays = pinhole(Vec3::new(0.0, 0.5, -3.0), Vec3::ZERO, 0.8, 300);
    check(&mut structure, &rays, "spheres");
}

/// How many rays of a batch the fast test answers otherwise than single rays are.
fn answered_otherwise_by_the_fast_test(mesh: &TriangleMesh, rays: &[Ray]) -> usize {
    let options = BuildOptions { triangle_test: TriangleTest::Fast, ..Default::default() };
    let fast = Structure::build(StructureKind::BvhWide, mesh, &options).expect("it builds");
    let mut hits = vec![None; rays.len()];
    fast.intersect_batch(rays, &mut hits);
    let exact = build(mesh);
    let differ = rays.iter().zip(hits).filter(|(ray, hit)| match (hit, exact.intersect(ray)) {
        (Some(hit), Some(expected)) => !hit.agrees_with(&expected),
        (hit, expected) => hit.is_some() != expected.is_some(),
    });
    differ.count()
}

#[test]
fn the_fast_test_differs_near_edges_alone() {
    let mesh = shapes::uv_sphere(40, Vec3::ZERO, 1.0);
    let rays = pinhole(Vec3::new(1.9, 0.7, -2.1), Vec3::ZERO, 0.9, 4096);
    assert!(answered_otherwise_by_the_fast_test(&mesh, &rays) <= 4);
}

#[test]
fn the_fast_test_knows_edges_as_well_behind_mirrors() {
    // Lines that pass by their image by some millionths: every hundredth of a thousandth part of these triangles is that close to an edge.
    let mesh = shapes::soup(20_000, 0.02, 9);
    let mirror = [Vec3::new(0.0, -1.2, 0.0), Vec3::Y];
    let mut rays = reflected(Vec3::new(0.2, -3.0, -0.4), Vec3::ZERO, 0.5, mirror, 60_000);
    let mut rng = Rng::new(34);
    for ray in &mut rays {
        ray.origin += 2e-6 * rng.in_cube();
    }
    assert!(answered_otherwise_by_the_fast_test(&mesh, &rays) <= 4);
}

#[test]
fn answers_do_not_depend_on_threads() {
    let mesh = shapes::soup(2000, 0.2, 8);
    let structure = build(&mesh);
    for count in [0, 1, 100, 3000] {
        let rays = pinhole(Vec3::new(0.1, 0.2, -3.0), Vec3::ZERO, 0.8, count);
        let mut expected = vec![None; rays.len()];
        structure.intersect_batch_serial(&rays, &mut expected);
        let mut hits = vec![None; rays.len()];
        structure.intersect_batch(&rays, &mut hits);
        assert!(hits == expected);
    }
}

trait BoundsOfAll {
    fn bounds_of_all(&self) -> raywood::Aabb;
}

impl BoundsOfAll for TriangleMesh {
    fn bounds_of_all(&self) -> raywood::Aabb {
        let empty =
            raywood::Aabb { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };
        (0..self.len() as u32).map(|p| self.bounds(p)).fold(empty, |all, b| raywood::Aabb {
            min: all.min.min(b.min),
            max: all.max.max(b.max),
        })
    }
}

#[test]
fn shadow_rays_that_start_on_or_just_beside_surfaces_answer_as_single_rays_do() {
    let mut rng = Rng::new(11);
    for (mesh, scale) in [
        (shapes::uv_sphere(24, Vec3::new(30.0, -20.0, 10.0), 1.0), 1.0),
        (shapes::soup(500, 0.7, 12), 1.0),
    ] {
        let mut structure = build(&mesh);
        let center = mesh.bounds_of_all().center();
        let light = center + scale * Vec3::new(1.5, 2.5, 2.0);
        let eye = center + scale * Vec3::new(-2.0, 2.2, 1.7);
        let mut points = Vec::new();
        for ray in pinhole(eye, center, 0.6, 9000) {
            let Some(hit) = structure.intersect(&ray) else { continue };
            let point = structure.surface_point(&ray, &hit);
            let raw = ray.at(hit.t);
            let ulp = f32::EPSILON * raw.abs().max_element();
            points.push(match points.len() % 4 {
                0 => point.origin_towards(light - point.position),
                1 => point.origin_towards(point.position - light),
                2 => raw,
                _ => raw + 2.0 * ulp * rng.in_cube(),
            });
        }
        assert!(points.len() > 1000, "{}", points.len());
        check_point(&mut structure, light, &points, "from surfaces");
        let rays: Vec<_> = points.iter().map(|point| Ray::between(*point, light)).collect();
        check(&mut structure, &rays, "from surfaces");
        for direction in [light - center, Vec3::Y, -Vec3::X] {
            let rays: Vec<_> = points.iter().map(|point| Ray::new(*point, direction)).collect();
            check(&mut structure, &rays, "from surfaces, parallel");
        }
    }
}

#[test]
fn rays_that_are_known_to_start_beside_surfaces_are_blocked_as_others() {
    let mut rng = Rng::new(47);
    let mesh = shapes::uv_sphere(60, Vec3::ZERO, 1.0);
    let balls = (0..60).map(|_| (1.1 * rng.direction(), rng.range(0.01, 0.2))).collect();
    let spheres = Spheres::new(balls).expect("spheres");
    let mut structure = build(Joined { first: &mesh, second: &spheres });
    // A light far off, one that grazes, and one inside.
    for light in [Vec3::new(5.0, 3.0, -4.0), Vec3::new(1.15, 0.0, -0.1), 0.3 * Vec3::ONE] {
        for eye in [Vec3::new(1.0, 0.5, -3.0), Vec3::new(0.2, -0.1, 0.4)] {
            let rays = pinhole(eye, Vec3::ZERO, 0.9, 3000);
            let hits: Vec<_> = rays
                .iter()
                .filter_map(|ray| Some((ray, structure.intersect(ray)?)))
                .map(|(ray, hit)| {
                    let point = structure.surface_point(ray, &hit);
                    (point.origin_towards(light - point.position), hit.primitive)
                })
                .collect();
            let (points, primitives): (Vec<_>, Vec<_>) = hits.into_iter().unzip();
            assert!(points.len() > 500, "{eye:?}: {}", points.len());
            for level in SimdLevel::available() {
                structure.set_simd_level(level);
                let mut blocked = vec![false; points.len()];
                let end = Ray::SHORT_END;
                structure.occluded_from_surfaces_serial(
                    light,
                    end,
                    &points,
                    &primitives,
                    &mut blocked,
                );
                for (&point, blocked) in points.iter().zip(blocked) {
                    let ray = Ray::short_of(point, light);
                    assert_eq!(blocked, structure.occluded(&ray), "{}, {ray:?}", level.name());
                }
            }
        }
    }
}
