//! Questions about space instead of rays: a robot in a room. How far is it from the next wall, is a point inside of something, what is in reach, how far may it roll?
//!
//! `cargo run --release -p raywood --example 12_space_queries`

use std::ops::ControlFlow;

use raywood::{Aabb, Ball, Bvh, Ray, TriangleMesh, Vec3};

/// A box between two corners, its triangles counter-clockwise from outside.
fn add_box(
    low: [f32; 3],
    high: [f32; 3],
    positions: &mut Vec<Vec3>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let first = positions.len() as u32;
    let side = |axis: usize, corner: u32| [low, high][corner as usize >> axis & 1][axis];
    positions.extend((0..8).map(|c| Vec3::new(side(0, c), side(1, c), side(2, c))));
    for [a, b, c, d] in
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    {
        triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|vertex| first + vertex)));
    }
}

/// What a triangle belongs to: a box has twelve.
const NAMES: [&str; 3] = ["the cupboard", "the table", "the pillar"];

fn name(primitive: u32) -> &'static str {
    NAMES[primitive as usize / 12]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // In metres, z up.
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    add_box([0.0, 0.0, 0.0], [1.0, 0.5, 2.0], &mut positions, &mut triangles);
    add_box([3.0, 2.0, 0.0], [4.5, 3.0, 0.75], &mut positions, &mut triangles);
    add_box([6.0, 0.75, 0.0], [6.5, 1.25, 3.0], &mut positions, &mut triangles);
    let room = Bvh::build(TriangleMesh::new(positions, triangles)?)?;

    // The closest point of anything, or of what is no further than a metre.
    let robot = Vec3::new(2.0, 1.0, 0.3);
    let closest = room.closest_point(robot, f32::INFINITY).expect("the room is not empty");
    println!(
        "{} is closest, {} away at {:?}",
        name(closest.primitive),
        closest.distance,
        closest.point
    );
    assert_eq!((name(closest.primitive), closest.point), (NAMES[0], Vec3::new(1.0, 0.5, 0.3)));
    assert!(room.closest_point(robot, 1.0).is_none());

    // Inside or outside, and how far from the surface: negative inside. For many points, on all cores.
    let solid = room.solid();
    assert!(solid.contains([0.5, 0.25, 1.0]) && !solid.contains(robot));
    let points = [Vec3::new(0.5, 0.25, 1.0), Vec3::new(3.5, 2.5, 1.0), robot];
    let mut distances = [None; 3];
    solid.signed_distance_batch(&points, &mut distances);
    println!("signed distances of {points:?}: {distances:?}");
    assert_eq!(distances[..2], [Some(-0.25), Some(0.25)]);

    // What touches a region, told once for each triangle until the closure has heard enough.
    let mut in_reach = Vec::new();
    let _ = room.overlapping(&Ball::new(robot, 1.5), |primitive| {
        in_reach.push(name(primitive));
        ControlFlow::Continue(())
    });
    in_reach.sort_unstable();
    in_reach.dedup();
    println!("in reach: {in_reach:?}");
    assert_eq!(in_reach, [NAMES[0], NAMES[1]]);
    assert!(!room.overlaps(&Aabb::new([1.5, 0.5, 0.0], [2.5, 1.5, 0.6])), "there is room to turn");

    // How far a ball of that size gets on its way along x, and where it then touches.
    let way = Ray::new(robot, [1.0, 0.0, 0.0]);
    let stop = room.sphere_cast(&way, 0.3).expect("the pillar is in the way");
    println!("after {} it touches {} at {:?}", stop.t, name(stop.primitive), stop.point);
    assert_eq!((name(stop.primitive), stop.normal), (NAMES[2], -Vec3::X));
    assert!((stop.t - 3.7).abs() < 1e-5);

    // Two geometries against each other: a plank across the table, and another beside it.
    for (height, touches) in [(0.7, true), (0.8, false)] {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        add_box([2.0, 2.4, height], [5.0, 2.6, height + 0.02], &mut positions, &mut triangles);
        let plank = Bvh::build(TriangleMesh::new(positions, triangles)?)?;
        assert_eq!(room.overlaps_any_of(&plank), touches);
    }
    Ok(())
}
