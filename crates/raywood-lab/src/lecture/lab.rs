//! What experiments are made with: scenes, the rays that renderings of them have, and how much of everything.

use std::sync::OnceLock;

use raywood::Ray;
use raywood_render::{PreparedScene, default_view};
use raywood_scene::Scene;

use super::LectureError;
use crate::ray_sets::{RayKind, RaySet, ray_sets};

/// Rays that are kept together: the 8 x 8 pixels of a block.
const PACKET: usize = 64;

/// The scenes to measure, and whether there is time.
pub struct Lab<'a> {
    subjects: Vec<Subject<'a>>,
    quick: bool,
    threads: usize,
}

/// A scene to measure.
pub(super) struct Subject<'a> {
    pub(super) scene: &'a Scene,
    quick: bool,
    prepared: OnceLock<Result<Prepared<'a>, LectureError>>,
}

/// A scene with its default structure and its rays.
pub(super) struct Prepared<'a> {
    pub(super) scene: PreparedScene<'a>,
    sets: Vec<RaySet>,
}

impl<'a> Lab<'a> {
    /// Takes the scenes, of which the first is the one for experiments that need only one. `quick` measures less: for trying whether
    /// it all works. `threads` is the most that are used at a time, 0 for one per core.
    ///
    /// # Errors
    ///
    /// One of the scenes is empty.
    pub fn new(scenes: &'a [Scene], quick: bool, threads: usize) -> Result<Self, LectureError> {
        let threads = match threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            some => some,
        };
        let subjects = scenes.iter().map(|scene| Subject::new(scene, quick));
        Ok(Self { subjects: subjects.collect::<Result<_, _>>()?, quick, threads })
    }

    /// Whether there is little time.
    pub fn is_quick(&self) -> bool {
        self.quick
    }

    /// The most threads to use.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// What the scenes are called.
    pub fn scene_names(&self) -> impl Iterator<Item = &str> {
        self.subjects.iter().map(|subject| subject.scene.name.as_str())
    }

    pub(super) fn subjects(&self) -> &[Subject<'a>] {
        &self.subjects
    }

    /// How often times are taken.
    pub(super) fn rounds(&self) -> usize {
        if self.quick { 3 } else { 7 }
    }

    /// One of two numbers.
    pub(super) fn pick<T>(&self, quick: T, thorough: T) -> T {
        if self.quick { quick } else { thorough }
    }
}

impl<'a> Subject<'a> {
    pub(super) fn new(scene: &'a Scene, quick: bool) -> Result<Self, LectureError> {
        if scene.bounds().is_empty() {
            return Err(LectureError::EmptyScene { scene: scene.name.clone() });
        }
        Ok(Self { scene, quick, prepared: OnceLock::new() })
    }

    pub(super) fn name(&self) -> &str {
        &self.scene.name
    }

    /// The scene with its default structure and its rays, made when first asked for.
    pub(super) fn prepared(&self) -> Result<&Prepared<'a>, LectureError> {
        let prepared = self.prepared.get_or_init(|| Prepared::new(self.scene, self.quick));
        prepared.as_ref().map_err(Clone::clone)
    }

    /// Some rays of every kind, those of different kinds in turn.
    pub(super) fn mixed_rays(&self, count: usize) -> Result<Vec<KindRay>, LectureError> {
        let sets = &self.prepared()?.sets;
        let of_kind = |set: &RaySet| {
            let any_hit = set.kind.any_hit();
            let rays = set.sample(count.div_ceil(sets.len()));
            let ray = |index: usize| KindRay { ray: set.rays[index], any_hit };
            rays.into_iter().map(ray).collect::<Vec<_>>()
        };
        Ok(sets.iter().flat_map(of_kind).collect())
    }
}

/// A ray and its question.
#[derive(Clone, Copy)]
pub(super) struct KindRay {
    pub(super) ray: Ray,
    pub(super) any_hit: bool,
}

impl<'a> Prepared<'a> {
    fn new(scene: &'a Scene, quick: bool) -> Result<Self, LectureError> {
        let scene = PreparedScene::new(scene)?;
        // Whole packets as a picture of 1280 x 800 pixels has them, spread evenly over it.
        let (aspect, pixels, packets) =
            if quick { (1.6, 320 * 200, 32) } else { (1.6, 1280 * 800, 256) };
        let view = default_view(&scene, aspect);
        let mut sets = ray_sets(&scene, &view, aspect, pixels)?;
        for set in &mut sets {
            set.keep_runs(packets, PACKET);
        }
        Ok(Self { scene, sets })
    }

    /// The rays of a kind in whole packets; none where the eye sees too little.
    pub(super) fn rays(&self, kind: RayKind) -> &[Ray] {
        self.sets.iter().find(|set| set.kind == kind).map_or(&[], |set| &set.rays)
    }
}
