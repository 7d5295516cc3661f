//! Whether anything lies between two points: the shadow of a ball on a floor.
//!
//! `cargo run --release -p raywood --example 03_any_hit`

use raywood::{Bvh, Joined, Ray, Spheres, TriangleMesh, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners = vec![[-5.0, 0.0, -5.0], [5.0, 0.0, -5.0], [5.0, 0.0, 5.0], [-5.0, 0.0, 5.0]];
    let floor = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 3, 2]])?;
    let ball = Spheres::new(vec![([0.0, 2.0, 0.0].into(), 1.0)])?;
    let bvh = Bvh::build(Joined { first: floor, second: ball })?;

    // Look down on the floor, past the ball, and ask from each point whether the light is seen.
    let light = Vec3::new(2.0, 8.0, 0.0);
    let mut shadowed = 0;
    for row in 0..20 {
        let line: String = (0..60)
            .map(|column| {
                let (x, z) = (column as f32 / 6.0 - 5.0, row as f32 / 2.0 - 4.75);
                let down = Ray::new([x + 0.01, 0.5, z], [0.0, -1.0, 0.0]);
                let hit = bvh.intersect(&down).expect("the floor is below");

                // A ray from a surface must not hit the surface that it leaves. How far off it starts follows from the numbers; there is no
                // epsilon to choose.
                let point = bvh.surface_point(&down, &hit);
                let dark = bvh.occluded(&point.spawn_towards(light));
                shadowed += u32::from(dark);
                if dark { '#' } else { '.' }
            })
            .collect();
        println!("{line}");
    }

    // A ball of radius 1, two thirds of the way down, throws a shadow a third larger.
    let share = f64::from(shadowed) / 1200.0;
    println!("{:.1} % of the floor is in the shadow of the ball", 100.0 * share);
    assert!((0.045..0.07).contains(&share));

    // Between two given points: both ends are free.
    assert!(bvh.occluded(&Ray::between([-3.0, 2.0, 0.0], [3.0, 2.0, 0.0])));
    assert!(!bvh.occluded(&Ray::between([-3.0, 3.5, 0.0], [3.0, 3.5, 0.0])));
    Ok(())
}
