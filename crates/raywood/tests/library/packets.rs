//! Packets answer as single rays do, to the bit, whatever rays travel together.

use raywood::{
    AccelerationStructure, BuildOptions, Builder, Bvh2, Coherence, Counts, Hit, Ray, TriangleMesh,
    Vec3,
};
use raywood_testkit::{Rng, nasty, rays, shapes};

const BUILDERS: [Builder; 4] =
    [Builder::Midpoint, Builder::Median, Builder::SahSweep, Builder::SahBinned];

const SIZES: [usize; 12] = [1, 2, 3, 7, 8, 16, 31, 64, 100, 200, 255, 256];

fn build(builder: Builder, mesh: &TriangleMesh) -> Bvh2 {
    Bvh2::build_by(builder, mesh, &BuildOptions::default()).expect("it builds")
}

/// Traces rays as packets of so many; fails if an answer differs from that to the ray alone. Returns how many hit something.
fn check(what: &str, tree: &Bvh2, mesh: &TriangleMesh, rays: &[Ray], size: usize) -> usize {
    // Answers of somebody else, to be overwritten.
    let stale = Hit { t: -7.0, u: 0.0, v: 0.0, primitive: 12345, instance: 0 };
    let mut hits = vec![Some(stale); rays.len()];
    let mut occluded = vec![true; rays.len()];
    for (place, packet) in rays.chunks(size).enumerate() {
        let places = place * size..place * size + packet.len();
        tree.intersect_packet(mesh, packet, &mut hits[places.clone()], &mut ());
        tree.occluded_packet(mesh, packet, &mut occluded[places], &mut ());
    }
    for (place, ray) in rays.iter().enumerate() {
        let expected = tree.intersect(mesh, ray, &mut ());
        // As text, which tells every bit.
        assert_eq!(
            format!("{:?}", hits[place]),
            format!("{expected:?}"),
            "{what}, {size} rays, ray {place}: {ray:?}"
        );
        assert_eq!(
            occluded[place],
            expected.is_some(),
            "{what}, {size} rays, ray {place}: {ray:?}"
        );
    }
    hits.iter().flatten().count()
}

/// Rays through the pixels of a square picture of the unit cube's surroundings, row by row.
fn picture(edge: usize, eye: Vec3) -> Vec<Ray> {
    let place = |i: usize| 2.4 * (i as f32 + 0.5) / edge as f32 - 1.2;
    let pixels =
        (0..edge * edge).map(|pixel| Vec3::new(place(pixel % edge), place(pixel / edge), 0.0));
    pixels.map(|target| Ray::new(eye, target - eye)).collect()
}

/// Rays that hit nothing because they are no rays.
fn invalid(number: usize) -> Ray {
    let good = Ray::new([0.0, 0.0, 5.0], [0.1, 0.0, -1.0]);
    match number % 6 {
        0 => Ray::new([f32::NAN, 0.0, 5.0], good.direction),
        1 => Ray::new(good.origin, [0.0, f32::NAN, -1.0]),
        2 => Ray::new(good.origin, Vec3::ZERO),
        3 => Ray::new(good.origin, [0.0, f32::INFINITY, -1.0]),
        4 => good.with_interval(1.0, 1.0),
        _ => good.with_interval(0.0, f32::NAN),
    }
}

#[test]
fn any_rays_on_any_mesh() {
    let mut hits = 0;
    for (number, nasty) in nasty::all().iter().enumerate() {
        for builder in BUILDERS {
            let tree = build(builder, &nasty.mesh);
            let rays = rays::against(&nasty.mesh, 512, number as u64);
            for size in [3, 64, 256] {
                let what = format!("{builder:?} over {}", nasty.name);
                hits += check(&what, &tree, &nasty.mesh, &rays, size);
            }
        }
    }
    assert!(hits > 20_000, "only {hits} hits: the test looks at nothing");
}

#[test]
fn rays_towards_one_point_of_any_mesh() {
    // From nearby origins to nearby points: signs agree, and the interval test has something to say.
    for (number, nasty) in nasty::all().iter().enumerate() {
        let tree = build(Builder::SahBinned, &nasty.mesh);
        let seeds = rays::against(&nasty.mesh, 40, 100 + number as u64);
        let mut rng = Rng::new(number as u64);
        for seed in seeds {
            let size = Vec3::splat(seed.direction.abs().max_element());
            let rays: Vec<_> = (0..64)
                .map(|_| {
                    let (shift, turn) = (0.02 * size * rng.in_cube(), 0.05 * size * rng.in_cube());
                    Ray { origin: seed.origin + shift, direction: seed.direction + turn, ..seed }
                })
                .collect();
            check(nasty.name, &tree, &nasty.mesh, &rays, 64);
        }
    }
}

