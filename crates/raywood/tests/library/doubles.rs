//! Meshes and rays of double precision, against integers: exact to twelve digits, watertight, the same on all levels, in batches and trees.

use raywood::{
    BuildOptions, BuildPreset, Bvh, Bvh64, Hit64, MeshError, Ray64, SimdLevel, TriangleMesh,
    TriangleMesh64,
};
use raywood_testkit::exact::ExactMesh;
use raywood_testkit::{Rng, closed, distance, nasty, rays, shapes};

/// A number from -1 to 1 with all its digits.
pub(crate) fn number(rng: &mut Rng) -> f64 {
    (rng.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

pub(crate) fn in_cube(rng: &mut Rng) -> [f64; 3] {
    [number(rng), number(rng), number(rng)]
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub(crate) fn scaled(s: f64, a: [f64; 3]) -> [f64; 3] {
    a.map(|x| s * x)
}

pub(crate) fn double(mesh: &TriangleMesh, at: [f64; 3], size: f64) -> TriangleMesh64 {
    let place = |p: &raywood::Vec3| add(at, scaled(size, p.to_array().map(f64::from)));
    let positions = mesh.positions().iter().map(place).collect();
    TriangleMesh64::new(positions, mesh.triangles().to_vec()).expect("a mesh")
}

/// Places and sizes of things: at the origin, on the Earth in metres with features of millimetres, far out in space, tiny.
pub(crate) const PLACES: [([f64; 3], f64); 6] = [
    ([0.0; 3], 1.0),
    ([1e7, -1e7, 1e7], 1e-3),
    ([4_510_023.25, 4_510_731.5, 114.125], 0.01),
    ([1e12, 3e11, -7e12], 1e4),
    ([-3e-9, 1e-9, 0.0], 1e-12),
    ([0.1, 0.2, 0.3], 1e30),
];

/// A bumpy sphere of triangles of all shapes around a point, its vertices with all their digits.
pub(crate) fn bumpy(subdivisions: u32, at: [f64; 3], size: f64, rng: &mut Rng) -> TriangleMesh64 {
    let sphere = closed::icosphere(subdivisions, raywood::Vec3::ZERO, 1.0);
    let bump = |p: &raywood::Vec3| {
        let p = p.to_array().map(f64::from);
        add(at, scaled(size * (1.0 + 0.1 * number(rng)), p))
    };
    let positions = sphere.positions().iter().map(bump).collect();
    TriangleMesh64::new(positions, sphere.triangles().to_vec()).expect("a mesh")
}

/// Rays into and out of something that lies there: from inside, near and far; at random, at vertices and edges.
pub(crate) fn rays_at(
    mesh: &TriangleMesh64,
    at: [f64; 3],
    size: f64,
    count: usize,
    rng: &mut Rng,
) -> Vec<Ray64> {
    (0..count)
        .map(|i| {
            let reach = [0.3, 2.0, 5.0, 1e3, 1e8][i % 5];
            let from = add(at, scaled(reach * size, in_cube(rng)));
            let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
            let (u, v) = (0.5 * (number(rng) + 1.0), 0.5 * (number(rng) + 1.0));
            let on = |u: f64, v: f64| add(a, add(scaled(u, sub(b, a)), scaled(v, sub(c, a))));
            let to = match i % 4 {
                0 => a,
                1 => on(u, 0.0),
                2 => on(u * (1.0 - v), v),
                _ => add(at, scaled(size, in_cube(rng))),
            };
            let direction = sub(to, from);
            match i % 7 {
                0 => Ray64::new(from, scaled(1e-5, direction)),
                1 => Ray64::between(from, add(from, scaled(1.5, direction))),
                2 => Ray64::new(from, direction).with_interval(-1.0, 1.0),
                _ => Ray64::new(from, direction),
            }
        })
        .filter(|ray| ray.is_valid())
        .collect()
}

/// What every way of asking says of rays: all must agree, to the bit.
fn hits_in_all_ways(mesh: &TriangleMesh64, rays: &[Ray64]) -> Vec<Option<Hit64>> {
    let mut first: Option<Vec<Option<Hit64>>> = None;
    for preset in [BuildPreset::Fastest, BuildPreset::Balanced, BuildPreset::Best] {
        let mut bvh = Bvh64::build_with(mesh.clone(), &preset.options()).expect("it builds");
        bvh.validate().expect("a sound tree");
        for level in SimdLevel::available() {
            bvh.set_simd_level(level);
            let hits: Vec<_> = rays.iter().map(|ray| bvh.intersect(ray)).collect();
            let mut batch = vec![None; rays.len()];
            bvh.intersect_batch(rays, &mut batch);
            let mut occluded = vec![false; rays.len()];
            bvh.occluded_batch(rays, &mut occluded);
            let expected = first.get_or_insert_with(|| hits.clone());
            for (i, ray) in rays.iter().enumerate() {
                let name = level.name();
                assert_eq!(hits[i], expected[i], "{name}, {preset:?}: {ray:?}");
                assert_eq!(batch[i], expected[i], "batch, {name}, {preset:?}: {ray:?}");
                assert_eq!(occluded[i], expected[i].is_some(), "{name}, {preset:?}: {ray:?}");
                assert_eq!(bvh.occluded(ray), expected[i].is_some(), "{name}: {ray:?}");
            }
        }
    }
    first.unwrap_or_default()
}

#[test]
fn hits_are_right_to_twelve_digits_wherever_they_are() {
    let mut rng = Rng::new(1);
    for (at, size) in PLACES {
        let mesh = bumpy(2, at, size, &mut rng);
        let rays = rays_at(&mesh, at, size, 300, &mut rng);
        let exact = ExactMesh::new(&mesh);
        let mut count = 0;
        for (ray, hit) in rays.iter().zip(hits_in_all_ways(&mesh, &rays)) {
            exact.check_closest(ray, hit).unwrap_or_else(|error| panic!("at {at:?}: {error}"));
            exact.check_occluded(ray, hit.is_some()).unwrap_or_else(|error| panic!("{error}"));
            count += usize::from(hit.is_some());
        }
        assert!(count > rays.len() / 3, "{count} hits at {at:?}");
    }
}

#[test]
fn slivers_and_soups_are_right_too() {
    let mut rng = Rng::new(2);
    for (at, size) in PLACES {
        for aspect in [1.0, 1e3, 1e6] {
            let mut positions = Vec::new();
            for _ in 0..60 {
                let [a, b] = [in_cube(&mut rng), in_cube(&mut rng)];
                let share = number(&mut rng);
                let between = add(a, scaled(share, sub(b, a)));
                let c = add(between, scaled(1.0 / aspect, in_cube(&mut rng)));
                positions.extend([a, b, c].map(|p| add(at, scaled(size, p))));
            }
            let triangles = (0..60).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = TriangleMesh64::new(positions, triangles).expect("a mesh");
            let rays = rays_at(&mesh, at, size, 300, &mut rng);
            let exact = ExactMesh::new(&mesh);
            for (ray, hit) in rays.iter().zip(hits_in_all_ways(&mesh, &rays)) {
                let checked = exact.check_closest(ray, hit);
                checked.unwrap_or_else(|error| panic!("at {at:?}, aspect {aspect}: {error}"));
            }
        }
    }
}

#[test]
fn no_ray_leaks_through_edges_and_vertices() {
    let mut rng = Rng::new(3);
    for (at, size) in PLACES {
        for segments in [6, 50, 100] {
            let sphere = shapes::uv_sphere(segments, raywood::Vec3::ZERO, 1.0);
            let mesh = double(&sphere, at, size);
            let bvh = Bvh64::build(mesh.clone()).expect("it builds");
            let mut rays = Vec::new();
            for triangle in 0..mesh.triangles().len() as u32 {
                let [a, b, c] = mesh.corners(triangle);
                let from = add(at, scaled(0.4 * size, in_cube(&mut rng)));
                let middle = scaled(0.5, add(a, b));
                let on_edge = add(b, scaled(0.5 + 0.5 * number(&mut rng), sub(c, b)));
                for to in [a, middle, on_edge] {
                    rays.extend([from, at].map(|from| Ray64::new(from, sub(to, from))));
                }
            }
            // In the planes of vertices, along the axes, and anywhere.
            for axis in 0..3 {
                let mut direction = [0.0; 3];
                direction[axis] = 1.0;
                rays.push(Ray64::new(at, direction));
            }
            rays.extend((0..5000).map(|_| Ray64::new(at, in_cube(&mut rng))));
            let rays: Vec<_> = rays.into_iter().filter(Ray64::is_valid).collect();
            let mut hits = vec![None; rays.len()];
            bvh.intersect_batch(&rays, &mut hits);
            for (ray, hit) in rays.iter().zip(hits) {
                assert!(hit.is_some(), "{segments} segments at {at:?}: {ray:?} leaks");
                assert_eq!(bvh.intersect(ray), hit, "{ray:?}");
                assert!(bvh.occluded(ray), "{segments} segments at {at:?}: {ray:?}");
            }
        }
    }
}

#[test]
fn meshes_of_single_precision_are_hit_as_by_single_precision() {
    for nasty::Nasty { name, mesh } in nasty::all() {
        let Ok(single) = Bvh::build(&mesh) else { continue };
        let bvh = Bvh64::build(double(&mesh, [0.0; 3], 1.0)).expect("it builds");
        let exact = ExactMesh::new(bvh.mesh());
        for ray in rays::against(&mesh, 120, 4) {
            let ray64 = Ray64::new(
                ray.origin.to_array().map(f64::from),
                ray.direction.to_array().map(f64::from),
            )
            .with_interval(f64::from(ray.t_min), f64::from(ray.t_max));
            let (hit, hit64) = (single.intersect(&ray), bvh.intersect(&ray64));
            if let (Some(hit), Some(hit64)) = (hit, hit64)
                && hit.primitive == hit64.primitive
            {
                let t = f64::from(hit.t);
                let tolerance = (t.abs() + hit64.t.abs()) / 4096.0 + f64::from(f32::MIN_POSITIVE);
                assert!((t - hit64.t).abs() <= tolerance, "{name}: {hit:?}, {hit64:?}: {ray:?}");
            }
            if mesh.triangles().len() <= 300 {
                let checked = exact.check_closest(&ray64, hit64);
                checked.unwrap_or_else(|error| panic!("{name}: {error}"));
            }
        }
    }
}

#[test]
fn packets_agree_with_single_rays() {
    let mut rng = Rng::new(5);
    for (at, size) in PLACES {
        let mesh = bumpy(4, at, size, &mut rng);
        for options in [BuildOptions::default(), BuildPreset::Best.options()] {
            let mut bvh = Bvh64::build_with(mesh.clone(), &options).expect("it builds");
            for level in SimdLevel::available() {
                bvh.set_simd_level(level);
                for kind in 0..5 {
                    let rays = coherent_rays(kind, &bvh, at, size, &mut rng);
                    let mut hits = vec![None; rays.len()];
                    bvh.intersect_batch(&rays, &mut hits);
                    let mut occluded = vec![false; rays.len()];
                    bvh.occluded_batch(&rays, &mut occluded);
                    let mut count = 0;
                    for (i, ray) in rays.iter().enumerate() {
                        let expected = bvh.intersect(ray);
                        assert_eq!(hits[i], expected, "kind {kind} at {at:?}: {ray:?}");
                        assert_eq!(occluded[i], expected.is_some(), "kind {kind}: {ray:?}");
                        count += usize::from(expected.is_some());
                    }
                    assert!(count > 200, "{count} hits of kind {kind} at {at:?}");
                }
            }
        }
    }
}

/// Rays of a kind that packets are made of: from a point, with and without an end, to a point, mirrored, parallel. Every eighth aims at a vertex or the middle
/// of an edge.
fn coherent_rays(kind: usize, bvh: &Bvh64, at: [f64; 3], size: f64, rng: &mut Rng) -> Vec<Ray64> {
    let eye = add(at, scaled(size, [2.5, 0.3, -0.2]));
    let mesh = bvh.mesh();
    let mut rays = Vec::new();
    for i in 0..2048 {
        let [a, b, _] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
        let to = match i % 16 {
            0 => a,
            8 => scaled(0.5, add(a, b)),
            _ => {
                let (row, column) = ((i / 46) as f64 / 23.0 - 1.0, (i % 46) as f64 / 23.0 - 1.0);
                add(at, scaled(size, [0.0, 1.1 * row, 1.1 * column]))
            }
        };
        let direction = sub(to, eye);
        let ray = Ray64::new(eye, direction);
        let surface = || {
            let hit = bvh.intersect(&ray)?;
            Some(bvh.surface_point(&hit))
        };
        rays.push(match kind {
            0 => ray,
            1 => ray.with_interval(0.0, 0.8),
            2 => match surface() {
                Some(point) => point.spawn_towards(add(at, scaled(size, [0.1, 3.0, 0.2]))),
                None => ray,
            },
            // As mirrored by a plane before the eye.
            3 => Ray64::new(add(eye, scaled(0.25, direction)), direction),
            // To the sun, or through the sphere.
            _ => match surface() {
                Some(point) if i < 1024 => point.spawn([0.3, 0.8, 0.1]),
                Some(point) => point.spawn([-0.9, 0.3, 0.1]),
                None => Ray64::new(to, [-0.9, 0.3, 0.1]),
            },
        });
    }
    rays
}

#[test]
fn spawned_rays_leave_their_surface() {
    let mut rng = Rng::new(6);
    for (at, size) in PLACES {
        let sphere = shapes::uv_sphere(24, raywood::Vec3::ZERO, 1.0);
        let bvh = Bvh64::build(double(&sphere, at, size)).expect("it builds");
        for _ in 0..2000 {
            let from = add(at, scaled(3.0 * size, in_cube(&mut rng)));
            let Some(hit) = bvh.intersect(&Ray64::new(from, sub(at, from))) else { continue };
            let point = bvh.surface_point(&hit);
            let direction = in_cube(&mut rng);
            let rise: f64 = (0..3).map(|i| direction[i] * point.normal[i]).sum();
            let out = if rise < 0.0 { scaled(-1.0, direction) } else { direction };
            let away = point.spawn(out);
            assert!(!bvh.occluded(&away), "at {at:?}: {away:?} hits {:?}", bvh.intersect(&away));
            let light = add(point.position, scaled(2.0 * size, out));
            assert!(!bvh.occluded(&point.spawn_towards(light)), "at {at:?}: {point:?}");
            let inwards = point.spawn(scaled(-1.0, out));
            assert!(bvh.occluded(&inwards), "at {at:?}: {inwards:?} leaks");
        }
    }
}

#[test]
fn equally_near_triangles_go_by_their_number() {
    let at = [1e7, 1e7, -1e7];
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|p| add(at, p));
    let copies = TriangleMesh64::new(corners.to_vec(), vec![[0, 1, 2]; 1000]).expect("a mesh");
    let bvh = Bvh64::build(copies).expect("it builds");
    let ray = Ray64::new(add(at, [0.25, 0.25, 8.0]), [0.0, 0.0, -1.0]);
    let mut hits = vec![None; 500];
    bvh.intersect_batch(&vec![ray; 500], &mut hits);
    hits.push(bvh.intersect(&ray));
    let expected = Some(Hit64 { t: 8.0, u: 0.25, v: 0.25, primitive: 0 });
    assert!(hits.iter().all(|hit| *hit == expected), "{:?}", hits[0]);
}

#[test]
fn rays_that_are_none_miss() {
    let sphere = shapes::uv_sphere(10, raywood::Vec3::ZERO, 1.0);
    let bvh = Bvh64::build(double(&sphere, [1e7; 3], 1.0)).expect("it builds");
    let good = Ray64::new([1e7; 3], [1.0, 0.0, 0.0]);
    assert!(bvh.occluded(&good));
    let mut bad = Vec::new();
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for axis in 0..3 {
            let mut ray = good;
            ray.origin[axis] = number;
            bad.push(ray);
            let mut ray = good;
            ray.direction[axis] = number;
            bad.push(ray);
        }
    }
    bad.push(good.with_interval(f64::NAN, 1.0));
    bad.push(good.with_interval(0.0, f64::NAN));
    bad.push(good.with_interval(1.0, 1.0));
    bad.push(Ray64::new(good.origin, [0.0; 3]));
    for ray in &bad {
        assert!(!ray.is_valid() && bvh.intersect(ray).is_none() && !bvh.occluded(ray), "{ray:?}");
    }
    // Also among others.
    let rays: Vec<_> =
        (0..1024).map(|i| if i % 3 == 0 { bad[i % bad.len()] } else { good }).collect();
    let mut hits = vec![None; rays.len()];
    bvh.intersect_batch(&rays, &mut hits);
    let mut occluded = vec![true; rays.len()];
    bvh.occluded_batch(&rays, &mut occluded);
    for (i, hit) in hits.iter().enumerate() {
        assert_eq!((hit.is_some(), occluded[i]), (i % 3 != 0, i % 3 != 0), "{:?}", rays[i]);
    }
}

#[test]
fn bad_meshes_are_refused_by_number() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0], [f64::INFINITY; 3]];
    let refused = TriangleMesh64::new(corners.clone(), vec![[0, 1, 2]]);
    assert_eq!(refused, Err(MeshError::NotFinite { first: 2, count: 2 }));
    let refused = TriangleMesh64::new(corners[..2].to_vec(), vec![[0, 1, 0], [0, 7, 1]]);
    assert_eq!(refused, Err(MeshError::IndexOutOfRange { triangle: 1, index: 7, positions: 2 }));
    let refused = TriangleMesh64::new(vec![[0.0; 3], [0.0, -1e46, 0.0]], vec![]);
    assert_eq!(refused, Err(MeshError::TooFar { first: 1, count: 1 }));
}

