//! Millimetres on the Earth: a terrain in coordinates from its centre, in double precision, measured from an aeroplane and lit by the sun.
//!
//! `cargo run --release -p raywood --example 11_doubles`

use raywood::{Bvh, Bvh64, Ray, Ray64, TriangleMesh, TriangleMesh64};

/// Vertices to a side of the terrain, a millimetre from each to the next.
const SIDE: u32 = 300;

/// Where it lies: Greenwich, in metres from the centre of the Earth.
const PLACE: [f64; 3] = [3_980_608.9, -102.5, 4_966_861.3];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Up, east and north there.
    let length = PLACE.iter().map(|x| x * x).sum::<f64>().sqrt();
    let up = PLACE.map(|x| x / length);
    let level = up[0].hypot(up[1]);
    let east = [-up[1] / level, up[0] / level, 0.0];
    let north = [
        up[1] * east[2] - up[2] * east[1],
        up[2] * east[0] - up[0] * east[2],
        up[0] * east[1] - up[1] * east[0],
    ];
    let at = |x: f64, y: f64, height: f64| -> [f64; 3] {
        [0, 1, 2].map(|i| PLACE[i] + x * east[i] + y * north[i] + height * up[i])
    };

    // Ripples of half a millimetre.
    let height = |x: f64, y: f64| 0.0005 * ((400.0 * x).sin() + (300.0 * y).sin());
    let vertex = |number: u32| {
        let place = |n: u32| 0.001 * (f64::from(n) - f64::from(SIDE) / 2.0);
        let (x, y) = (place(number % SIDE), place(number / SIDE));
        at(x, y, height(x, y))
    };
    let positions: Vec<[f64; 3]> = (0..SIDE * SIDE).map(vertex).collect();
    let squares = (0..(SIDE - 1) * (SIDE - 1)).map(|n| n / (SIDE - 1) * SIDE + n % (SIDE - 1));
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|a| [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]]).collect();

    // Single precision has half a metre there between one number and the next: nothing is left.
    let rounded = positions.iter().map(|p| p.map(|x| x as f32)).collect();
    let single = Bvh::build(TriangleMesh::new::<[f32; 3]>(rounded, triangles.clone())?)?;

    // Straight down from a thousand metres, at every fourth millimetre.
    let bvh = Bvh64::build(TriangleMesh64::new(positions, triangles)?)?;
    let down = up.map(|x| -x);
    let (mut rays, mut expected) = (Vec::new(), Vec::new());
    for number in 0..70 * 70 {
        let place = |n: u32| 0.004 * (f64::from(n) - 35.0) + 0.0003;
        let (x, y) = (place(number % 70), place(number / 70));
        rays.push(Ray64::new(at(x, y, 1000.0), down));
        expected.push(1000.0 - height(x, y));
    }
    let mut hits = vec![None; rays.len()];
    bvh.intersect_batch(&rays, &mut hits);

    // Between its vertices the terrain is flat, so what is measured differs from the ripples by some micrometres.
    let (mut worst, mut worst_single) = (0.0f64, 0.0f64);
    for ((ray, hit), expected) in rays.iter().zip(&hits).zip(&expected) {
        let hit = hit.ok_or("a ray fell through the terrain")?;
        worst = worst.max((hit.t - expected).abs());
        let [x, y, z] = ray.origin.map(|x| x as f32);
        let [dx, dy, dz] = ray.direction.map(|x| x as f32);
        if let Some(hit) = single.intersect(&Ray::new([x, y, z], [dx, dy, dz])) {
            worst_single = worst_single.max((f64::from(hit.t) - expected).abs());
        }
    }
    println!("{} heights, off by {:.1} micrometres at most", rays.len(), 1e6 * worst);
    println!("in single precision by {:.0} micrometres", 1e6 * worst_single);
    assert!(worst < 4e-5 && worst_single > 1e-2);

    // What the low sun shines on: rays from there start a few billionths of a metre above the ground, as far as its coordinates ask for.
    let sun = [0, 1, 2].map(|i| east[i] + 0.15 * up[i]);
    let points: Vec<_> = hits.iter().flatten().map(|hit| bvh.surface_point(hit)).collect();
    let to_sun: Vec<_> = points.iter().map(|point| point.spawn(sun)).collect();
    let mut shadow = vec![false; to_sun.len()];
    bvh.occluded_batch(&to_sun, &mut shadow);
    let dark = shadow.iter().filter(|&&dark| dark).count();
    println!("{dark} of {} points lie in shadow", points.len());
    assert!(dark > points.len() / 20 && dark < points.len() / 2);

    // The nearest ground to a point a centimetre above it.
    let closest = bvh.closest_point(at(0.01, 0.02, 0.01), 1.0).ok_or("there is ground")?;
    println!("the ground is {:.3} mm away", 1e3 * closest.distance);
    assert!((closest.distance - 0.01).abs() < 0.002);
    Ok(())
}
