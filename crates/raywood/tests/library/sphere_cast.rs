//! Moving spheres against brute force: the distance along the way, in double precision.

use raywood::{Bvh, Geometry, Joined, Ray, SimdLevel, SphereHit, Spheres, TriangleMesh, Vec3};
use raywood_testkit::{Rng, distance, nasty, rays, shapes};

fn meshes() -> impl Iterator<Item = (&'static str, TriangleMesh)> {
    let friendly = [
        ("a sphere", shapes::uv_sphere(24, Vec3::new(0.3, -0.2, 0.1), 1.5)),
        ("a box", shapes::grid_box(6, Vec3::splat(-1.0), Vec3::splat(1.0))),
        ("a soup", shapes::soup(1000, 0.1, 3)),
    ];
    friendly.into_iter().chain(nasty::all().into_iter().map(|nasty| (nasty.name, nasty.mesh)))
}

/// The answer, which is the same on all levels and in batches.
fn cast<G: Geometry>(bvh: &mut Bvh<G>, ray: &Ray, radius: f32) -> Option<SphereHit> {
    let mut answers = SimdLevel::available().map(|level| {
        bvh.set_simd_level(level);
        let mut hits = [None];
        bvh.sphere_cast_batch(&[*ray], radius, &mut hits);
        hits[0]
    });
    let first = answers.next().expect("a level");
    assert!(answers.all(|other| other == first), "levels differ: {ray:?} {radius}");
    first
}

