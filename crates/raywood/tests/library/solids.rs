//! Discs, capsules, cylinders, boxes and spheres: each against its distance function in double precision, and all of them in every structure against brute force.

use raywood::{
    Aabb, Assembly, Boxes, BuildOptions, Bvh, Capsule, Capsules, Cylinder, Cylinders, Disc, Discs,
    Geometry, Hit, PreparedRay, PrimitiveHit, Ray, SimdLevel, Spheres, Structure, StructureKind,
    Vec3,
};
use raywood_testkit::Rng;
use raywood_testkit::solids::Solid;

use crate::bounding_balls;

/// The geometry of one shape alone.
fn alone(solid: &Solid) -> Box<dyn Geometry + Send> {
    match *solid {
        Solid::Ball(center, radius) => {
            Box::new(Spheres::new(vec![(center, radius)]).expect("a sphere"))
        }
        Solid::Capsule(capsule) => Box::new(Capsules::new(vec![capsule]).expect("a capsule")),
        Solid::Cylinder(cylinder) => Box::new(Cylinders::new(vec![cylinder]).expect("a cylinder")),
        Solid::Box(corners) => Box::new(Boxes::new(vec![corners]).expect("a box")),
        Solid::Disc(disc) => Box::new(Discs::new(vec![disc]).expect("a disc")),
    }
}

/// A tree over any geometry, compiled once.
fn build(geometry: &dyn Geometry) -> Bvh<&dyn Geometry> {
    Bvh::build(geometry).expect("it builds")
}

/// A random shape of one of five kinds, of any proportions, along an axis or not, centred at some multiple of its size from zero.
fn shape(kind: usize, scale: f32, offset: f32, rng: &mut Rng) -> Solid {
    let center = scale * offset * rng.direction();
    let axis = match rng.below(4) {
        0 => [Vec3::X, -Vec3::Y, Vec3::Z][rng.below(3)],
        _ => rng.direction(),
    };
    let thin = 10f32.powf(rng.range(-3.0, 0.0));
    let half = 0.5 * scale * axis;
    match kind {
        0 => Solid::Ball(center, scale * thin),
        1 if rng.below(5) == 0 => Solid::Capsule(Capsule::new(center, center, scale * thin)),
        1 => Solid::Capsule(Capsule::new(center - half, center + half, scale * thin)),
        2 => {
            // Needles and coins.
            let (tall, wide) = if rng.below(2) == 0 { (1.0, thin) } else { (thin, 1.0) };
            Solid::Cylinder(Cylinder::new(center - tall * half, center + tall * half, scale * wide))
        }
        3 => {
            let mut half = [0.5 * scale, 0.5 * scale * thin, 0.5 * scale * rng.range(0.1, 1.0)];
            half.rotate_left(rng.below(3));
            Solid::Box(Aabb::new(center - Vec3::from(half), center + Vec3::from(half)))
        }
        _ => Solid::Disc(Disc {
            normal: axis.normalize_or_zero(),
            ..Disc::new(center, axis, scale * thin)
        }),
    }
}

/// Shapes of all kinds, tiny to huge, at zero and away from it.
fn shapes(each: usize, seed: u64) -> Vec<Solid> {
    let mut rng = Rng::new(seed);
    let mut all = Vec::new();
    for kind in 0..5 {
        for scale in [1e-6, 1e-3, 1.0, 1e3, 1e9] {
            for offset in [0.0, 3.0, 300.0] {
                all.extend((0..each).map(|_| shape(kind, scale, offset, &mut rng)));
            }
        }
    }
    // Rounding may leave nothing between two ends, or two faces.
    all.retain(|solid| solid.extent().2 > 1e-4 * solid.largest() * f32::EPSILON.sqrt());
    all
}

