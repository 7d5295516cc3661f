//! Arches: openings with a half-elliptic head, the wall around them, and the path of the mouldings along them.

use std::f32::consts::PI;

use raywood::Vec3;

use super::{Cells, Part, PathPoint};

/// The outline of an opening with a half-elliptic head, in the plane z = 0, upright and centred on x = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arch {
    /// Half the width of the opening.
    pub half_width: f32,
    /// The height at which the head begins.
    pub spring: f32,
    /// The height of the head; equal to `half_width` for a round arch.
    pub rise: f32,
}

impl Arch {
    /// A round arch.
    pub const fn round(half_width: f32, spring: f32) -> Self {
        Self { half_width, spring, rise: half_width }
    }

    /// Point `i` of `segments` of the head, from the right springing over the crown to the left.
    pub fn point(&self, i: usize, segments: usize) -> [f32; 2] {
        // The left half mirrors the right one exactly; the springings and the crown are exact too.
        let (k, sign) = if 2 * i <= segments { (i, 1.0) } else { (segments - i, -1.0) };
        let (sin, cos) = (PI * k as f32 / segments as f32).sin_cos();
        let cos = if 2 * k == segments { 0.0 } else { cos };
        [sign * self.half_width * cos, self.spring + self.rise * sin]
    }
}

/// The path along an arch from the foot of its right leg over the crown to the foot of its left leg; `foot` equal
/// to the springing leaves the legs out. A profile swept along it has its `x` away from the opening and its `y` out
/// of the wall (z), so a moulding on the wall is drawn from its outer edge to its inner one.
pub fn arch_path(arch: &Arch, foot: f32, segments: usize) -> Vec<PathPoint> {
    let head = (0..=segments).map(|i| arch.point(i, segments));
    let leg = |side: f32| [side * arch.half_width, foot];
    let legs = if foot < arch.spring { 1 } else { 0 };
    std::iter::repeat_n(leg(1.0), legs)
        .chain(head)
        .chain(std::iter::repeat_n(leg(-1.0), legs))
        .map(|[x, y]| PathPoint { position: Vec3::new(x, y, 0.0), up: Vec3::Z })
        .collect()
}

/// An upright piece of wall with one arched opening: front and back (towards +z and -z) and the inside of the opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArchedWall {
    /// The opening.
    pub arch: Arch,
    /// The lower end of the opening.
    pub sill: f32,
    /// From end to end, centred on the opening.
    pub width: f32,
    /// The wall's lower edge.
    pub bottom: f32,
    /// The wall's upper edge.
    pub top: f32,
    /// From front to back.
    pub thickness: f32,
}

impl ArchedWall {
    /// Faces and reveal together, with the head cut into `segments`.
    pub fn build(&self, segments: usize) -> Part {
        let mut part = self.faces(segments);
        part.add_part(&self.reveal(segments));
        part
    }

    /// The faces towards +z and -z.
    pub fn faces(&self, segments: usize) -> Part {
        let mut part = Part::default();
        let z = 0.5 * self.thickness;
        for front in [true, false] {
            self.add_face(&mut part, segments, if front { z } else { -z }, front);
        }
        part
    }

    /// The inside of the opening, through the wall.
    pub fn reveal(&self, segments: usize) -> Part {
        let mut part = Part::default();
        let z = 0.5 * self.thickness;
        let path = arch_path(&self.arch, self.sill, segments);
        part.add_grid(Cells::open(1), Cells::open(path.len() - 1), |i, j| {
            path[j].position + Vec3::new(0.0, 0.0, if i == 0 { -z } else { z })
        });
        if self.sill > self.bottom {
            let (x, y) = (self.arch.half_width, self.sill);
            part.add_polygon(&[
                Vec3::new(-x, y, z),
                Vec3::new(x, y, z),
                Vec3::new(x, y, -z),
                Vec3::new(-x, y, -z),
            ]);
        }
        part
    }

    /// Adds the wall's face at a depth, towards +z if it is the front, else towards -z.
    fn add_face(&self, part: &mut Part, segments: usize, z: f32, front: bool) {
        let mut polygon = |corners: &[[f32; 2]]| {
            let mut corners: Vec<_> = corners.iter().map(|&[x, y]| Vec3::new(x, y, z)).collect();
            if !front {
                corners.reverse();
            }
            part.add_polygon(&corners);
        };
        let mut rectangle = |left: f32, right: f32, low: f32, high: f32| {
            if high > low && right > left {
                polygon(&[[left, low], [right, low], [right, high], [left, high]]);
            }
        };

        // Both jambs, cut at the heights where neighbouring faces have corners, so that no ray slips through.
        let (outer, inner) = (0.5 * self.width, self.arch.half_width);
        let cuts = [self.bottom, self.sill, self.arch.spring, self.top];
        for heights in cuts.windows(2) {
            rectangle(inner, outer, heights[0], heights[1]);
            rectangle(-outer, -inner, heights[0], heights[1]);
        }
        rectangle(-inner, inner, self.bottom, self.sill);

        // Upright strips from the head to the top.
        for i in 0..segments {
            let [a, b] = [i, i + 1].map(|i| self.arch.point(i, segments));
            polygon(&[a, [a[0], self.top], [b[0], self.top], b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{is_closed, signed_volume};
    use super::*;

    #[test]
    fn a_wall_with_its_rims_closed_is_closed_around_the_opening() {
        let wall = ArchedWall {
            arch: Arch::round(1.0, 2.0),
            sill: 1.0,
            width: 4.0,
            bottom: 0.0,
            top: 4.0,
            thickness: 0.5,
        };
        let segments = 24;
        let mut part = wall.build(segments);
        // Close the four rims by hand: their cuts are those of the faces.
        let mut rim = vec![[2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [2.0, 4.0]];
        rim.extend((0..=segments).map(|i| [wall.arch.point(i, segments)[0], 4.0]));
        rim.extend([[-2.0, 4.0], [-2.0, 2.0], [-2.0, 1.0], [-2.0, 0.0], [-1.0, 0.0], [1.0, 0.0]]);
        for i in 0..rim.len() {
            let ([ax, ay], [bx, by]) = (rim[i], rim[(i + 1) % rim.len()]);
            part.add_polygon(&[
                Vec3::new(ax, ay, 0.25),
                Vec3::new(ax, ay, -0.25),
                Vec3::new(bx, by, -0.25),
                Vec3::new(bx, by, 0.25),
            ]);
        }
        assert!(is_closed(&part));
        let exact = 0.5 * (16.0 - 2.0 - 0.5 * PI);
        assert!((signed_volume(&part) - exact).abs() < 0.01, "{}", signed_volume(&part));
    }
}
