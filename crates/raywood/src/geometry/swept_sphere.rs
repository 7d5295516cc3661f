//! When a moving sphere first touches a triangle: the moment when its centre enters the triangle thickened by the radius, which is bounded by two shifted
//! copies of the triangle, a cylinder around each edge and a sphere around each corner. In double precision.

use super::closest_to_zero;
use crate::double::{Double3, add, cross, dot, scale, sub};

/// The least `t >= t_min` at which a point, at zero for `t = 0` and moving by `direction` per unit of `t`, is no further than `radius` from the triangle, and
/// the closest point of the triangle then. `None` if there is none.
pub(crate) fn swept_sphere(
    corners: [Double3; 3],
    direction: Double3,
    radius: f64,
    t_min: f64,
) -> Option<(f64, Double3)> {
    let [a, b, c] = corners;
    let start = scale(t_min, direction);
    let (beside, ..) = closest_to_zero([sub(a, start), sub(b, start), sub(c, start)]);
    if dot(beside, beside) <= radius * radius {
        return Some((t_min, add(start, beside)));
    }
    let mut first = Contact { t_min, t: f64::INFINITY, point: [0.0; 3] };

    // The face, shifted to the side from which the point comes.
    let normal = cross(sub(b, a), sub(c, a));
    let (length, speed, height) =
        (dot(normal, normal).sqrt(), dot(normal, direction), dot(normal, a));
    if length > 0.0 && speed != 0.0 {
        let side = -speed.signum();
        let t = (height + side * radius * length) / speed;
        let point = sub(scale(t, direction), scale(side * radius / length, normal));
        let weight =
            |from: Double3, to: Double3| dot(normal, cross(sub(from, point), sub(to, point)));
        if weight(a, b) >= 0.0 && weight(b, c) >= 0.0 && weight(c, a) >= 0.0 {
            first.offer(t, point);
        }
    }

    for (from, to) in [(a, b), (b, c), (c, a)] {
        // The corner.
        if let Some(t) = entry(from, direction, radius) {
            first.offer(t, from);
        }

        // The edge: what happens across it is the same with a sphere, in a plane.
        let edge = sub(to, from);
        let squared = dot(edge, edge);
        if squared > 0.0 {
            let across = |v: Double3| sub(v, scale(dot(v, edge) / squared, edge));
            if let Some(t) = entry(across(from), across(direction), radius) {
                let share = dot(sub(scale(t, direction), from), edge) / squared;
                if (0.0..=1.0).contains(&share) {
                    first.offer(t, add(from, scale(share, edge)));
                }
            }
        }
    }
    first.t.is_finite().then_some((first.t, first.point))
}

/// The first contact so far.
struct Contact {
    t_min: f64,
    t: f64,
    point: Double3,
}

impl Contact {
    fn offer(&mut self, t: f64, point: Double3) {
        if t >= self.t_min && t < self.t {
            (self.t, self.point) = (t, point);
        }
    }
}

/// When a point that starts at zero enters a sphere.
fn entry(center: Double3, direction: Double3, radius: f64) -> Option<f64> {
    let squared = dot(direction, direction);
    // From the point of the way that is nearest to the centre: the root is then that of a difference of small numbers.
    let nearest = dot(center, direction) / squared;
    let beside = sub(center, scale(nearest, direction));
    let remaining = radius * radius - dot(beside, beside);
    // NaN, of a direction along the edge, is no entry.
    (remaining >= 0.0).then(|| nearest - (remaining / squared).sqrt())
}