#[test]
fn hits_are_those_of_the_distance_function() {
    let mut rng = Rng::new(71);
    let mut hits = [0; 5];
    for solid in shapes(4, 70) {
        let geometry = alone(&solid);
        let bvh = build(&*geometry);
        bvh.validate().expect("a valid tree");
        for _ in 0..150 {
            let ray = solid.ray(&mut rng);
            let Some(prepared) = PreparedRay::new(&ray) else { continue };
            let as_hit = |PrimitiveHit { t, u, v }| Hit { t, u, v, primitive: 0, instance: 0 };
            let closest = geometry.intersect(0, &prepared).map(as_hit);
            solid.check_closest(&ray, closest).unwrap_or_else(|error| panic!("{error}"));
            let mut all = Vec::new();
            geometry.intersect_all(0, &prepared, &mut |hit| all.push(hit.t));
            all.sort_by(f32::total_cmp);
            solid.check_all(&ray, &all).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(all.first().copied(), closest.map(|hit| hit.t), "{solid:?}, {ray:?}");

            // In a tree the same, but for what it takes to bring a hit into its box.
            let in_tree = bvh.intersect(&ray);
            let agree = match (&in_tree, &closest) {
                (Some(a), Some(b)) => a.agrees_with(b),
                (a, b) => a.is_some() == b.is_some(),
            };
            assert!(agree, "{in_tree:?}, {closest:?}, {solid:?}, {ray:?}");
            let kind = match solid {
                Solid::Ball(..) => 0,
                Solid::Capsule(_) => 1,
                Solid::Cylinder(_) => 2,
                Solid::Box(_) => 3,
                Solid::Disc(_) => 4,
            };
            hits[kind] += all.len();
        }
    }
    assert!(hits.iter().all(|&hits| hits > 1000), "{hits:?}");
}

#[test]
fn lines_cross_closed_shapes_an_even_number_of_times() {
    let mut rng = Rng::new(72);
    let mut inside = 0;
    for solid in shapes(3, 73).into_iter().filter(Solid::is_closed) {
        let geometry = alone(&solid);
        let bvh = build(&*geometry);
        for _ in 0..300 {
            let ray = solid.ray(&mut rng);
            if !ray.is_valid() {
                continue;
            }
            let line = ray.with_interval(f32::NEG_INFINITY, f32::INFINITY);
            assert_eq!(bvh.crossings(&line) % 2, 0, "{solid:?}, {line:?}");

            // What lies in front tells whether the origin is inside, unless it is on the surface.
            let ray = ray.with_interval(0.0, f32::INFINITY);
            let distance = solid.distance(ray.origin.to_array().map(f64::from));
            if distance.abs() > 1e-6 * f64::from(solid.largest()) {
                let odd = bvh.crossings(&ray) % 2 == 1;
                assert_eq!(odd, distance < 0.0, "{solid:?}, {ray:?}");
                inside += usize::from(odd);
            }
        }
    }
    assert!(inside > 1000, "only {inside} from inside");
}

