//! What structures say of rays, and that all must say the same.

use std::fmt;

use raywood::{Geometry, Hit, Ray, Structure};

use crate::RayKind;

/// What a structure says of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The closest hit, if any.
    Closest(Option<Hit>),
    /// Whether there is any hit.
    Any(bool),
}

impl Answer {
    /// Whether the ray hits.
    pub fn hits(&self) -> bool {
        match self {
            Self::Closest(hit) => hit.is_some(),
            Self::Any(blocked) => *blocked,
        }
    }

    /// Whether this means the same as another answer to the same ray.
    pub fn agrees_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Closest(Some(hit)), Self::Closest(Some(other))) => hit.agrees_with(other),
            (a, b) => a == b,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Closest(Some(Hit { t, u, v, primitive, .. })) => {
                write!(f, "hits primitive {primitive} at t = {t:?}, u = {u:?}, v = {v:?}")
            }
            Self::Any(true) => write!(f, "hits something"),
            Self::Closest(None) | Self::Any(false) => write!(f, "hits nothing"),
        }
    }
}

/// Two that disagree about a ray, which they must never do.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// What ray it is.
    pub kind: RayKind,
    /// The ray.
    pub ray: Ray,
    /// What the two are called.
    pub names: [String; 2],
    /// What they say.
    pub answers: [Answer; 2],
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, ray, names: [a, b], answers: [x, y] } = self;
        let (o, d) = (ray.origin, ray.direction);
        write!(f, "structures disagree about a {} ray: {a} {x}, {b} {y}", kind.name())?;
        write!(f, "; the ray starts at ({:?}, {:?}, {:?})", o.x, o.y, o.z)?;
        write!(f, " along ({:?}, {:?}, {:?})", d.x, d.y, d.z)?;
        write!(f, ", {:?} <= t < {:?}", ray.t_min, ray.t_max)
    }
}

impl std::error::Error for Mismatch {}

/// What the structure says of each ray, on the threads of the current rayon pool.
pub(crate) fn answers<G: Geometry>(
    structure: &Structure<G>,
    kind: RayKind,
    rays: &[Ray],
) -> Vec<Answer> {
    if kind.any_hit() {
        let mut blocked = vec![false; rays.len()];
        structure.occluded_batch(rays, &mut blocked);
        blocked.into_iter().map(Answer::Any).collect()
    } else {
        let mut hits = vec![None; rays.len()];
        structure.intersect_batch(rays, &mut hits);
        hits.into_iter().map(Answer::Closest).collect()
    }
}

/// Holds two lots of answers to the same rays against each other, each with the name of who gave them.
pub(crate) fn check_agreement(
    kind: RayKind,
    rays: &[Ray],
    a: (&str, &[Answer]),
    b: (&str, &[Answer]),
) -> Result<(), Box<Mismatch>> {
    for ((&ray, &x), &y) in rays.iter().zip(a.1).zip(b.1) {
        if !x.agrees_with(&y) {
            let names = [a.0.to_owned(), b.0.to_owned()];
            return Err(Box::new(Mismatch { kind, ray, names, answers: [x, y] }));
        }
    }
    Ok(())
}
