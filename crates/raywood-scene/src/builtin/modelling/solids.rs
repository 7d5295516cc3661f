//! Solids with flat faces: boxes and bars.

use raywood::Vec3;

use super::Part;

/// A closed box between two corners, front faces outside.
pub fn cuboid(min: Vec3, max: Vec3) -> Part {
    let corner = |i: usize| {
        Vec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    };
    let mut part = Part::default();
    // Each face by its corners, counter-clockwise from outside; bit 0 of a corner's number is x, bit 1 y, bit 2 z.
    for face in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
    {
        part.add_polygon(&face.map(corner));
    }
    part
}

/// A closed bar of square section, from one point to another, `width` thick.
pub fn bar(from: Vec3, to: Vec3, width: f32) -> Part {
    let along = (to - from).normalize_or_zero();
    let (s, t) = along.orthonormal_basis();
    let mut part = cuboid(
        Vec3::new(-0.5 * width, -0.5 * width, 0.0),
        Vec3::new(0.5 * width, 0.5 * width, 1.0),
    );
    for p in &mut part.positions {
        *p = from + p.x * s + p.y * t + p.z * (to - from);
    }
    for n in &mut part.normals {
        *n = n.x * s + n.y * t + n.z * along;
    }
    part
}

#[cfg(test)]
mod tests {
    use super::super::{is_closed, signed_volume};
    use super::*;

    #[test]
    fn boxes_and_bars_are_closed_with_their_front_outside() {
        let box_ = cuboid(Vec3::new(-1.0, 2.0, 3.0), Vec3::new(1.0, 5.0, 4.0));
        assert!(is_closed(&box_));
        assert!((signed_volume(&box_) - 6.0).abs() < 1e-5);
        let bar = bar(Vec3::new(1.0, 1.0, 1.0), Vec3::new(4.0, 5.0, 1.0), 0.1);
        assert!(is_closed(&bar));
        assert!((signed_volume(&bar) - 0.05).abs() < 1e-5);
    }
}
