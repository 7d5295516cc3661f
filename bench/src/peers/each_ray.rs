//! The loop that drives every library without batches of its own: pieces of the set go to the threads, each traced ray by ray.

use std::borrow::Cow;
use std::hint::black_box;

use rayon::prelude::*;
use raywood::{Hit, Hit64, Ray};

use super::Tracer;
use crate::answers::Answers;
use crate::ray_sets::RaySet;

/// How many rays a task handles: enough that handing it out costs nothing in comparison.
pub(crate) const PIECE: usize = 1024;

/// An answer to a ray, as a library gives it.
pub(super) trait Answer: Copy + Default + Send + Sync {
    /// What such answers say.
    fn collect(answers: &[Self]) -> Answers;
}

impl Answer for bool {
    fn collect(answers: &[Self]) -> Answers {
        Answers::Any(answers.to_vec())
    }
}

impl Answer for Option<Hit> {
    fn collect(answers: &[Self]) -> Answers {
        Answers::closest(answers.iter().map(|hit| hit.map(|hit| hit.t)))
    }
}

impl Answer for Option<Hit64> {
    fn collect(answers: &[Self]) -> Answers {
        Answers::closest(answers.iter().map(|hit| hit.map(|hit| hit.t as f32)))
    }
}

/// A primitive and the distance at which it is hit, as much as the smaller libraries tell.
pub(super) type Found = Option<(u32, f32)>;

impl Answer for Found {
    fn collect(answers: &[Self]) -> Answers {
        Answers::closest(answers.iter().map(|found| found.map(|(_, t)| t)))
    }
}

/// A set of rays traced one by one.
pub(super) struct EachRay<R, A, F> {
    rays: Vec<R>,
    answers: Vec<A>,
    trace: F,
}

impl<R, A: Answer, F: Fn(&R) -> A> EachRay<R, A, F> {
    /// The rays converted, and what answers one of them.
    pub(super) fn new(set: &RaySet, convert: impl Fn(&Ray) -> R, trace: F) -> Self {
        let rays: Vec<_> = set.rays.iter().map(convert).collect();
        Self { answers: vec![A::default(); rays.len()], rays, trace }
    }

    /// The same as one of several tracers.
    pub(super) fn boxed<'a>(self) -> Option<Box<dyn Tracer + 'a>>
    where
        R: Copy + Send + Sync + 'a,
        A: 'a,
        F: Send + Sync + 'a,
    {
        Some(Box::new(self))
    }
}

impl<R: Copy + Send + Sync, A: Answer, F: Fn(&R) -> A + Send + Sync> Tracer for EachRay<R, A, F> {
    fn reset(&mut self) {
        warm(&self.rays);
        self.answers.fill(A::default());
    }

    fn trace(&mut self) {
        answer_each(&self.rays, &mut self.answers, &self.trace);
    }

    fn answers(&self) -> Answers {
        A::collect(&self.answers)
    }
}

/// A set of rays handed over whole to a library that traces batches.
pub(super) struct Batch<'a, R: Clone, A, F> {
    rays: Cow<'a, [R]>,
    answers: Vec<A>,
    trace: F,
}

impl<'a, R, A, F> Batch<'a, R, A, F>
where
    R: Copy + Send + Sync + 'a,
    A: Answer + 'a,
    F: Fn(&[R], &mut [A]) + Send + Sync + 'a,
{
    /// The rays, and what answers all of them.
    pub(super) fn boxed(rays: impl Into<Cow<'a, [R]>>, trace: F) -> Option<Box<dyn Tracer + 'a>> {
        let rays = rays.into();
        let answers = vec![A::default(); rays.len()];
        Some(Box::new(Self { rays, answers, trace }))
    }
}

impl<R, A, F> Tracer for Batch<'_, R, A, F>
where
    R: Copy + Send + Sync,
    A: Answer,
    F: Fn(&[R], &mut [A]) + Send + Sync,
{
    fn reset(&mut self) {
        warm(&self.rays);
        self.answers.fill(A::default());
    }

    fn trace(&mut self) {
        (self.trace)(&self.rays, &mut self.answers);
    }

    fn answers(&self) -> Answers {
        A::collect(&self.answers)
    }
}

/// Answers all questions one by one, pieces of them on each thread of the current rayon pool.
pub(super) fn answer_each<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(&Q) -> A + Sync,
) {
    let pieces = questions.par_chunks(PIECE).zip(answers.par_chunks_mut(PIECE));
    pieces.for_each(|(questions, answers)| {
        for (question, place) in questions.iter().zip(answers) {
            *place = answer(question);
        }
    });
}

/// Reads all questions.
pub(super) fn warm<Q: Copy>(questions: &[Q]) {
    for &question in questions {
        black_box(question);
    }
}
