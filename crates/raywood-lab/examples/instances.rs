//! What instances cost: builds of the top-level tree, and rays beside those through the same triangles in one mesh.
//!
//! `RAYON_NUM_THREADS=1 cargo run --release -p raywood-lab --example instances`

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use raywood::{BuildPreset, Bvh, Hit, Instance, Ray, Tlas, Transform, TriangleMesh};

/// Each measured as often, by turns; medians count.
const ROUNDS: usize = 9;
/// Rays to a side of the picture.
const SIDE: usize = 256;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (positions, triangles) = ball(24);
    let object = Arc::new(Bvh::build(TriangleMesh::new(positions.clone(), triangles.clone())?)?);

    // Builds of many.
    let many = instances(&object, 100, 100, 3.0);
    for preset in [BuildPreset::Fastest, BuildPreset::Fast, BuildPreset::Balanced] {
        let options = preset.options();
        let mut times = Vec::new();
        for _ in 0..ROUNDS {
            let instances = many.clone();
            let start = Instant::now();
            black_box(Tlas::build_with(instances, &options)?);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        println!(
            "top-level build of {} instances, {preset:?}: {:.2} ms",
            many.len(),
            median(&mut times)
        );
        let mut scene = Tlas::build_with(many.clone(), &options)?;
        let mut times = Vec::new();
        for round in 0..ROUNDS {
            let moved = Transform::translation([0.1 * (round % 2) as f32, 0.0, 0.0]);
            for (number, instance) in many.iter().enumerate() {
                scene.set_transform(number, instance.transform.then(&moved));
            }
            let start = Instant::now();
            black_box(scene.update(f64::INFINITY)?);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        println!("the same with new boxes alone: {:.2} ms", median(&mut times));
    }

    // Rays, apart and where objects overlap.
    for (name, distance) in [("apart", 3.0), ("touching", 2.0), ("overlapping", 1.0)] {
        let few = instances(&object, 16, 16, distance);
        let scene = Tlas::build(few.clone())?;
        let (mut all_positions, mut all_triangles) = (Vec::new(), Vec::new());
        for instance in &few {
            let first = all_positions.len() as u32;
            all_positions.extend(positions.iter().map(|&p| instance.transform.point(p).to_array()));
            all_triangles.extend(triangles.iter().map(|corners| corners.map(|c| c + first)));
        }
        let count = all_triangles.len();
        let flat = Bvh::build(TriangleMesh::new(all_positions, all_triangles)?)?;

        let rays = rays(16.0 * distance);
        let mut hits = [vec![None; rays.len()], vec![None; rays.len()]];
        let mut times: [Vec<f64>; 3] = Default::default();
        for _ in 0..ROUNDS {
            times[0].push(each(&rays, || scene.intersect_batch(&rays, &mut hits[0])));
            times[1].push(each(&rays, || {
                rays.iter().zip(&mut hits[1]).for_each(|(ray, hit)| *hit = flat.intersect(ray));
            }));
            let mut batch: Vec<Option<Hit>> = vec![None; rays.len()];
            times[2].push(each(&rays, || flat.intersect_batch(&rays, &mut batch)));
        }
        let [a, b] = &hits;
        let differ = a.iter().zip(b).filter(|(a, b)| a.is_some() != b.is_some()).count();
        let [instanced, single, batch] = &mut times;
        println!(
            "{name}: {count} triangles, ns a ray: instances {:.0}, flat singly {:.0}, flat in batches {:.0}; {differ} of {} rays differ in whether they hit",
            median(instanced),
            median(single),
            median(batch),
            rays.len()
        );
    }
    Ok(())
}

/// A ball of radius one.
fn ball(rings: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let columns = 2 * rings;
    for ring in 0..=rings {
        for column in 0..columns {
            let theta = std::f32::consts::PI * ring as f32 / rings as f32;
            let phi = std::f32::consts::TAU * column as f32 / columns as f32;
            positions.push([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]);
        }
    }
    for ring in 0..rings {
        for column in 0..columns {
            let at = |r: u32, c: u32| r * columns + c % columns;
            let (a, b) = (at(ring, column), at(ring, column + 1));
            let (c, d) = (at(ring + 1, column), at(ring + 1, column + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    (positions, triangles)
}

/// A grid of balls, each turned and stretched.
fn instances(
    object: &Arc<Bvh<TriangleMesh>>,
    rows: usize,
    columns: usize,
    distance: f32,
) -> Vec<Instance<Bvh<TriangleMesh>>> {
    let at = |number: usize| {
        let (row, column) = ((number / columns) as f32, (number % columns) as f32);
        let transform = Transform::scaling([1.0, 0.8, 1.1])
            .then(&Transform::rotation([1.0, 2.0, 3.0], 37.0 * number as f32))
            .then(&Transform::translation([distance * column, distance * row, 0.0]));
        Instance::new(Arc::clone(object), transform)
    };
    (0..rows * columns).map(at).collect()
}

/// A picture of the ground from aslant.
fn rays(width: f32) -> Vec<Ray> {
    let eye = [0.5 * width, -0.5 * width, 0.6 * width];
    let ray = |number: usize| {
        let x = (number % SIDE) as f32 / SIDE as f32 * width;
        let y = (number / SIDE) as f32 / SIDE as f32 * width;
        Ray::new(eye, [x - eye[0], y - eye[1], -eye[2]])
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// Nanoseconds a ray.
fn each(rays: &[Ray], run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() * 1e9 / rays.len() as f64
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