#[test]
fn coherent_rays_in_packets_of_every_size() {
    let mesh = shapes::soup(3000, 0.1, 1);
    let rays = picture(40, Vec3::new(0.3, -0.4, 4.0));
    for builder in BUILDERS {
        let tree = build(builder, &mesh);
        for size in SIZES {
            // 1600 is no multiple of most sizes: the last packet is not full.
            let hits = check(&format!("{builder:?}"), &tree, &mesh, &rays, size);
            assert!(hits > 300, "only {hits} hits");
        }
    }
    let tree = build(Builder::SahBinned, &mesh);
    for size in 1..=256 {
        check("one packet", &tree, &mesh, &rays[700..700 + size], size);
    }
}

#[test]
fn more_rays_than_a_packet_takes() {
    let mesh = shapes::soup(500, 0.2, 2);
    let tree = build(Builder::SahBinned, &mesh);
    let rays = picture(30, Vec3::new(0.3, -0.4, 4.0));
    check("all at once", &tree, &mesh, &rays, rays.len());
    check("none", &tree, &mesh, &[], 1);
}

#[test]
fn rays_of_all_octants_and_intervals_travel_together() {
    let mesh = shapes::soup(3000, 0.1, 3);
    let tree = build(Builder::SahBinned, &mesh);
    let mut rng = Rng::new(4);
    let mut any = |number: usize| {
        let from = 2.0 * rng.in_cube();
        let ray = Ray::new(from, rng.in_cube() - from);
        match number % 5 {
            0 => ray.with_interval(0.0, rng.unit()),
            1 => ray.with_interval(rng.unit(), 1.0 + rng.unit()),
            2 => Ray::new(from, [0.0, -0.0, if from.z > 0.0 { -1.0 } else { 1.0 }]),
            3 => ray.with_interval(f32::NEG_INFINITY, 0.5),
            _ => ray,
        }
    };
    let rays: Vec<_> = (0..2048).map(&mut any).collect();
    for size in SIZES {
        let hits = check("mixed", &tree, &mesh, &rays, size);
        assert!(hits > 200, "only {hits} hits");
    }
}

#[test]
fn a_ray_along_a_face_is_not_bounded_by_it() {
    // Its distance to the face's plane is zero times infinity: no number, whatever the interval of the packet says of the others.
    let mesh = shapes::grid_box(3, [0.0, -1.0, -1.0].into(), [1.0; 3].into());
    let along = Ray::new([0.0, 0.1, 5.0], [0.0, 0.0, 1.0]).with_interval(-10.0, -1.0);
    let miss = Ray::new([-1.0, 5.0, 5.0], [1.0, 0.01, 1.0]).with_interval(-10.0, -1.0);
    for builder in BUILDERS {
        let tree = build(builder, &mesh);
        assert_eq!(check("along a face", &tree, &mesh, &[miss, along], 2), 1);
    }
}

#[test]
fn intervals_of_different_lengths() {
    let mesh = shapes::soup(3000, 0.1, 5);
    let tree = build(Builder::SahBinned, &mesh);
    let mut rng = Rng::new(6);
    let mut rays = picture(16, Vec3::new(0.3, -0.4, 4.0));
    for ray in &mut rays {
        let start = rng.range(-1.0, 1.2);
        *ray = ray.with_interval(start, start + rng.range(0.0, 0.6));
    }
    assert!(check("short", &tree, &mesh, &rays, 256) > 20);
}

#[test]
fn the_lowest_number_wins_among_equals() {
    let mesh = nasty::all().into_iter().find(|n| n.name == "every triangle five times");
    let mesh = mesh.expect("it is in the list").mesh;
    let rays = picture(48, Vec3::new(0.3, -0.4, 4.0));
    for builder in BUILDERS {
        assert!(check("copies", &build(builder, &mesh), &mesh, &rays, 256) > 1000);
    }
}