#[test]
fn points_on_surfaces_lie_there_and_rays_leave_them() {
    let mut rng = Rng::new(74);
    let mut left = 0;
    for solid in shapes(4, 75) {
        let geometry = alone(&solid);
        let bvh = build(&*geometry);
        for _ in 0..120 {
            let ray = solid.ray(&mut rng);
            let Some(hit) = bvh.intersect(&ray) else { continue };
            let point = bvh.surface_point(&ray, &hit);
            let what = format!("{point:?} of {solid:?} by {ray:?}");

            // Where it says it lies, and on the ray as far as the distance is known.
            let off = solid.distance(point.position.to_array().map(f64::from)).abs();
            assert!(off <= 0.5 * f64::from(point.clearance), "{off:e} off, {what}");
            assert!((point.normal.length() - 1.0).abs() < 1e-6, "{what}");

            // Away from the surface at any angle, however flat.
            for _ in 0..8 {
                let n = point.normal;
                let any = rng.direction();
                let direction = match rng.below(3) {
                    0 => any,
                    1 => any - any.dot(n) * n,
                    _ => any - any.dot(n) * n + 10f32.powf(rng.range(-9.0, -2.0)) * n,
                };
                let out = if direction.dot(n) < 0.0 { -direction } else { direction };
                let what = format!("towards {out:?}, {what}");
                assert!(!bvh.occluded(&point.spawn(out)), "{what}");
                if solid.is_closed() {
                    // Into it, and out again on the other side; not beside an edge, where that is near.
                    let deep = 100.0 * point.clearance;
                    let ahead = point.position + deep / any.length() * any;
                    let inside = solid.distance(ahead.to_array().map(f64::from));
                    let spawned = point.spawn(any);
                    let start = solid.distance(spawned.origin.to_array().map(f64::from));
                    if inside.max(10.0 * start) < -5.0 * f64::from(point.clearance) {
                        let found = bvh.intersect(&spawned).map(|hit| hit.t);
                        let is_deep = |t: f32| t * any.length() > deep;
                        assert!(found.is_some_and(is_deep), "{found:?} of {any:?}, {what}");
                    }
                } else {
                    assert!(!bvh.occluded(&point.spawn(-out)), "{what}");
                }
                left += 1;
            }
        }
    }
    assert!(left > 50_000, "only {left} rays");
}

#[test]
fn closest_points_and_insides_are_those_of_the_distance_function() {
    let mut rng = Rng::new(76);
    for solid in shapes(4, 77) {
        let geometry = alone(&solid);
        let bvh = build(&*geometry);
        let inside = bvh.solid();
        let (center, reach, thickness) = solid.extent();
        for number in 0..200 {
            let size = [0.3 * thickness, reach, 1.5 * reach, 100.0 * reach][number % 4];
            let point = center + size * rng.in_cube();
            let double = |v: Vec3| v.to_array().map(f64::from);
            let expected = solid.distance(double(point));
            let largest = f64::from(point.abs().max_element() + solid.largest());
            let tolerance = 2e-7 * expected.abs() + 1e-13 * largest;
            let what = format!("{point:?}, {solid:?}");

            let found = bvh.closest_point(point, f32::INFINITY).expect("a surface");
            let off = (f64::from(found.distance) - expected.abs()).abs();
            assert!(off <= tolerance, "{} instead of {expected}, {what}", found.distance);
            let off = solid.distance(double(found.point)).abs();
            assert!(off <= 1.5e-7 * largest, "{off:e} off the surface, {what}");
            let way = (0..3).map(|i| (double(found.point)[i] - double(point)[i]).powi(2));
            let way = way.sum::<f64>().sqrt();
            assert!((way - expected.abs()).abs() <= 2e-7 * largest + tolerance, "{way}, {what}");

            if expected.abs() > tolerance {
                let is_inside = solid.is_closed() && expected < 0.0;
                assert_eq!(inside.contains(point), is_inside, "{expected:e}, {what}");
            }
        }
    }
}

/// Many shapes of one kind, or of all.
fn crowd(kind: Option<usize>, count: usize, seed: u64) -> Assembly<'static> {
    let mut rng = Rng::new(seed);
    let mut of_kind = [(); 5].map(|()| Vec::new());
    for number in 0..count {
        let kind = kind.unwrap_or(number % 5);
        let size = 0.3 * 10f32.powf(rng.range(-1.5, 0.0));
        of_kind[kind].push(shape(kind, size, rng.unit() / size, &mut rng));
    }
    let mut assembly = Assembly::new();
    for solid in of_kind.iter().flatten() {
        assembly.add(alone(solid));
    }
    assembly
}