#[test]
fn no_sooner_and_no_later_than_brute_force_says() {
    let mut hits = 0;
    for (name, mesh) in meshes() {
        let size = if mesh.triangles().is_empty() { 1.0 } else { mesh.total_bounds().diagonal() };
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        for ray in rays::against(&mesh, 60, 41) {
            for radius in [0.003 * size, 0.05 * size, 0.4 * size] {
                let found = cast(&mut bvh, &ray, radius);
                let length = ray.direction.length();
                if !(ray.is_valid() && length > 1e-20 && length < 1e20) {
                    continue;
                }
                let what = format!("{name}: {ray:?}, radius {radius}: {found:?}");
                let reach = ray.origin.abs().max_element() + size;
                let tolerance = 1e-5 * f64::from(radius + reach);
                let end = found.map_or(ray.t_max.min(4.0 * reach / length), |hit| hit.t);

                // Nothing is touched before.
                for step in 0..24 {
                    let t = ray.t_min + (end - ray.t_min) * step as f32 / 24.0;
                    if t < end && t.is_finite() {
                        let distance = distance::to_mesh(ray.at(t), &mesh);
                        assert!(distance >= f64::from(radius) - tolerance, "at {t}: {what}");
                    }
                }

                // And something then: the radius away, or overlapping at the start.
                if let Some(SphereHit { t, point, normal, primitive, .. }) = found {
                    hits += 1;
                    assert!(ray.t_min <= t && t < ray.t_max, "{what}");
                    let center = ray.at(t);
                    let distance = distance::to_triangle(center, mesh.corners(primitive));
                    let off = distance - f64::from(radius);
                    assert!(
                        off <= tolerance && (t == ray.t_min || off >= -tolerance),
                        "{off} {what}"
                    );
                    let apart = f64::from((center - point).length());
                    assert!((apart - distance).abs() <= tolerance, "{what}");
                    assert!(normal == Vec3::ZERO || (normal.length() - 1.0).abs() < 1e-5, "{what}");
                }
            }
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn the_lowest_number_of_those_touched_together() {
    for (name, mesh) in meshes() {
        let size = if mesh.triangles().is_empty() { 1.0 } else { mesh.total_bounds().diagonal() };
        let mut bvh = Bvh::build(&mesh).expect("it builds");
        let alone: Vec<_> = (0..mesh.triangles().len().min(300) as u32)
            .map(|triangle| {
                let corners = mesh.corners(triangle).to_vec();
                let one = TriangleMesh::new(corners, vec![[0, 1, 2]]).expect("finite corners");
                Bvh::build(one).expect("it builds")
            })
            .collect();
        if alone.len() < mesh.triangles().len() {
            continue;
        }
        for ray in rays::against(&mesh, 40, 42) {
            let radius = 0.05 * size;
            let found = cast(&mut bvh, &ray, radius);
            let mut expected: Option<SphereHit> = None;
            for (primitive, one) in alone.iter().enumerate() {
                if let Some(hit) = one.sphere_cast(&ray, radius)
                    && expected.is_none_or(|first| hit.t < first.t)
                {
                    expected = Some(SphereHit { primitive: primitive as u32, ..hit });
                }
            }
            assert_eq!(found, expected, "{name}: {ray:?}");
        }
    }
}

#[test]
fn faces_edges_corners_and_overlap() {
    let mesh = shapes::grid_box(1, Vec3::splat(-1.0), Vec3::splat(1.0));
    let mut bvh = Bvh::build(&mesh).expect("it builds");
    let mut t = |origin: [f32; 3], direction: [f32; 3], radius| {
        cast(&mut bvh, &Ray::new(origin, direction), radius).map(|hit| hit.t)
    };
    assert_eq!(t([0.0, 0.0, 5.0], [0.0, 0.0, -1.0], 1.0), Some(3.0));
    assert_eq!(t([0.0, 0.0, 5.0], [0.0, 0.0, -2.0], 1.0), Some(1.5));
    assert_eq!(t([1.6, 0.0, 5.0], [0.0, 0.0, -1.0], 1.0), Some(3.2));
    assert_eq!(t([2.1, 0.0, 5.0], [0.0, 0.0, -1.0], 1.0), None);
    assert_eq!(t([0.0, 0.0, 5.0], [0.0, 0.0, 1.0], 1.0), None);
    assert_eq!(t([0.0, 0.0, 1.5], [0.0, 0.0, 1.0], 1.0), Some(0.0));
    // From inside, where nothing is touched yet.
    assert_eq!(t([0.0; 3], [1.0, 0.0, 0.0], 0.25), Some(0.75));
    // With no radius it is a ray.
    assert_eq!(t([0.3, 0.2, 5.0], [0.0, 0.0, -1.0], 0.0), Some(4.0));
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(t([0.0, 0.0, 5.0], [0.0, 0.0, -1.0], bad), None);
    }
    assert_eq!(t([f32::NAN, 0.0, 5.0], [0.0, 0.0, -1.0], 1.0), None);
    assert_eq!(t([0.0, 0.0, 5.0], [0.0; 3], 1.0), None);
    let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
    assert_eq!(bvh.sphere_cast(&ray.with_interval(0.0, 3.0), 1.0), None);
    let hit = bvh.sphere_cast(&ray.with_interval(f32::NEG_INFINITY, 9.0), 1.0);
    assert_eq!(hit.map(|hit| hit.t), Some(3.0));
    let hit = bvh.sphere_cast(&ray.with_interval(3.5, 9.0), 1.0);
    assert_eq!(hit.map(|hit| hit.t), Some(3.5));
    let no_mesh = TriangleMesh::default();
    let nothing = Bvh::build(&no_mesh).expect("it builds");
    assert_eq!(nothing.sphere_cast(&ray, 1.0), None);
}

#[test]
fn other_primitives_are_approached() {
    let spheres = Spheres::new(vec![(Vec3::new(0.0, 0.0, 0.0), 2.0)]).expect("finite");
    let things = Joined { first: shapes::soup(100, 0.01, 3), second: spheres };
    let bvh = Bvh::build(&things).expect("it builds");
    let mut rng = Rng::new(43);
    let mut hits = 0;
    for _ in 0..2000 {
        let origin = 6.0 * rng.direction();
        let ray = Ray::new(origin, 3.5 * rng.in_cube() - origin);
        // A point and a sphere that is larger by the radius.
        let grown = Spheres::new(vec![(Vec3::ZERO, 2.5)]).expect("finite");
        let expected = Bvh::build(&grown).expect("it builds").intersect(&ray);
        let found = bvh.sphere_cast(&ray, 0.5);
        match (found, expected) {
            (Some(found), Some(expected)) => {
                hits += 1;
                assert_eq!(found.primitive, 100);
                assert!((ray.at(found.t).length() - 2.5).abs() < 1e-4, "{found:?} {expected:?}");
                assert!((found.point.length() - 2.0).abs() < 1e-5);
            }
            (None, None) => {}
            (found, expected) => {
                let closest = ray.origin.cross(ray.direction).length() / ray.direction.length();
                assert!((closest - 2.5).abs() < 1e-4, "{found:?} {expected:?}");
            }
        }
    }
    assert!(hits > 300);
}
