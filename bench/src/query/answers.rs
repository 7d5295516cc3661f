//! Answers to sets of questions, and how far a peer's may be from those expected before they count as wrong.
//!
//! What is tolerated, and why:
//!
//! - **Distances** of closest points differ by at most [`DISTANCE`] of themselves and [`ROUNDING`] of the largest coordinate, which is what single precision makes of
//!   coordinates: all of them, without exception.
//! - **Crossings** are whole numbers. For [`MISCOUNTS`] of all rays, and one ray, they may differ: where a ray passes an edge, tests that are not watertight count
//!   both triangles or none.

/// By how much distances may differ, as a share of the expected one.
const DISTANCE: f64 = 1e-4;

/// By how much more, as a share of the largest coordinate: four units in the last place.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// The share of rays whose crossings may be miscounted.
const MISCOUNTS: f64 = 100e-6;

/// What a set of questions was answered, in its order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Answers {
    /// The distance of each point from the closest one.
    Distances(Vec<f64>),
    /// How often each ray crosses the surface.
    Crossings(Vec<usize>),
}

/// What should be answered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Expected {
    pub(crate) answers: Answers,
    /// The largest coordinate of the mesh.
    pub(crate) reach: f64,
}

/// How answers compare with those expected.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Agreement {
    pub(crate) questions: usize,
    /// How many answers differ by more than is tolerated.
    pub(crate) differing: usize,
    /// How many may.
    pub(crate) allowed: usize,
    /// The question whose answer differs most, with what is expected and what was answered.
    worst: Option<(usize, f64, f64)>,
}

impl Agreement {
    /// Compares answers.
    ///
    /// # Errors
    ///
    /// The answers are not as many, or to another question.
    pub(crate) fn of(expected: &Expected, found: &Answers) -> Result<Self, String> {
        let numbers = |counts: &[usize]| counts.iter().map(|&n| n as f64).collect::<Vec<_>>();
        let rounding = ROUNDING * expected.reach;
        match (&expected.answers, found) {
            (Answers::Distances(expected), Answers::Distances(found)) => {
                Self::compare(expected, found, 0, |distance| DISTANCE * distance + rounding)
            }
            (Answers::Crossings(expected), Answers::Crossings(found)) => {
                let allowed = (MISCOUNTS * expected.len() as f64) as usize + 1;
                Self::compare(&numbers(expected), &numbers(found), allowed, |_| 0.0)
            }
            _ => Err("answers to another question".to_owned()),
        }
    }

    fn compare(
        expected: &[f64],
        found: &[f64],
        allowed: usize,
        tolerance: impl Fn(f64) -> f64,
    ) -> Result<Self, String> {
        let (questions, answered) = (expected.len(), found.len());
        if questions != answered {
            return Err(format!("{answered} answers to {questions} questions"));
        }
        let mut agreement = Self { questions, allowed, ..Self::default() };
        let mut most = 0.0;
        for (number, (&expected, &found)) in expected.iter().zip(found).enumerate() {
            let excess = (found - expected).abs() - tolerance(expected);
            // NaN is far from anything.
            let excess = if excess.is_nan() { f64::INFINITY } else { excess };
            if excess > 0.0 {
                agreement.differing += 1;
            }
            if excess > most {
                most = excess;
                agreement.worst = Some((number, expected, found));
            }
        }
        Ok(agreement)
    }

    /// Whether the answers are right, as far as is asked for.
    ///
    /// # Errors
    ///
    /// How they are wrong.
    pub(crate) fn verdict(&self) -> Result<(), String> {
        let Self { questions, differing, allowed, worst } = *self;
        match worst {
            Some((number, expected, found)) if differing > allowed => Err(format!(
                "{differing} of {questions} answers differ, most of all that to number {number}: \
                 {found} instead of {expected}"
            )),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(expected: Answers, found: Answers) -> Result<(), String> {
        let expected = Expected { answers: expected, reach: 10.0 };
        Agreement::of(&expected, &found).and_then(|agreement| agreement.verdict())
    }

    #[test]
    fn every_distance_has_to_be_right() {
        let distances = |last: f64| {
            let mut distances = vec![2.0; 100_000];
            distances.push(last);
            Answers::Distances(distances)
        };
        for right in [2.0, 2.000_199, 1.999_801, 2.000_204] {
            assert_eq!(verdict(distances(2.0), distances(right)), Ok(()), "{right}");
        }
        for wrong in [2.000_21, 1.999_79, 0.0, -2.0, f64::INFINITY, f64::NAN] {
            assert!(verdict(distances(2.0), distances(wrong)).is_err(), "{wrong}");
        }
        // The rounding of coordinates counts where there is no distance.
        assert_eq!(verdict(distances(0.0), distances(4e-6)), Ok(()));
        assert_eq!(
            verdict(distances(0.0), distances(1e-5)).expect_err("too far"),
            "1 of 100001 answers differ, most of all that to number 100000: 0.00001 instead of 0"
        );
    }

    #[test]
    fn few_rays_may_be_miscounted() {
        let crossings = |wrong: usize| {
            Answers::Crossings((0..30_000).map(|i| i % 5 + usize::from(i < wrong)).collect())
        };
        assert_eq!(verdict(crossings(0), crossings(4)), Ok(()));
        assert!(verdict(crossings(0), crossings(5)).is_err());
        assert!(verdict(crossings(5), crossings(0)).is_err());
    }

    #[test]
    fn answers_to_something_else_are_errors() {
        let one = || Answers::Distances(vec![1.0]);
        assert!(verdict(one(), Answers::Distances(vec![1.0, 1.0])).is_err());
        assert!(verdict(one(), Answers::Crossings(vec![1])).is_err());
    }
}
