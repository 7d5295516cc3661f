//! Which hits count: leaves with holes, one-sided walls, what only some rays see.
//!
//! `cargo run --release -p raywood --example 06_filters`

use raywood::{
    Aabb, Bvh, Face, Geometry, Hit, PreparedRay, PrimitiveHit, QueryOptions, Ray, SurfacePoint,
    TriangleMesh, Vec3,
};

/// What only cameras see, and what only shadow rays see.
const CAMERA: u32 = 1;
const SHADOW: u32 = 2;

/// A mesh with a group for each triangle.
struct Grouped {
    mesh: TriangleMesh,
    groups: Vec<u32>,
}

impl Geometry for Grouped {
    fn len(&self) -> usize {
        self.mesh.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.mesh.bounds(primitive)
    }

    fn triangle(&self, primitive: u32) -> Option<[Vec3; 3]> {
        self.mesh.triangle(primitive)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.mesh.intersect(primitive, ray)
    }

    fn mask(&self, primitive: u32) -> u32 {
        self.groups[primitive as usize]
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.mesh.surface_point(ray, hit)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Three panes behind each other, their fronts towards the viewer: leaves, a wall that no camera sees, a wall.
    let pane = |z: f32| [[-1.0, -1.0, z], [7.0, -1.0, z], [-1.0, 7.0, z]];
    let positions = [pane(0.0), pane(-1.0), pane(-2.0)].concat();
    let mesh = TriangleMesh::new(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]])?;
    let bvh = Bvh::build(Grouped { mesh, groups: vec![CAMERA | SHADOW, SHADOW, CAMERA | SHADOW] })?;

    // A leaf is where a round drawing on the first pane says so.
    let is_leaf = |hit: &Hit| {
        let (x, y) = ((40.0 * hit.u).fract() - 0.5, (20.0 * hit.v).fract() - 0.5);
        hit.primitive != 0 || x * x + y * y < 0.15
    };
    let camera = QueryOptions::new().mask(CAMERA).filter(is_leaf);
    let mut seen = [0; 3];
    for row in 0..16 {
        let line: String = (0..64)
            .map(|column| {
                let origin = [column as f32 / 32.0, 1.0 - row as f32 / 16.0, 5.0];
                let hit = bvh.intersect_with(&Ray::new(origin, [0.0, 0.0, -1.0]), camera);
                let primitive = hit.expect("the last pane is everywhere").primitive;
                seen[primitive as usize] += 1;
                b"@?."[primitive as usize] as char
            })
            .collect();
        println!("{line}");
    }
    println!("{} rays end on leaves, {} on the wall behind", seen[0], seen[2]);
    assert!(seen[0] > 200 && seen[1] == 0 && seen[2] > 200);

    // From behind, panes without a back are not there; a primitive can be left out by its number.
    let ray = Ray::new([0.5, 0.5, -5.0], [0.0, 0.0, 1.0]);
    let t = |options| bvh.intersect_with(&ray, options).map(|hit| hit.t);
    assert_eq!(t(QueryOptions::new()), Some(3.0));
    assert_eq!(t(QueryOptions::new().skip(2)), Some(4.0));
    assert_eq!(t(QueryOptions::new().mask(CAMERA).skip(2)), Some(5.0));
    assert_eq!(t(QueryOptions::new().cull(Face::Back)), None);

    // A filter may also look on: here it multiplies what each pane lets through, and nothing blocks.
    let mut light = 1.0;
    let mut glass = |_: &Hit| {
        light *= 0.5;
        false
    };
    assert!(!bvh.occluded_with(&ray, QueryOptions::new().filter(&mut glass)));
    println!("three panes of glass let {light} of the light through");
    assert_eq!(light, 0.125);
    Ok(())
}
