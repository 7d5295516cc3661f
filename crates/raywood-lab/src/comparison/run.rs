//! Building the structures, checking their answers, timing them by turns.

use rayon::prelude::*;
use raywood::{BuildOptions, Counts, Geometry, Ray, Structure, StructureKind};
use raywood_render::{PreparedScene, Surfaces, View};

use super::{CompareError, CompareOptions, Comparison, RaySetSummary, StructureReport, Traces};
use crate::answers::{Answer, answers, check_agreement};
use crate::flat::structure_of;
use crate::ray_sets::{RayKind, RaySet, ray_sets};
use crate::timing::{Timing, seconds, take_turns};
use crate::tracing::{affordable, trace};

/// A structure that is built this often is built no more.
const BUILDS: usize = 3;

/// Nor is one whose builds have taken so many seconds together.
const BUILD_SECONDS: f64 = 4.0;

/// Builds the structures over the scene and has each trace the same rays, on the threads of the current rayon pool.
///
/// Times are medians of rounds in which all structures take turns. Every hit of every structure is held against those of the structure in
/// `reference`, whose own are held against brute force if that is among the structures: all agree, or the comparison is an
/// error. Brute force, and any other structure that would take too long, traces a sample of the rays. All structures are in
/// memory at once, and are handed over in the end. `step` is told what is being done.
///
/// # Errors
///
/// A structure that cannot be built, a camera through which nothing can be seen, or structures that disagree.
pub fn compare<'a>(
    reference: &PreparedScene<'a>,
    view: &View,
    options: &CompareOptions,
    mut step: impl FnMut(&str),
) -> Result<(Comparison, Vec<SceneStructure<'a>>), CompareError> {
    step("choosing rays");
    let sets = ray_sets(reference, view, options.aspect, options.rays);
    let sets = sets.map_err(CompareError::Camera)?;
    let expected: Vec<_> =
        sets.iter().map(|set| answers(structure_of(reference), set.kind, &set.rays)).collect();

    let surfaces = PreparedScene::surfaces(reference.scene());
    let (structures, builds) = build(&options.kinds, surfaces, &options.build, &mut step)?;
    let mut reports: Vec<_> = structures
        .iter()
        .zip(builds)
        .map(|(structure, build)| StructureReport {
            kind: structure.kind(),
            build,
            stats: structure.stats(),
            traces: Vec::new(),
        })
        .collect();

    for (set, expected) in sets.iter().zip(&expected) {
        // Find what each structure can trace in time, and hold its answers against the reference's.
        let mut samples = Vec::new();
        for structure in &structures {
            step(&format!("checking {} rays: {}", set.kind.name(), structure.kind().name()));
            let sample = set.sample(affordable(structure, set));
            check(structure_of(reference), structure, set, expected, &sample)?;
            samples.push(sample.into_iter().map(|index| set.rays[index]).collect::<Vec<_>>());
        }

        step(&format!("timing {} rays", set.kind.name()));
        let timings = take_turns(structures.len(), options.rounds.max(1), |number| {
            Some(trace(&structures[number], set.kind, &samples[number]))
        });
        for (number, timing) in timings.into_iter().flatten().enumerate() {
            let rays = &samples[number];
            let counts = count(&structures[number], set.kind, rays);
            let traces = Traces { kind: set.kind, rays: rays.len(), counts, timing };
            reports[number].traces.push(traces);
        }
    }

    let ray_sets =
        sets.iter().zip(&expected).map(|(set, answers)| RaySetSummary::new(set, answers));
    let comparison = Comparison {
        primitives: surfaces.len(),
        threads: rayon::current_num_threads(),
        ray_sets: ray_sets.collect(),
        structures: reports,
    };
    Ok((comparison, structures))
}

/// A structure over a scene.
pub type SceneStructure<'a> = Structure<Surfaces<'a>>;

