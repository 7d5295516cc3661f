//! Batches through scenes of instances answer as single rays do.

use std::sync::Arc;

use raywood::{
    Bvh, Geometry, Hit, HitColumns, Instance, MeshPart, Ray, SimdLevel, Tlas, Traceable, Transform,
    TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, rays, shapes};

/// Instances of every kind of transform, near to each other and on top of each other.
fn transforms(count: usize, rng: &mut Rng) -> Vec<Transform> {
    let one = |number: usize, rng: &mut Rng| {
        let shape = match number % 5 {
            0 => Transform::IDENTITY,
            1 => Transform::scaling([2.0, 0.5, 1.0]),
            2 => Transform::scaling([-1.0, 1.0, 1.3]),
            3 => Transform::from_rows([
                [1.0, 0.7, 0.0, 0.0],
                [0.0, 1.0, -0.4, 0.0],
                [0.2, 0.0, 1.0, 0.0],
            ]),
            // Directions become so long that rays are rescaled there.
            _ => Transform::scaling([1e-24; 3]),
        };
        let turn = Transform::rotation(rng.direction(), rng.range(-180.0, 180.0));
        let place = Transform::translation(6.0 * rng.in_cube());
        shape.then(&turn).then(&place)
    };
    (0..count).map(|number| one(number, rng)).collect()
}

fn scene<B: Traceable>(object: &Arc<B>, transforms: &[Transform], level: SimdLevel) -> Tlas<B> {
    let instances = transforms.iter().zip(0..).map(|(&transform, number)| Instance {
        mask: if number % 7 == 6 { 2 } else { 1 },
        ..Instance::new(Arc::clone(object), transform)
    });
    let mut scene = Tlas::build(instances.collect()).expect("good transforms");
    scene.set_simd_level(level);
    scene
}

/// Rays of all sorts: from one point, parallel, without order, limited, and some that are none.
fn all_rays(rng: &mut Rng) -> Vec<Ray> {
    let eye = Vec3::new(1.0, 2.0, 20.0);
    let mut all = Vec::new();
    for row in 0..48 {
        for column in 0..48 {
            let (x, y) = (column as f32 / 4.0 - 6.0, row as f32 / 4.0 - 6.0);
            all.push(Ray::new(eye, Vec3::new(x, y, 0.0) - eye));
        }
    }
    all.extend((0..1500).map(|number| {
        let [x, y] = [number % 40, number / 40].map(|place| place as f32 / 3.0 - 6.0);
        Ray::new([x, y, 30.0], [0.1, 0.0, -1.0]).with_interval(0.0, 33.0)
    }));
    all.extend((0..3000).map(|_| Ray::new(8.0 * rng.in_cube(), rng.direction())));
    let nasty = shapes::uv_sphere(6, Vec3::ZERO, 6.0);
    all.extend(rays::against(&nasty, 1500, 5));
    for number in (0..all.len()).step_by(97) {
        all[number].direction.x = f32::NAN;
    }
    all
}

fn check(scene: &Tlas<impl Traceable>, rays: &[Ray], name: &str) {
    let (mut hits, mut blocked) = (vec![None; rays.len()], vec![false; rays.len()]);
    for mask in [1, u32::MAX] {
        scene.intersect_batch_masked(rays, mask, &mut hits);
        scene.occluded_batch_masked(rays, mask, &mut blocked);
        let mut count = 0;
        for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(&blocked) {
            let expected = scene.intersect_masked(ray, mask);
            let agrees = match (&expected, hit) {
                (Some(expected), Some(hit)) => hit.agrees_with(expected),
                (None, None) => true,
                _ => false,
            };
            assert!(agrees, "{name}: {ray:?} hits {hit:?}, alone {expected:?}");
            assert_eq!(*blocked, expected.is_some(), "{name}: {ray:?}");
            count += usize::from(expected.is_some());
        }
        assert!(count > rays.len() / 20, "{name}: only {count} hits");
    }
    // On the calling thread the same to the last digit.
    let (mut serial, mut serial_blocked) = (vec![None; rays.len()], vec![true; rays.len()]);
    scene.intersect_batch_serial(rays, &mut serial);
    scene.occluded_batch_serial(rays, &mut serial_blocked);
    assert_eq!(serial, hits, "{name}");
    assert_eq!(serial_blocked, blocked, "{name}");
}

#[test]
fn batches_answer_as_single_rays() {
    let mut rng = Rng::new(4);
    let rays = all_rays(&mut rng);
    for (name, mesh) in [
        ("sphere", shapes::uv_sphere(9, Vec3::splat(0.1), 1.2)),
        ("soup", shapes::soup(80, 0.5, 3)),
        ("nothing", shapes::soup(0, 0.5, 3)),
    ] {
        let transforms = transforms(60, &mut rng);
        for level in SimdLevel::available() {
            let mut object = Bvh::build(mesh.clone()).expect("it builds");
            object.set_simd_level(level);
            let scene = scene(&Arc::new(object), &transforms, level);
            if mesh.is_empty() {
                let mut hits = vec![None; rays.len()];
                scene.intersect_batch(&rays, &mut hits);
                assert!(hits.iter().all(Option::is_none));
            } else {
                check(&scene, &rays, name);
            }
        }
    }
}

