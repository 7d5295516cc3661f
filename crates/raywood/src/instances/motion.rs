//! Instances that move while a picture is taken: a second transform, blends of the two, and what holds at all times between.
//!
//! Matrices are blended linearly, as in Glassner, "Spacetime Ray Tracing for Animation", 1988: every point of the object then moves on a straight line at an even pace, and the union of the boxes
//! at both ends is one around all between. What turns is no longer rigid meanwhile: halfway through a turn by an angle it is smaller across the axis by the cosine of half of that.

use super::transform::Matrix;
use super::{Transform, TransformError};
use crate::Aabb;
use crate::double::{Double3, cross, dot};

/// How an instance moves, besides its transform at time 0.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Its transform at time 1.
    later: Transform,
    /// What holds of the blended transforms of all times, at most: the condition, see [`Inverse`](super::transform::Inverse),
    pub(super) condition: f64,
    /// how much longer a coordinate may become, and how much on the way back,
    pub(super) stretch: f64,
    pub(super) stretch_back: f64,
    /// and the largest coordinate of the place of the object's origin.
    pub(super) distance: f64,
}

/// Blends count as singular beyond this condition: half of what transforms may have, so that rounding their coefficients leaves an inverse.
const WORST_CONDITION: f64 = (1 << 21) as f64;

/// Blends in a piece of time are looked at more closely while the bound of their condition exceeds this, which costs a wider margin,
const GOOD_CONDITION: f64 = 64.0;

/// in pieces of time not shorter than 2 to the minus this for the margin's sake, and this to find out whether there is an inverse at all.
const DEPTH_FOR_MARGIN: u32 = 5;
const DEPTH_FOR_INVERSE: u32 = 12;

/// What rounding coefficients of blends may make the bounds larger by: `docs/numerics.md`, "Motion".
const ROUNDED: f64 = 1.25;

impl Motion {
    /// That from one transform to another.
    pub(super) fn new(first: &Transform, later: &Transform) -> Result<Self, TransformError> {
        later.check()?;
        let (a, b) = (first.linear(), later.linear());
        let bound = InverseBound::over(&a, &b, 0).ok_or(TransformError::FlatBetween)?;
        let distance = |transform: &Transform| {
            let places = transform.rows().map(|row| f64::from(row[3]).abs());
            places.into_iter().fold(0.0, f64::max)
        };
        Ok(Self {
            later: *later,
            condition: ROUNDED * bound.condition,
            stretch: ROUNDED * first.stretch().max(later.stretch()),
            stretch_back: ROUNDED * bound.stretch,
            distance: ROUNDED * distance(first).max(distance(later)),
        })
    }

    /// The transform at a time.
    pub(super) fn transform(&self, first: &Transform, time: f32) -> Transform {
        first.blended(&self.later, time)
    }

    /// The box around the object at all times.
    pub(super) fn bounds(&self, first: &Transform, object: &Aabb) -> Aabb {
        let both = first.bounds(object).union(self.later.bounds(object));
        // Coefficients of blends are rounded: a corner so moves by one rounding of each.
        let reach = object.min.abs().max(object.max.abs()).to_array();
        let slack = [0, 1, 2].map(|axis| {
            let largest = |column: usize| {
                let [a, b] = [first, &self.later].map(|t| f64::from(t.rows()[axis][column]).abs());
                a.max(b)
            };
            let sum: f64 = (0..3).map(|axis| largest(axis) * f64::from(reach[axis])).sum();
            (sum + largest(3)) * ROUNDING
        });
        let [min, max] = [both.min, both.max].map(|corner| corner.to_array());
        let outwards = |number: f32, slack: f64| (f64::from(number) + slack) as f32;
        Aabb::new(
            [0, 1, 2].map(|axis| outwards(min[axis], -slack[axis]).next_down()),
            [0, 1, 2].map(|axis| outwards(max[axis], slack[axis]).next_up()),
        )
    }
}

/// What a coefficient is rounded by, and to spare.
const ROUNDING: f64 = f32::EPSILON as f64;

/// What holds at most of the inverses of all blends between two matrices.
#[derive(Clone, Copy)]
struct InverseBound {
    condition: f64,
    stretch: f64,
}

