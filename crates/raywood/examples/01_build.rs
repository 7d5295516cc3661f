//! Makes a mesh, builds the tree over it, and looks at what came out.
//!
//! `cargo run --release -p raywood --example 01_build`

use raywood::{BuildPreset, Bvh, MeshError, TriangleMesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Hills: a grid of 256 by 256 squares, two triangles each.
    const SIDE: u32 = 256;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..=SIDE {
        for column in 0..=SIDE {
            let (x, z) = (column as f32 / 16.0, row as f32 / 16.0);
            positions.push([x, x.sin() * z.cos(), z]);
            if row < SIDE && column < SIDE {
                let [a, b] = [row * (SIDE + 1) + column, (row + 1) * (SIDE + 1) + column];
                triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
            }
        }
    }

    // A mesh is checked once, when it is made. What is wrong with one is said by name and number.
    let broken = TriangleMesh::new(positions.clone(), vec![[0, 1, 999_999]]);
    let complaint: MeshError = broken.expect_err("there is no such vertex");
    println!("a broken mesh: {complaint}");

    // Good defaults, or a preset that trades the time of the build for that of rays.
    let mesh = TriangleMesh::new(positions, triangles)?;
    let bvh = Bvh::build(&mesh)?;
    println!("\nwith defaults, traced by {}:\n{}", bvh.simd_level().name(), bvh.stats());
    let quick = Bvh::build_with(&mesh, &BuildPreset::Fastest.options())?;
    println!("\nbuilt as fast as possible:\n{}", quick.stats());

    // Every invariant of the tree can be checked.
    bvh.validate()?;
    quick.validate()?;
    assert_eq!(mesh.triangles().len(), 2 * (SIDE * SIDE) as usize);
    Ok(())
}
