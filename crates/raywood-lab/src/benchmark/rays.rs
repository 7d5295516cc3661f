//! Rays of every kind, by every level of instructions and on every number of threads.

use raywood::{SimdLevel, StructureKind};
use raywood_render::{PreparedScene, View};

use super::{BenchmarkError, BenchmarkOptions, Speed, Team};
use crate::answers::{Answer, answers, check_agreement};
use crate::flat::structure_of;
use crate::ray_sets::{RayKind, RaySet, RaySetSummary, ray_sets};
use crate::timing::take_turns;
use crate::tracing::{affordable, trace};

/// Not more rays than this are traced at once, unless a set has more.
const MOST_RAYS: usize = 1 << 20;

/// How fast rays of a kind were traced.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySpeed {
    /// What rays they are.
    pub kind: RayKind,
    /// By which instructions; `None` if the structure uses no vector instructions.
    pub level: Option<SimdLevel>,
    /// How fast the set was traced: as many copies of it as there are threads, so that each has as much to do as one alone.
    pub speed: Speed,
}

/// A level of instructions on the threads of a team, given by number.
#[derive(Clone, Copy)]
struct Variant {
    level: Option<SimdLevel>,
    team: usize,
}

impl Variant {
    /// The level in use with every team, and the others with the first, which is one thread.
    fn all(active: Option<SimdLevel>, levels: &[SimdLevel], teams: usize) -> Vec<Self> {
        let others = levels.iter().copied().map(Some).filter(|level| *level != active);
        let alone = others.map(|level| Self { level, team: 0 });
        alone.chain((0..teams).map(|team| Self { level: active, team })).collect()
    }

    /// Has the scene traced by the level.
    fn prepare(&self, scene: &mut PreparedScene<'_>) {
        if let Some(level) = self.level {
            scene.set_simd_level(level);
        }
    }

    /// What answers call it.
    fn name(&self, scene: &PreparedScene<'_>, teams: &[Team]) -> String {
        let structure = structure_of(scene).kind().name();
        let level = self.level.map_or("", SimdLevel::name);
        format!("{structure} {level} on {} threads", teams[self.team].threads())
    }
}

/// Checks and times all rays: the sets of rays, and how fast they are traced.
pub(super) fn measure(
    scene: &mut PreparedScene<'_>,
    view: &View,
    options: &BenchmarkOptions,
    levels: &[SimdLevel],
    teams: &mut [Team],
    step: &mut impl FnMut(&str),
) -> Result<(Vec<RaySetSummary>, Vec<RaySpeed>), BenchmarkError> {
    let most = &teams[teams.len() - 1];
    step("building the reference");
    let reference = most.run(|| build_reference(scene))?;
    step("choosing rays");
    // By the faster of the two: the one that is measured may be slow.
    let has_default = structure_of(scene).kind() == StructureKind::default();
    let fast = if has_default { &*scene } else { &reference };
    let aspect = options.picture.width as f32 / options.picture.height as f32;
    let sets = most.run(|| ray_sets(fast, view, aspect, options.rays));
    let mut sets = sets.map_err(BenchmarkError::Camera)?;

    let variants = Variant::all(structure_of(scene).simd_level(), levels, teams.len());
    let mut summaries = Vec::new();
    for set in &mut sets {
        step(&format!("checking {} rays", set.kind.name()));
        // A slow structure traces a sample.
        let sample = set.sample(teams[0].run(|| affordable(structure_of(scene), set)));
        set.rays = sample.into_iter().map(|index| set.rays[index]).collect();
        let answers = check(scene, set, &variants, teams)?;
        let most = &teams[teams.len() - 1];
        most.run(|| check_against_reference(scene, &reference, set))?;
        summaries.push(RaySetSummary::new(set, &answers));
    }
    drop(reference);

    step("timing rays");
    let speeds = time(scene, &sets, &variants, options.rounds, teams);
    Ok((summaries, speeds))
}

/// A structure to hold answers against: the default one, and for that itself brute force, which can hardly be wrong.
fn build_reference<'a>(scene: &PreparedScene<'a>) -> Result<PreparedScene<'a>, BenchmarkError> {
    let kind = match structure_of(scene).kind() {
        kind if kind == StructureKind::default() => StructureKind::BruteForce,
        _ => StructureKind::default(),
    };
    PreparedScene::with_structure(scene.scene(), kind).map_err(BenchmarkError::Build)
}

/// Holds the answers of all variants against each other: what they are.
fn check(
    scene: &mut PreparedScene<'_>,
    set: &RaySet,
    variants: &[Variant],
    teams: &[Team],
) -> Result<Vec<Answer>, BenchmarkError> {
    let mut first: Option<(String, Vec<Answer>)> = None;
    for variant in variants {
        variant.prepare(scene);
        let structure = structure_of(scene);
        let found = teams[variant.team].run(|| answers(structure, set.kind, &set.rays));
        let name = variant.name(scene, teams);
        match &first {
            None => first = Some((name, found)),
            Some((first, expected)) => {
                check_agreement(set.kind, &set.rays, (first, expected), (&name, &found))?;
            }
        }
    }
    Ok(first.map(|(_, answers)| answers).unwrap_or_default())
}

/// Holds the scene's answers against the reference's: all, or those to a sample if the reference is slow.
fn check_against_reference(
    scene: &PreparedScene<'_>,
    reference: &PreparedScene<'_>,
    set: &RaySet,
) -> Result<(), BenchmarkError> {
    let both = [structure_of(reference), structure_of(scene)];
    let sample = set.sample(affordable(structure_of(reference), set));
    let rays: Vec<_> = sample.into_iter().map(|index| set.rays[index]).collect();
    let [expected, found] = both.map(|structure| answers(structure, set.kind, &rays));
    let [expecting, finding] = both.map(|structure| structure.kind().name());
    check_agreement(set.kind, &rays, (expecting, &expected), (finding, &found))?;
    Ok(())
}

/// Times all variants on all sets. Everything takes turns, so that what slows the machine for a while slows all alike.
fn time(
    scene: &mut PreparedScene<'_>,
    sets: &[RaySet],
    variants: &[Variant],
    rounds: usize,
    teams: &mut [Team],
) -> Vec<RaySpeed> {
    // As many copies of a set as there are threads, so that all of these have as much to do as one has alone.
    let copies = |set: &RaySet, team: &Team| {
        let copies = team.threads().min(MOST_RAYS / set.rays.len().max(1)).max(1);
        set.rays.repeat(copies)
    };
    let copies = |set| teams.iter().map(|team| copies(set, team)).collect();
    let rays: Vec<Vec<_>> = sets.iter().map(copies).collect();

    let all = (0..sets.len()).flat_map(|set| variants.iter().map(move |variant| (set, variant)));
    let contestants: Vec<_> = all.collect();
    let timings = take_turns(contestants.len(), rounds.max(1), |number| {
        let (set, variant) = contestants[number];
        let (kind, rays) = (sets[set].kind, &rays[set][variant.team]);
        variant.prepare(scene);
        Some(teams[variant.team].measure(|| trace(structure_of(scene), kind, rays)))
    });
    let speed = |(&(set, variant), timing): (&(usize, &Variant), _)| {
        let rays = rays[set][variant.team].len() as u64;
        let speed = Speed { threads: teams[variant.team].threads(), rays, timing };
        RaySpeed { kind: sets[set].kind, level: variant.level, speed }
    };
    contestants.iter().zip(timings.into_iter().flatten()).map(speed).collect()
}
