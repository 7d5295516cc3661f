//! Few boxes around many things, so that a ray that misses all of them misses all things.

use raywood::Aabb;

/// A division must leave less than this share of a box's surface, or it is not made.
const WORTHWHILE: f64 = 0.8;

/// At most so many boxes that together hold all the given ones, small where things lie apart: the largest is divided in two at the place that leaves
/// the least surface, again and again. O(n log n).
pub(crate) fn few_boxes(boxes: Vec<Aabb>, most: usize) -> Vec<Aabb> {
    let mut finished = Vec::new();
    let mut groups = vec![(union(&boxes), boxes)];
    groups.retain(|(bounds, _)| !bounds.is_empty());
    while !groups.is_empty() {
        if finished.len() + groups.len() == most {
            finished.extend(groups.into_iter().map(|(bounds, _)| bounds));
            break;
        }
        let by_area =
            |a: &usize, b: &usize| groups[*a].0.half_area().total_cmp(&groups[*b].0.half_area());
        let Some(largest) = (0..groups.len()).max_by(by_area) else { break };
        let (bounds, boxes) = groups.swap_remove(largest);
        match divide(&bounds, boxes) {
            Some(halves) => groups.extend(halves),
            None => finished.push(bounds),
        }
    }
    finished
}

/// Divides boxes in two groups along the longest axis of what holds them, if that is worthwhile.
fn divide(bounds: &Aabb, mut boxes: Vec<Aabb>) -> Option<[(Aabb, Vec<Aabb>); 2]> {
    let axis = (bounds.max - bounds.min).max_axis();
    let place = |b: &Aabb| b.min[axis] + b.max[axis];
    boxes.sort_by(|a, b| place(a).total_cmp(&place(b)));

    // What holds all from each place on, then what holds all before it.
    let mut after = boxes.clone();
    for number in (1..after.len()).rev() {
        after[number - 1] = after[number - 1].union(after[number]);
    }
    let mut before = Aabb::EMPTY;
    let mut best = (WORTHWHILE * bounds.half_area(), 0, Aabb::EMPTY);
    for number in 1..boxes.len() {
        before = before.union(boxes[number - 1]);
        let area = before.half_area() + after[number].half_area();
        if area < best.0 {
            best = (area, number, before);
        }
    }
    let (_, number, first) = best;
    if number == 0 {
        return None;
    }
    let others = boxes.split_off(number);
    Some([(first, boxes), (after[number], others)])
}

fn union(boxes: &[Aabb]) -> Aabb {
    boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union)
}

#[cfg(test)]
mod tests {
    use raywood::Vec3;

    use super::*;

    /// A cube with its centre there.
    fn cube(x: f32, y: f32, z: f32) -> Aabb {
        let center = Vec3::new(x, y, z);
        Aabb::new(center - Vec3::splat(0.5), center + Vec3::splat(0.5))
    }

    #[test]
    fn things_that_lie_apart_get_boxes_of_their_own() {
        let places = [0.0, 100.0, 30.0];
        let boxes = places.iter().flat_map(|&x| [cube(x, 0.0, 5.0), cube(x + 0.5, 0.0, 5.0)]);
        let mut found = few_boxes(boxes.collect(), 8);
        found.sort_by(|a, b| a.min.x.total_cmp(&b.min.x));
        let expected = [0.0, 30.0, 100.0].map(|x| cube(x, 0.0, 5.0).union(cube(x + 0.5, 0.0, 5.0)));
        assert_eq!(found, expected);
    }

    #[test]
    fn few_boxes_hold_many() {
        assert!(few_boxes(Vec::new(), 8).is_empty());
        let boxes: Vec<_> = (0..200)
            .map(|i| cube((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i * 71 % 89) as f32))
            .collect();
        let found = few_boxes(boxes.clone(), 8);
        assert!(found.len() <= 8);
        for b in boxes {
            assert!(found.iter().any(|f| f.union(b) == *f), "{b:?} is in none of {found:?}");
        }
    }
}
