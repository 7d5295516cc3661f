//! Everything along a ray: how thick a wall is, what is inside, the first few of many.
//!
//! `cargo run --release -p raywood --example 05_all_hits`

use std::ops::ControlFlow;

use raywood::{Bvh, Ray, TriangleMesh, Vec3};

/// A box from `-half` to `half`, its triangles counter-clockwise from outside.
fn add_box(half: f32, positions: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
    let first = positions.len() as u32;
    let side = |bit: u32, corner: u32| if corner >> bit & 1 == 1 { half } else { -half };
    positions.extend((0..8).map(|c| Vec3::new(side(0, c), side(1, c), side(2, c))));
    for [a, b, c, d] in
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    {
        triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|vertex| first + vertex)));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Three boxes, one in another.
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for half in [1.0, 2.0, 4.0] {
        add_box(half, &mut positions, &mut triangles);
    }
    let bvh = Bvh::build(TriangleMesh::new(positions, triangles)?)?;

    // Right through the middle: along the diagonals of the faces, where two triangles meet. Each face counts once.
    let ray = Ray::new([-10.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let mut hits = Vec::new();
    bvh.all_hits(&ray, &mut hits);
    let distances: Vec<f32> = hits.iter().map(|hit| hit.t).collect();
    println!("faces at {distances:?}");
    assert_eq!(distances, [6.0, 8.0, 9.0, 11.0, 12.0, 14.0]);

    // Between the first and the second hit lies the outer wall.
    bvh.nearest_hits(&ray, 2, &mut hits);
    println!("the outer wall is {} thick", hits[1].t - hits[0].t);
    assert_eq!(hits[1].t - hits[0].t, 2.0);

    // From outside an even number, from inside an odd one, whichever way the ray goes: here at each corner of each box.
    for (from, boxes) in [([0.0; 3], 3), ([0.0, 1.5, 0.0], 2), ([3.0, 0.0, 0.0], 1), ([5.0; 3], 0)]
    {
        let corners = bvh.geometry().positions();
        let rays = corners.iter().map(|&corner| Ray::new(from, corner - Vec3::from(from)));
        let counts: Vec<usize> = rays.map(|ray| bvh.crossings(&ray)).collect();
        println!("from {from:?}, inside of {boxes}: {counts:?} crossings");
        assert!(counts.iter().all(|count| count % 2 == boxes % 2));
    }

    // One at a time, until something says enough.
    let mut seen = 0;
    let flow = bvh.for_each_hit(&ray, |_| {
        seen += 1;
        if seen == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((seen, flow), (4, ControlFlow::Break(())));

    // Many rays at once: one array of hits, and where those of each ray begin.
    let rays: Vec<Ray> =
        (0..8).map(|y| Ray::new([-10.0, y as f32, 0.5], [1.0, 0.0, 0.0])).collect();
    let lists = bvh.all_hits_batch(&rays);
    println!("{} hits of {} rays, from {:?}", lists.hits().len(), lists.len(), lists.offsets());
    assert_eq!(lists.of(3).len(), 2);
    Ok(())
}
