//! Bump maps: heights as gray images, and the normals of such a landscape (Blinn, "Simulation of Wrinkled Surfaces", 1978).

/// How steep the landscape is, in texels of height for all of the way from black to white.
const HEIGHT: f32 = 4.0;

/// Whether an image holds heights rather than normals: it is gray.
pub(super) fn are_heights(texels: &[[u8; 4]]) -> bool {
    // What JPEG makes of gray is not quite gray.
    texels.iter().all(|[r, g, b, _]| r.abs_diff(*g) <= 4 && g.abs_diff(*b) <= 4)
}

/// Writes the normals of heights, as normal maps hold them: x to the right, y up, z out.
pub(super) fn to_normals(heights: &[[u8; 4]], width: u32, height: u32, normals: &mut [[u8; 4]]) {
    let (columns, rows) = (width as usize, height as usize);
    let at = |x: usize, y: usize| f32::from(heights[y * columns + x][1]) / 255.0;
    // The image goes on beyond its edges as if repeated.
    let (before, after) = (|i: usize, n: usize| (i + n - 1) % n, |i: usize, n: usize| (i + 1) % n);
    for y in 0..rows {
        for x in 0..columns {
            let right = at(after(x, columns), y) - at(before(x, columns), y);
            let up = at(x, before(y, rows)) - at(x, after(y, rows));
            let normal = [-0.5 * HEIGHT * right, -0.5 * HEIGHT * up, 1.0];
            let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt();
            let [x_byte, y_byte, z_byte] = normal.map(|n| (127.5 * (n / length + 1.0) + 0.5) as u8);
            normals[y * columns + x] = [x_byte, y_byte, z_byte, 255];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_leans_away_from_where_it_rises() {
        // Rises to the right and towards the top of the image, but for the seam.
        let gray = |x: u32, y: u32| (40 * x + 20 * (4 - y)) as u8;
        let heights: Vec<_> = (0..25).map(|i| [gray(i % 5, i / 5); 4]).collect();
        assert!(are_heights(&heights));
        let mut normals = vec![[0; 4]; 25];
        to_normals(&heights, 5, 5, &mut normals);
        let [x, y, z, _] = normals[2 * 5 + 2];
        assert!(x < 110 && y < 120 && x < y && z > 200, "{:?}", normals[12]);
        assert!(!are_heights(&normals));
    }
}