#[test]
fn every_structure_gives_the_hits_of_brute_force() {
    for kind in [Some(0), Some(1), Some(2), Some(3), Some(4), None] {
        let crowd = crowd(kind, 300, 78);
        let crowd: &dyn Geometry = &crowd;
        let mut rng = Rng::new(79);
        let near = |number: usize, rng: &mut Rng| {
            // Mostly near the middle, which all of them have.
            let bounds = crowd.bounds(number as u32);
            bounds.center() + 0.5 * rng.unit().powi(4) * bounds.extent() * rng.in_cube()
        };
        let rays: Vec<_> = (0..1500)
            .map(|number| {
                let from = if number % 3 == 0 { rng.in_cube() } else { 3.0 * rng.direction() };
                let target = near(number % crowd.len(), &mut rng);
                match number % 5 {
                    0 => Ray::new(target + 3.0 * Vec3::Z, [0.0, 0.0, -1.0]),
                    1 => Ray::new(target - 3.0 * Vec3::X, [1.0, 0.0, 0.0]),
                    _ => Ray::new(from, target - from),
                }
            })
            .collect();
        let brute = Structure::build(StructureKind::BruteForce, crowd, &BuildOptions::default());
        let brute = brute.expect("it builds");
        let expected: Vec<_> = rays.iter().map(|ray| brute.intersect(ray)).collect();
        let hits = expected.iter().flatten().count();
        assert!(hits > 400, "only {hits} hits");
        for &structure in StructureKind::ALL {
            let built = Structure::build(structure, crowd, &BuildOptions::default());
            let built = built.expect("it builds");
            assert_eq!(built.validate(), Ok(()), "{}", structure.name());
            for (ray, expected) in rays.iter().zip(&expected) {
                let what = format!("{}, {kind:?}, {ray:?}", structure.name());
                assert_eq!(built.intersect(ray), *expected, "{what}");
                assert_eq!(built.occluded(ray), expected.is_some(), "{what}");
            }
        }
        bounding_balls::check(crowd, &rays, &format!("kind {kind:?}"));
        let eye = Vec3::new(0.1, 0.2, -3.0);
        let rays: Vec<_> = (0..1500)
            .map(|number| Ray::new(eye, near(number % crowd.len(), &mut rng) - eye))
            .collect();
        bounding_balls::check(crowd, &rays, &format!("kind {kind:?} from a point"));
    }
}

#[test]
fn every_query_of_a_crowd_gives_what_asking_all_gives() {
    let crowd = crowd(None, 200, 80);
    let mut bvh = build(&crowd);
    let mut rng = Rng::new(81);
    for level in SimdLevel::available() {
        bvh.set_simd_level(level);
        for _ in 0..300 {
            let ray = Ray::new(1.5 * rng.in_cube(), rng.direction());
            let prepared = PreparedRay::new(&ray).expect("a ray");
            let mut expected = Vec::new();
            for primitive in 0..crowd.len() as u32 {
                crowd.intersect_all(primitive, &prepared, &mut |hit| {
                    expected.push((hit.t, primitive));
                });
            }
            expected.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
            let mut hits = Vec::new();
            bvh.all_hits(&ray, &mut hits);
            assert_eq!(hits.len(), expected.len(), "{ray:?}");
            for (hit, (t, _)) in hits.iter().zip(&expected) {
                assert!((hit.t - t).abs() <= 1e-6 * t.abs(), "{hit:?}, {t}, {ray:?}");
            }

            let point = 1.5 * rng.in_cube();
            let all = (0..crowd.len() as u32).filter_map(|p| crowd.closest_point(p, point));
            let least = all.map(|found| found.distance).fold(f32::INFINITY, f32::min);
            let found = bvh.closest_point(point, f32::INFINITY).map(|found| found.distance);
            assert_eq!(found, Some(least), "{point:?}");
        }
    }
}

