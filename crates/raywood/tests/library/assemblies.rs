//! Geometries of many kinds in one tree.

use std::sync::Arc;

use raywood::{
    Aabb, Assembly, Boxes, BuildOptions, Bvh, Capsule, Capsules, Disc, Discs, Geometry, Instance,
    Joined, QueryOptions, Ray, Spheres, Structure, StructureKind, Tlas, Transform, TriangleMesh,
    Vec3,
};
use raywood_testkit::{Rng, rays, shapes};

#[test]
fn the_same_as_joined_one_by_one() {
    let mut rng = Rng::new(101);
    let mesh = shapes::soup(400, 0.2, 102);
    let balls = (0..100).map(|_| (rng.in_cube(), 0.1 * rng.unit())).collect();
    let balls = Spheres::new(balls).expect("spheres");
    let beams = shapes::beams(50, 20);
    let joined = Joined { first: &mesh, second: Joined { first: &balls, second: &beams } };
    let mut assembly = Assembly::new();
    assert_eq!(assembly.add(&mesh), 0);
    assert_eq!(assembly.add(TriangleMesh::default()), 1);
    assert_eq!(assembly.add(&balls), 2);
    assert_eq!(assembly.add(Arc::new(beams.clone())), 3);
    assert_eq!(assembly.add(Box::new(Spheres::default()) as Box<dyn Geometry + Send>), 4);
    assert_eq!((assembly.count(), assembly.len()), (5, joined.len()));

    // Numbers there and back.
    for primitive in 0..assembly.len() as u32 {
        let (geometry, own) = assembly.locate(primitive);
        assert_eq!(assembly.primitive(geometry, own), Some(primitive));
        let part = assembly.get(geometry).expect("it is there");
        assert_eq!(part.bounds(own), joined.bounds(primitive));
    }
    assert_eq!(assembly.locate(399), (0, 399));
    assert_eq!(assembly.locate(400), (2, 0));
    assert_eq!(assembly.locate(500), (3, 0));
    assert_eq!(assembly.primitive(0, 400), None);
    assert_eq!(assembly.primitive(1, 0), None);
    assert_eq!(assembly.primitive(9, 0), None);
    assert!(assembly.get(5).is_none());

    let both: [&dyn Geometry; 2] = [&assembly, &joined];
    let rays = rays::against(&mesh, 1000, 103);
    for &kind in StructureKind::ALL {
        let options = BuildOptions::default();
        let one = Structure::build(kind, both[0], &options).expect("it builds");
        let other = Structure::build(kind, both[1], &options).expect("it builds");
        assert_eq!(one.validate(), Ok(()), "{}", kind.name());
        for ray in &rays {
            let hit = one.intersect(ray);
            assert_eq!(hit, other.intersect(ray), "{}: {ray:?}", kind.name());
            let points =
                hit.map(|hit| (one.surface_point(ray, &hit), other.surface_point(ray, &hit)));
            assert!(points.is_none_or(|(a, b)| a == b));
        }
        // Triangles lie in the tree itself.
        assert_eq!(one.stats().bytes, other.stats().bytes, "{}", kind.name());
    }
    let (one, other) = (Bvh::build(both[0]), Bvh::build(both[1]));
    let (one, other) = (one.expect("it builds"), other.expect("it builds"));
    let (solid, other_solid) = (one.solid(), other.solid());
    for _ in 0..300 {
        let point = 1.5 * rng.in_cube();
        let closest = one.closest_point(point, f32::INFINITY);
        assert_eq!(closest, other.closest_point(point, f32::INFINITY));
        assert_eq!(solid.winding_number(point), other_solid.winding_number(point));
    }
}

