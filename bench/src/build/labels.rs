//! Where the labels of marks stand so that they cover each other, the marks and the lines of a picture as little as possible: one after the other, each at the best of a
//! few places around its mark.

/// A place in pixels, y downwards.
pub(super) type Pixel = (i32, i32);

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rect {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Rect {
    /// The one of that size around a centre.
    pub(super) fn around((x, y): Pixel, (width, height): (i32, i32)) -> Self {
        let (left, top) = (x - width / 2, y - height / 2);
        Self { left, top, right: left + width, bottom: top + height }
    }

    /// The one with these opposite corners, wider by a margin on all sides.
    pub(super) fn between(a: Pixel, b: Pixel, margin: i32) -> Self {
        Self {
            left: a.0.min(b.0) - margin,
            top: a.1.min(b.1) - margin,
            right: a.0.max(b.0) + margin,
            bottom: a.1.max(b.1) + margin,
        }
    }

    fn area(&self) -> i32 {
        (self.right - self.left).max(0) * (self.bottom - self.top).max(0)
    }

    /// How many pixels two have in common.
    fn overlap(&self, other: &Self) -> i32 {
        let common = Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        };
        common.area()
    }
}

/// How high a label is, and how far its edge is from its mark's centre.
const HEIGHT: i32 = 13;
const GAP: i32 = 8;

/// The offset of each label's centre from its mark. Every label stands inside the frame and covers as little as possible of the obstacles, of all marks, and of the labels
/// before it; below its mark where nothing speaks against it. `labels` are the places of the marks and the widths of their labels.
pub(super) fn places(labels: &[(Pixel, i32)], lines: &[Rect], frame: Rect) -> Vec<Pixel> {
    let mut taken = lines.to_vec();
    taken.extend(labels.iter().map(|&(mark, _)| Rect::around(mark, (2 * GAP, 2 * GAP))));
    let place = |&((x, y), width): &(Pixel, i32)| {
        let (side, up) = (GAP + width / 2, GAP + HEIGHT / 2);
        let candidates = [
            (0, up),
            (0, -up),
            (side, 0),
            (-side, 0),
            (side, up),
            (-side, up),
            (side, -up),
            (-side, -up),
            (0, up + HEIGHT),
            (0, -up - HEIGHT),
        ];
        let rect = |(dx, dy): Pixel| Rect::around((x + dx, y + dy), (width, HEIGHT));
        let covered = |offset: &Pixel| {
            let rect = rect(*offset);
            let outside = rect.area() - rect.overlap(&frame);
            // Letters that are cut off are worse than any that meet others.
            taken.iter().map(|other| rect.overlap(other)).sum::<i32>() + 10 * outside
        };
        // Of equally good ones the first.
        let best = candidates.into_iter().min_by_key(covered).unwrap_or_default();
        taken.push(rect(best));
        best
    };
    labels.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { left: 0, top: 0, right: 400, bottom: 300 };

    #[test]
    fn labels_stand_below_where_there_is_room() {
        assert_eq!(places(&[((100, 100), 40), ((200, 100), 40)], &[], FRAME), [(0, 14), (0, 14)]);
    }

    #[test]
    fn labels_keep_off_each_other_off_lines_and_inside_of_the_frame() {
        let marks = [((100, 100), 60), ((125, 102), 60), ((150, 100), 60), ((200, 295), 60)];
        let line = Rect::between((100, 100), (100, 200), 1);
        let rects: Vec<_> = marks
            .iter()
            .zip(places(&marks, &[line], FRAME))
            .map(|(((x, y), width), (dx, dy))| Rect::around((x + dx, y + dy), (*width, HEIGHT)))
            .collect();
        for (number, rect) in rects.iter().enumerate() {
            assert_eq!(rect.overlap(&FRAME), rect.area(), "{rect:?}");
            assert_eq!(rect.overlap(&line), 0, "{rect:?}");
            for other in &rects[..number] {
                assert_eq!(rect.overlap(other), 0, "{rect:?} {other:?}");
            }
            for ((x, y), _) in marks {
                assert_eq!(rect.overlap(&Rect::around((x, y), (10, 10))), 0, "{rect:?}");
            }
        }
    }
}