#[test]
fn cells_that_a_surface_passes_through_are_told() {
    let mut rng = Rng::new(82);
    let (mut told, mut empty) = (0, 0);
    for solid in shapes(4, 83) {
        let geometry = alone(&solid);
        let (_, reach, _) = solid.extent();
        for _ in 0..60 {
            // Cells around points of the surface, and beside it.
            let ray = solid.ray(&mut rng);
            let Some(prepared) = PreparedRay::new(&ray) else { continue };
            let hit = geometry.intersect(0, &prepared);
            let size = reach * 10f32.powf(rng.range(-4.0, 0.0));
            let point = match hit {
                Some(PrimitiveHit { t, u, v }) => {
                    let hit = Hit { t, u, v, primitive: 0, instance: 0 };
                    geometry.surface_point(&ray, &hit).position
                }
                None => ray.origin,
            };
            let beside = size * Vec3::new(rng.unit(), rng.unit(), rng.unit());
            let cell = Aabb::new(point - beside, point - beside + Vec3::splat(size));
            let clipped = geometry.clipped_bounds(0, &cell);
            let overlaps = geometry.overlaps(0, &cell);
            assert!(cell.contains(&clipped) && geometry.bounds(0).contains(&clipped));
            let what = format!("{cell:?}, {clipped:?}, {solid:?}");
            // The point itself is off by its rounding.
            let rounding = 2.0 * f32::EPSILON * solid.largest();
            let larger =
                Aabb::new(clipped.min - Vec3::splat(rounding), clipped.max + Vec3::splat(rounding));
            if hit.is_some() && size > 4.0 * rounding {
                let held = larger.contains(&Aabb { min: point, max: point });
                assert!(overlaps && held, "{point:?}, {what}");
                told += 1;
            }
            // What is far off is not told of.
            let middle = cell.center().to_array().map(f64::from);
            if solid.is_closed()
                && solid.distance(middle).abs() > f64::from(2.0 * size + 16.0 * rounding)
            {
                let beside_a_rim = matches!(solid, Solid::Cylinder(_));
                assert!(!overlaps || beside_a_rim, "{what}");
                empty += 1;
            }
        }
    }
    assert!(told > 1000 && empty > 1000, "{told} and {empty}");
}

#[test]
fn what_cannot_be_told_by_rounding_is_exact() {
    // No ray slips between two boxes side by side.
    let boxes = (0..64).map(|number: u8| {
        let corner = [number & 3, number >> 2 & 3, number >> 4].map(|x| 0.1 * f32::from(x));
        Aabb::new(corner, corner.map(|x| x + 0.1))
    });
    let boxes = Boxes::new(boxes.collect()).expect("boxes");
    let bvh = build(&boxes);
    for number in 0..1000 {
        let along = 0.4 * (number as f32 / 1000.0);
        for ray in [
            Ray::new([0.1, along, 5.0], [0.0, 0.0, -1.0]),
            Ray::new([along, 0.1, 5.0], [0.0, 0.0, -1.0]),
            Ray::new([0.1, 0.1, 5.0], [0.0, 0.0, -1.0]),
        ] {
            assert!(bvh.occluded(&ray), "{ray:?}");
        }
    }

    // Rays in a disc's plane miss it, those along a cylinder's axis hit both ends.
    let disc = Discs::new(vec![Disc::new([0.0; 3], [0.0, 3.0, 0.0], 1.0)]).expect("a disc");
    let bvh = build(&disc);
    assert_eq!(disc.as_slice()[0].normal, Vec3::Y);
    assert_eq!(disc.bounds(0).extent().y, 0.0);
    assert!(!bvh.occluded(&Ray::new([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0])));
    let cylinder = Cylinder::new([1.0, 2.0, 3.0], [2.0, 4.0, 6.0], 0.5);
    let cylinder = Cylinders::new(vec![cylinder]).expect("it is sound");
    let bvh = build(&cylinder);
    let mut hits = Vec::new();
    bvh.all_hits(&Ray::new([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]), &mut hits);
    assert_eq!(hits.iter().map(|hit| (hit.t, hit.u)).collect::<Vec<_>>(), [(1.0, 0.0), (2.0, 1.0)]);
}

