//! A scene that moves: a flag in the wind that a tree follows, drops that fall and bounce, come and go; and the last picture still traced while the next is prepared.
//!
//! `cargo run --release -p raywood --example 09_moving`

use std::sync::Arc;
use std::thread;

use raywood::{Bvh, Decision, DynamicBvh, Instance, Ray, Tlas, Transform, TriangleMesh};

/// Squares to a side of the flag.
const SIDE: u32 = 60;
/// Pictures.
const STEPS: usize = 24;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The flag: its triangles stay, its vertices move.
    let corner = |x: u32, y: u32| y * (SIDE + 1) + x;
    let squares = (0..SIDE * SIDE).map(|number| (number % SIDE, number / SIDE));
    let triangles = squares.flat_map(|(x, y)| {
        let [a, b] = [corner(x, y), corner(x + 1, y)];
        let [c, d] = [corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let mesh = TriangleMesh::new(waving(0), triangles.collect())?;
    let mut flag = DynamicBvh::build(mesh.clone())?;

    // Drops: one object at many places.
    let drop = Arc::new(Bvh::build(TriangleMesh::new(
        vec![[0.0, 0.0, 0.03], [0.01, 0.0, 0.0], [-0.01, 0.01, 0.0], [-0.01, -0.01, 0.0]],
        vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    )?)?);
    let falling = |number: usize, step: usize| {
        let (x, y) = ((number % 30) as f32 / 30.0, (number / 30) as f32 / 30.0);
        let height = (0.37 * number as f32 - 0.2 * step as f32).rem_euclid(3.0);
        Transform::translation([x, y, 0.5 + height])
    };
    let drops = (0..900).map(|number| Instance::new(Arc::clone(&drop), falling(number, 0)));
    let mut rain = Tlas::build(drops.collect())?;

    // Rays from above, as of a camera.
    let down = |number: u32| {
        let place = |n: u32| (n as f32 + 0.5) / 100.0;
        Ray::new([place(number % 100), place(number / 100), 5.0], [0.0, 0.0, -1.0])
    };
    let rays: Vec<_> = (0..10_000).map(down).collect();

    let (mut refitted, mut wet, mut dry_at_all) = (0, 0, 0);
    for step in 1..=STEPS {
        // What was true until now: clones share memory, and keep it as it is.
        let before = Arc::new(flag.bvh().clone());
        let sky = rain.clone();
        let tracer = thread::spawn({
            let rays = rays.clone();
            move || {
                let sees = |ray: &&Ray| before.occluded(ray) && !sky.occluded(ray);
                rays.iter().filter(sees).count()
            }
        });

        // Meanwhile everything moves on: new boxes for the flag and for the drops, or new trees where that is better.
        let update = flag.update(mesh.with_positions(waving(step))?)?;
        for number in 0..rain.instances().len() {
            rain.set_transform(number, falling(number, step));
        }
        if step % 8 == 0 {
            rain.remove(step);
            rain.insert(Instance::new(Arc::clone(&drop), falling(step, step)));
            rain.insert(Instance::new(Arc::clone(&drop), Transform::translation([0.5, 0.5, 2.0])));
        }
        let of_rain = rain.update(1.5)?;

        let dry = tracer.join().map_err(|_| "the tracer panicked")?;
        println!(
            "picture {step:2}: {dry} dry rays; flag {update}; {} drops {of_rain}",
            rain.instances().len()
        );
        refitted += usize::from(update.decision == Decision::Refitted);
        (wet, dry_at_all) = (wet + rays.len() - dry, dry_at_all + dry);
    }
    assert!(refitted > STEPS / 2 && wet > 1000 && dry_at_all > 1000);
    flag.bvh().validate()?;
    Ok(())
}

/// The vertices of the flag, in a wave that runs along it.
fn waving(step: usize) -> Vec<[f32; 3]> {
    let vertex = |number: u32| {
        let place = |n: u32| n as f32 / SIDE as f32;
        let (x, y) = (place(number % (SIDE + 1)), place(number / (SIDE + 1)));
        [x, y, 0.05 * x * (9.0 * x + 2.0 * y - 0.6 * step as f32).sin()]
    };
    (0..(SIDE + 1) * (SIDE + 1)).map(vertex).collect()
}