#[test]
fn invalid_rays_change_nothing_for_others() {
    let mesh = shapes::soup(5000, 0.1, 7);
    let tree = build(Builder::SahBinned, &mesh);
    for size in [16usize, 64, 256] {
        let edge = (size as f32).sqrt() as usize;
        let good = picture(edge, Vec3::new(0.3, -0.4, 4.0));
        let nodes = |rays: &[Ray]| {
            let mut counts = Counts::default();
            tree.intersect_packet(&mesh, rays, &mut vec![None; rays.len()], &mut counts);
            counts.nodes
        };
        for number in 0..6 {
            for place in [0, 1, size / 2, size - 1] {
                let mut rays = good.clone();
                rays[place] = invalid(number);
                check("one invalid", &tree, &mesh, &rays, size);
                let without: Vec<_> = [&good[..place], &good[place + 1..]].concat();
                assert_eq!(nodes(&rays), nodes(&without), "{:?}", invalid(number));
                assert!(2 * nodes(&rays) <= 5 * nodes(&good), "{:?}", invalid(number));
            }
        }
        // Half of them, and all.
        let halved = |(i, ray): (usize, &Ray)| if i % 2 == 0 { invalid(i / 2) } else { *ray };
        let rays: Vec<_> = good.iter().enumerate().map(halved).collect();
        assert!(check("half invalid", &tree, &mesh, &rays, size) > 0);
        let rays: Vec<_> = (0..size).map(invalid).collect();
        assert_eq!(check("all invalid", &tree, &mesh, &rays, size), 0);
        assert_eq!(nodes(&rays), 0);
    }
}

#[test]
fn one_stray_ray_costs_its_own_way_at_most() {
    let mesh = shapes::soup(5000, 0.1, 8);
    let tree = build(Builder::SahBinned, &mesh);
    let good = picture(16, Vec3::new(0.3, -0.4, 4.0));
    let stray = Ray::new([-3.0, 0.2, -0.3], [1.0, 0.1, 0.2]);
    let nodes = |rays: &[Ray]| {
        let mut counts = Counts::default();
        tree.intersect_packet(&mesh, rays, &mut vec![None; rays.len()], &mut counts);
        counts.nodes
    };
    let mut alone = Counts::default();
    tree.intersect(&mesh, &stray, &mut alone);
    for place in [0, 100, 255] {
        let mut rays = good.clone();
        rays[place] = stray;
        check("one stray", &tree, &mesh, &rays, 256);
        // It may lead the others to farther children first, which costs a little more.
        let most = nodes(&good) + alone.nodes;
        assert!(2 * nodes(&rays) <= 5 * most, "{} nodes, {most} apart", nodes(&rays));
    }
}

#[test]
fn packets_share_nodes_and_box_tests() {
    let mesh = shapes::uv_sphere(64, Vec3::ZERO, 1.0);
    let tree = build(Builder::SahBinned, &mesh);
    let rays = &picture(256, Vec3::new(0.0, 0.1, 4.0))[..];
    // A tile of 16 x 16 pixels inside the sphere.
    let tile: Vec<_> = (0..256).map(|i| rays[(120 + i / 16) * 256 + 120 + i % 16]).collect();
    let (mut single, mut packet) = (Counts::default(), Counts::default());
    for ray in &tile {
        tree.intersect(&mesh, ray, &mut single);
    }
    tree.intersect_packet(&mesh, &tile, &mut [None; 256], &mut packet);
    assert!(20 * packet.nodes < single.nodes, "{packet:?}, singly {single:?}");
    assert!(3 * packet.boxes < 2 * single.boxes, "{packet:?}, singly {single:?}");
}

#[test]
fn coherence_is_one_for_equal_rays_and_their_number_for_strangers() {
    let mesh = shapes::soup(2000, 0.1, 9);
    let tree = build(Builder::SahBinned, &mesh);
    let ray = Ray::new([0.1, 0.2, 5.0], [0.0, 0.0, -1.0]);
    let measure = |rays: &[Ray]| {
        let mut coherence = Coherence::default();
        tree.intersect_packet(&mesh, rays, &mut vec![None; rays.len()], &mut coherence);
        coherence
    };
    assert_eq!(measure(&[ray; 64]).coherence(), 1.0);
    assert_eq!(measure(&[ray; 64]).rays_per_node(), 64.0);
    assert_eq!(measure(&[ray]).coherence(), 1.0);
    let away = Ray::new([9.0, 9.0, 9.0], [1.0, 0.0, 0.0]);
    let mut rays = [away; 64];
    rays[17] = ray;
    assert_eq!(measure(&rays).coherence(), 64.0);
    // An invalid ray is not in the packet.
    rays[3] = invalid(0);
    assert_eq!(measure(&rays).coherence(), 63.0);
    assert!(measure(&[away]).coherence().is_nan());
}

#[test]
#[should_panic(expected = "as many hits as rays")]
fn as_many_answers_as_rays() {
    let mesh = shapes::soup(10, 0.1, 1);
    let tree = build(Builder::SahBinned, &mesh);
    tree.intersect_packet(&mesh, &[Ray::new([0.0; 3], [1.0; 3])], &mut [], &mut ());
}
