//! The loop that asks any library one question after the other: pieces of the set go to the threads.

use super::Finder;
use crate::peers::each_ray::{answer_each, warm};
use crate::query::answers::Answers;

/// Questions asked one by one.
pub(super) struct OneByOne<Q, A, F, R> {
    questions: Vec<Q>,
    answers: Vec<A>,
    find: F,
    read: R,
}

impl<Q, A, F, R> OneByOne<Q, A, F, R>
where
    Q: Copy + Send + Sync,
    A: Copy + Default + Send + Sync,
    F: Fn(&Q) -> A + Send + Sync,
    R: Fn(&[Q], &[A]) -> Answers + Send,
{
    /// The questions, what answers one of them by the clock, and what makes sense of the answers afterwards.
    pub(super) fn boxed<'a>(questions: Vec<Q>, find: F, read: R) -> Box<dyn Finder + 'a>
    where
        Self: 'a,
    {
        Box::new(Self { answers: vec![A::default(); questions.len()], questions, find, read })
    }
}

impl<Q, A, F, R> Finder for OneByOne<Q, A, F, R>
where
    Q: Copy + Send + Sync,
    A: Copy + Default + Send + Sync,
    F: Fn(&Q) -> A + Send + Sync,
    R: Fn(&[Q], &[A]) -> Answers + Send,
{
    fn reset(&mut self) {
        warm(&self.questions);
        self.answers.fill(A::default());
    }

    fn find(&mut self) {
        answer_each(&self.questions, &mut self.answers, &self.find);
    }

    fn answers(&self) -> Answers {
        (self.read)(&self.questions, &self.answers)
    }
}

/// Crossings as each was counted.
pub(super) fn counts<Q>(_: &[Q], counts: &[usize]) -> Answers {
    Answers::Crossings(counts.to_vec())
}
