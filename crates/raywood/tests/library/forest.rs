//! Every structure of the registry: the same answers on every mesh, checked against brute force in double precision.

use raywood::{
    BuildOptions, Hit, Ray, SimdLevel, Structure, StructureKind, StructureStats, TriangleMesh, Vec3,
};
use raywood_testkit::{Rng, nasty, oracle, rays, shapes};

fn build(kind: StructureKind, mesh: &TriangleMesh) -> Structure<&TriangleMesh> {
    let structure = Structure::build(kind, mesh, &BuildOptions::default()).expect("it builds");
    structure.validate().unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
    structure
}

#[test]
fn names_are_unique_and_lead_back() {
    for &kind in StructureKind::ALL {
        assert_eq!(StructureKind::from_name(kind.name()), Some(kind));
        assert!(kind.description().ends_with('.'));
    }
    assert_eq!(StructureKind::from_name("hedge"), None);
}

#[test]
fn every_structure_agrees_with_brute_force_and_with_every_other() {
    for (number, nasty) in nasty::all().iter().enumerate() {
        let mesh = &nasty.mesh;
        let rays = rays::against(mesh, 1500, 1000 + number as u64);
        let reference = build(StructureKind::BruteForce, mesh);
        let hits: Vec<_> = rays.iter().map(|ray| reference.intersect(ray)).collect();
        for (ray, hit) in rays.iter().zip(&hits) {
            oracle::check_closest(mesh, ray, *hit)
                .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            oracle::check_occluded(mesh, ray, hit.is_some())
                .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
        }
        for &kind in StructureKind::ALL {
            let structure = build(kind, mesh);
            let what = || format!("{} over {}", kind.name(), nasty.name);
            for (ray, hit) in rays.iter().zip(&hits) {
                assert_eq!(structure.intersect(ray), *hit, "{}: {ray:?}", what());
                assert_eq!(structure.occluded(ray), hit.is_some(), "{}: {ray:?}", what());
            }

            let mut batch: Vec<Option<Hit>> = vec![None; rays.len()];
            structure.intersect_batch(&rays, &mut batch);
            assert!(batch == hits, "{}: a batch differs", what());
            let mut blocked = vec![false; rays.len()];
            structure.occluded_batch(&rays, &mut blocked);
            assert!(blocked.iter().zip(&hits).all(|(b, hit)| *b == hit.is_some()), "{}", what());
        }
    }
}

#[test]
fn vector_instructions_can_be_chosen_and_change_no_answer() {
    let mesh = &nasty::all()[0].mesh;
    let rays = rays::against(mesh, 500, 7);
    for &kind in StructureKind::ALL {
        let mut structure = build(kind, mesh);
        let expected: Vec<_> = rays.iter().map(|ray| structure.intersect(ray)).collect();
        let uses_vectors = kind == StructureKind::BvhWide;
        assert_eq!(structure.simd_level(), uses_vectors.then(SimdLevel::active));
        for &level in SimdLevel::ALL {
            structure.set_simd_level(level);
            let used = if level.is_available() { level } else { SimdLevel::Portable };
            assert_eq!(structure.simd_level(), uses_vectors.then_some(used));
            let mut hits = vec![None; rays.len()];
            structure.intersect_batch(&rays, &mut hits);
            assert!(hits == expected, "{} on {}", kind.name(), level.name());
        }
    }
}

#[test]
fn no_ray_leaks_out_of_any_structure() {
    let mut rng = Rng::new(8);
    let far = Vec3::new(148376.0, 1234.0, -223423.0);
    for (center, radius) in [(Vec3::ZERO, 1.0), (far, 50.0), (Vec3::splat(1e5), 1e9)] {
        let half = Vec3::splat(radius);
        for mesh in [
            shapes::uv_sphere(30, center, radius),
            shapes::grid_box(1, center - half, center + half),
            shapes::grid_box(9, center - half, center + half),
        ] {
            let mut rays: Vec<Ray> = (0..5000)
                .map(|_| Ray::new(center + 0.5 * radius * rng.in_cube(), rng.direction()))
                .collect();
            for &vertex in mesh.positions() {
                let from = center + 0.5 * radius * rng.in_cube();
                rays.extend([Ray::new(from, vertex - from), Ray::new(center, vertex - center)]);
                let beside = center + 0.5 * (vertex - center);
                rays.extend([Vec3::X, Vec3::Y, -Vec3::Z].map(|axis| Ray::new(beside, axis)));
            }
            for &kind in StructureKind::ALL {
                let structure = build(kind, &mesh);
                // Testing every triangle is slow, and trivially tight.
                let step = if kind == StructureKind::BruteForce { 50 } else { 1 };
                for ray in rays.iter().filter(|ray| ray.is_valid()).step_by(step) {
                    let name = kind.name();
                    assert!(structure.intersect(ray).is_some(), "{name}, size {radius}: {ray:?}");
                    assert!(structure.occluded(ray), "{name}, size {radius}: {ray:?}");
                }
            }
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn every_structure_is_the_same_for_any_number_of_threads() {
    let mesh = shapes::soup(40_000, 0.02, 2);
    let rays = rays::against(&mesh, 500, 3);
    for &kind in StructureKind::ALL {
        let answers = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let structure = pool.expect("a pool").install(|| build(kind, &mesh));
            let hits: Vec<_> = rays.iter().map(|ray| structure.intersect(ray)).collect();
            (structure.stats(), hits)
        };
        let one = answers(1);
        for threads in [2, 7] {
            assert!(answers(threads) == one, "{}: {threads} threads", kind.name());
        }
    }
}

#[test]
fn a_million_identical_triangles_are_no_trouble() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]; 1 << 20]).expect("a mesh");
    let ray = Ray::new([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]);
    let bounds = memory_bounds();
    for &kind in StructureKind::ALL {
        let structure = build(kind, &mesh);
        let hit = structure.intersect(&ray).expect("a hit");
        assert_eq!((hit.primitive, hit.t), (0, 1.0), "{}", kind.name());
        let stats = structure.stats();
        assert!(stats.bytes < 200 << 20, "{}: {stats}", kind.name());
        check_memory(kind, &stats, &bounds, "a million identical");
    }
}

