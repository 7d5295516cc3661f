//! Balls around primitives that are no triangles: rays that pass by them closely, singly and in packets, hit what they hit without any structure.

use raywood::{
    Aabb, BuildOptions, Geometry, Hit, Joined, PreparedRay, PrimitiveHit, Ray, SimdLevel, Spheres,
    Structure, StructureKind, SurfacePoint, Vec3,
};
use raywood_testkit::{Rng, shapes};

fn build<G: Geometry>(kind: StructureKind, geometry: G) -> Structure<G> {
    Structure::build(kind, geometry, &BuildOptions::default()).expect("it builds")
}

/// Holds rays through the wide tree, on every level, against brute force: singly to the bit, in batches as far as these agree.
pub(crate) fn check<G: Geometry + Copy>(geometry: G, rays: &[Ray], what: &str) {
    let expected = build(StructureKind::BruteForce, geometry);
    let mut structure = build(StructureKind::BvhWide, geometry);
    assert_eq!(structure.validate(), Ok(()), "{what}");
    for level in SimdLevel::available() {
        structure.set_simd_level(level);
        let mut hits = vec![None; rays.len()];
        let mut blocked = vec![false; rays.len()];
        structure.intersect_batch_serial(rays, &mut hits);
        structure.occluded_batch_serial(rays, &mut blocked);
        for ((ray, hit), blocked) in rays.iter().zip(hits).zip(blocked) {
            let what = format!("{what}, {}: {ray:?}", level.name());
            let expected = expected.intersect(ray);
            assert_eq!(structure.intersect(ray), expected, "{what}");
            assert_eq!(structure.occluded(ray), expected.is_some(), "{what}");
            assert_eq!(blocked, expected.is_some(), "{what}");
            let agree = match (&hit, &expected) {
                (Some(hit), Some(expected)) => hit.agrees_with(expected),
                (hit, expected) => hit == expected,
            };
            assert!(agree, "{hit:?}, by brute force {expected:?}, {what}");
        }
    }
}

/// A point at the edge of a sphere as seen from another one, but for a share of the radius of any size.
fn near_edge(center: Vec3, radius: f32, from: Vec3, rng: &mut Rng) -> Vec3 {
    let axis = (center - from).normalize_or_zero();
    let (x, y) = axis.orthonormal_basis();
    let angle = rng.range(0.0, 6.3);
    let side = angle.cos() * x + angle.sin() * y;
    let off = rng.range(-1.0, 1.0) * 10f32.powi(-(rng.below(8) as i32));
    // The tangent's point, not the equator's.
    let share = radius / (center - from).length();
    let tangent = radius * ((1.0 - share * share).max(0.0).sqrt() * side - share * axis);
    center + (1.0 + off) * tangent
}

#[test]
fn rays_that_graze_spheres_hit_what_they_hit() {
    let mut rng = Rng::new(61);
    for exponent in [-12, -6, -2, 0, 3, 9, 14] {
        let scale = 10f32.powi(exponent);
        let balls: Vec<_> = (0..40)
            .map(|_| (scale * rng.in_cube(), scale * 0.2 * 10f32.powi(-(rng.below(5) as i32))))
            .collect();
        let spheres = Spheres::new(balls.clone()).expect("spheres");
        let eye = scale * Vec3::new(0.3, 0.2, -3.0);
        let target = |rng: &mut Rng| {
            let (center, radius) = balls[rng.below(balls.len())];
            near_edge(center, radius, eye, rng)
        };
        for (length, name) in [(1.0, "near"), (1e-5, "short"), (1e5, "long")] {
            let what = format!("10^{exponent}, {name}");
            // From one point; to one point; and from anywhere, as if there were no packets.
            let towards = |rng: &mut Rng| Ray::new(eye, length / scale * (target(rng) - eye));
            let rays: Vec<_> = (0..600).map(|_| towards(&mut rng)).collect();
            check(&spheres, &rays, &what);
            let rays: Vec<_> =
                (0..600).map(|_| Ray::between(eye + 1.7 * (target(&mut rng) - eye), eye)).collect();
            check(&spheres, &rays, &what);
            let anywhere = |rng: &mut Rng| {
                let (center, radius) = balls[rng.below(balls.len())];
                let from = center + 10.0 * scale * rng.unit() * rng.direction();
                Ray::new(from, length / scale * (near_edge(center, radius, from, rng) - from))
            };
            let rays: Vec<_> = (0..300).map(|_| anywhere(&mut rng)).collect();
            check(&spheres, &rays, &what);
        }
    }
}

#[test]
fn spheres_among_triangles_are_hit_in_packets() {
    let mut rng = Rng::new(62);
    let mesh = shapes::uv_sphere(24, Vec3::ZERO, 1.0);
    let balls = (0..200).map(|_| (rng.range(0.98, 1.02) * rng.direction(), 0.02)).collect();
    let spheres = Spheres::new(balls).expect("spheres");
    let scene = Joined { first: &mesh, second: &spheres };
    let eye = Vec3::new(0.4, 0.5, -2.5);
    let towards = |rng: &mut Rng| Ray::new(eye, rng.in_cube() - eye);
    let rays: Vec<_> = (0..2000).map(|_| towards(&mut rng)).collect();
    check(scene, &rays, "from a point");
    let rays: Vec<_> = (0..2000).map(|_| Ray::between(1.2 * rng.direction(), eye)).collect();
    check(scene, &rays, "to a point");
    let rays: Vec<_> =
        (0..2000).map(|_| Ray::new(2.0 * rng.in_cube(), Vec3::new(0.2, -0.9, 0.3))).collect();
    check(scene, &rays, "parallel");
}

/// Spheres that tell of no balls.
#[derive(Clone, Copy)]
struct Plain<'a>(&'a Spheres);

impl Geometry for Plain<'_> {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.0.bounds(primitive)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.0.intersect(primitive, ray)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

#[test]
fn primitives_without_a_ball_are_always_asked() {
    let mut rng = Rng::new(63);
    let balls = (0..100).map(|_| (rng.in_cube(), 0.1 * rng.unit())).collect();
    let spheres = Spheres::new(balls).expect("spheres");
    let eye = Vec3::new(0.1, 0.2, -4.0);
    let rays: Vec<_> = (0..1000).map(|_| Ray::new(eye, 1.2 * rng.in_cube() - eye)).collect();
    check(Plain(&spheres), &rays, "no balls");
}
