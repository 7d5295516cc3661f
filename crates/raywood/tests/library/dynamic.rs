//! Trees that look after themselves: what they decide by which costs, and that their hits are right whatever that is.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use raywood::{
    BuildError, BuildMemory, BuildOptions, BuildPreset, Bvh, Decision, DynamicBvh, Geometry, Hit,
    Ray, SimdLevel, StructureKind, TriangleMesh, Update, UpdateOptions, Vec3,
};
use raywood_testkit::{Rng, nasty, oracle, rays, shapes};

/// A sheet of squares, two triangles each, whose height is given.
fn sheet(side: u32, height: impl Fn(f32, f32) -> f32) -> TriangleMesh {
    let at = |number: u32| {
        let place = |n: u32| n as f32 / side as f32;
        let (x, y) = (place(number % (side + 1)), place(number / (side + 1)));
        Vec3::new(x, y, height(x, y))
    };
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let squares = (0..side * side).map(|number| (number % side, number / side));
    let triangles = squares.flat_map(|(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let positions: Vec<_> = (0..(side + 1) * (side + 1)).map(at).collect();
    TriangleMesh::new(positions, triangles.collect()).expect("a sheet")
}

/// The same triangles of a soup, those that are asked for at each other's places.
fn shuffled(soup: &TriangleMesh, seed: u64, is_moved: impl Fn(Vec3) -> bool) -> TriangleMesh {
    let corners = soup.positions().as_chunks::<3>().0;
    let chosen: Vec<_> = (0..corners.len()).filter(|&t| is_moved(corners[t][0])).collect();
    let (mut order, mut rng) = (chosen.clone(), Rng::new(seed));
    for place in (1..order.len()).rev() {
        order.swap(place, rng.below(place + 1));
    }
    let mut moved = corners.to_vec();
    for (&from, &to) in chosen.iter().zip(&order) {
        moved[to] = corners[from];
    }
    soup.with_positions(moved.into_flattened()).expect("as many")
}

/// That a tree is valid, and that its hits are those of brute force and of a tree that was built there.
fn check(scene: &DynamicBvh<TriangleMesh>, name: &str) {
    let bvh = scene.bvh();
    bvh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
    // What is checked when a tree is loaded holds of it too, and how deep it is is known.
    let mut file = Vec::new();
    bvh.save(&mut file).expect("it is saved");
    let loaded = Bvh::load(file).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(loaded.stats() == bvh.stats(), "{name}");
    if scene.bvh().simd_level() == loaded.simd_level() {
        assert!(loaded.tree() == bvh.tree(), "{name}");
    }
    let fresh = Bvh::build(bvh.geometry().clone()).expect("it builds");
    for (number, ray) in rays::against(bvh.geometry(), 400, 1).iter().enumerate() {
        let hit = bvh.intersect(ray);
        assert_eq!(hit, fresh.intersect(ray), "{name}: {ray:?}");
        assert_eq!(bvh.occluded(ray), hit.is_some(), "{name}: {ray:?}");
        if number % 20 == 0 {
            oracle::check_closest(bvh.geometry(), ray, hit).expect("it is the closest");
        }
    }
}

/// That the costs told of are those of the tree.
fn check_costs(scene: &DynamicBvh<TriangleMesh>, update: &Update) {
    let q = scene.bvh().stats().q;
    assert!((update.cost - q).abs() <= 1e-9 * q, "{update:?}, Q {q}");
    let limit = scene.options().max_growth * update.built_cost;
    match update.decision {
        Decision::Refitted => assert_eq!(update.cost, update.refitted_cost),
        Decision::Rebuilt => assert_eq!(update.cost, update.built_cost),
        _ => assert!(update.cost < update.refitted_cost && update.cost <= limit),
    }
    if update.decision == Decision::Refitted {
        assert!(update.cost <= limit, "{update:?}");
    }
}

#[test]
fn a_wave_in_a_sheet_only_moves_boxes() {
    let mut scene = DynamicBvh::build(sheet(80, |_, _| 0.0)).expect("it builds");
    let built = scene.bvh().stats().q;
    for step in 0..12 {
        let wave = |x: f32, y: f32| 0.02 * (9.0 * x + 5.0 * y + 0.5 * step as f32).sin();
        let update = scene.update(sheet(80, wave)).expect("it is taken on");
        assert_eq!(update.decision, Decision::Refitted, "{update}");
        assert!((update.built_cost - built).abs() < 1e-9 * built);
        check_costs(&scene, &update);
        check(&scene, "a wave");
    }
}

#[test]
fn what_is_shuffled_is_built_anew() {
    let soup = shapes::soup(20_000, 0.02, 1);
    let mut scene = DynamicBvh::build(soup.clone()).expect("it builds");
    let update = scene.update(shuffled(&soup, 2, |_| true)).expect("it is taken on");
    assert_eq!(update.decision, Decision::Rebuilt, "{update}");
    assert!(update.refitted_cost > 5.0 * update.cost, "{update}");
    check_costs(&scene, &update);
    check(&scene, "all shuffled");

    // From then on it is judged by the new tree.
    let update = scene.update(scene.bvh().geometry().clone()).expect("nothing moved");
    assert_eq!(update.decision, Decision::Refitted, "{update}");
    check_costs(&scene, &update);
}

#[test]
fn an_explosion_is_built_anew() {
    let ball = shapes::uv_sphere(60, Vec3::ZERO, 1.0);
    // Triangles of their own, so that they can part.
    let corners = (0..ball.len() as u32).flat_map(|triangle| ball.corners(triangle));
    let corners: Vec<_> = corners.collect();
    let own = (0..ball.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let whole = TriangleMesh::new(corners.clone(), own).expect("a ball");
    let mut scene = DynamicBvh::build(whole.clone()).expect("it builds");
    let mut rng = Rng::new(5);
    let ways: Vec<_> = (0..ball.len()).map(|_| rng.direction()).collect();
    let mut decisions = Vec::new();
    for step in 0..8 {
        let far = 0.1 * step as f32;
        let at = |(number, &corner): (usize, &Vec3)| corner + far * ways[number / 3];
        let moved = corners.iter().enumerate().map(at).collect::<Vec<_>>();
        let moved = whole.with_positions(moved).expect("as many");
        let update = scene.update(moved).expect("it is taken on");
        check_costs(&scene, &update);
        check(&scene, "an explosion");
        decisions.push(update.decision);
    }
    assert_eq!(decisions[0], Decision::Refitted);
    assert!(decisions.contains(&Decision::Rebuilt), "{decisions:?}");
}

/// A mesh of triangles that share nothing.
fn of_corners(corners: &[[Vec3; 3]]) -> TriangleMesh {
    let triangles = (0..corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    TriangleMesh::new(corners.as_flattened().to_vec(), triangles.collect()).expect("sound")
}

#[test]
fn triangles_come_and_go() {
    for preset in BuildPreset::ALL {
        let all = shapes::soup(5_000, 0.05, 8);
        let mut rest = (4_000..5_000).map(|t| all.corners(t));
        let mut corners: Vec<_> = (0..4_000).map(|t| all.corners(t)).collect();
        let options = UpdateOptions { build: preset.options(), ..Default::default() };
        let mut scene = DynamicBvh::build_with(of_corners(&corners), options).expect("it builds");
        let depth = scene.bvh().stats().depth;
        let (mut rng, mut repaired) = (Rng::new(9), 0);
        for step in 0..40 {
            // One comes, one goes, some come and others move, many go.
            match step % 4 {
                0 => corners.extend(rest.next()),
                1 => drop(corners.swap_remove(rng.below(corners.len()))),
                2 => {
                    corners.extend(rest.by_ref().take(20));
                    for corners in &mut corners[100..200] {
                        *corners = corners.map(|corner| corner + Vec3::splat(0.01));
                    }
                }
                _ => corners.truncate(corners.len() - rng.below(15)),
            }
            let update = scene.update(of_corners(&corners)).expect("it is taken on");
            repaired += usize::from(matches!(update.decision, Decision::Repaired { .. }));
            check_costs(&scene, &update);
            check(&scene, &format!("{preset:?}, step {step}: {update}"));
        }
        // Some steps change nothing, and at times too much was built since the last build.
        assert!(repaired > 20, "{preset:?}: {repaired}");
        let now = scene.bvh().stats().depth;
        assert!(now <= depth + 2, "{preset:?}: {depth}, now {now}");
    }
}

#[test]
fn one_comes_and_one_goes_where_there_are_few() {
    let all = shapes::soup(100, 0.5, 4);
    let corners: Vec<_> = (0..100).map(|t| all.corners(t)).collect();
    let mut scene = DynamicBvh::build(of_corners(&[])).expect("it builds");
    for count in (0..100).chain((0..100).rev()) {
        let update = scene.update(of_corners(&corners[..count])).expect("it is taken on");
        check_costs(&scene, &update);
        check(&scene, &format!("{count}"));
    }
    assert!(scene.bvh().stats().q == 0.0);
}

#[test]
fn what_is_bad_in_one_place_is_repaired_there() {
    let soup = shapes::soup(40_000, 0.02, 3);
    for preset in BuildPreset::ALL {
        let build = preset.options();
        let options = UpdateOptions { build, max_growth: 2.0, max_repair_share: 1.0 };
        let mut scene = DynamicBvh::build_with(soup.clone(), options).expect("it builds");
        let mut mesh = soup.clone();
        let mut most = 0;
        for step in 0..3 {
            // Somewhere else each time.
            let low = 0.5 * step as f32 - 0.9;
            mesh = shuffled(&mesh, step, |p| low < p.x && p.x < low + 0.25);
            let update = scene.update(mesh.clone()).expect("it is taken on");
            let name = format!("{}, step {step}: {update}", preset.name());
            let Decision::Repaired { subtrees, primitives } = update.decision else {
                panic!("{name}")
            };
            assert!(subtrees > 10 && primitives < 20_000, "{name}");
            most = most.max(primitives);
            check_costs(&scene, &update);
            check(&scene, &name);
            // The same again needs nothing.
            let again = scene.update(mesh.clone()).expect("nothing moved");
            if *preset != BuildPreset::Best {
                assert_eq!(again.decision, Decision::Refitted, "{name}, {again}");
            }
        }
        assert!(most > 4000, "{most}");
    }
}

#[test]
fn repairs_end_in_a_build() {
    let soup = shapes::soup(40_000, 0.02, 3);
    let mut scene = DynamicBvh::build(soup.clone()).expect("it builds");
    let (mut repaired, mut decisions) = (0, [0; 2]);
    for step in 0..20 {
        // Always in the same place, always from what was built there last.
        let pose = shuffled(scene.bvh().geometry(), step, |p| p.max_element() < -0.4);
        let update = scene.update(pose).expect("it is taken on");
        check_costs(&scene, &update);
        match update.decision {
            Decision::Repaired { primitives, .. } => {
                repaired += primitives;
                decisions[0] += 1;
                assert!(repaired <= 20_000, "{update}");
            }
            Decision::Rebuilt => {
                repaired = 0;
                decisions[1] += 1;
            }
            _ => {}
        }
    }
    assert!(decisions[0] > 3 * decisions[1] && decisions[1] > 0, "{decisions:?}");
    check(&scene, "repaired again and again");
}

#[test]
fn what_became_harder_in_one_place_is_repaired() {
    // Vertices that triangles share: these become long, and no tree makes them cheap.
    let flat = sheet(150, |_, _| 0.0);
    let mut scene = DynamicBvh::build(flat.clone()).expect("it builds");
    let mut rng = Rng::new(6);
    let torn = |&p: &Vec3| match p.max_element() < 0.1 {
        true => Vec3::new(0.1 * rng.unit(), 0.1 * rng.unit(), 0.1 * rng.unit()),
        false => p,
    };
    let torn = flat.positions().iter().map(torn).collect::<Vec<_>>();
    let update = scene.update(flat.with_positions(torn).expect("as many")).expect("it is taken on");
    assert!(matches!(update.decision, Decision::Repaired { .. }), "{update}");
    check_costs(&scene, &update);
    check(&scene, "torn");
    let fresh = Bvh::build(scene.bvh().geometry().clone()).expect("it builds").stats().q;
    assert!(update.cost < 1.15 * fresh, "{update}, {fresh}");
}

#[test]
fn threads_decide_nothing() {
    let soup = shapes::soup(40_000, 0.02, 3);
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let options = UpdateOptions { max_growth: 2.0, ..Default::default() };
            let mut scene = DynamicBvh::build_with(soup.clone(), options).expect("it builds");
            let poses = [
                shapes::mapped(&soup, |p| 1.01 * p),
                shuffled(&soup, 7, |p| p.x < -0.7),
                shuffled(&soup, 8, |_| true),
            ];
            let updates = poses.map(|pose| {
                let update = scene.update(pose).expect("it is taken on");
                (update, scene.bvh().tree().clone())
            });
            updates.to_vec()
        })
    };
    let one = of(1);
    let decisions: Vec<_> = one.iter().map(|(update, _)| update.decision).collect();
    assert!(matches!(
        decisions[..],
        [Decision::Refitted, Decision::Repaired { .. }, Decision::Rebuilt]
    ));
    for threads in [2, 3] {
        assert!(one == of(threads), "{threads} threads");
    }
}

#[test]
fn limits_decide() {
    let soup = shapes::soup(40_000, 0.02, 3);
    let shuffled = shuffled(&soup, 7, |p| p.x < -0.2);
    let decision = |max_growth: f64, max_repair_share: f64| {
        let options = UpdateOptions { max_growth, max_repair_share, ..Default::default() };
        let mut scene = DynamicBvh::build_with(soup.clone(), options).expect("it builds");
        let decision = scene.update(shuffled.clone()).expect("it is taken on").decision;
        scene.bvh().validate().expect("it is valid");
        decision
    };
    assert_eq!(decision(f64::INFINITY, 1.0), Decision::Refitted);
    assert_eq!(decision(1.3, 0.0), Decision::Rebuilt);
    assert!(matches!(decision(2.0, 1.0), Decision::Repaired { primitives: 16_000.., .. }));
    // What is out of range counts as the nearest that is in.
    assert_eq!(decision(0.0, -1.0), Decision::Rebuilt);
    assert_eq!(decision(f64::NAN, f64::NAN), Decision::Rebuilt);
}

#[test]
fn nasty_meshes_change_into_each_other() {
    let all = nasty::all();
    let mut scene = DynamicBvh::build(all[0].mesh.clone()).expect("it builds");
    let mut rng = Rng::new(4);
    let mut decisions = [0; 3];
    for round in 0..150 {
        // Another one, or the same with some of its vertices elsewhere.
        let mesh = match round % 3 {
            0 => all[rng.below(all.len())].mesh.clone(),
            _ => {
                let last = scene.bvh().geometry().clone();
                let share = rng.unit() * rng.unit();
                let size = last.total_bounds().diagonal().clamp(1e-12, 1e12);
                let moved = |&p: &Vec3| {
                    if rng.unit() < share { p + 0.5 * size * rng.in_cube() } else { p }
                };
                let moved = last.positions().iter().map(moved).collect::<Vec<_>>();
                last.with_positions(moved).expect("finite")
            }
        };
        let same = mesh.len() == scene.bvh().geometry().len();
        let update = scene.update(mesh).expect("it is taken on");
        decisions[match update.decision {
            Decision::Refitted => 0,
            Decision::Rebuilt => 1,
            _ => 2,
        }] += 1;
        assert_eq!(update.refitted_cost.is_finite(), same, "{update}");
        let bvh = scene.bvh();
        bvh.validate().unwrap_or_else(|error| panic!("round {round}: {error}"));
        let fresh = Bvh::build(bvh.geometry()).expect("it builds");
        for ray in rays::against(bvh.geometry(), 100, round) {
            assert_eq!(bvh.intersect(&ray), fresh.intersect(&ray), "round {round}: {ray:?}");
        }
    }
    assert!(decisions[0] > 10 && decisions[1] > 10, "{decisions:?}");
}

#[test]
fn a_build_that_is_not_allowed_changes_nothing() {
    let few = shapes::soup(1000, 0.1, 1);
    let kind = StructureKind::BvhWide;
    let limit = BuildMemory::of(kind, 1500, &BuildOptions::default()).peak;
    let build = BuildOptions { memory_limit: Some(limit), ..Default::default() };
    let options = UpdateOptions { build, ..Default::default() };
    let mut scene = DynamicBvh::build_with(few.clone(), options).expect("it is allowed");
    let error = scene.update(shapes::soup(30_000, 0.1, 1)).expect_err("it is too large");
    assert!(matches!(error, BuildError::MemoryLimit { .. }), "{error}");
    assert_eq!(scene.bvh().geometry(), &few);
    check(&scene, "after an error");
}

#[test]
fn instructions_stay_chosen() {
    let soup = shapes::soup(5000, 0.02, 1);
    let mut scene = DynamicBvh::build(soup.clone()).expect("it builds");
    for &level in SimdLevel::ALL.iter().filter(|level| level.is_available()) {
        scene.set_simd_level(level);
        for pose in [&shuffled(&soup, 1, |p| p.x < -0.6), &shuffled(&soup, 2, |_| true), &soup] {
            scene.update(pose.clone()).expect("it is taken on");
            assert_eq!(scene.bvh().simd_level(), level);
            check(&scene, level.name());
        }
    }
}

#[test]
fn rays_in_another_thread_see_one_pose_whole() {
    // A sheet that lies higher in every pose, so that a hit tells the pose.
    let height = |pose: usize| 1.0 + pose as f32;
    let mut scene = DynamicBvh::build(sheet(60, |_, _| height(0))).expect("it builds");
    let rays: Vec<_> = (0..4096)
        .map(|number| {
            let place = |n: usize| (n as f32 + 0.5) / 64.0;
            Ray::new([place(number % 64), place(number / 64), 0.0], [0.0, 0.0, 1.0])
        })
        .collect();
    let is_over = AtomicBool::new(false);
    let (send, receive) = std::sync::mpsc::channel::<(usize, Arc<Bvh<TriangleMesh>>)>();
    std::thread::scope(|scope| {
        let tracer = scope.spawn(|| {
            let mut hits: Vec<Option<Hit>> = vec![None; rays.len()];
            let mut traced = 0;
            for (pose, snapshot) in receive {
                // Again and again, while updates go on.
                for _ in 0..5 {
                    snapshot.intersect_batch(&rays, &mut hits);
                    let is_whole = |hit: &Option<Hit>| hit.is_some_and(|hit| hit.t == height(pose));
                    assert!(hits.iter().all(is_whole), "pose {pose}");
                    traced += 1;
                }
                if is_over.load(Ordering::Relaxed) {
                    break;
                }
            }
            traced
        });
        for pose in 1..60 {
            let snapshot = Arc::new(scene.bvh().clone());
            if send.send((pose - 1, snapshot)).is_err() {
                break;
            }
            scene.update(sheet(60, |_, _| height(pose))).expect("it is taken on");
            assert_eq!(scene.bvh().intersect(&rays[0]).map(|hit| hit.t), Some(height(pose)));
        }
        is_over.store(true, Ordering::Relaxed);
        drop(send);
        assert!(tracer.join().expect("every batch saw one pose") >= 5);
    });
}
