//! What it takes to follow a mesh that moves: `refit MODEL [PRESET]`. The vertices of the model wave to and fro; milliseconds for new boxes and for a new tree, on one thread and on
//! two, medians of 31 rounds that take turns, everything in memory.

use std::hint::black_box;
use std::time::Instant;

use raywood::{
    BuildOptions, BuildPreset, Builder, Bvh, Bvh2, DynamicBvh, TriangleMesh, UpdateOptions, Vec3,
};
use raywood_scene::{LoadOptions, load_file};

const ROUNDS: usize = 31;

fn main() {
    let model = std::env::args().nth(1).expect("refit MODEL [PRESET]");
    let preset = std::env::args().nth(2).unwrap_or_else(|| "balanced".to_owned());
    let options = BuildPreset::from_name(&preset).expect("a preset").options();
    let mesh = load_file(model.as_ref(), &LoadOptions::default()).expect("a model").mesh.triangles;
    let poses = [0.0, 0.01].map(|size| waved(&mesh, size));
    println!("{} triangles, {preset}", mesh.triangles().len());

    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut wide = Bvh::build_with(poses[0].clone(), &options).expect("it builds");
            let mut binary =
                Bvh2::build_by(Builder::SahBinned, &poses[0], &options).expect("it builds");
            let mut times = [const { Vec::new() }; 5];
            let mut costs = [0.0; 2];
            for round in 0..ROUNDS {
                let pose = &poses[round % 2];
                let moved = pose.clone();
                times[0].push(milliseconds(|| wide.refit(moved).expect("it takes it on")));
                costs[round % 2] = wide.stats().q;
                let (shared, moved) = (wide.clone(), pose.clone());
                times[1].push(milliseconds(|| wide.refit(moved).expect("it takes it on")));
                drop(shared);
                times[2].push(milliseconds(|| binary.refit(pose).expect("it takes it on")));
                let positions = pose.positions().to_vec();
                times[3].push(milliseconds(|| pose.with_positions(positions).expect("finite")));
                if round % 4 == 0 {
                    times[4]
                        .push(milliseconds(|| Bvh::build_with(pose, &options).expect("it builds")));
                }
            }
            wide.validate().expect("it is valid");
            let names = [
                "refit in place",
                "refit of a clone",
                "refit of the binary tree",
                "new positions",
                "build",
            ];
            for (name, times) in names.iter().zip(&mut times) {
                times.sort_by(f64::total_cmp);
                let (least, median) = (times[0], times[times.len() / 2]);
                println!("{threads} threads, {name:24} {median:8.2} ms, least {least:.2}");
            }
            println!("Q {:.3}, waved {:.3}", costs[0], costs[1]);
            decide(&mesh, &options);
        });
    }
}

/// What is decided, and how long that takes, for poses that are worse and worse.
fn decide(mesh: &TriangleMesh, options: &BuildOptions) {
    let options = UpdateOptions { build: options.clone(), ..Default::default() };
    let mut scene = DynamicBvh::build_with(mesh.clone(), options).expect("it builds");
    for share in [0.0, 0.02, 0.1, 1.0] {
        let mut times = Vec::new();
        let mut update = None;
        for _ in 0..5 {
            scene =
                DynamicBvh::build_with(mesh.clone(), scene.options().clone()).expect("it builds");
            let pose = torn(mesh, share);
            times.push(milliseconds(|| update = Some(scene.update(pose).expect("it is taken on"))));
        }
        times.sort_by(f64::total_cmp);
        let update = update.expect("there are rounds");
        println!("{:3.0} % torn: {update}, in {:.1} ms", 100.0 * share, times[2]);
    }
}

/// The mesh with such a share of its vertices, those with the least x, at each other's places.
fn torn(mesh: &TriangleMesh, share: f64) -> TriangleMesh {
    let mut positions = mesh.positions().to_vec();
    let mut order: Vec<_> = (0..positions.len()).collect();
    order.sort_by(|&a, &b| positions[a].x.total_cmp(&positions[b].x));
    order.truncate((share * positions.len() as f64) as usize);
    let mut state = 1u64;
    for last in (1..order.len()).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        positions.swap(order[last], order[(state >> 33) as usize % (last + 1)]);
    }
    mesh.with_positions(positions).expect("finite")
}

/// The mesh with all vertices moved by waves, which are as high as such a share of its size.
fn waved(mesh: &TriangleMesh, size: f32) -> TriangleMesh {
    let bounds = mesh.total_bounds();
    let largest = bounds.extent().max_element();
    let wave = |x: f32| size * largest * (20.0 * x / largest).sin();
    let moved = |p: &Vec3| Vec3::new(p.x + wave(p.y), p.y + wave(p.z), p.z + wave(p.x));
    mesh.with_positions(mesh.positions().iter().map(moved).collect::<Vec<_>>()).expect("finite")
}

fn milliseconds<T>(f: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    black_box(f());
    start.elapsed().as_secs_f64() * 1e3
}
