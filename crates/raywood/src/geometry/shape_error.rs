//! Why an array does not describe discs, capsules, cylinders or boxes.

use std::fmt;

/// Which of the shapes of an array is wrong, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeError {
    /// What the array is one of, such as `"disc"`.
    pub shape: &'static str,
    /// The first that is wrong.
    pub number: usize,
    /// What is wrong with it.
    pub problem: ShapeProblem,
}

/// What is wrong with a shape.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShapeProblem {
    /// A coordinate is NaN or infinite.
    NotFinite,
    /// The radius is NaN, infinite, zero or negative.
    Radius(f32),
    /// The normal is zero, so that it tells no direction.
    NoDirection,
    /// Both ends are one point, so that caps across the axis face nowhere.
    NoLength,
    /// A least coordinate is greater than the greatest.
    Empty,
    /// It reaches beyond the largest number of single precision.
    TooLarge,
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} ", self.shape, self.number)?;
        match self.problem {
            ShapeProblem::NotFinite => f.write_str("has coordinates that are NaN or infinite"),
            ShapeProblem::Radius(radius) => {
                write!(f, "has radius {radius}: it must be finite and greater than zero")
            }
            ShapeProblem::NoDirection => f.write_str("has a normal of length zero"),
            ShapeProblem::NoLength => f.write_str(
                "has both ends at the same point, so that its caps face nowhere: make it a sphere or a capsule",
            ),
            ShapeProblem::Empty => {
                f.write_str("is empty: a least coordinate is greater than the greatest")
            }
            ShapeProblem::TooLarge => {
                write!(f, "reaches beyond {:e}, the largest number of single precision", f32::MAX)
            }
        }
    }
}

impl std::error::Error for ShapeError {}

/// Refuses shapes with a problem, naming the first.
pub(super) fn check<T>(
    shape: &'static str,
    shapes: &[T],
    problem: impl Fn(&T) -> Option<ShapeProblem>,
) -> Result<(), ShapeError> {
    let first = shapes.iter().enumerate().find_map(|(number, it)| Some((number, problem(it)?)));
    match first {
        Some((number, problem)) => Err(ShapeError { shape, number, problem }),
        None => Ok(()),
    }
}

/// What is wrong with a radius, if anything.
pub(super) fn radius_problem(radius: f32) -> Option<ShapeProblem> {
    (!(radius > 0.0 && radius.is_finite())).then_some(ShapeProblem::Radius(radius))
}
