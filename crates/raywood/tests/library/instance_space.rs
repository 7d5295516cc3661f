//! What is near in scenes of instances: closest points and overlaps, on several levels, are those of the flattened scene.

use std::ops::ControlFlow;
use std::sync::Arc;

use raywood::{
    Aabb, Ball, Bvh, ClosestPoint, Geometry, Instance, Region, SceneRegion, Searchable, SimdLevel,
    Spheres, Tlas, Transform, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, distance, shapes};

use crate::instances::{friendly, nasty_transforms};

/// Transforms of every kind that take points of a coarse lattice to points of a finer one, so that nothing is rounded.
pub(crate) fn exact_transforms() -> Vec<Transform> {
    let place = |x, y, z| Transform::translation([x, y, z]);
    let turn =
        Transform::from_rows([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0]]);
    let shear =
        Transform::from_rows([[1.0, 0.5, 0.0, 0.0], [0.0, 1.0, -0.75, 0.0], [0.25, 0.0, 1.0, 0.0]]);
    vec![
        Transform::IDENTITY,
        turn.then(&place(1.5, -2.0, 0.25)),
        Transform::scaling([-1.0, 1.0, 1.0]).then(&place(-3.0, 1.0, 2.0)),
        Transform::scaling([4.0, 0.25, 1.0]).then(&turn),
        shear.then(&place(0.5, 3.0, -2.5)),
        shear.then(&turn).then(&Transform::scaling([1.0, -2.0, 0.125])),
        // One twice, so that distances are equal.
        turn.then(&place(1.5, -2.0, 0.25)),
    ]
}

/// Triangles on a lattice.
pub(crate) fn on_lattice(count: usize, seed: u64) -> TriangleMesh {
    shapes::mapped(&shapes::soup(count, 0.5, seed), |p| {
        p.to_array().map(|x| (256.0 * x).round() / 256.0).into()
    })
}

const MASKS: [u32; 3] = [u32::MAX, 1, 0];

fn placed<B>(object: &Arc<B>, transforms: &[Transform]) -> Vec<Instance<B>> {
    let pairs = transforms.iter().zip(MASKS.into_iter().cycle());
    pairs.map(|(&t, mask)| Instance { mask, ..Instance::new(Arc::clone(object), t) }).collect()
}

/// A scene of scenes, and all triangles of it in the order of instances; those that no mask sees in a place of their own, far away.
pub(crate) struct Flattened {
    pub(crate) scene: Tlas<Tlas<Bvh<TriangleMesh>>>,
    pub(crate) flat: Bvh<TriangleMesh>,
    count: u32,
}

pub(crate) fn flattened(
    mesh: TriangleMesh,
    transforms: &[Transform],
    mask: u32,
    level: SimdLevel,
) -> Flattened {
    let mut object = Bvh::build(mesh).expect("it builds");
    object.set_simd_level(level);
    let mesh = object.geometry().clone();
    let inner = placed(&Arc::new(object), transforms);
    let inner = Arc::new(Tlas::build(inner).expect("good transforms"));
    let scene = Tlas::build(placed(&inner, transforms)).expect("good transforms");
    let mut positions = Vec::new();
    for outer in scene.instances() {
        for instance in inner.instances() {
            let seen = outer.mask & mask != 0 && instance.mask & mask != 0;
            for triangle in 0..mesh.len() as u32 {
                let corners = mesh.corners(triangle);
                let placed = corners.map(|p| outer.transform.point(instance.transform.point(p)));
                positions.extend(if seen { placed } else { [Vec3::splat(1e9); 3] });
            }
        }
    }
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let flat = TriangleMesh::new(positions, triangles.collect()).expect("sound");
    let count = mesh.len() as u32;
    Flattened { scene, flat: Bvh::build(flat).expect("it builds"), count }
}

impl Flattened {
    /// An answer of the flattened scene by the numbers of the other.
    fn in_scene(&self, closest: ClosestPoint) -> ClosestPoint {
        let (instance, primitive) = self.numbers(closest.primitive);
        ClosestPoint { instance, primitive, ..closest }
    }

    pub(crate) fn numbers(&self, primitive: u32) -> (u32, u32) {
        (primitive / self.count, primitive % self.count)
    }

    /// What touches a region in the flattened scene, by the numbers of the other, in order.
    pub(crate) fn overlapping(&self, region: &impl Region) -> Vec<(u32, u32)> {
        let mut found = Vec::new();
        let flow = self.flat.overlapping(region, |primitive| {
            found.push(self.numbers(primitive));
            ControlFlow::Continue(())
        });
        assert!(flow.is_continue());
        found.sort_unstable();
        found
    }
}

