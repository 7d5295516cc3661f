//! All hits, the nearest few, and those that options let count, in double precision: against integers, and each crossing of a closed surface once.

use raywood::{BuildPreset, Bvh64, Face, Hit64, QueryOptions, Ray64, SimdLevel, TriangleMesh64};
use raywood_testkit::exact::ExactMesh;
use raywood_testkit::{Rng, closed, shapes};

use crate::doubles::{PLACES, add, bumpy, double, in_cube, number, rays_at, scaled, sub};

/// Trees of all kinds over a mesh, on all levels of instructions.
fn trees(mesh: &TriangleMesh64) -> Vec<Bvh64> {
    let presets = [BuildPreset::Fastest, BuildPreset::Balanced, BuildPreset::Best];
    let built = presets.map(|p| Bvh64::build_with(mesh.clone(), &p.options()).expect("it builds"));
    let at = |bvh: &Bvh64, level| {
        let mut bvh = bvh.clone();
        bvh.set_simd_level(level);
        bvh
    };
    built.iter().flat_map(|bvh| SimdLevel::available().map(move |level| at(bvh, level))).collect()
}

fn all_hits(bvh: &Bvh64, ray: &Ray64) -> Vec<Hit64> {
    let mut hits = Vec::new();
    bvh.all_hits(ray, &mut hits);
    hits
}

#[test]
fn all_hits_are_those_of_integers_in_every_tree() {
    let mut rng = Rng::new(1);
    for (at, size) in PLACES {
        let mesh = bumpy(2, at, size, &mut rng);
        let rays = rays_at(&mesh, at, size, 200, &mut rng);
        let exact = ExactMesh::new(&mesh);
        let mut expected: Option<Vec<Vec<Hit64>>> = None;
        for bvh in trees(&mesh) {
            let hits: Vec<_> = rays.iter().map(|ray| all_hits(&bvh, ray)).collect();
            let expected = expected.get_or_insert_with(|| {
                for (ray, hits) in rays.iter().zip(&hits) {
                    exact.check_all(ray, hits).unwrap_or_else(|e| panic!("at {at:?}: {e}"));
                }
                hits.clone()
            });
            assert_eq!(&hits, expected, "{} at {at:?}", bvh.simd_level().name());
            let lists = bvh.all_hits_batch(&rays);
            assert!(lists.iter().eq(expected.iter().map(Vec::as_slice)), "a batch at {at:?}");
            for (ray, hits) in rays.iter().zip(expected) {
                assert_eq!(bvh.crossings(ray), hits.len(), "{ray:?}");
            }
        }
        let count: usize = expected.iter().flatten().map(Vec::len).sum();
        assert!(count > rays.len() / 2, "{count} hits at {at:?}");
    }
}

#[test]
fn what_goes_into_a_closed_mesh_comes_out_of_it() {
    let mut rng = Rng::new(2);
    for (at, size) in PLACES {
        for closed in [
            shapes::uv_sphere(12, raywood::Vec3::ZERO, 1.0),
            closed::icosphere(2, raywood::Vec3::ZERO, 1.0),
        ] {
            let mesh = double(&closed, at, size);
            let bvh = Bvh64::build(mesh.clone()).expect("it builds");
            for i in 0..3000 {
                let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
                let outside = i % 2 == 0;
                let from = match outside {
                    // In the planes of vertices, too.
                    true if i % 4 == 0 => add(at, scaled(size, [3.0, 0.0, 0.0])),
                    true => {
                        add(add(at, scaled(size, [4.0, 0.0, 0.0])), scaled(size, in_cube(&mut rng)))
                    }
                    false => add(at, scaled(0.4 * size, in_cube(&mut rng))),
                };
                let share = 0.5 + 0.5 * number(&mut rng);
                let to = match i % 5 {
                    0 => a,
                    1 => scaled(0.5, add(a, b)),
                    2 => add(b, scaled(share, sub(c, b))),
                    3 => at,
                    _ => add(at, scaled(size, in_cube(&mut rng))),
                };
                // Starts that are the same number as the middle have nowhere to go.
                let ray = Ray64::new(from, sub(to, from));
                if !ray.is_valid() {
                    continue;
                }
                let crossings = bvh.crossings(&ray);
                assert_eq!(crossings.is_multiple_of(2), outside, "{crossings} at {at:?}: {ray:?}");
            }
        }
    }
}

