//! Comparisons of all structures: complete, consistent, and about rays that do what their names say.

use raywood::StructureKind;
use raywood_lab::ray_sets::ray_sets;
use raywood_lab::{CompareOptions, RayKind, compare};
use raywood_render::{PreparedScene, default_view};
use raywood_scene::{Scene, builtin};

fn small() -> CompareOptions {
    CompareOptions { rays: 640, rounds: 2, ..CompareOptions::default() }
}

#[test]
fn every_structure_is_compared_with_every_kind_of_rays() {
    let scene = builtin("sphereflake?depth=2").expect("a scene");
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    let (comparison, structures) = compare(&prepared, &view, &small(), |_| {}).expect("they agree");

    let kinds: Vec<_> = comparison.structures.iter().map(|structure| structure.kind).collect();
    assert_eq!(kinds, StructureKind::ALL);
    assert!(structures.iter().map(|structure| structure.kind()).eq(kinds));
    assert_eq!(comparison.ray_sets.len(), RayKind::ALL.len());
    for structure in &comparison.structures {
        assert_eq!(structure.stats.primitives, comparison.primitives);
        assert!(structure.build.median() > 0.0 && structure.build.rounds() > 0);
        assert_eq!(structure.traces.len(), RayKind::ALL.len());
        for (traces, set) in structure.traces.iter().zip(&comparison.ray_sets) {
            assert_eq!((traces.kind, traces.timing.rounds()), (set.kind, 2));
            assert!(0 < traces.rays && traces.rays <= set.rays, "{:?}", structure.kind);
            assert!(traces.million_rays_per_second() > 0.0);
            let primitives = traces.per_ray(traces.counts.primitives);
            assert!(traces.per_ray(traces.counts.nodes) >= 0.9, "{:?}", structure.kind);
            if structure.kind == StructureKind::BruteForce && !set.kind.any_hit() {
                assert_eq!(primitives, comparison.primitives as f64);
            } else {
                // A mailbox forgets now and then.
                assert!(primitives <= 1.2 * comparison.primitives as f64, "{primitives}");
            }
        }
    }
}

#[test]
fn rays_are_what_their_names_say() {
    let scene = builtin("sphereflake?depth=2").expect("a scene");
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    let sets = ray_sets(&prepared, &view, 1.6, 5000).expect("a camera");
    assert_eq!(sets.iter().map(|set| set.kind).collect::<Vec<_>>(), RayKind::ALL);
    let [primary, shadow, reflection, diffuse] = &sets[..] else { panic!("four sets") };

    assert!((4000..=5000).contains(&primary.rays.len()), "{}", primary.rays.len());
    assert!(primary.rays.iter().all(|ray| ray.origin == view.camera.eye));
    let hits = primary
        .rays
        .iter()
        .filter(|ray| prepared.structure().expect("no instances").occluded(ray))
        .count();
    assert_eq!((reflection.rays.len(), diffuse.rays.len()), (hits, hits));
    assert!(!shadow.rays.is_empty() && shadow.rays.len() <= hits);
    for ray in sets[1..].iter().flat_map(|set| &set.rays) {
        // Nothing starts inside what the eye sees: all rays start near its surface, outwards.
        assert!(ray.origin != view.camera.eye && ray.is_valid(), "{ray:?}");
    }

    // The same set again, and a sample without repetition.
    assert_eq!(ray_sets(&prepared, &view, 1.6, 5000).expect("a camera"), sets);
    let sample = primary.sample(100);
    assert!(sample.len() == 100 && sample.is_sorted_by(|a, b| a < b));
    assert_eq!(shadow.sample(usize::MAX).len(), shadow.rays.len());
}

#[test]
fn nothing_to_see_is_no_trouble() {
    let scene = Scene::default();
    let prepared = PreparedScene::new(&scene).expect("it builds");
    let view = default_view(&prepared, 1.6);
    let (comparison, _) = compare(&prepared, &view, &small(), |_| {}).expect("they agree");
    assert_eq!(comparison.primitives, 0);
    assert!(comparison.ray_sets.iter().all(|set| set.hits == 0));
}
