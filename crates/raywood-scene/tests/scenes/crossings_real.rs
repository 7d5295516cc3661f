//! Closed models, where this machine has them: rays from outside cross them an even number of times.

use raywood::{Bvh, Ray};
use raywood_scene::{LoadOptions, load_file};
use raywood_testkit::{Rng, test_scenes};

/// Models whose every edge belongs to two triangles, vertices at the same place being the same.
const CLOSED: &[&str] = &[
    "stanford/dragon-48k.ply",
    "cad/cycloidal.ply",
    "cad/koala.obj",
    "hyperion/glass.obj",
    "hyperion/ring1.obj",
];

#[test]
fn closed_models_are_crossed_an_even_number_of_times_from_outside() {
    let Some(folder) = test_scenes() else { return };
    let mut rng = Rng::new(1);
    for name in CLOSED {
        let scene = load_file(&folder.join(name), &LoadOptions::default()).expect("it loads");
        let mesh = &scene.mesh.triangles;
        let bvh = Bvh::build(mesh).expect("it builds");
        let bounds = mesh.total_bounds();
        let mut crossed = 0;
        for _ in 0..50_000 {
            let from = bounds.center() + bounds.diagonal() * rng.direction();
            let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
            // At a vertex, the middle of an edge, a point in the plane of a triangle; along an edge from far away.
            let edge =
                (b - a) * (2.0 * bounds.diagonal() / (b - a).length().max(f32::MIN_POSITIVE));
            let rays = [
                Ray::new(from, a - from),
                Ray::new(from, 0.5 * (a + b) - from),
                Ray::new(from, a + (a - b) + 0.5 * (c - a) - from),
                Ray::new(a - edge, edge),
            ];
            for ray in rays {
                let crossings = bvh.crossings(&ray);
                assert_eq!(crossings % 2, 0, "{name}: {crossings} crossings of {ray:?}");
                crossed += crossings;
            }
        }
        assert!(crossed > 100_000, "{name}: only {crossed}");
    }
}
