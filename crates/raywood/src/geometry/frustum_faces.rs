//! The planes of a frustum's faces from its corners, for regions of both precisions.

use crate::double::{Double3, add, cross, dot, scale, sub};

/// The corners of each face, in order around it, where four are around the front and behind them, in the same order, four around the back.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Of each face the normal, inwards, and a point on its plane. The plane is along both diagonals, through the corners' mean.
pub(crate) fn frustum_faces(corners: [Double3; 8]) -> [(Double3, Double3); 6] {
    let middle = scale(0.125, corners.into_iter().fold([0.0; 3], add));
    FACES.map(|face| {
        let [a, b, c, d] = face.map(|number| corners[number]);
        let normal = cross(sub(c, a), sub(d, b));
        let center = scale(0.25, add(add(a, b), add(c, d)));
        let side = dot(normal, sub(middle, center)).signum();
        (scale(side, normal), center)
    })
}
