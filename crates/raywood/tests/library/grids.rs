//! What only grids can get wrong: cells, planes, corners, resolutions, memory.

use raywood::{BuildOptions, Counts, Ray, Spheres, Structure, StructureKind, TriangleMesh, Vec3};
use raywood_testkit::{Rng, rays, shapes};

const GRIDS: &[StructureKind] = &[StructureKind::UniformGrid, StructureKind::NestedGrid];

fn build(kind: StructureKind, mesh: &TriangleMesh) -> Structure<&TriangleMesh> {
    with(kind, mesh, &BuildOptions::default())
}

fn with<'a>(
    kind: StructureKind,
    mesh: &'a TriangleMesh,
    options: &BuildOptions,
) -> Structure<&'a TriangleMesh> {
    let structure = Structure::build(kind, mesh, options).expect("it builds");
    structure.validate().unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
    structure
}

/// Separate triangles.
fn triangles(corners: Vec<[Vec3; 3]>) -> TriangleMesh {
    let indices = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(corners.into_flattened(), indices).expect("finite corners")
}

fn assert_same_hits(mesh: &TriangleMesh, rays: &[Ray], options: &BuildOptions) {
    let reference = build(StructureKind::BruteForce, mesh);
    let hits: Vec<_> = rays.iter().map(|ray| reference.intersect(ray)).collect();
    for &kind in GRIDS {
        let grid = with(kind, mesh, options);
        for (ray, hit) in rays.iter().zip(&hits) {
            assert_eq!(grid.intersect(ray), *hit, "{}: {ray:?}", kind.name());
            assert_eq!(grid.occluded(ray), hit.is_some(), "{}: {ray:?}", kind.name());
        }
    }
}

/// Cubes whose faces fall on cell planes, and rays that pass the planes' crossings: from near and from so far that many planes lie at
/// distances that rounding makes equal.
#[test]
fn rays_through_the_corners_of_cells_miss_nothing() {
    let mut corners = Vec::new();
    for i in 0..512 {
        let low = Vec3::new((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32);
        let y_or_z = if i % 2 == 0 { Vec3::Y } else { Vec3::Z };
        corners.push([low, low + Vec3::X, low + y_or_z]);
    }
    let mesh = triangles(corners);
    let mut rng = Rng::new(5);
    let lattice_point = |rng: &mut Rng| Vec3::from([(); 3].map(|()| rng.below(17) as f32 * 0.5));
    let mut rays = Vec::new();
    for i in 0..4000 {
        let through = lattice_point(&mut rng);
        let direction = match i % 4 {
            0 => Vec3::ONE,
            1 => Vec3::new(1.0, -1.0, 1.0),
            2 => Vec3::new(1.0, -1.0, 0.0),
            _ => lattice_point(&mut rng) - through,
        };
        let away = [0.0, 1.0, 30.0, 1e4, 1e7][i % 5];
        rays.push(Ray::new(through - away * direction, direction));
        rays.push(Ray::new(through, direction).with_interval(-1e3, 1e3));
    }
    // Also with so many cells that every coordinate of the mesh is a plane, and with a single cell.
    for grid_density in [4.0, 100.0, 1.0, 0.0] {
        assert_same_hits(&mesh, &rays, &BuildOptions { grid_density, ..Default::default() });
    }
}

#[test]
fn densities_out_of_range_are_brought_into_it() {
    let mesh = shapes::soup(300, 0.2, 4);
    let rays = rays::against(&mesh, 500, 5);
    for grid_density in [f32::NAN, f32::INFINITY, -1.0, 1e-30, 0.3, 30.0] {
        assert_same_hits(&mesh, &rays, &BuildOptions { grid_density, ..Default::default() });
    }
}

#[test]
fn extents_that_overflow_or_vanish_are_no_trouble() {
    let base = shapes::soup(300, 0.3, 6);
    for scale in [
        Vec3::new(2.5e38, 1.0, 1e-40),
        Vec3::splat(3e37),
        Vec3::splat(1e-44),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(1e6, 1.0, 1e-6),
    ] {
        let mesh = shapes::mapped(&base, |p| scale * p);
        let rays: Vec<_> = rays::against(&mesh, 500, 7).into_iter().filter(Ray::is_valid).collect();
        assert_same_hits(&mesh, &rays, &BuildOptions::default());
    }
}

#[test]
fn cells_at_the_end_of_all_numbers_are_sound() {
    // Boxes longer than any number along one axis, and cells whose margins overflow.
    for (count, size) in [(1, 1.0), (1, 0.0), (30, 1.0), (30, 1e-3)] {
        let mut rng = Rng::new(12);
        let mut corner = |number: i32| {
            let p = rng.in_cube();
            let x = if number % 2 == 0 { f32::MAX } else { f32::MIN };
            Vec3::new(x, size * p.y, 0.5 * f32::MAX * p.z)
        };
        let mesh = triangles((0..count).map(|_| [0, 1, 2].map(&mut corner)).collect());
        for &kind in GRIDS {
            build(kind, &mesh);
        }
    }
}

#[test]
fn spheres_are_in_the_cells_that_their_surface_reaches() {
    let mut rng = Rng::new(13);
    let spheres = (0..300).map(|_| (rng.in_cube(), rng.range(0.0, 0.3))).collect();
    let spheres = Spheres::new(spheres).expect("sound spheres");
    for &kind in GRIDS {
        let grid = Structure::build(kind, &spheres, &BuildOptions::default()).expect("it builds");
        grid.validate().unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
    }
}

#[test]
fn memory_is_bounded_whatever_the_scene() {
    let mut rng = Rng::new(9);
    let diagonals = (0..20_000).map(|_| {
        let aside = 0.01 * rng.in_cube();
        [Vec3::splat(-1.0) + aside, Vec3::ONE + aside, Vec3::ONE - aside]
    });
    let diagonals = triangles(diagonals.collect());
    let mut one_huge = vec![[Vec3::splat(-1e4), Vec3::new(1e4, -1e4, 1e4), Vec3::splat(1e4)]];
    one_huge.extend((0..50_000).map(|_| {
        let center = rng.in_cube();
        [center, center + 1e-3 * rng.in_cube(), center + 1e-3 * rng.in_cube()]
    }));
    let one_huge = triangles(one_huge);
    for mesh in [&diagonals, &one_huge] {
        for &kind in GRIDS {
            let stats = build(kind, mesh).stats();
            let bound = 128 * stats.primitives + (1 << 17);
            assert!(stats.bytes < bound, "{}: {stats}", kind.name());
        }
    }
}

#[test]
fn a_triangle_in_many_cells_is_tested_once() {
    let mut corners = vec![[Vec3::splat(-1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::ONE]];
    let mut rng = Rng::new(2);
    corners.extend((0..1000).map(|_| {
        let center = 0.5 * rng.in_cube() - 0.5 * Vec3::Z;
        [center, center + 0.01 * Vec3::X, center + 0.01 * Vec3::Y]
    }));
    let mesh = triangles(corners);
    // Above all small triangles, through many cells that the large one touches.
    let ray = Ray::new([-2.0, 0.9, 0.95], [1.0, 1e-3, 1e-3]);
    for &kind in GRIDS {
        let mut counts = Counts::default();
        build(kind, &mesh).intersect_probed(&ray, &mut counts);
        assert!(counts.primitives <= 1, "{}: {counts:?}", kind.name());
        assert!(counts.nodes >= 4, "{}: {counts:?}", kind.name());
    }
}