/// The memory bounds of `docs/memory.md`: name, bytes a primitive, bytes besides.
fn memory_bounds() -> Vec<(String, usize, usize)> {
    include_str!("../../../../docs/memory.md")
        .lines()
        .filter_map(|line| {
            let mut columns = line.split('|').map(str::trim).skip(1);
            let name = columns.next()?.trim_matches('`').to_owned();
            Some((name, columns.next()?.parse().ok()?, columns.next()?.parse().ok()?))
        })
        .collect()
}

/// Holds what a structure takes against its documented bound.
fn check_memory(
    kind: StructureKind,
    stats: &StructureStats,
    bounds: &[(String, usize, usize)],
    scene: &str,
) {
    let name = kind.name();
    let bound = bounds.iter().find(|(listed, ..)| listed == name);
    let Some((_, each, besides)) = bound else { panic!("{name} is not in docs/memory.md") };
    assert!(stats.bytes <= each * stats.primitives + besides, "{name}, {scene}: {stats}");
}

#[test]
fn memory_stays_within_the_documented_bounds_whatever_the_scene() {
    let mut rng = Rng::new(10);
    let separate = |corners: Vec<[Vec3; 3]>| {
        let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriangleMesh::new(corners.into_flattened(), triangles).expect("finite corners")
    };
    let diagonals = (0..100_000).map(|_| {
        let aside = 0.02 * rng.in_cube();
        [Vec3::splat(-1.0) + aside, Vec3::ONE + aside, Vec3::ONE + aside + 1e-4 * Vec3::X]
    });
    let diagonals = separate(diagonals.collect());
    let mut huge_and_tiny = vec![[Vec3::splat(-1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ONE]];
    huge_and_tiny.extend((0..1_000_000).map(|_| {
        let center = rng.in_cube();
        [(); 3].map(|()| center + 1e-3 * rng.in_cube())
    }));
    let huge_and_tiny = separate(huge_and_tiny);
    // A million of them are above.
    let identical =
        TriangleMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::ONE], vec![[0, 1, 2]; 100_000]);
    let identical = identical.expect("a mesh");

    let bounds = memory_bounds();
    for (scene, mesh) in
        [("diagonals", diagonals), ("huge and tiny", huge_and_tiny), ("identical", identical)]
    {
        for &kind in StructureKind::ALL {
            let structure = Structure::build(kind, &mesh, &BuildOptions::default());
            check_memory(kind, &structure.expect("it builds").stats(), &bounds, scene);
        }
    }
}

#[test]
fn no_ray_leaks_beside_an_edge_of_large_triangles() {
    let mut rng = Rng::new(9);
    for length in [1.0, 1e3, 1e6] {
        let half = Vec3::new(1.0, 1.0, length);
        let mesh = shapes::grid_box(2, -half, half);
        let structures: Vec<_> =
            StructureKind::ALL.iter().map(|&kind| build(kind, &mesh)).collect();
        for nearness in [1.5, 0.1, 1e-3, 1e-5] {
            for _ in 0..2000 {
                let ray = rays::towards_an_edge(&mut rng, half, nearness);
                let hit = structures[0].intersect(&ray);
                assert!(hit.is_some(), "length {length}: {ray:?} leaks");
                for structure in &structures {
                    let name = structure.kind().name();
                    assert_eq!(structure.intersect(&ray), hit, "{name}, length {length}: {ray:?}");
                    assert!(structure.occluded(&ray), "{name}, length {length}: {ray:?}");
                }
            }
        }
    }
}
