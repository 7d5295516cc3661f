//! Closed models, where this machine has them: rays from outside cross them an even number of times, on every level of instructions.

use std::collections::HashMap;
use std::path::Path;

use raywood::{Bvh, Ray, SimdLevel, TriangleMesh, Vec3};
use raywood_scene::{LoadOptions, load_file};
use raywood_testkit::{Rng, test_scenes};

/// Models whose every edge belongs to two triangles, vertices at the same place being the same.
const CLOSED: &[&str] = &[
    "stanford/dragon-48k.ply",
    "cad/cycloidal.ply",
    "cad/koala.obj",
    "hyperion/glass.obj",
    "hyperion/ring1.obj",
];

/// A model with holes.
const BUNNY: &str = "stanford/bunny.ply";

fn load(path: &Path) -> TriangleMesh {
    load_file(path, &LoadOptions::default()).expect("it loads").mesh.triangles
}

/// The mesh with a fan of triangles over each of its holes: over each loop of edges that belong to one triangle alone.
fn with_closed_holes(mesh: &TriangleMesh) -> TriangleMesh {
    // Vertices at the same place are one.
    let mut places = HashMap::new();
    let corner = |&p: &Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let same: Vec<u32> = (0..)
        .zip(mesh.positions())
        .map(|(number, p)| *places.entry(corner(p)).or_insert(number))
        .collect();
    let mut triangles: Vec<_> =
        mesh.triangles().iter().map(|t| t.map(|vertex| same[vertex as usize])).collect();
    let mut open = HashMap::new();
    for [a, b, c] in triangles.iter().copied() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *open.entry((from, to)).or_insert(0) += 1;
            *open.entry((to, from)).or_insert(0) -= 1;
        }
    }
    // What a triangle over the hole runs along is the other way around. A vertex may lie on several holes.
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut edges: Vec<_> = open.into_iter().filter(|(_, count)| *count > 0).collect();
    edges.sort_unstable();
    for ((from, to), count) in edges {
        next.entry(to).or_default().extend(std::iter::repeat_n(from, count as usize));
    }
    let mut positions = mesh.positions().to_vec();
    while let Some(&start) = next.keys().min() {
        let mut hole = vec![start];
        loop {
            let vertex = hole[hole.len() - 1];
            let ways = next.get_mut(&vertex).expect("loops end where they begin");
            let to = ways.pop().expect("a way on");
            if ways.is_empty() {
                next.remove(&vertex);
            }
            if to == start {
                break;
            }
            hole.push(to);
        }
        let middle = positions.len() as u32;
        let sum = hole.iter().fold(Vec3::ZERO, |sum, &v| sum + positions[v as usize]);
        positions.push(sum / hole.len() as f32);
        let ends = hole.iter().zip(hole.iter().cycle().skip(1));
        triangles.extend(ends.map(|(&from, &to)| [from, to, middle]));
    }
    TriangleMesh::new(positions, triangles).expect("a sound mesh")
}

/// That rays from outside cross a closed mesh an even number of times: at vertices, middles of edges, in the planes of triangles and along edges.
fn check_parity(name: &str, mesh: &TriangleMesh, count: usize) {
    let mut rng = Rng::new(1);
    let mut bvh = Bvh::build(mesh).expect("it builds");
    let bounds = mesh.total_bounds();
    for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
        bvh.set_simd_level(level);
        let mut crossed = 0;
        for _ in 0..count {
            let from = bounds.center() + bounds.diagonal() * rng.direction();
            let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
            let edge =
                (b - a) * (2.0 * bounds.diagonal() / (b - a).length().max(f32::MIN_POSITIVE));
            let rays = [
                Ray::new(from, a - from),
                Ray::new(from, 0.5 * (a + b) - from),
                Ray::new(from, a + (a - b) + 0.5 * (c - a) - from),
                Ray::new(a - edge, edge),
            ];
            for ray in rays {
                let crossings = bvh.crossings(&ray);
                assert_eq!(crossings % 2, 0, "{name}, {level:?}: {crossings} crossings of {ray:?}");
                crossed += crossings;
            }
        }
        assert!(crossed > 2 * count, "{name}: only {crossed}");
    }
}

/// Looks at all of them with so many rays of each kind.
fn check_models(count: usize) {
    let Some(folder) = test_scenes() else { return };
    for name in CLOSED {
        check_parity(name, &load(&folder.join(name)), count);
    }
    let bunny = load(&folder.join(BUNNY));
    let closed = with_closed_holes(&bunny);
    assert!(closed.triangles().len() > bunny.triangles().len(), "there were holes");
    check_parity(BUNNY, &closed, count);
}

#[test]
fn closed_models_are_crossed_an_even_number_of_times_from_outside() {
    check_models(20_000);
}

#[test]
#[ignore = "takes minutes: cargo test --release -p raywood-scene --test scenes -- --ignored millions"]
fn closed_models_are_crossed_an_even_number_of_times_by_millions_of_rays() {
    check_models(1_000_000);
}