/// Points in and around a scene, some of them on its lattice.
pub(crate) fn some_points(bounds: &Aabb, count: usize, seed: u64) -> Vec<Vec3> {
    let mut rng = Rng::new(seed);
    let (center, half) = (bounds.center(), 0.5 * bounds.extent());
    (0..count)
        .map(|i| {
            let point = center + [0.3, 1.0, 5.0, 0.7][i % 4] * half * rng.in_cube();
            if i % 4 == 3 { point.to_array().map(f32::round).into() } else { point }
        })
        .collect()
}

#[test]
fn closest_points_are_those_of_the_flattened_scene_to_the_bit() {
    for level in SimdLevel::available() {
        for mask in [u32::MAX, 2] {
            let both = flattened(on_lattice(20, 1), &exact_transforms(), mask, level);
            let (mut found, mut beyond) = (0, 0);
            for (i, point) in some_points(&both.scene.bounds(), 1500, 2).into_iter().enumerate() {
                let max_distance = [f32::INFINITY, 1.0, 0.0][i % 3];
                let expected = both.flat.closest_point(point, max_distance);
                // What no mask sees lies far away in the flattened scene.
                let expected = expected.filter(|closest| closest.distance < 1e8);
                let expected = expected.map(|closest| both.in_scene(closest));
                let closest = both.scene.closest_point_masked(point, max_distance, mask);
                assert_eq!(closest, expected, "{point:?}");
                found += usize::from(closest.is_some());
                beyond += usize::from(closest.is_none());
                let Some(ClosestPoint { distance, .. }) = closest else { continue };
                assert_eq!(both.scene.closest_point_masked(point, distance, mask), expected);
                if distance > 0.0 {
                    let nearer = distance.next_down();
                    assert_eq!(both.scene.closest_point_masked(point, nearer, mask), None);
                }
            }
            assert!(found > 500 && beyond > 100, "{found} found, {beyond} beyond");
        }
    }
}

#[test]
fn distances_are_the_scenes_under_any_transform() {
    let mut rng = Rng::new(3);
    let mesh = shapes::soup(40, 0.5, 4);
    let object = Arc::new(Bvh::build(mesh.clone()).expect("it builds"));
    let outer =
        Transform::rotation([1.0, 2.0, 3.0], 33.0).then(&Transform::scaling([3.0, 1.0, -0.2]));
    for transform in friendly(&mut rng).into_iter().chain(nasty_transforms(&mut rng)) {
        let alone = Tlas::build(vec![Instance::new(Arc::clone(&object), transform)]);
        let alone = Arc::new(alone.expect("a good transform"));
        let nested = Tlas::build(vec![Instance::new(Arc::clone(&alone), outer)]).expect("good");
        let flat = shapes::mapped(&mesh, |p| transform.point(p));
        let flat_nested = shapes::mapped(&flat, |p| outer.point(p));
        check_distances(&*alone, &flat, &mut rng);
        check_distances(&nested, &flat_nested, &mut rng);
    }
}

/// That closest points lie as far as brute force says, but for the rounding of the flattened corners.
fn check_distances<B: Searchable>(scene: &Tlas<B>, flat: &TriangleMesh, rng: &mut Rng) {
    let bounds = flat.total_bounds();
    let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
    for point in some_points(&bounds, 40, rng.bits()) {
        let closest = scene.closest_point(point, f32::INFINITY).expect("there is something");
        let expected = distance::to_mesh(point, flat);
        let tolerance = distance::tolerance(point, flat, expected) + 4e-7 * f64::from(reach);
        let error = (f64::from(closest.distance) - expected).abs();
        assert!(error <= tolerance, "{closest:?} instead of {expected} from {point:?}");
        let own = distance::to_triangle(closest.point, flat.corners(closest.primitive));
        assert!(own <= tolerance + 1e-6 * f64::from(point.abs().max_element()), "{own}");
    }
}

/// What touches a region, in order.
pub(crate) fn overlapping<B: Searchable>(
    scene: &Tlas<B>,
    region: &impl SceneRegion,
) -> Vec<(u32, u32)> {
    let mut found = Vec::new();
    let flow = scene.overlapping(region, |instance, primitive| {
        found.push((instance, primitive));
        ControlFlow::Continue(())
    });
    assert!(flow.is_continue());
    assert_eq!(scene.overlaps(region), !found.is_empty());
    found.sort_unstable();
    found
}

