//! Dividing references at a plane.

use super::super::driver::{Around, Split};
use super::super::{PackedAabb, Primitive, Work};
use super::bins::PIECE;
use super::cut::{Plane, Side, cut};
use crate::Geometry;

/// Where a reference goes, and the boxes that it has there.
#[derive(Clone, Copy)]
enum Place {
    Left(PackedAabb),
    Right(PackedAabb),
    Both([PackedAabb; 2]),
}

impl Place {
    /// Where a reference goes that the plane crosses, if it is to be cut.
    fn of<G: Geometry>(geometry: &G, plane: Plane, reference: &Primitive) -> Self {
        match cut(geometry, plane, reference) {
            Some([left, right]) => match (left.is_empty(), right.is_empty()) {
                (false, false) => Self::Both([left, right]),
                (false, true) => Self::Left(left),
                (true, false) => Self::Right(right),
                // Nothing of the primitive is here, as it turns out; but some reference to it there must be.
                (true, true) => Self::Left(*reference.bounds()),
            },
            None if reference.center()[plane.axis] < plane.place => Self::Left(*reference.bounds()),
            None => Self::Right(*reference.bounds()),
        }
    }
}

/// What one side of the plane has.
struct Half {
    /// The box around all that may come to it.
    bounds: PackedAabb,
    /// How many may come to it.
    count: usize,
    /// What is around those that came.
    around: Around,
}

impl Half {
    const NOTHING: Self = Self { bounds: PackedAabb::EMPTY, count: 0, around: Around::NOTHING };

    /// Expects a reference with such a box.
    fn expect(&mut self, bounds: &PackedAabb) {
        self.bounds.grow(bounds);
        self.count += 1;
    }

    /// Takes a reference.
    fn take(&mut self, reference: Primitive) -> Primitive {
        self.around.include(&reference);
        reference
    }

    fn cost(&self) -> f64 {
        self.bounds.half_area() * self.count as f64
    }

    /// What it costs with one reference less.
    fn cost_of_fewer(&self) -> f64 {
        self.bounds.half_area() * (self.count - 1) as f64
    }

    /// What it costs where one of the references is whole.
    fn cost_with(&self, whole: &PackedAabb) -> f64 {
        self.bounds.union(*whole).half_area() * self.count as f64
    }
}

/// Divides the first `count` references at a plane, the left ones first, and tells how many there are then. Those that the plane crosses are cut, or put to one
/// side as a whole where that costs less (reference unsplitting). `None`, with nothing changed, where there is no room for as many more as it crosses, or where
/// all would lie on one side; or where the work is cancelled.
pub(super) fn partition<G: Geometry>(
    geometry: &G,
    references: &mut [Primitive],
    count: usize,
    plane: Plane,
    work: Work<'_>,
) -> Option<(Split, usize)> {
    let is_crossed = |reference: &&Primitive| plane.side_of(reference.bounds()) == Side::Both;
    let crossed = references[..count].iter().filter(is_crossed).count();
    if crossed > references.len() - count {
        return None;
    }
    let (mut left, mut right) = (Half::NOTHING, Half::NOTHING);
    let mut crossing = Vec::with_capacity(crossed);
    for (number, reference) in references[..count].iter().enumerate() {
        if number % PIECE == 0 {
            work.ask().ok()?;
        }
        let place = match plane.side_of(reference.bounds()) {
            Side::Left => Place::Left(*reference.bounds()),
            Side::Right => Place::Right(*reference.bounds()),
            Side::Both => {
                let place = Place::of(geometry, plane, reference);
                crossing.push((*reference, place));
                place
            }
        };
        match place {
            Place::Left(bounds) => left.expect(&bounds),
            Place::Right(bounds) => right.expect(&bounds),
            Place::Both(parts) => {
                left.expect(&parts[0]);
                right.expect(&parts[1]);
            }
        }
    }
    if left.count == 0 || right.count == 0 {
        return None;
    }

    // What lies on one side goes to one end, so that there is a gap for the others.
    let (mut left_end, mut next, mut right_start) = (0, 0, count);
    while next < right_start {
        match plane.side_of(references[next].bounds()) {
            Side::Left => {
                left.take(references[next]);
                references.swap(next, left_end);
                left_end += 1;
                next += 1;
            }
            Side::Right => {
                right.take(references[next]);
                right_start -= 1;
                references.swap(next, right_start);
            }
            Side::Both => next += 1,
        }
    }

    // Each of these takes one place of the gap, and if it is cut one behind all.
    let mut total = count;
    for (reference, place) in crossing {
        let number = reference.number();
        match unsplit(&mut left, &mut right, reference.bounds(), place) {
            Place::Left(bounds) => {
                references[left_end] = left.take(Primitive::new(number, bounds));
                left_end += 1;
            }
            Place::Right(bounds) => {
                right_start -= 1;
                references[right_start] = right.take(Primitive::new(number, bounds));
            }
            Place::Both(parts) => {
                references[left_end] = left.take(Primitive::new(number, parts[0]));
                references[total] = right.take(Primitive::new(number, parts[1]));
                left_end += 1;
                total += 1;
            }
        }
    }
    debug_assert!(left_end == right_start && 0 < left_end && left_end < total);
    let (left, right) = (left.around, right.around);
    Some((Split { left_count: left_end, left, right, in_spare: false }, total))
}

/// Leaves a reference whole, on one side, where that costs less than to cut it. Both sides expect a part of it.
fn unsplit(left: &mut Half, right: &mut Half, whole: &PackedAabb, place: Place) -> Place {
    let Place::Both(_) = place else { return place };
    let cut = left.cost() + right.cost();
    let only_left = left.cost_with(whole) + right.cost_of_fewer();
    let only_right = left.cost_of_fewer() + right.cost_with(whole);
    if only_left < cut && only_left <= only_right && right.count > 1 {
        left.bounds.grow(whole);
        right.count -= 1;
        Place::Left(*whole)
    } else if only_right < cut && left.count > 1 {
        right.bounds.grow(whole);
        left.count -= 1;
        Place::Right(*whole)
    } else {
        place
    }
}
