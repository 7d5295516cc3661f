//! How much of a surface a ray stands for: a cone as wide as a pixel, which widens on its way (Akenine-Moeller et al., "Texture Level of
//! Detail Strategies for Real-Time Ray Tracing", 2019), and the ellipse in which it meets a surface.

use raywood::Vec3;

/// The two axes of the ellipse in which a cone of some width meets a surface, which it meets in direction `direction` (unit length): along the direction, and
/// across. `normal` is the surface's, of unit length, on either side. Without branches, as all here, so that a loop over many becomes vectors.
#[inline(always)]
pub(crate) fn footprint(direction: Vec3, normal: Vec3, width: f32) -> [Vec3; 2] {
    /// A surface seen from its edge has no end: here it is sixty-four times as long as it is wide.
    const LEAST_COSINE: f32 = 1.0 / 64.0;
    let cosine = direction.dot(normal);
    let along = direction - cosine * normal;
    // Seen head-on any direction will do.
    let any = if normal.x.abs() < 0.5 { Vec3::X } else { Vec3::Y };
    let is_head_on = along.dot(along) < 1e-12;
    let along = if is_head_on { normal.cross(any) } else { along };
    let along = (1.0 / along.dot(along).sqrt()) * along;
    let cosine = if cosine < 0.0 { -cosine } else { cosine };
    let length = width / if cosine > LEAST_COSINE { cosine } else { LEAST_COSINE };
    [length * along, width * normal.cross(along)]
}

/// How texture coordinates change along two vectors in the plane of a triangle; not at all if it has no area.
///
/// `edges` lead from the first corner to the others, `steps` tell by how much the texture coordinates change along them.
#[inline(always)]
pub(crate) fn change(edges: [Vec3; 2], steps: [[f32; 2]; 2], along: [Vec3; 2]) -> [[f32; 2]; 2] {
    let normal = edges[0].cross(edges[1]);
    let area = normal.dot(normal);
    let reciprocal = if area > 0.0 { 1.0 / area } else { 0.0 };
    // What is perpendicular to one edge and has a product of one with the other.
    let first = reciprocal * edges[1].cross(normal);
    let second = reciprocal * normal.cross(edges[0]);
    let one = |along: Vec3| {
        let (a, b) = (along.dot(first), along.dot(second));
        [a * steps[0][0] + b * steps[1][0], a * steps[0][1] + b * steps[1][1]]
    };
    [one(along[0]), one(along[1])]
}

/// The logarithm to base 2 of a positive number, off by at most a twelfth: the exponent, and the mantissa as if it were straight between powers of two.
#[inline(always)]
pub(crate) fn rough_log2(x: f32) -> f32 {
    const MANTISSA: f32 = (1u32 << 23) as f32;
    x.to_bits() as f32 / MANTISSA - 127.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_cone_meets_a_longer_ellipse() {
        let down = Vec3::new(0.6, 0.0, -0.8);
        let [along, across] = footprint(down, Vec3::Z, 0.1);
        assert!((along - Vec3::new(0.125, 0.0, 0.0)).length() < 1e-6, "{along:?}");
        assert!((across.length() - 0.1).abs() < 1e-6 && across.dot(along).abs() < 1e-7);
        // Head-on it is a circle, from either side.
        for normal in [Vec3::Z, -Vec3::Z, Vec3::X] {
            let axes = footprint(normal, normal, 0.1);
            assert!(axes.iter().all(|axis| (axis.length() - 0.1).abs() < 1e-6), "{axes:?}");
            assert!(axes[0].dot(axes[1]).abs() < 1e-7 && axes[0].dot(normal).abs() < 1e-7);
        }
        let edge_on = footprint(Vec3::X, Vec3::Z, 0.1);
        assert!(edge_on.iter().all(|axis| axis.is_finite()));
    }

    #[test]
    fn texture_coordinates_change_as_their_triangle_says() {
        // u runs along x at 3 a unit, v along x + y at 5.
        let at = |p: Vec3| [3.0 * p.x, 5.0 * (p.x + p.y)];
        let edges = [Vec3::new(2.0, 0.5, 0.0), Vec3::new(-1.0, 1.5, 0.0)];
        let along = Vec3::new(0.3, -0.2, 0.0);
        for (found, along) in
            change(edges, edges.map(at), [along, edges[0]]).iter().zip([along, edges[0]])
        {
            let expected = at(along);
            assert!((found[0] - expected[0]).abs() < 1e-5 && (found[1] - expected[1]).abs() < 1e-5);
        }
        assert_eq!(change([Vec3::X; 2], [[1.0; 2]; 2], [Vec3::X; 2]), [[0.0; 2]; 2]);
    }

    #[test]
    fn rough_logarithms_are_near() {
        for x in [1e-30f32, 0.3, 0.5, 1.0, 1.4, 3.0, 4096.0, 1e20] {
            assert!((rough_log2(x) - x.log2()).abs() < 1.0 / 11.0, "{x}");
        }
    }
}
