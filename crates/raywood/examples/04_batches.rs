//! Many rays at once, on all cores: several times as fast as one by one.
//!
//! `cargo run --release -p raywood --example 04_batches`

use std::time::Instant;

use raywood::{Bvh, HitColumns, Ray, TriangleMesh, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A lattice of 64,000 octahedra.
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..64_000 {
        let center = Vec3::new((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32);
        positions.extend([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| center + 0.3 * axis));
        positions.extend([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| center - 0.3 * axis));
        let sides = [
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ];
        triangles.extend(sides.map(|side| side.map(|vertex| 6 * i + vertex)));
    }
    let bvh = Bvh::build(TriangleMesh::new(positions, triangles)?)?;

    // 512 by 512 rays from one point.
    let eye = Vec3::new(-30.0, 17.3, 15.1);
    let directions: Vec<Vec3> = (0..512 * 512)
        .map(|i| Vec3::new(1.0, (i % 512) as f32 / 512.0 - 0.5, (i / 512) as f32 / 512.0 - 0.5))
        .collect();
    let rays: Vec<Ray> = directions.iter().map(|&d| Ray::new(eye, d)).collect();
    let timed = |what: &str, work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        let millions = rays.len() as f64 / start.elapsed().as_secs_f64() / 1e6;
        println!("{what:38} {millions:6.1} million rays a second");
    };

    // One by one; as a slice of rays; as directions from one point. The caller owns the answers.
    let mut singles = Vec::new();
    timed("closest hits, one by one", &mut || {
        singles = rays.iter().map(|ray| bvh.intersect(ray)).collect();
    });
    let mut hits = vec![None; rays.len()];
    timed("closest hits, a slice", &mut || bvh.intersect_batch(&rays, &mut hits));
    let mut columns = HitColumns::default();
    timed("closest hits, directions from a point", &mut || {
        bvh.intersect_from(eye, &directions, &mut columns);
    });
    let mut occluded = vec![false; rays.len()];
    timed("any hits, a slice", &mut || bvh.occluded_batch(&rays, &mut occluded));

    // All of them agree.
    let count = singles.iter().flatten().count();
    println!("{count} of {} rays hit something", rays.len());
    assert!(count > 10_000);
    for (ray, single) in singles.iter().enumerate() {
        assert_eq!(hits[ray].is_some(), single.is_some());
        assert_eq!(columns.get(ray).is_some(), single.is_some());
        assert_eq!(occluded[ray], single.is_some());
    }
    Ok(())
}
