//! One object at many places: a forest that takes hardly more memory than its tree, and groves as objects of their own.
//!
//! `cargo run --release -p raywood --example 07_instances`

use std::sync::Arc;

use raywood::{Bvh, Face, Instance, QueryOptions, Ray, Tlas, Transform, TriangleMesh};

/// What only cameras see.
const CAMERA: u32 = 1;
/// What throws shadows.
const SHADOW: u32 = 2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A fir: a pyramid on a square of two by two, three high.
    let positions = vec![
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 3.0],
    ];
    let sides = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let fir = Arc::new(Bvh::build(TriangleMesh::new(positions, sides)?)?);

    // A grove: ten by ten firs, each higher than the one before, and turned. The tree itself is shared.
    let firs = (0..100).map(|number| {
        let (row, column) = (number / 10, number % 10);
        let transform = Transform::scaling([1.0, 1.0, 1.0 + 0.01 * number as f32])
            .then(&Transform::rotation([0.0, 0.0, 1.0], 7.0 * number as f32))
            .then(&Transform::translation([4.0 * column as f32, 4.0 * row as f32, 0.0]));
        Instance { id: number, ..Instance::new(Arc::clone(&fir), transform) }
    });
    let grove = Arc::new(Tlas::build(firs.collect())?);

    // A forest: two groves, the second mirrored, which no shadow ray sees.
    let mirrored =
        Transform::scaling([-1.0, 1.0, 1.0]).then(&Transform::translation([-4.0, 0.0, 0.0]));
    let mut forest = Tlas::build(vec![
        Instance::new(Arc::clone(&grove), Transform::IDENTITY),
        Instance { mask: CAMERA, ..Instance::new(Arc::clone(&grove), mirrored) },
    ])?;

    // Down onto the top of the fir in row 2, column 3 of either grove: t is in the forest's units.
    let down = |x: f32, y: f32| Ray::new([x, y, 10.0], [0.0, 0.0, -1.0]);
    for (grove_number, x) in [(0, 12.01), (1, -16.01)] {
        let ray = down(x, 8.02);
        let hit = forest.intersect(&ray).expect("a fir stands there");
        let (instance, inner) = forest.locate(hit.instance);
        let id = grove.instances()[inner as usize].id;
        let point = forest.surface_point(&ray, &hit);
        println!("grove {instance}, fir {id}, side {}, t {:.3}", hit.primitive, hit.t);
        assert_eq!((instance, id), (grove_number, 23));
        // Its height is 1.23 times 3; normals point outside in the mirrored grove, too.
        assert!(hit.t > 10.0 - 3.69 && hit.t < 10.0 - 3.5 && point.normal.z > 0.0);
    }

    // Masks: the mirrored grove throws no shadows.
    assert!(forest.occluded_masked(&down(12.01, 8.02), SHADOW));
    assert!(!forest.occluded_masked(&down(-16.01, 8.02), SHADOW));

    // What a tree answers scenes answer, too: of all hits of a ray across both groves the first with each fir, and what is closest to a point above one, its top.
    let across = Ray::new([-50.0, 8.02, 1.0], [1.0, 0.0, 0.0]);
    let mut entered = Vec::new();
    forest.all_hits_with(&across, QueryOptions::new().cull(Face::Back), &mut entered);
    assert_eq!(entered.len(), 20);
    let closest = forest.closest_point([12.0, 8.0, 5.0], f32::INFINITY).expect("firs stand there");
    println!("{} firs in a row, the top of one at height {:.2}", entered.len(), closest.point.z);
    assert!((closest.point.z - 3.69).abs() < 1e-5 && closest.instance == 23);

    // Many rays over all cores.
    let rays: Vec<_> = (0..10_000)
        .map(|number| down((number % 100) as f32 * 0.4, (number / 100) as f32 * 0.4))
        .collect();
    let mut hits = vec![None; rays.len()];
    forest.intersect_batch(&rays, &mut hits);
    let covered = hits.iter().flatten().count();
    println!("{covered} of {} rays meet a fir", rays.len());
    assert!(covered > 2000 && covered < 3500);

    // What moves counts from the next rebuild on; what has no inverse is refused by its number, and the scene stays as it was.
    forest.set_transform(0, Transform::scaling([1.0, 1.0, 0.0]));
    let error = forest.rebuild().expect_err("firs cannot be flat");
    println!("{error}");
    assert!(forest.occluded(&down(12.01, 8.02)));
    Ok(())
}
