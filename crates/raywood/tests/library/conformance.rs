//! Every query on friendly and nasty meshes against brute force in double precision.

use raywood::{BuildOptions, BuildPreset, Builder, Bvh, Hit, Ray};
use raywood_testkit::{nasty, oracle, rays};

/// Options that make different trees over the same mesh.
fn options() -> Vec<BuildOptions> {
    let default = BuildOptions::default();
    let by_heuristic = BuildOptions { wide_builder: Builder::SahBinned, ..default.clone() };
    let odd = [
        BuildOptions { max_leaf_size: 1, wide_leaf_size: 1, ..default },
        BuildOptions { bins: 3, max_leaf_size: 64, primitive_cost: 0.01, ..by_heuristic },
    ];
    BuildPreset::ALL.iter().map(|preset| preset.options()).chain(odd).collect()
}

#[test]
fn closest_and_any_hits_agree_with_brute_force() {
    for (number, nasty) in nasty::all().iter().enumerate() {
        let rays = rays::against(&nasty.mesh, 1500, number as u64);
        for options in options() {
            let bvh = Bvh::build_with(&nasty.mesh, &options).expect("it builds");
            bvh.validate().unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            for ray in &rays {
                oracle::check_closest(&nasty.mesh, ray, bvh.intersect(ray))
                    .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
                oracle::check_occluded(&nasty.mesh, ray, bvh.occluded(ray))
                    .unwrap_or_else(|error| panic!("{}: {error}", nasty.name));
            }
        }
    }
}

#[test]
fn different_trees_give_the_same_hits() {
    for nasty in nasty::all() {
        let rays = rays::against(&nasty.mesh, 4000, 99);
        let trees =
            options().map_each(|options| Bvh::build_with(&nasty.mesh, options).expect("it builds"));
        for ray in &rays {
            let answers = trees.map_each(|bvh| bvh.intersect(ray));
            assert!(
                answers.iter().all(|a| *a == answers[0]),
                "{}: {answers:?} with {ray:?}",
                nasty.name
            );
            for bvh in &trees {
                assert_eq!(bvh.occluded(ray), answers[0].is_some(), "{}: {ray:?}", nasty.name);
            }
        }
    }
}

/// `iter().map().collect()` by a shorter name.
trait MapEach<T> {
    fn map_each<U>(&self, f: impl Fn(&T) -> U) -> Vec<U>;
}

impl<T> MapEach<T> for Vec<T> {
    fn map_each<U>(&self, f: impl Fn(&T) -> U) -> Vec<U> {
        self.iter().map(f).collect()
    }
}

#[test]
fn the_lowest_number_wins_among_equals() {
    let nasty = nasty::all()
        .into_iter()
        .find(|n| n.name == "every triangle five times")
        .expect("it is in the list");
    let rays = rays::against(&nasty.mesh, 20_000, 5);
    let mut hits = 0;
    for options in options() {
        let bvh = Bvh::build_with(&nasty.mesh, &options).expect("it builds");
        for hit in rays.iter().filter_map(|ray| bvh.intersect(ray)) {
            // Copies stand 60 apart, so the first copy of any triangle is among the first 60.
            assert!(hit.primitive < 60, "{hit:?}");
            hits += 1;
        }
    }
    assert!(hits > 10_000, "only {hits} hits: the test looks at nothing");
}

#[test]
fn batches_answer_as_single_rays_do() {
    let mesh = raywood_testkit::shapes::soup(2000, 0.1, 11);
    let bvh = Bvh::build(&mesh).expect("it builds");
    for count in [0, 1, 255, 10_000] {
        let rays = rays::against(&mesh, count, 12);
        let mut hits: Vec<Option<Hit>> = vec![None; count];
        let mut occluded = vec![false; count];
        bvh.intersect_batch(&rays, &mut hits);
        bvh.occluded_batch(&rays, &mut occluded);
        for ((ray, hit), occluded) in rays.iter().zip(&hits).zip(&occluded) {
            assert_eq!(*hit, bvh.intersect(ray));
            assert_eq!(*occluded, bvh.occluded(ray));
        }
    }
}

#[test]
fn intervals_include_their_start_and_exclude_their_end() {
    let mesh =
        raywood_testkit::shapes::grid_box(1, [-1.0, -1.0, 2.0].into(), [1.0, 1.0, 4.0].into());
    let bvh = Bvh::build(&mesh).expect("it builds");
    let ray = Ray::new([0.25, 0.125, 0.0], [0.0, 0.0, 1.0]);
    let t = |t_min, t_max| bvh.intersect(&ray.with_interval(t_min, t_max)).map(|hit| hit.t);
    assert_eq!(t(0.0, f32::INFINITY), Some(2.0));
    assert_eq!(t(2.0, f32::INFINITY), Some(2.0));
    assert_eq!(t(2f32.next_up(), f32::INFINITY), Some(4.0));
    assert_eq!(t(0.0, 2.0), None);
    assert_eq!(t(0.0, 2f32.next_up()), Some(2.0));
    assert_eq!(t(-1.0, 0.0), None);
    assert_eq!(t(4.0, 4.0), None);

    // Behind the origin, when asked for.
    let back = Ray::new([0.25, 0.125, 10.0], [0.0, 0.0, 1.0]).with_interval(-20.0, 0.0);
    assert_eq!(bvh.intersect(&back).map(|hit| hit.t), Some(-8.0));
}

#[test]
fn distances_are_in_units_of_the_direction() {
    let mesh = raywood_testkit::shapes::grid_box(2, [-1.0; 3].into(), [1.0; 3].into());
    let bvh = Bvh::build(&mesh).expect("it builds");
    for scale in [1e-30, 1e-6, 1.0, 1e6, 1e30] {
        let ray = Ray::new([0.3, 0.2, 5.0], [0.0, 0.0, -scale]);
        let hit = bvh.intersect(&ray).unwrap_or_else(|| panic!("scale {scale} misses"));
        let expected = 4.0 / scale;
        assert!(
            (hit.t - expected).abs() <= 4.0 * f32::EPSILON * expected,
            "{} instead of {expected}",
            hit.t
        );
    }
}

#[test]
fn invalid_rays_miss() {
    let mesh = raywood_testkit::shapes::grid_box(2, [-1.0; 3].into(), [1.0; 3].into());
    let bvh = Bvh::build(&mesh).expect("it builds");
    let good = Ray::new([0.1, 0.2, 0.3], [0.0, 0.0, 1.0]);
    assert!(bvh.intersect(&good).is_some());
    let mut bad = vec![
        Ray::new(good.origin, [0.0, -0.0, 0.0]),
        Ray::new(good.origin, [1e-40, 0.0, 0.0]),
        good.with_interval(f32::NAN, 1.0),
        good.with_interval(0.0, f32::NAN),
        good.with_interval(1.0, 0.0),
    ];
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let with = |v: raywood::Vec3| {
                let mut v = v.to_array();
                v[axis] = value;
                v
            };
            bad.push(Ray::new(with(good.origin), good.direction));
            bad.push(Ray::new(good.origin, with(good.direction)));
        }
    }
    for ray in &bad {
        assert_eq!(bvh.intersect(ray), None, "{ray:?}");
        assert!(!bvh.occluded(ray), "{ray:?}");
    }
}
