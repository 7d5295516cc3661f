//! The closest hit of each pixel's ray, as a picture of letters.
//!
//! `cargo run --release -p raywood --example 02_closest_hit`

use raywood::{Bvh, Joined, Ray, Spheres, TriangleMesh, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A pyramid and a sphere in one tree: triangles come first in the numbering.
    let pyramid = vec![
        [-3.0, 0.0, 1.0],
        [-1.0, 0.0, 1.0],
        [-1.0, 0.0, -1.0],
        [-3.0, 0.0, -1.0],
        [-2.0, 2.0, 0.0],
    ];
    let sides = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let scene = Joined {
        first: TriangleMesh::new(pyramid, sides)?,
        second: Spheres::new(vec![([1.0, 1.0, 0.0].into(), 1.0)])?,
    };
    let bvh = Bvh::build(scene)?;

    // Directions need not be of unit length: distances are in units of it.
    let eye = Vec3::new(0.0, 1.0, 6.0);
    let light = Vec3::new(0.5, 0.7, 0.5);
    let mut counts = [0; 2];
    for row in 0..18 {
        let line: String = (0..76)
            .map(|column| {
                let (x, y) = (column as f32 / 20.0 - 2.3, 0.85 - row as f32 / 10.0);
                let ray = Ray::new(eye, [x / 4.5, y / 4.5, -1.0]);
                let Some(hit) = bvh.intersect(&ray) else { return ' ' };
                counts[usize::from(hit.primitive >= 4)] += 1;

                // The point and its normal follow from the hit.
                let normal = bvh.surface_point(&ray, &hit).normal;
                let shades = b".:-=+*#%@";
                let shade = normal.dot(light).max(0.0) * (shades.len() - 1) as f32;
                shades[shade as usize % shades.len()] as char
            })
            .collect();
        println!("{}", line.trim_end());
    }
    println!("{} rays hit the pyramid, {} the sphere", counts[0], counts[1]);
    assert!(counts[0] > 100 && counts[1] > 100);

    // Straight at the sphere: 6 to its centre, less its radius.
    let hit = bvh.intersect(&Ray::new([1.0, 1.0, 6.0], [0.0, 0.0, -1.0])).expect("a hit");
    assert_eq!((hit.primitive, hit.t), (4, 5.0));
    Ok(())
}
