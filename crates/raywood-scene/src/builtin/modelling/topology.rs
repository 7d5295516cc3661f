//! Checks on surfaces: whether they are closed, and the volume that they hold.

use std::collections::HashMap;

use raywood::Vec3;

use super::Part;

/// Whether a surface is closed and turned the same way all over: every edge is used once in each direction. Vertices at
/// exactly the same position count as one, so sharp edges are no gaps.
pub fn is_closed(part: &Part) -> bool {
    let bits = |p: Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut uses: HashMap<_, i32> = HashMap::new();
    for triangle in &part.triangles {
        let corners = triangle.map(|i| bits(part.positions[i as usize]));
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            // Count an edge up in one direction and down in the other; a second use in one direction is remembered.
            let (key, step) = if a < b { ((a, b), 1) } else { ((b, a), 1 << 16) };
            *uses.entry(key).or_default() += step;
        }
    }
    !uses.is_empty() && uses.values().all(|&count| count == 1 + (1 << 16))
}

/// The volume inside a closed surface: positive when its front is outside.
pub fn signed_volume(part: &Part) -> f32 {
    let six_volumes = part.triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|i| part.positions[i as usize].to_array().map(f64::from));
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    });
    (six_volumes.sum::<f64>() / 6.0) as f32
}