#[test]
fn a_capsule_without_length_is_a_sphere() {
    let mut rng = Rng::new(84);
    for _ in 0..100 {
        let (center, radius) = (10.0 * rng.in_cube(), rng.range(0.1, 3.0));
        let sphere = Spheres::new(vec![(center, radius)]).expect("a sphere");
        let capsule = Capsules::new(vec![Capsule::new(center, center, radius)]).expect("a capsule");
        assert_eq!(sphere.bounds(0), capsule.bounds(0));
        for _ in 0..100 {
            let ray = Ray::new(20.0 * rng.in_cube(), rng.direction());
            let prepared = PreparedRay::new(&ray).expect("a ray");
            assert_eq!(sphere.intersect(0, &prepared), capsule.intersect(0, &prepared));
            let point = 20.0 * rng.in_cube();
            assert_eq!(sphere.closest_point(0, point), capsule.closest_point(0, point));
        }
    }
}

#[test]
fn what_is_no_shape_is_refused_by_number() {
    let (nan, inf, max) = (f32::NAN, f32::INFINITY, f32::MAX);
    let refused = |error: String, expected: &str| assert!(error.starts_with(expected), "{error}");
    for (wrong, what) in [
        (Disc::new([nan, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0), "disc 1 has coordinates"),
        (Disc::new([0.0; 3], [inf, 0.0, 1.0], 1.0), "disc 1 has coordinates"),
        (Disc::new([0.0; 3], [0.0, -0.0, 0.0], 1.0), "disc 1 has a normal of length zero"),
        (Disc::new([0.0; 3], [0.0, 0.0, 1.0], 0.0), "disc 1 has radius 0:"),
        (Disc::new([0.0; 3], [0.0, 0.0, 1.0], nan), "disc 1 has radius NaN:"),
        (Disc::new([max, 0.0, 0.0], [0.0, 0.0, 1.0], max), "disc 1 reaches beyond"),
    ] {
        let fine = Disc::new([0.0; 3], [0.0, 0.0, 1.0], 1.0);
        refused(Discs::new(vec![fine, wrong]).expect_err("it is refused").to_string(), what);
    }
    for (start, end, radius, what) in [
        ([0.0, inf, 0.0], [1.0; 3], 1.0, "1 has coordinates"),
        ([0.0; 3], [0.0, nan, 0.0], 1.0, "1 has coordinates"),
        ([0.0; 3], [1.0; 3], -1.0, "1 has radius -1: it must be finite and greater than zero"),
        ([0.0; 3], [1.0; 3], inf, "1 has radius inf:"),
        ([0.0; 3], [max, max, 0.0], max, "1 reaches beyond"),
        ([5.0; 3], [5.0; 3], 1.0, "1 has both ends"),
    ] {
        let fine = Cylinder::new([0.0; 3], [1.0; 3], 1.0);
        let error = Cylinders::new(vec![fine, Cylinder::new(start, end, radius)]);
        refused(error.expect_err("it is refused").to_string(), &format!("cylinder {what}"));
        let fine = Capsule::new([0.0; 3], [1.0; 3], 1.0);
        let capsules = Capsules::new(vec![fine, Capsule::new(start, end, radius)]);
        if start != end {
            refused(capsules.expect_err("it is refused").to_string(), &format!("capsule {what}"));
        }
    }
    for (wrong, what) in [
        (Aabb::new([0.0, nan, 0.0], [1.0; 3]), "box 1 has coordinates"),
        (Aabb::new([0.0; 3], [1.0, inf, 1.0]), "box 1 has coordinates"),
        (Aabb::new([0.0; 3], [1.0, -1.0, 1.0]), "box 1 is empty"),
    ] {
        let fine = Aabb::new([0.0; 3], [0.0, 1.0, 1.0]);
        refused(Boxes::new(vec![fine, wrong]).expect_err("it is refused").to_string(), what);
    }
}
