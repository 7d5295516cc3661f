//! More than triangles: several kinds of geometry in one scene, a mesh that stays where it lies, and a kind of one's own.
//!
//! `cargo run --release -p raywood --example 10_geometries`

use raywood::{
    Aabb, Assembly, Boxes, Bvh, Capsule, Capsules, Cylinder, Cylinders, Disc, Discs, Geometry, Hit,
    MeshView, PreparedRay, PrimitiveHit, Ray, Spheres, Strided, SurfacePoint, Vec3,
};

/// A kind of one's own: surfaces `y = h + a sin(x) sin(z)` over a square, found by marching. A box, a test and a point of the surface are all it takes.
struct Waves(Vec<(f32, f32)>);

impl Waves {
    fn height(&self, wave: u32, at: Vec3) -> f32 {
        let (height, amplitude) = self.0[wave as usize];
        at.y - height - amplitude * at.x.sin() * at.z.sin()
    }
}

impl Geometry for Waves {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, wave: u32) -> Aabb {
        let (height, amplitude) = self.0[wave as usize];
        Aabb::new([-9.0, height - amplitude, -9.0], [9.0, height + amplitude, 9.0])
    }

    fn intersect(&self, wave: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        let at = |t: f32| ray.origin + t * ray.direction;
        let inside = |t: f32| at(t).x.abs() <= 9.0 && at(t).z.abs() <= 9.0;
        let above = |t: f32| self.height(wave, at(t)) > 0.0;
        let (start, step) = (ray.t_min.max(0.0), 0.01 / ray.direction.length());
        let mut steps = (0..3000).map(|i| start + i as f32 * step);
        let mut low = steps.find(|&t| inside(t) && above(t) != above(t + step))?;
        let (mut high, side) = (low + step, above(low));
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if above(middle) == side { low = middle } else { high = middle }
        }
        ray.accepts(low).then_some(PrimitiveHit { t: low, u: 0.0, v: 0.0 })
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let position = ray.at(hit.t);
        let (_, a) = self.0[hit.primitive as usize];
        let (x, z) = (position.x, position.z);
        let normal = Vec3::new(-a * x.cos() * z.sin(), 1.0, -a * x.sin() * z.cos());
        SurfacePoint { position, normal: normal.normalize_or_zero(), clearance: 1e-3 }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A roof in a vertex buffer as a graphics card wants it: positions and colours in turns, and 16-bit indices. Neither is copied.
    let buffer: [[f32; 6]; 4] = [
        [2.0, 3.0, 2.0, 1.0, 0.0, 0.0],
        [4.0, 3.0, 2.0, 0.0, 1.0, 0.0],
        [4.0, 3.0, 4.0, 0.0, 0.0, 1.0],
        [2.0, 3.0, 4.0, 1.0, 1.0, 1.0],
    ];
    let indices: [u16; 6] = [0, 2, 1, 0, 3, 2];
    let roof = MeshView::new(Strided::of_floats(buffer.as_flattened(), 0, 6)?, &indices)?;

    // Four columns below it, and what else there is; each kind knows its own numbers.
    let corners = [[2.2, 2.2], [3.8, 2.2], [2.2, 3.8], [3.8, 3.8]];
    let columns = corners.map(|[x, z]| Cylinder::new([x, 0.0, z], [x, 3.0, z], 0.1));
    let spring = (0..=200).map(|i| {
        let turn = 0.2 * i as f32;
        [turn.cos() - 3.0, 1.0 + 0.01 * i as f32, turn.sin()]
    });
    let spring: Vec<[f32; 3]> = spring.collect();

    let mut scene = Assembly::new();
    let names = ["roof", "columns", "spring", "crates", "pond", "balls", "waves"];
    scene.add(roof);
    scene.add(Cylinders::new(columns.to_vec())?);
    scene.add(Capsules::new(Capsule::along(&spring, 0.12).collect())?);
    scene.add(Boxes::new(vec![Aabb::new([-4.0, 0.5, 3.0], [-3.0, 1.5, 4.0])])?);
    scene.add(Discs::new(vec![Disc::new([3.0, 0.6, 3.0], [0.0, 1.0, 0.0], 0.5)])?);
    scene.add(Spheres::new(vec![([3.0, 1.2, 3.0].into(), 0.3), ([0.0, 2.0, -4.0].into(), 1.0)])?);
    scene.add(Waves(vec![(0.0, 0.2)]));
    let bvh = Bvh::build(scene)?;
    println!("{}", bvh.stats());

    // A look from above, a letter for each kind.
    let mut seen = [0; 7];
    for row in 0..24 {
        let mut line = String::new();
        for column in 0..48 {
            let (x, z) = (0.25 * column as f32 - 5.9, 0.5 * row as f32 - 5.9);
            let hit = bvh.intersect(&Ray::new([x, 9.0, z], [0.0, -1.0, 0.0])).ok_or("a hole")?;
            let (geometry, _) = bvh.geometry().locate(hit.primitive);
            seen[geometry] += 1;
            line.push(['r', 'c', 's', 'b', 'p', 'o', '.'][geometry]);
        }
        println!("{line}");
    }

    // Below the roof: what is there, which one of its kind, and whether the sun comes in between the columns.
    let lit = |x: f32, z: f32| {
        let down = Ray::new([x, 2.9, z], [0.0, -1.0, 0.0]);
        let hit = bvh.intersect(&down)?;
        let (geometry, primitive) = bvh.geometry().locate(hit.primitive);
        let point = bvh.surface_point(&down, &hit);
        let sun = !bvh.occluded(&point.spawn([1.0, 0.7, -0.2]));
        Some((names[geometry], primitive, sun))
    };
    println!("below the roof: {:?}, {:?}, {:?}", lit(3.0, 3.0), lit(2.6, 3.0), lit(3.9, 2.5));
    assert_eq!(lit(3.0, 3.0).map(|(kind, number, _)| (kind, number)), Some(("balls", 0)));
    assert!(seen[0] > 0 && seen[2] > 0 && seen[3] > 0 && seen[5] > 0 && seen[6] > 500);
    Ok(())
}
