//! A tree that is built once, saved, and loaded with everything that belongs to it.
//!
//! `cargo run --release -p raywood --example 08_saved_trees`

use std::fs::{self, File};

use raywood::{Bvh, Ray, SavedTree, SavedTreeError, TriangleMesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A pyramid on a square.
    let positions = vec![
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 3.0],
    ];
    let sides = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let bvh = Bvh::build(TriangleMesh::new(positions, sides)?)?;

    // A file of its own; beside the tree a section for what the triangles are called.
    let path = std::env::temp_dir().join(format!("pyramid.{}.rwood", std::process::id()));
    bvh.save_with(&[("names", b"south east north west")], File::create(&path)?)?;

    // Whoever can map files passes the mapped file instead, and nothing is copied.
    let saved = SavedTree::open(fs::read(&path)?)?;
    let names = String::from_utf8_lossy(saved.section("names").unwrap_or_default()).into_owned();
    let loaded = saved.bvh(saved.mesh())?;
    let ray = Ray::new([0.0, -5.0, 1.0], [0.0, 1.0, 0.0]);
    let hit = loaded.intersect(&ray).expect("the pyramid is in the way");
    assert_eq!(Some(hit), bvh.intersect(&ray));
    println!("{} at {:.3}", names.split(' ').nth(hit.primitive as usize).unwrap_or("?"), hit.t);

    // For a mesh alone there is a shorter way. It holds the memory that it came in for as long as it needs it.
    let loaded = Bvh::load(fs::read(&path)?)?;
    assert!(loaded.occluded(&ray));

    // Damage is an error, and so is whatever else is no saved tree.
    let mut damaged = fs::read(&path)?;
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    let error = Bvh::load(damaged).expect_err("a bit was flipped");
    println!("{error}");
    assert_eq!(error, SavedTreeError::Damaged { section: "names".to_owned() });
    fs::remove_file(&path)?;
    Ok(())
}