/// Builds all structures, by turns and several times.
fn build<'a>(
    kinds: &[StructureKind],
    surfaces: Surfaces<'a>,
    options: &BuildOptions,
    step: &mut impl FnMut(&str),
) -> Result<(Vec<SceneStructure<'a>>, Vec<Timing>), CompareError> {
    let mut structures: Vec<Option<SceneStructure<'a>>> = vec![None; kinds.len()];
    let mut times = vec![Vec::new(); kinds.len()];
    for _ in 0..BUILDS {
        for (number, &kind) in kinds.iter().enumerate() {
            if times[number].iter().sum::<f64>() > BUILD_SECONDS {
                continue;
            }
            step(&format!("building {}", kind.name()));
            // Free the last one's memory first, outside the time that counts.
            structures[number] = None;
            let (time, built) = seconds(|| Structure::build(kind, surfaces, options));
            structures[number] = Some(built.map_err(|error| CompareError::Build(kind, error))?);
            times[number].push(time);
        }
    }
    let structures = structures.into_iter().flatten().collect();
    Ok((structures, times.into_iter().map(Timing::new).collect()))
}

/// Holds the structure's answers to a sample of the rays, given by number, against the reference's.
fn check(
    reference: &SceneStructure<'_>,
    structure: &SceneStructure<'_>,
    set: &RaySet,
    expected: &[Answer],
    sample: &[usize],
) -> Result<(), CompareError> {
    let rays: Vec<_> = sample.iter().map(|&index| set.rays[index]).collect();
    let expected: Vec<_> = sample.iter().map(|&index| expected[index]).collect();
    let found = answers(structure, set.kind, &rays);
    let [expecting, finding] = [reference, structure].map(|structure| structure.kind().name());
    check_agreement(set.kind, &rays, (expecting, &expected), (finding, &found))
        .map_err(CompareError::Mismatch)
}

/// What the structure visits and tests for the rays, all together.
fn count(structure: &SceneStructure<'_>, kind: RayKind, rays: &[Ray]) -> Counts {
    let one = |ray: &Ray| {
        let mut counts = Counts::default();
        if kind.any_hit() {
            structure.occluded_probed(ray, &mut counts);
        } else {
            structure.intersect_probed(ray, &mut counts);
        }
        counts
    };
    rays.par_iter().map(one).sum()
}

#[cfg(test)]
mod tests {
    use raywood::{Hit, Vec3};
    use raywood_render::default_view;
    use raywood_scene::builtin;

    use super::*;

    #[test]
    fn a_wrong_answer_is_an_error_that_names_the_ray() {
        let scene = builtin("terrain?n=16").expect("a scene");
        let prepared = PreparedScene::new(&scene).expect("it builds");
        let view = default_view(&prepared, 1.6);
        for set in ray_sets(&prepared, &view, 1.6, 640).expect("a camera") {
            let structure = structure_of(&prepared);
            let mut expected = answers(structure, set.kind, &set.rays);
            let sample = set.sample(64);
            let check = |expected: &[Answer]| check(structure, structure, &set, expected, &sample);
            assert_eq!(check(&expected), Ok(()));

            // A wrong answer outside the sample goes unnoticed, one inside it does not.
            let (inside, outside) = (sample[40], sample[40] + 1);
            let wrong = |answer: Answer| match answer {
                Answer::Any(blocked) => Answer::Any(!blocked),
                Answer::Closest(Some(hit)) => Answer::Closest(Some(Hit { t: hit.t * 1.01, ..hit })),
                Answer::Closest(None) => {
                    Answer::Closest(Some(Hit { t: 1.0, u: 0.0, v: 0.0, primitive: 7, instance: 0 }))
                }
            };
            expected[outside] = wrong(expected[outside]);
            assert_eq!(check(&expected), Ok(()));
            expected[inside] = wrong(expected[inside]);
            let error = check(&expected).expect_err("the answers differ");
            let Vec3 { x, .. } = set.rays[inside].direction;
            let text = error.to_string();
            assert!(text.contains(&format!("along ({x:?}, ")), "{text}");
            assert!(text.contains(set.kind.name()) && text.contains("bvh-wide"), "{text}");
        }
    }
}