#[test]
fn what_touches_regions_is_that_of_the_flattened_scene() {
    let mut rng = Rng::new(5);
    let mut found = 0;
    for level in SimdLevel::available() {
        let both = flattened(on_lattice(20, 6), &exact_transforms(), u32::MAX, level);
        for (i, point) in some_points(&both.scene.bounds(), 800, 7).into_iter().enumerate() {
            let size = rng.range(0.0, 3.0);
            let ball = Ball::new(point, if i % 5 == 0 { 0.0 } else { size });
            let expected = both.overlapping(&ball);
            let touching = overlapping(&both.scene, &ball);
            assert_eq!(touching, expected, "{ball:?}");
            found += touching.len();

            let reach = size * Vec3::new(rng.unit(), rng.unit(), rng.unit());
            let region = Aabb::new(point - reach, point + reach);
            let expected = both.overlapping(&region);
            let touching = overlapping(&both.scene, &region);
            assert_eq!(touching, expected, "{region:?}");
            found += touching.len();
        }
        // What reaches to infinity holds everything on its side; what is broken nothing.
        let half = Aabb::new([0.0, f32::NEG_INFINITY, f32::NEG_INFINITY], [1e8; 3]);
        let expected = both.overlapping(&half);
        assert_eq!(overlapping(&both.scene, &half), expected);
        let all = overlapping(&both.scene, &Ball::new([0.0; 3], f32::INFINITY));
        assert!(all.len() > expected.len());
        let at_infinity = Aabb::of_points([Vec3::new(0.0, f32::INFINITY, 0.0)]);
        for region in [Aabb::EMPTY, Aabb::new([f32::NAN; 3], [1.0; 3]), at_infinity] {
            assert!(overlapping(&both.scene, &region).is_empty());
        }
        for ball in [Ball::new([f32::NAN; 3], 1.0), Ball::new([0.0; 3], -1.0)] {
            assert!(overlapping(&both.scene, &ball).is_empty());
        }
    }
    assert!(found > 10_000, "only {found}");
}

#[test]
fn spheres_are_near_where_transforms_leave_them_spheres() {
    let mut rng = Rng::new(8);
    let list: Vec<_> = (0..50).map(|_| (rng.in_cube(), rng.range(0.05, 0.3))).collect();
    let object = Spheres::new(list.clone()).expect("sound");
    let object = Arc::new(Bvh::build(object).expect("it builds"));
    let turn = Transform::rotation(rng.direction(), 77.0);
    let even = Transform::scaling([-2.5, 2.5, 2.5]).then(&turn);
    let inner =
        Arc::new(Tlas::build(vec![Instance::new(Arc::clone(&object), even)]).expect("good"));
    let outer = turn.then(&Transform::translation([3.0, -2.0, 1.0]));
    let scene = Tlas::build(vec![Instance::new(Arc::clone(&inner), outer)]).expect("good");
    for point in some_points(&scene.bounds(), 400, 9) {
        let closest = scene.closest_point(point, f32::INFINITY).expect("there is something");
        let distance = |(center, radius): (Vec3, f32)| {
            let center = outer.point(even.point(center));
            ((point - center).length() - 2.5 * radius).abs()
        };
        let expected = list.iter().map(|&s| distance(s)).fold(f32::INFINITY, f32::min);
        assert!((closest.distance - expected).abs() < 1e-5 * (1.0 + expected), "{closest:?}");
        assert!(overlapping(&scene, &Ball::new(point, 1.01 * expected + 1e-4)).len() < list.len());
        assert!(scene.overlaps(&Ball::new(point, 1.01 * expected + 1e-4)));
        assert!(!scene.overlaps(&Ball::new(point, 0.99 * expected - 1e-4)));
    }

    // Of an ellipsoid nothing is told but whether its box may touch another.
    let uneven = Instance::new(object, Transform::scaling([1.0, 2.0, 1.0]));
    let scene = Tlas::build(vec![uneven]).expect("good");
    assert_eq!(scene.closest_point([0.0; 3], f32::INFINITY), None);
    let (center, _) = list[7];
    let region = Aabb::of_points([center * Vec3::new(1.0, 2.0, 1.0)]);
    assert!(overlapping(&scene, &region).contains(&(0, 7)));
}

#[test]
fn batches_answer_as_single_points_do_and_what_is_broken_is_near_nothing() {
    let both = flattened(on_lattice(20, 10), &exact_transforms(), u32::MAX, SimdLevel::active());
    let mut points = some_points(&both.scene.bounds(), 300, 11);
    points.push(Vec3::new(0.0, f32::NAN, 0.0));
    points.push(Vec3::new(f32::INFINITY, 0.0, 0.0));
    let mut answers = vec![None; points.len()];
    both.scene.closest_point_batch(&points, 4.0, &mut answers);
    for (&point, answer) in points.iter().zip(&answers) {
        assert_eq!(*answer, both.scene.closest_point(point, 4.0));
    }
    assert!(answers[300..].iter().all(Option::is_none) && answers.iter().flatten().count() > 100);
    for distance in [f32::NAN, -1.0, f32::NEG_INFINITY] {
        assert_eq!(both.scene.closest_point([0.0; 3], distance), None);
    }
    let empty = Tlas::<Bvh<TriangleMesh>>::build(vec![]).expect("legal");
    assert_eq!(empty.closest_point([0.0; 3], f32::INFINITY), None);
    assert!(!empty.overlaps(&Ball::new([0.0; 3], f32::INFINITY)));
}
