//! Milliseconds until a saved tree answers its first ray: `saved_trees MODEL [PRESET]`. Medians of 31 rounds that take turns, with the file in the page cache; each round maps or
//! reads the file anew.

#![allow(unsafe_code)]

use std::fs::{self, File};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use memmap2::Mmap;
use raywood::{BuildPreset, Bvh, Ray, TriangleMesh};
use raywood_scene::{LoadOptions, load_file};

const ROUNDS: usize = 31;

/// Some way to a tree that can be asked.
type Contestant<'a> = Box<dyn Fn() -> Bvh<TriangleMesh> + Sync + 'a>;

fn main() {
    let model = std::env::args().nth(1).expect("saved_trees MODEL [PRESET]");
    let preset = std::env::args().nth(2).unwrap_or_else(|| "balanced".to_owned());
    let options = BuildPreset::from_name(&preset).expect("a preset").options();
    let scene = load_file(model.as_ref(), &LoadOptions::default()).expect("a model");
    let mesh = scene.mesh.triangles;
    let built = Bvh::build_with(mesh.clone(), &options).expect("it builds");

    let path = std::env::temp_dir().join(format!("saved_trees.{}.rwood", std::process::id()));
    let mut file = File::create(&path).expect("a file");
    let start = Instant::now();
    built.save(&mut file).expect("it is written");
    let seconds = start.elapsed().as_secs_f64();
    let bytes = file.metadata().expect("it is there").len();
    println!(
        "{} triangles, {preset}: {bytes} bytes, saved in {seconds:.3} s",
        mesh.triangles().len()
    );

    let bounds = built.tree().bounds();
    let from = bounds.max + (bounds.max - bounds.min);
    let ray = Ray::between(from, mesh.corners(mesh.triangles().len() as u32 / 2)[0]);
    let expected = built.intersect(&ray);
    let contestants: [(&str, Contestant<'_>); 3] = [
        ("map, check everything", Box::new(|| Bvh::load(map(&path)).expect("it is sound"))),
        (
            "read, check everything",
            Box::new(|| Bvh::load(fs::read(&path).expect("it is there")).expect("it is sound")),
        ),
        ("build", Box::new(|| Bvh::build_with(mesh.clone(), &options).expect("it builds"))),
    ];
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut times = [const { Vec::new() }; 3];
        for round in 0..ROUNDS {
            for ((_, contestant), times) in contestants.iter().zip(&mut times) {
                let start = Instant::now();
                let tree = pool.install(contestant);
                let hit = black_box(tree.intersect(&ray));
                times.push(start.elapsed().as_secs_f64() * 1e3);
                assert_eq!(hit, expected, "round {round}");
            }
        }
        for ((name, _), times) in contestants.iter().zip(&mut times) {
            times.sort_by(f64::total_cmp);
            let (least, median) = (times[0], times[ROUNDS / 2]);
            println!("{threads} threads, {name:24} {median:8.2} ms, least {least:.2}");
        }
    }
    fs::remove_file(&path).expect("it was there");
}

/// Maps a file that nobody else knows of.
fn map(path: &Path) -> Mmap {
    let file = File::open(path).expect("it is there");
    // SAFETY: the file has a name of its own, and nobody writes to it any more.
    unsafe { Mmap::map(&file) }.expect("it can be mapped")
}