impl InverseBound {
    /// Over the time between two matrices; `None` if some have no inverse, or nearly so. The adjugate is of second degree in time and the determinant of third, so all their values lie between
    /// the least and the greatest of their Bezier coefficients; time is halved until these are close enough.
    fn over(a: &Matrix, b: &Matrix, depth: u32) -> Option<Self> {
        let bound = Self::at_once(a, b);
        let depth_for = match bound.condition {
            condition if condition <= GOOD_CONDITION => 0,
            condition if condition <= WORST_CONDITION => DEPTH_FOR_MARGIN,
            _ => DEPTH_FOR_INVERSE,
        };
        if depth < depth_for {
            let middle = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.5 * (a[i][j] + b[i][j])));
            let (first, second) =
                (Self::over(a, &middle, depth + 1)?, Self::over(&middle, b, depth + 1)?);
            return Some(Self {
                condition: first.condition.max(second.condition),
                stretch: first.stretch.max(second.stretch),
            });
        }
        (bound.condition <= WORST_CONDITION).then_some(bound)
    }

    fn at_once([a0, b0, c0]: &Matrix, [a1, b1, c1]: &Matrix) -> Self {
        // Products of what is linear in time: the coefficients of the cofactors, then of the determinant.
        let crossed = |p0, p1, q0, q1| {
            let mixed = [cross(p0, q1), cross(p1, q0)];
            [cross(p0, q0), [0, 1, 2].map(|i| 0.5 * (mixed[0][i] + mixed[1][i])), cross(p1, q1)]
        };
        let cofactors =
            [crossed(*b0, *b1, *c0, *c1), crossed(*c0, *c1, *a0, *a1), crossed(*a0, *a1, *b0, *b1)];
        let [first, second, third] = cofactors[0];
        let determinants = [
            dot(*a0, first),
            (dot(*a1, first) + 2.0 * dot(*a0, second)) / 3.0,
            (2.0 * dot(*a1, second) + dot(*a0, third)) / 3.0,
            dot(*a1, third),
        ];
        let (all_above, all_below) =
            (determinants.iter().all(|&d| d > 0.0), determinants.iter().all(|&d| d < 0.0));
        if !(all_above || all_below) {
            return Self { condition: f64::INFINITY, stretch: f64::INFINITY };
        }
        let least = determinants.iter().fold(f64::INFINITY, |least, d| least.min(d.abs()));

        let largest = |all: &[Double3]| {
            [0, 1, 2].map(|i| all.iter().fold(0.0, |most: f64, v| most.max(v[i].abs())))
        };
        let columns = cofactors.map(|all| largest(&all).map(|number| number / least));
        let rows = [largest(&[*a0, *a1]), largest(&[*b0, *b1]), largest(&[*c0, *c1])];
        let greatest = |sums: [f64; 3]| sums.into_iter().fold(0.0, f64::max);
        Self {
            condition: greatest(rows.map(|row| columns.iter().map(|c| dot(row, *c)).sum())),
            stretch: greatest([0, 1, 2].map(|i| columns.iter().map(|column| column[i]).sum())),
        }
    }
}

impl Transform {
    /// The transform at a time between this one, at 0, and another, at 1: each coefficient of the matrix is blended linearly, in double precision, and rounded once. Times beyond count as the
    /// nearest of these, NaN as 0. Points so move on straight lines at an even pace; what turns shrinks on the way, halfway by the cosine of half the angle.
    ///
    /// ```
    /// use raywood::Transform;
    ///
    /// let (here, there) = (Transform::IDENTITY, Transform::translation([2.0, 0.0, 0.0]));
    /// assert_eq!(here.blended(&there, 0.25), Transform::translation([0.5, 0.0, 0.0]));
    /// ```
    #[must_use]
    pub fn blended(&self, later: &Self, time: f32) -> Self {
        let time = f64::from(sound(time));
        let (first, later) = (self.rows(), later.rows());
        let entry = |i: usize, j: usize| {
            ((1.0 - time) * f64::from(first[i][j]) + time * f64::from(later[i][j])) as f32
        };
        let row = |i: usize| [entry(i, 0), entry(i, 1), entry(i, 2), entry(i, 3)];
        Self::from_rows([row(0), row(1), row(2)])
    }

    /// Whether an instance can move from here to another transform: see [`Instance::later`](super::Instance::later).
    ///
    /// # Errors
    ///
    /// Either is not finite or has no inverse, or a blend of them has none.
    pub fn check_motion(&self, later: &Self) -> Result<(), TransformError> {
        self.check()?;
        Motion::new(self, later).map(|_| ())
    }
}

/// A time that there is.
#[inline(always)]
pub(super) fn sound(time: f32) -> f32 {
    // NaN is not larger.
    if time > 0.0 { time.min(1.0) } else { 0.0 }
}
