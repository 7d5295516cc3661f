//! Answers to sets of rays, and how far a peer's may be from the reference's before they count as wrong.
//!
//! What is tolerated, and why:
//!
//! - **Hit or miss**: [`MISMATCHES`] of all rays, and one ray more so that small sets are not ruled by chance. Tests that are not
//!   watertight let rays through at edges, and hit where exact arithmetic passes by; single precision decides such rays by chance.
//! - **Distances**: where both hit, they differ by at most [`DISTANCE`] of the reference's. All but [`FAR_OFF`] of the rays that hit must
//!   comply, and one ray. The others have slipped through an edge to what lies behind it, or meet a triangle at grazing angles or just off the
//!   ray's origin, where the rounding of coordinates alone moves the hit by more.

/// The share of rays for which hit and miss may be confused.
const MISMATCHES: f64 = 5e-6;

/// By how much distances may differ, as a share of the reference's.
const DISTANCE: f32 = 1e-4;

/// The share of rays for which they may differ by more.
const FAR_OFF: f64 = 100e-6;

/// What a set of rays was answered, in its order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Answers {
    /// The distance of each closest hit, infinite where there is none.
    Closest(Vec<f32>),
    /// Whether each ray hits anything.
    Any(Vec<bool>),
}

impl Answers {
    /// Closest hits, `None` where there is none.
    pub(crate) fn closest(distances: impl Iterator<Item = Option<f32>>) -> Self {
        Self::Closest(distances.map(|t| t.unwrap_or(f32::INFINITY)).collect())
    }

    /// How many rays hit something.
    pub(crate) fn hits(&self) -> usize {
        match self {
            Self::Closest(distances) => distances.iter().filter(|&&t| is_hit(t)).count(),
            Self::Any(occluded) => occluded.iter().filter(|&&occluded| occluded).count(),
        }
    }
}

/// Whether a distance tells of a hit; NaN does, and is far from any.
fn is_hit(t: f32) -> bool {
    t != f32::INFINITY
}

/// How answers compare with the reference's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Agreement {
    /// The rays.
    pub(crate) rays: usize,
    /// How many of them hit by the reference.
    pub(crate) expected_hits: usize,
    /// How many hit by the peer.
    pub(crate) hits: usize,
    /// How many of them hit by one and miss by the other.
    pub(crate) mismatches: usize,
    /// How many hit by both, but at distances that differ by more than is tolerated.
    pub(crate) far_off: usize,
}

impl Agreement {
    /// Compares answers.
    ///
    /// # Errors
    ///
    /// The answers are not as many, or not of the same kind.
    pub(crate) fn of(expected: &Answers, found: &Answers) -> Result<Self, String> {
        let (rays, answered) = (expected.len(), found.len());
        if rays != answered {
            return Err(format!("{answered} answers to {rays} rays"));
        }
        let mut agreement =
            Self { rays, expected_hits: expected.hits(), hits: found.hits(), ..Self::default() };
        match (expected, found) {
            (Answers::Closest(expected), Answers::Closest(found)) => {
                for (&expected, &found) in expected.iter().zip(found) {
                    if is_hit(expected) != is_hit(found) {
                        agreement.mismatches += 1;
                    } else if is_hit(expected) && !near(expected, found) {
                        agreement.far_off += 1;
                    }
                }
            }
            (Answers::Any(expected), Answers::Any(found)) => {
                let pairs = expected.iter().zip(found);
                agreement.mismatches = pairs.filter(|(expected, found)| expected != found).count();
            }
            _ => return Err("answers to another question".to_owned()),
        }
        Ok(agreement)
    }

    /// Whether the answers are right, as far as is asked for.
    ///
    /// # Errors
    ///
    /// How they are wrong.
    pub(crate) fn verdict(&self) -> Result<(), String> {
        let Self { rays, expected_hits, hits, mismatches, far_off } = *self;
        let allowed = |share: f64, of: usize| (share * of as f64) as usize + 1;
        if mismatches > allowed(MISMATCHES, rays) {
            return Err(format!(
                "{hits} of {rays} rays hit, {expected_hits} should; {mismatches} differ"
            ));
        }
        if far_off > allowed(FAR_OFF, expected_hits) {
            return Err(format!(
                "{far_off} of {expected_hits} distances are off by more than {DISTANCE} of \
                 themselves"
            ));
        }
        Ok(())
    }
}

