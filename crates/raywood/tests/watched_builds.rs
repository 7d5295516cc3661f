//! Builds that are watched: what they tell, that they can be stopped anywhere, and that nothing else changes.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use raywood::{
    AccelerationStructure, BuildError, BuildOptions, BuildPreset, Builder, Bvh, Bvh2, Geometry,
    Ray, Structure, StructureKind, TriangleMesh, Vec3, WideBvh,
};
use raywood_testkit::shapes;

const BUILDERS: [Builder; 7] = [
    Builder::Midpoint,
    Builder::Median,
    Builder::SahSweep,
    Builder::SahBinned,
    Builder::Lbvh,
    Builder::Hlbvh,
    Builder::Ploc,
];

/// Large enough for several pieces of everything that is done in pieces.
fn large_soup() -> TriangleMesh {
    shapes::soup(300_001, 0.01, 3)
}

/// Large enough for several pieces of what takes longest.
fn soup() -> TriangleMesh {
    shapes::soup(80_001, 0.01, 3)
}

/// A height field of a million triangles.
fn terrain() -> TriangleMesh {
    let side = 708u32;
    let height = |x: u32, y: u32| {
        let (x, y) = (x as f32, y as f32);
        8.0 * (0.031 * x).sin() * (0.023 * y).cos() + (0.37 * x + 0.11 * y).sin()
    };
    let corner = |x: u32, y: u32| Vec3::new(x as f32, height(x, y), y as f32);
    let corners = (0..side * side).map(|i| corner(i % side, i / side)).collect::<Vec<_>>();
    let mut triangles = Vec::new();
    for i in (0..side * (side - 1)).filter(|i| i % side < side - 1) {
        triangles.extend([[i, i + side, i + 1], [i + 1, i + side, i + side + 1]]);
    }
    TriangleMesh::new(corners, triangles).expect("a sound mesh")
}

/// The same number for every set of options that builds in another way.
fn all_options() -> Vec<BuildOptions> {
    let improved = BuildOptions { reinsertion_passes: Some(2), ..Default::default() };
    let mut options: Vec<_> = BuildPreset::ALL.iter().map(|preset| preset.options()).collect();
    options.extend(BUILDERS.map(|wide_builder| BuildOptions { wide_builder, ..improved.clone() }));
    options
}