#[test]
fn the_nearest_hits_are_the_first_of_all() {
    let mut rng = Rng::new(3);
    for (at, size) in PLACES {
        // Many layers.
        let positions = (0..300).map(|_| add(at, scaled(size, in_cube(&mut rng)))).collect();
        let triangles = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = TriangleMesh64::new(positions, triangles).expect("a mesh");
        let rays = rays_at(&mesh, at, size, 100, &mut rng);
        for bvh in trees(&mesh) {
            let all = bvh.all_hits_batch(&rays);
            for k in [0, 1, 2, 5, 1000] {
                let nearest = bvh.nearest_hits_batch(&rays, k);
                for (i, ray) in rays.iter().enumerate() {
                    let expected = &all.of(i)[..k.min(all.of(i).len())];
                    assert_eq!(nearest.of(i), expected, "{k} at {at:?}: {ray:?}");
                    let mut hits = vec![Hit64 { t: 1.0, u: 0.0, v: 0.0, primitive: 7 }];
                    bvh.nearest_hits(ray, k, &mut hits);
                    assert_eq!(hits, expected, "{k} at {at:?}: {ray:?}");
                }
            }
        }
    }
}

/// A mesh of some triangles of another, and their numbers there.
fn part(mesh: &TriangleMesh64, counts: impl Fn(u32) -> bool) -> (Bvh64, Vec<u32>) {
    let numbers: Vec<u32> = (0..mesh.triangles().len() as u32).filter(|&n| counts(n)).collect();
    let triangles = numbers.iter().map(|&n| mesh.triangles()[n as usize]).collect();
    let part = TriangleMesh64::new(mesh.positions().to_vec(), triangles).expect("a mesh");
    (Bvh64::build(part).expect("it builds"), numbers)
}

#[test]
fn what_does_not_count_is_as_if_it_were_not_there() {
    let mut rng = Rng::new(4);
    for (at, size) in PLACES {
        let mesh = bumpy(2, at, size, &mut rng);
        let rays = rays_at(&mesh, at, size, 200, &mut rng);
        let counts = |number: u32| !number.is_multiple_of(3);
        let (part, numbers) = part(&mesh, counts);
        let renumbered = |hit: Hit64| Hit64 { primitive: numbers[hit.primitive as usize], ..hit };
        for bvh in trees(&mesh) {
            for ray in &rays {
                let options = || QueryOptions::new().filter64(|hit: &Hit64| counts(hit.primitive));
                let expected = part.intersect(ray).map(renumbered);
                assert_eq!(bvh.intersect_with(ray, options()), expected, "at {at:?}: {ray:?}");
                assert_eq!(bvh.occluded_with(ray, options()), expected.is_some(), "{ray:?}");
                let expected: Vec<_> = all_hits(&part, ray).into_iter().map(renumbered).collect();
                let mut hits = Vec::new();
                bvh.all_hits_with(ray, options(), &mut hits);
                assert_eq!(hits, expected, "at {at:?}: {ray:?}");
                bvh.nearest_hits_with(ray, 1, options(), &mut hits);
                assert_eq!(hits, expected[..expected.len().min(1)], "at {at:?}: {ray:?}");

                // Nothing is asked, and nothing changes; or nothing counts.
                assert_eq!(bvh.intersect_with(ray, QueryOptions::new()), bvh.intersect(ray));
                assert_eq!(bvh.occluded_with(ray, QueryOptions::new()), bvh.occluded(ray));
                assert_eq!(bvh.intersect_with(ray, QueryOptions::new().mask(0)), None);
            }
        }
    }
}

#[test]
fn sides_are_told_apart_and_triangles_skipped() {
    let mut rng = Rng::new(5);
    let (mut fronts, mut backs) = (0, 0);
    for (at, size) in PLACES {
        let mesh = bumpy(2, at, size, &mut rng);
        let bvh = Bvh64::build(mesh.clone()).expect("it builds");
        let exact = ExactMesh::new(&mesh);
        for ray in rays_at(&mesh, at, size, 400, &mut rng) {
            let all = all_hits(&bvh, &ray);
            for (culled, is_front) in [(Face::Back, true), (Face::Front, false)] {
                let mut hits = Vec::new();
                bvh.all_hits_with(&ray, QueryOptions::new().cull(culled), &mut hits);
                let front = |hit: &&Hit64| exact.meets_front(hit.primitive, &ray) == Some(is_front);
                let expected: Vec<_> = all.iter().filter(front).copied().collect();
                assert_eq!(hits, expected, "{culled:?} at {at:?}: {ray:?}");
                *if is_front { &mut fronts } else { &mut backs } += hits.len();
            }
            let Some(first) = all.first() else { continue };
            let mut hits = Vec::new();
            bvh.all_hits_with(&ray, QueryOptions::new().skip(first.primitive), &mut hits);
            assert_eq!(hits, all[1..], "at {at:?}: {ray:?}");
        }
    }
    assert!(fronts > 500 && backs > 500, "{fronts} fronts, {backs} backs");
}
