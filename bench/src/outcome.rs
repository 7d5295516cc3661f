//! What comes of contestants: checked, then timed by turns. Whoever answers wrongly gets no time.

use raywood_lab::Timing;

/// Who takes longer than this for all questions takes part in fewer rounds, in the first [`FEW_ROUNDS`].
const SLOW_SECONDS: f64 = 0.6;
const FEW_ROUNDS: usize = 3;

/// What came of a contestant; `A` tells how well its answers agree with those expected.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome<A> {
    /// Its answers are right, and it took so long.
    Timed { timing: Timing, agreement: A },
    /// Its answers are wrong: how.
    Wrong(String),
    /// It is not there: why.
    Absent(String),
}

impl<A> Outcome<A> {
    /// Nanoseconds for each of so many questions, on all threads together; nothing for who has no time.
    pub(crate) fn nanoseconds(&self, questions: usize) -> Option<f64> {
        match self {
            Self::Timed { timing, .. } => Some(nanoseconds(timing, questions)),
            Self::Wrong(_) | Self::Absent(_) => None,
        }
    }
}

/// Nanoseconds for each of so many questions that took so long together.
pub(crate) fn nanoseconds(timing: &Timing, questions: usize) -> f64 {
    1e9 * timing.median() / questions.max(1) as f64
}

/// What comes of each contestant. `time` lets one answer and says how many seconds that took; `check` looks at the answers of the last time.
pub(crate) fn outcomes<T: ?Sized, A>(
    contestants: &mut [Box<T>],
    rounds: usize,
    mut time: impl FnMut(&mut T) -> f64,
    check: impl Fn(&T) -> Result<A, String>,
) -> Vec<Outcome<A>> {
    // Check, which also warms up, and see who is slow.
    let mut verdicts = Vec::new();
    let mut allowed = Vec::new();
    for contestant in contestants.iter_mut() {
        let time = time(&mut **contestant);
        let verdict = check(&**contestant);
        allowed.push(match verdict {
            Err(_) => 0,
            Ok(_) if time > SLOW_SECONDS => rounds.min(FEW_ROUNDS),
            Ok(_) => rounds,
        });
        verdicts.push(verdict);
    }

    // Take turns, every other round backwards, so that what slows the machine for a while slows all alike.
    let mut times = vec![Vec::new(); contestants.len()];
    for round in 0..rounds {
        for place in 0..contestants.len() {
            let turn = if round % 2 == 0 { place } else { contestants.len() - 1 - place };
            if round < allowed[turn] {
                times[turn].push(time(&mut *contestants[turn]));
            }
        }
    }

    // The answers that were timed are right too.
    let parts = contestants.iter().zip(verdicts).zip(times);
    parts
        .map(|((contestant, verdict), times)| match verdict.and_then(|_| check(&**contestant)) {
            Ok(agreement) => Outcome::Timed { timing: Timing::new(times), agreement },
            Err(wrong) => Outcome::Wrong(wrong),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Is right until it has answered so often, and counts how often it was asked.
    struct Decaying {
        right: usize,
        asked: usize,
    }

    #[test]
    fn wrong_answers_get_no_time_not_even_late_ones() {
        // Right, wrong, and wrong from the fourth time on.
        let mut contestants = [100, 0, 3].map(|right| Box::new(Decaying { right, asked: 0 }));
        let time = |contestant: &mut Decaying| {
            contestant.asked += 1;
            1e-9
        };
        let check = |contestant: &Decaying| {
            if contestant.asked <= contestant.right { Ok(()) } else { Err("wrong".to_owned()) }
        };
        let outcomes = outcomes(&mut contestants, 5, time, check);
        assert!(matches!(&outcomes[0], Outcome::Timed { timing, .. } if timing.rounds() == 5));
        assert_eq!(outcomes[0].nanoseconds(2), Some(0.5));
        for outcome in &outcomes[1..] {
            assert_eq!((outcome, outcome.nanoseconds(2)), (&Outcome::Wrong("wrong".into()), None));
        }
        // Who is wrong at once is not even timed.
        assert_eq!(contestants.map(|contestant| contestant.asked), [6, 1, 6]);
    }

    #[test]
    fn who_is_slow_takes_part_in_fewer_rounds() {
        let mut contestants = [1.0, 0.5].map(Box::new);
        let outcomes = outcomes(&mut contestants, 5, |seconds: &mut f64| *seconds, |_| Ok(()));
        let rounds = outcomes.iter().map(|outcome| match outcome {
            Outcome::Timed { timing, .. } => timing.rounds(),
            _ => 0,
        });
        assert_eq!(rounds.collect::<Vec<_>>(), [3, 5]);
    }
}