fn go_on(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// What a build tells, with an answer to each.
fn told<T>(
    answer: impl Fn(f64) -> ControlFlow<()> + Sync,
    build: impl FnOnce(&mut (dyn FnMut(f64) -> ControlFlow<()> + Send)) -> Result<T, BuildError>,
) -> (Vec<f64>, Result<T, BuildError>) {
    let mut told = Vec::new();
    let result = build(&mut |done| {
        told.push(done);
        answer(done)
    });
    (told, result)
}

#[test]
fn the_tree_is_the_same_as_without_a_watcher() {
    let mesh = large_soup();
    for options in all_options() {
        let alone = WideBvh::build(&mesh, &options).expect("it builds");
        let watched = WideBvh::build_watched(&mesh, &options, go_on).expect("it builds");
        assert!(watched == alone, "{options:?}");
    }
    let options = BuildOptions { reinsertion_passes: Some(1), ..Default::default() };
    for builder in BUILDERS {
        let alone = Bvh2::build_by(builder, &mesh, &options).expect("it builds");
        let watched = Bvh2::build_watched(builder, &mesh, &options, go_on).expect("it builds");
        assert!(watched == alone, "{builder:?}");
        assert_eq!(watched.validate(&mesh), Ok(()));
    }
}

#[test]
fn every_structure_is_the_same_as_without_a_watcher() {
    let mesh = large_soup();
    let options = BuildOptions::default();
    for &kind in StructureKind::ALL {
        let nodes = |structure: Structure<&TriangleMesh>| {
            let mut nodes = Vec::new();
            structure.visit_nodes(&mut |node| nodes.push((node.bounds, node.references)));
            nodes
        };
        let alone = nodes(Structure::build(kind, &mesh, &options).expect("it builds"));
        let watched = Structure::build_watched(kind, &mesh, &options, go_on).expect("it builds");
        assert!(nodes(watched) == alone, "{}", kind.name());
    }
}

#[test]
fn what_is_done_grows_from_0_to_1() {
    let mesh = soup();
    for &kind in StructureKind::ALL {
        for options in all_options() {
            if kind != StructureKind::BvhWide && options != BuildOptions::default() {
                continue;
            }
            let (told, built) =
                told(go_on, |tell| Structure::build_watched(kind, &mesh, &options, tell));
            let name = kind.name();
            assert!(built.is_ok());
            assert_eq!((told.first(), told.last()), (Some(&0.0), Some(&1.0)), "{name}");
            assert!(told.is_sorted(), "{name}");
            if name.starts_with("bvh-") {
                let largest = told.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
                // Of passes that reinsertion does not need nobody knows beforehand.
                assert!(largest < 0.4, "{name}: a step of {largest} with {options:?}");
                assert!(told.len() > 50, "{name}: {} times", told.len());
            }
        }
    }
}

#[test]
fn a_build_ends_where_it_is_told_to() {
    let mesh = soup();
    for &kind in StructureKind::ALL {
        for place in [0.0, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0] {
            let answer = |done: f64| match done >= place {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let options = BuildOptions { reinsertion_passes: Some(2), ..Default::default() };
            let (told, built) =
                told(answer, |tell| Structure::build_watched(kind, &mesh, &options, tell));
            assert_eq!(built.err(), Some(BuildError::Cancelled), "{} at {place}", kind.name());
            let before = told.iter().filter(|done| **done < place).count();
            assert_eq!(told.len(), before + 1, "{}: asked again after {place}", kind.name());
        }
    }
}

#[test]
fn a_build_of_a_million_triangles_ends_soon() {
    let mesh = terrain();
    for builder in BUILDERS {
        let options = BuildOptions {
            wide_builder: builder,
            wide_leaf_size: 1,
            reinsertion_share: 0.2,
            ..Default::default()
        };
        // The slowest to build takes most of its time for what is all the same.
        let places: &[f64] = match builder {
            Builder::SahSweep => &[0.02, 0.99],
            _ => &[0.0, 0.05, 0.3, 0.6, 0.8, 0.95],
        };
        for &place in places {
            let mut stopped = None;
            let result = WideBvh::build_watched(&mesh, &options, |done| {
                if done < place {
                    return ControlFlow::Continue(());
                }
                stopped = Some(Instant::now());
                ControlFlow::Break(())
            });
            assert_eq!(result.err(), Some(BuildError::Cancelled));
            let time = stopped.expect("it was asked").elapsed();
            assert!(time < Duration::from_secs(1), "{builder:?} at {place}: {time:?}");
        }
    }
}

#[test]
fn a_build_is_asked_often_whatever_it_is_doing() {
    let mesh = terrain();
    for builder in BUILDERS {
        let options = BuildOptions { wide_builder: builder, ..Default::default() };
        let (mut last, mut longest) = (Instant::now(), (Duration::ZERO, 0.0));
        let watched = |done| {
            let now = Instant::now();
            if now - last > longest.0 {
                longest = (now - last, done);
            }
            last = now;
            ControlFlow::Continue(())
        };
        Bvh::build_watched(&mesh, &options, watched).expect("it builds");
        // Of a second or more; generous, for busy machines.
        assert!(longest.0 < Duration::from_millis(250), "{builder:?}: {longest:?}");
    }
}

#[test]
fn a_panic_of_the_watcher_goes_its_way() {
    let mesh = soup();
    for &kind in StructureKind::ALL {
        for place in [0.0, 0.4, 0.9, 1.0] {
            let asked = AtomicUsize::new(0);
            let has_panicked = AtomicBool::new(false);
            let options = BuildOptions::default();
            let build = || {
                Structure::build_watched(kind, &mesh, &options, |done| {
                    asked.fetch_add(1, Ordering::Relaxed);
                    assert!(!has_panicked.load(Ordering::Relaxed), "asked after a panic");
                    if done >= place {
                        has_panicked.store(true, Ordering::Relaxed);
                        std::panic::resume_unwind(Box::new("enough"));
                    }
                    ControlFlow::Continue(())
                })
            };
            let panic = catch_unwind(AssertUnwindSafe(build)).expect_err("it panics");
            assert_eq!(panic.downcast_ref(), Some(&"enough"), "{}", kind.name());
        }
        // The pool works as before.
        assert!(Structure::build(kind, &mesh, &BuildOptions::default()).is_ok());
    }
}

#[cfg(feature = "rayon")]
#[test]
fn watched_by_many_threads() {
    let mesh = large_soup();
    let options = BuildOptions::default();
    let alone = WideBvh::build(&mesh, &options).expect("it builds");
    for threads in [1, 2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let (all, built) = told(go_on, |tell| WideBvh::build_watched(&mesh, &options, tell));
            assert!(built.expect("it builds") == alone);
            assert!(all.is_sorted() && all.last() == Some(&1.0));
            for place in [0.0, 0.2, 0.6, 0.9] {
                let answer = |done: f64| match done >= place {
                    true => ControlFlow::Break(()),
                    false => ControlFlow::Continue(()),
                };
                let (all, built) =
                    told(answer, |tell| WideBvh::build_watched(&mesh, &options, tell));
                assert_eq!(built.err(), Some(BuildError::Cancelled));
                assert_eq!(all.iter().filter(|done| **done >= place).count(), 1);
            }
        });
    }
}

#[test]
fn small_and_empty_and_bad_geometry() {
    let nothing = TriangleMesh::new(Vec::<Vec3>::new(), vec![]).expect("nothing");
    let few = shapes::soup(3, 0.1, 1);
    let alike = {
        // More than the codes along a curve tell apart.
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        TriangleMesh::new(corners, vec![[0, 1, 2]; 100_000]).expect("a sound mesh")
    };
    for &kind in StructureKind::ALL {
        for mesh in [&nothing, &few, &alike] {
            let options = BuildOptions::default();
            let (told, built) =
                told(go_on, |tell| Structure::build_watched(kind, mesh, &options, tell));
            let built = built.expect("it builds");
            assert_eq!(built.validate(), Ok(()), "{}", kind.name());
            assert_eq!((told.first(), told.last()), (Some(&0.0), Some(&1.0)));
            let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
            assert_eq!(built.occluded(&ray), mesh.len() == 100_000);
        }
    }
}
