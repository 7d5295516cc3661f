//! Microseconds per ray of all hits beside what else would find them, and whether crossings come in pairs: `all_hits SCENE`, one thread, medians of nine rounds that
//! take turns.

use std::collections::HashMap;
use std::hint::black_box;
use std::time::Instant;

use raywood::{Bvh, Hit, Ray, TriangleMesh};
use raywood_scene::{LoadOptions, load_file};
use raywood_testkit::Rng;

/// Answers a ray somehow, and says how many hits it found.
type Contestant<'a> = Box<dyn FnMut(&Ray) -> usize + 'a>;

fn main() {
    let path = std::env::args().nth(1).expect("all_hits SCENE");
    let scene = load_file(path.as_ref(), &LoadOptions::default()).expect("a scene");
    let mesh = &scene.mesh.triangles;
    let bvh = Bvh::build(mesh).expect("it builds");
    let rays = rays(mesh);

    let total: usize = rays.iter().map(|ray| bvh.crossings(ray)).sum();
    let per_ray = total as f64 / rays.len() as f64;
    println!("{} triangles, {} rays, {per_ray:.2} hits a ray", mesh.triangles().len(), rays.len());
    check_pairs(mesh, &bvh, &rays);

    let mut hits = Vec::new();
    let mut contestants: Vec<(&str, Contestant<'_>)> = vec![
        ("closest hit", Box::new(|ray| usize::from(bvh.intersect(ray).is_some()))),
        ("closest hits again and again", Box::new(|ray| again_and_again(&bvh, ray))),
        ("crossings", Box::new(|ray| bvh.crossings(ray))),
    ];
    let all = |ray: &Ray| {
        bvh.all_hits(ray, &mut hits);
        hits.len()
    };
    contestants.push(("all hits", Box::new(all)));
    for (name, k) in [("nearest 1", 1), ("nearest 2", 2), ("nearest 4", 4), ("nearest 16", 16)] {
        let (bvh, mut hits) = (&bvh, Vec::new());
        let nearest = move |ray: &Ray| {
            bvh.nearest_hits(ray, k, &mut hits);
            hits.len()
        };
        contestants.push((name, Box::new(nearest)));
    }
    let mut times = vec![Vec::new(); contestants.len()];
    let mut counts = vec![0; contestants.len()];
    for _ in 0..9 {
        for (number, (_, contestant)) in contestants.iter_mut().enumerate() {
            let start = Instant::now();
            counts[number] = rays.iter().map(|ray| black_box(contestant(ray))).sum();
            times[number].push(start.elapsed().as_secs_f64() * 1e6 / rays.len() as f64);
        }
    }
    for ((name, _), (times, count)) in contestants.iter().zip(times.iter_mut().zip(counts)) {
        times.sort_by(f64::total_cmp);
        println!("{name:30} {:8.3} us a ray, {count} hits", times[times.len() / 2]);
    }
}

/// Rays from all around through the middle of the mesh, and from within its box.
fn rays(mesh: &TriangleMesh) -> Vec<Ray> {
    let mut rng = Rng::new(1);
    let bounds = mesh.total_bounds();
    let mut point = |reach: f32| bounds.center() + 0.5 * reach * bounds.extent() * rng.in_cube();
    (0..100_000)
        .map(|i| {
            let from = point(if i % 4 == 0 { 1.0 } else { 4.0 });
            Ray::new(from, point(1.0) - from)
        })
        .collect()
}

/// How many hits closest-hit queries find, each from just behind the last.
fn again_and_again(bvh: &Bvh<&TriangleMesh>, ray: &Ray) -> usize {
    let (mut rest, mut count) = (*ray, 0);
    while let Some(Hit { t, .. }) = bvh.intersect(&rest) {
        count += 1;
        rest.t_min = t.next_up();
    }
    count
}

/// Says whether the mesh is closed, by the places of its vertices, and how many of the rays that start and end outside cross it an odd number of times.
fn check_pairs(mesh: &TriangleMesh, bvh: &Bvh<&TriangleMesh>, rays: &[Ray]) {
    let mut uses: HashMap<_, u32> = HashMap::new();
    for triangle in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.to_array().map(|x| (x + 0.0).to_bits()));
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if p != q {
                *uses.entry((p.min(q), p.max(q))).or_default() += 1;
            }
        }
    }
    let open = uses.values().filter(|&&uses| uses % 2 == 1).count();
    let bounds = mesh.total_bounds();
    let outside = rays.iter().filter(|ray| {
        (0..3).any(|i| ray.origin[i] < bounds.min[i] || ray.origin[i] > bounds.max[i])
    });
    let (mut odd, mut tested) = (0, 0);
    for ray in outside {
        // As it is, and from the same point at a vertex and at the middle of an edge.
        let number = tested % mesh.triangles().len();
        let [a, b, _] = mesh.corners(number as u32);
        for direction in [ray.direction, a - ray.origin, 0.5 * (a + b) - ray.origin] {
            odd += bvh.crossings(&Ray::new(ray.origin, direction)) % 2;
            tested += 1;
        }
    }
    println!("{open} open edges; {odd} of {tested} rays from outside cross an odd number of times");
}