#[test]
fn meshes_without_extent_are_legal() {
    let empty = Bvh64::build(TriangleMesh64::default()).expect("it builds");
    let ray = Ray64::new([0.0; 3], [1.0, 0.0, 0.0]);
    assert!(empty.intersect(&ray).is_none() && !empty.occluded(&ray));
    assert_eq!(empty.closest_point([0.0; 3], f64::INFINITY), None);
    let mut hits = vec![None; 3];
    empty.intersect_batch(&[ray; 3], &mut hits);
    assert_eq!(hits, [None; 3]);

    // Points and lines are never hit.
    let line = vec![[1e7; 3], [1e7, 1e7, 1e7 + 1.0], [1e7, 1e7, 1e7 + 2.0], [1e9; 3]];
    let flat = TriangleMesh64::new(line, vec![[0, 1, 2], [0, 0, 0], [1, 1, 2]]).expect("a mesh");
    let bvh = Bvh64::build(flat).expect("it builds");
    for to in [[1e7; 3], [1e7, 1e7, 1e7 + 0.5]] {
        assert_eq!(bvh.intersect(&Ray64::new([0.0; 3], to)), None);
    }
}

#[test]
fn closest_points_are_those_of_brute_force() {
    let mut rng = Rng::new(7);
    for (at, size) in PLACES {
        let mesh = bumpy(3, at, size, &mut rng);
        let bvh = Bvh64::build(mesh.clone()).expect("it builds");
        let points: Vec<_> = (0..200)
            .map(|i| add(at, scaled(size * [0.2, 1.0, 3.0, 1e4][i % 4], in_cube(&mut rng))))
            .collect();
        let mut answers = vec![None; points.len()];
        bvh.closest_point_batch(&points, f64::INFINITY, &mut answers);
        for (point, answer) in points.iter().zip(answers) {
            let answer = answer.expect("there is something");
            assert_eq!(bvh.closest_point(*point, f64::INFINITY), Some(answer));
            let distances = (0..mesh.triangles().len() as u32).map(|triangle| {
                distance::of_triangle(mesh.corners(triangle).map(|corner| sub(corner, *point)))
            });
            let least = distances.fold(f64::INFINITY, f64::min);
            let error = (answer.distance - least).abs();
            assert!(error <= 1e-12 * (least + size), "{answer:?} at {least} from {point:?}");
            let [a, b, c] = mesh.corners(answer.primitive);
            let (u, v) = (answer.u, answer.v);
            let there = add(a, add(scaled(u, sub(b, a)), scaled(v, sub(c, a))));
            let off = sub(there, answer.point).map(f64::abs).into_iter().fold(0.0, f64::max);
            let largest = there.map(f64::abs).into_iter().fold(size, f64::max);
            assert!(off <= 1e-12 * size + 4.0 * f64::EPSILON * largest, "{off} at {at:?}");
            assert_eq!(bvh.closest_point(*point, 0.5 * answer.distance), None);
        }
    }
}
