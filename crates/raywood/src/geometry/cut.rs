//! Triangles cut off at planes: Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974.

use crate::double::{Double3, add, dot, scale, sub};

/// A plane by its normal, inwards, and an offset: `normal . p + offset >= 0` inside.
pub(crate) type Plane = (Double3, f64);

/// Whether something is left of a triangle that is cut off at each of six planes.
#[inline(never)]
pub(crate) fn is_left_of(corners: [Double3; 3], planes: &[Plane; 6]) -> bool {
    // Each plane adds a corner at most.
    let mut polygon = [[0.0; 3]; 9];
    let mut count = 3;
    polygon[..3].copy_from_slice(&corners);
    for (normal, offset) in planes {
        let height = |p: Double3| dot(*normal, p) + offset;
        let whole = polygon;
        let mut kept = 0;
        let mut keep = |corner: Double3| {
            if let Some(place) = polygon.get_mut(kept) {
                *place = corner;
                kept += 1;
            }
        };
        for number in 0..count {
            let (p, q) = (whole[number], whole[(number + 1) % count]);
            let (h, k) = (height(p), height(q));
            if h >= 0.0 {
                keep(p);
            }
            if (h < 0.0) != (k < 0.0) {
                keep(add(p, scale(h / (h - k), sub(q, p))));
            }
        }
        count = kept;
    }
    count > 0
}