#[test]
fn batches_answer_as_single_rays_on_two_levels() {
    let mut rng = Rng::new(5);
    let rays = all_rays(&mut rng);
    let object = Arc::new(Bvh::build(shapes::uv_sphere(8, Vec3::ZERO, 1.0)).expect("it builds"));
    let level = SimdLevel::active();
    let inner = Arc::new(scene(&object, &transforms(9, &mut rng), level));
    let outer = transforms(10, &mut rng);
    check(&scene(&inner, &outer, level), &rays, "two levels");
}

#[test]
fn equally_near_hits_are_those_of_the_lowest_instance() {
    let object = Arc::new(Bvh::build(shapes::uv_sphere(8, Vec3::ZERO, 1.0)).expect("it builds"));
    let scene = scene(&object, &[Transform::IDENTITY; 5], SimdLevel::active());
    let eye = Vec3::new(0.3, 0.2, 5.0);
    let target = |number: usize| Vec3::new(number as f32 / 300.0 - 0.5, 0.1, 0.0);
    let rays: Vec<_> = (0..300).map(|number| Ray::new(eye, target(number) - eye)).collect();
    let alone: Vec<_> = rays.iter().map(|ray| scene.intersect(ray).expect("a hit")).collect();
    assert!(alone.iter().all(|hit| hit.instance == 0));

    // Few rays go into instances one by one, so that distances are equal to the last digit.
    let mut hits = vec![None; rays.len()];
    scene.intersect_batch(&rays[..100], &mut hits[..100]);
    assert!(hits[..100].iter().zip(&alone).all(|(hit, alone)| *hit == Some(*alone)));

    // Packets round, and of instances at the same place any may be named.
    scene.intersect_batch(&rays, &mut hits);
    let agrees = |(hit, alone): (&Option<Hit>, &Hit)| hit.is_some_and(|hit| hit.agrees_with(alone));
    assert!(hits.iter().zip(&alone).all(agrees));
}

#[test]
fn columns_tell_instances() {
    let object = Arc::new(Bvh::build(shapes::uv_sphere(8, Vec3::ZERO, 1.0)).expect("it builds"));
    let places = [[-3.0, 0.0, 0.0], [3.0, 0.0, 0.0]].map(Transform::translation);
    let scene = scene(&object, &places, SimdLevel::active());
    let eye = Vec3::new(0.0, 0.0, 9.0);
    let directions: Vec<_> =
        (0..64).map(|number| Vec3::new(number as f32 / 8.0 - 4.0, 0.0, -9.0)).collect();
    let mut columns = HitColumns::default();
    scene.intersect_from_serial(eye, &directions, &mut columns);
    let mut seen = [0; 2];
    for (direction, hit) in directions.iter().zip(columns.iter()) {
        let alone = scene.intersect(&Ray::new(eye, *direction));
        assert_eq!(hit.map(|hit| hit.instance), alone.map(|hit| hit.instance));
        hit.iter().for_each(|hit| seen[hit.instance as usize] += 1);
    }
    assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
    // Without instances they are all 0 again.
    object.intersect_from(eye, &directions, &mut columns);
    assert!(columns.instance.is_empty());
}

#[test]
fn parts_of_a_mesh_answer_as_meshes_of_their_own() {
    let (first, second) = (
        shapes::uv_sphere(7, Vec3::ZERO, 1.0),
        shapes::uv_sphere(5, Vec3::new(0.5, 0.0, 0.0), 1.0),
    );
    let vertices = first.positions().len() as u32;
    let positions = [first.positions(), second.positions()].concat();
    let mut triangles = first.triangles().to_vec();
    triangles.extend(second.triangles().iter().map(|t| t.map(|corner| corner + vertices)));
    let both = TriangleMesh::new(positions, triangles).expect("a mesh");
    let count = first.triangles().len() as u32;

    let part = MeshPart::new(&both, count..u32::MAX);
    assert_eq!((part.first(), part.len()), (count, second.len()));
    assert_eq!(part.total_bounds(), second.total_bounds());
    let (part, alone) = (Bvh::build(part).expect("it builds"), Bvh::build(&second).expect("it"));
    for ray in rays::against(&second, 2000, 6) {
        let (hit, expected) = (part.intersect(&ray), alone.intersect(&ray));
        assert_eq!(hit, expected, "{ray:?}");
        if let Some(hit) = hit {
            assert_eq!(part.surface_point(&ray, &hit), alone.surface_point(&ray, &hit));
        }
    }
    let (start, end) = (5, 3);
    assert!(MeshPart::new(&both, start..end).is_empty());
    assert!(MeshPart::new(&both, u32::MAX - 1..u32::MAX).is_empty());
}