#[test]
fn masks_of_geometries_and_of_their_primitives() {
    /// Discs of which every other is in the first group only.
    struct Striped(Discs);

    impl Geometry for Striped {
        fn len(&self) -> usize {
            self.0.len()
        }
        fn bounds(&self, primitive: u32) -> Aabb {
            self.0.bounds(primitive)
        }
        fn mask(&self, primitive: u32) -> u32 {
            if primitive.is_multiple_of(2) { 0b001 } else { 0b111 }
        }
        fn intersect(
            &self,
            primitive: u32,
            ray: &raywood::PreparedRay,
        ) -> Option<raywood::PrimitiveHit> {
            self.0.intersect(primitive, ray)
        }
        fn surface_point(&self, ray: &Ray, hit: &raywood::Hit) -> raywood::SurfacePoint {
            self.0.surface_point(ray, hit)
        }
    }

    let disc = |z: f32| Disc::new([0.0, 0.0, z], [0.0, 0.0, 1.0], 1.0);
    let mut assembly = Assembly::new();
    let room = Boxes::new(vec![Aabb::new([-9.0; 3], [9.0; 3])]).expect("a box");
    let room = assembly.add_masked(room, 0b100);
    let panes = Discs::new(vec![disc(1.0), disc(2.0)]).expect("discs");
    let panes = assembly.add_masked(Striped(panes), 0b011);
    let hidden = Spheres::new(vec![(Vec3::ZERO, 0.5)]).expect("a sphere");
    assembly.add_masked(hidden, 0);
    let bvh = Bvh::build(assembly).expect("it builds");
    let ray = Ray::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let first = |mask| {
        let hit = bvh.intersect_with(&ray, QueryOptions::new().mask(mask))?;
        Some(bvh.geometry().locate(hit.primitive))
    };
    assert_eq!(first(0b001), Some((panes, 0)));
    assert_eq!(first(0b010), Some((panes, 1)));
    assert_eq!(first(0b100), Some((room, 0)));
    assert_eq!(first(u32::MAX), Some((panes, 0)));
    assert_eq!(first(0b1000), None);
    // Plain queries do not ask.
    assert_eq!(bvh.intersect(&ray).map(|hit| hit.t), Some(0.5));
}

#[test]
fn instances_of_what_is_no_triangle() {
    // Rays that leave surfaces through rotations, scaling and shear, however flat, do not come back.
    let mut rng = Rng::new(104);
    let turned = Transform::rotation([1.0, 2.0, 3.0], 50.0);
    let flat = Transform::scaling([3.0, 0.2, -1.0]);
    for scale in [1e-3, 1.0, 1e4] {
        let capsule = Capsule::new([0.0; 3], [scale, 2.0 * scale, 0.0], 0.3 * scale);
        let corners = Aabb::new([-scale, 0.0, 3.0 * scale], [scale, scale, 4.0 * scale]);
        let mut assembly = Assembly::new();
        assembly.add(Capsules::new(vec![capsule]).expect("a capsule"));
        assembly.add(Boxes::new(vec![corners]).expect("a box"));
        let object = Arc::new(Bvh::build(assembly).expect("it builds"));
        let far = Transform::translation([30.0 * scale, 0.0, -5.0 * scale]);
        let transforms = [turned, far.then(&turned).then(&flat), flat.then(&far)];
        for transform in transforms {
            let scene = Tlas::build(vec![Instance::new(Arc::clone(&object), transform)]);
            let scene = scene.expect("it builds");
            let mut hits = 0;
            for _ in 0..3000 {
                let target = transform.point(scale * Vec3::new(0.5, 1.0, 3.5 * rng.unit()));
                let from = target + 20.0 * scale * rng.direction();
                let ray = Ray::new(from, target + 0.5 * scale * rng.in_cube() - from);
                let Some(hit) = scene.intersect(&ray) else { continue };
                let point = scene.surface_point(&ray, &hit);
                let n = point.normal;
                let any = rng.direction();
                let direction = if rng.below(2) == 0 { any } else { any - any.dot(n) * n };
                let out = if direction.dot(n) < 0.0 { -direction } else { direction };
                let again = scene.intersect(&point.spawn(out));
                let same = again.filter(|again| again.primitive == hit.primitive);
                assert_eq!(same, None, "{point:?} towards {out:?}, {transform:?}");
                hits += 1;
            }
            assert!(hits > 500, "only {hits} hits");
        }
    }
}