impl Answers {
    fn len(&self) -> usize {
        match self {
            Self::Closest(distances) => distances.len(),
            Self::Any(occluded) => occluded.len(),
        }
    }
}

/// Whether two distances differ by no more than is tolerated; NaN differs from everything.
fn near(expected: f32, found: f32) -> bool {
    (found - expected).abs() <= DISTANCE * expected.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAYS: usize = 400_000;

    fn distances() -> Vec<f32> {
        (0..RAYS).map(|i| if i % 4 == 0 { f32::INFINITY } else { 1.0 + i as f32 }).collect()
    }

    /// The verdict about the distances with the first `count` hits changed.
    fn verdict(count: usize, change: fn(f32) -> f32) -> Result<(), String> {
        let expected = Answers::Closest(distances());
        let mut found = distances();
        found.iter_mut().filter(|t| t.is_finite()).take(count).for_each(|t| *t = change(*t));
        Agreement::of(&expected, &Answers::Closest(found)).expect("comparable").verdict()
    }

    #[test]
    fn few_misses_are_tolerated_and_more_are_not() {
        // 5 ppm of 400,000 rays, and one.
        assert_eq!(verdict(3, |_| f32::INFINITY), Ok(()));
        let said = verdict(4, |_| f32::INFINITY).expect_err("too many misses");
        assert_eq!(said, "299996 of 400000 rays hit, 300000 should; 4 differ");
    }

    #[test]
    fn hits_that_make_up_for_misses_do_not_hide_them() {
        let expected = Answers::Closest(distances());
        let mut found = distances();
        // As many false hits as misses: the counts are equal.
        for i in 0..10 {
            found.swap(4 * i, 4 * i + 1);
        }
        let agreement = Agreement::of(&expected, &Answers::Closest(found)).expect("comparable");
        assert_eq!((agreement.hits, agreement.mismatches), (agreement.expected_hits, 20));
        assert!(agreement.verdict().is_err());
    }

    #[test]
    fn distances_may_differ_a_little_or_rarely() {
        assert_eq!(verdict(RAYS, |t| t * 1.00009), Ok(()));
        assert!(verdict(RAYS, |t| t * 1.00011).is_err());
        // 100 ppm of 300,000 hits, and one.
        assert_eq!(verdict(31, |t| t * 2.0), Ok(()));
        assert!(verdict(32, |t| t * 2.0).is_err());
        assert!(verdict(32, |t| t * 0.5).is_err());
        assert!(verdict(32, |_| f32::NAN).is_err());
        assert!(verdict(32, |_| -1.0).is_err());
    }

    #[test]
    fn wrong_any_hit_answers_are_wrong_whichever_way() {
        let expected: Vec<_> = (0..RAYS).map(|i| i % 2 == 0).collect();
        for place in [0, 1] {
            let mut found = expected.clone();
            let flip = |found: &mut Vec<bool>, count: usize| {
                (0..count).for_each(|i| found[2 * i + place] = place == 1);
            };
            let verdict = |found: &[bool]| {
                let found = Answers::Any(found.to_vec());
                Agreement::of(&Answers::Any(expected.clone()), &found)
                    .expect("comparable")
                    .verdict()
            };
            flip(&mut found, 3);
            assert_eq!(verdict(&found), Ok(()));
            flip(&mut found, 4);
            assert!(verdict(&found).is_err());
        }
    }

    #[test]
    fn answers_to_something_else_are_errors() {
        let closest = Answers::Closest(vec![1.0, 2.0]);
        assert!(Agreement::of(&closest, &Answers::Closest(vec![1.0])).is_err());
        assert!(Agreement::of(&closest, &Answers::Any(vec![true, true])).is_err());
    }
}
