//! Polygons into triangles: fans for convex ones, ear clipping for the others (Meisters 1975; ears kept up to date as in
//! O'Rourke, "Computational Geometry in C", 1998).

use raywood::Vec3;

/// The most corners of a concave polygon that are clipped ear by ear, for the time grows with their square.
const MOST_EARS: usize = 2048;

/// Cuts a polygon into triangles of the same orientation, two fewer than it has corners, or none below three corners. Tells
/// each by the numbers of its corners, 0 being the polygon's first. False if the polygon is concave and has too many
/// corners, in which case it was cut into a fan regardless.
#[inline]
pub(crate) fn triangulate(
    count: usize,
    position: impl Fn(usize) -> Vec3,
    mut emit: impl FnMut([usize; 3]),
) -> bool {
    match count {
        0..=2 => true,
        3 => {
            emit([0, 1, 2]);
            true
        }
        4 => {
            let halves = halve([0, 1, 2, 3].map(position));
            halves.into_iter().for_each(emit);
            true
        }
        _ => {
            let points = project(&(0..count).map(position).collect::<Vec<_>>());
            let convex = is_convex(&points);
            if convex || count > MOST_EARS {
                (2..count).for_each(|i| emit([0, i - 1, i]));
            } else {
                clip_ears(&points, emit);
            }
            convex || count <= MOST_EARS
        }
    }
}

/// Cuts a quad from its first corner to its third, unless it is concave at the second or fourth: then the other way.
fn halve([a, b, c, d]: [Vec3; 4]) -> [[usize; 3]; 2] {
    let (ab, ac, ad) = (b - a, c - a, d - a);
    let normal = ac.cross(d - b);
    if ab.cross(ac).dot(normal) >= 0.0 && ac.cross(ad).dot(normal) >= 0.0 {
        [[0, 1, 2], [0, 2, 3]]
    } else {
        [[1, 2, 3], [1, 3, 0]]
    }
}

/// A corner in the plane of its polygon.
type Point = [f64; 2];

/// The corners seen along the polygon's normal (Newell's), so that they run counter-clockwise. In double precision and
/// relative to the first corner, for polygons far from the origin. A corner that is NaN or infinite counts as the first: its
/// triangles are dropped later.
fn project(corners: &[Vec3]) -> Vec<Point> {
    let first = corners[0].to_array().map(f64::from);
    let relative = |corner: &Vec3| {
        let p = corner.to_array().map(f64::from);
        let d = [p[0] - first[0], p[1] - first[1], p[2] - first[2]];
        if d.iter().all(|x| x.is_finite()) { d } else { [0.0; 3] }
    };
    let points: Vec<[f64; 3]> = corners.iter().map(relative).collect();

    // The normal's largest component tells along which axis to look, its sign from which side.
    let mut normal = [0.0f64; 3];
    for (p, q) in edges(&points) {
        for (axis, component) in normal.iter_mut().enumerate() {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            *component += p[u] * q[v] - p[v] * q[u];
        }
    }
    let mut axis = 0;
    for other in 1..3 {
        if normal[other].abs() > normal[axis].abs() {
            axis = other;
        }
    }
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (u, v) = (v, u);
    }
    points.iter().map(|p| [p[u], p[v]]).collect()
}

/// Each point with the next one around.
fn edges<T>(points: &[T]) -> impl Iterator<Item = (&T, &T)> {
    points.iter().zip(points.iter().cycle().skip(1))
}

/// Twice the area of a triangle, positive if it runs counter-clockwise.
fn doubled_area(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a fan from the first corner covers the polygon: every triangle of it runs the same way round, or has no area,
/// and together they turn no more than once.
fn is_convex(points: &[Point]) -> bool {
    let count = points.len();
    let turns_left = (0..count)
        .all(|i| doubled_area(points[i], points[(i + 1) % count], points[(i + 2) % count]) >= 0.0);
    turns_left && points[1..].windows(2).all(|e| doubled_area(points[0], e[0], e[1]) >= 0.0)
}

/// A polygon whose corners are cut off one after the other: a ring of those that are left.
struct Ring<'a> {
    points: &'a [Point],
    previous: Vec<usize>,
    next: Vec<usize>,
    reflex: Vec<bool>,
    ear: Vec<bool>,
}

impl Ring<'_> {
    /// The corner with its neighbours.
    fn triangle(&self, corner: usize) -> [usize; 3] {
        [self.previous[corner], corner, self.next[corner]]
    }

    /// Finds out whether a corner turns right, and whether it can be cut off: it turns left and no other corner that turns
    /// right lies in its triangle.
    fn update(&mut self, corner: usize) {
        let [a, b, c] = self.triangle(corner).map(|i| self.points[i]);
        self.reflex[corner] = doubled_area(a, b, c) <= 0.0;
        self.ear[corner] = !self.reflex[corner] && !self.holds_reflex_corner(corner);
    }

    /// Whether the triangle of a corner holds another corner of the ring, inside or on its border. Only corners that turn
    /// right need be asked; one at the same place as the triangle's own (where a polygon touches itself) does no harm.
    fn holds_reflex_corner(&self, corner: usize) -> bool {
        let [previous, _, next] = self.triangle(corner);
        let [a, b, c] = self.triangle(corner).map(|i| self.points[i]);
        let mut other = self.next[next];
        while other != previous {
            let p = self.points[other];
            if self.reflex[other]
                && p != a
                && p != b
                && p != c
                && doubled_area(a, b, p) >= 0.0
                && doubled_area(b, c, p) >= 0.0
                && doubled_area(c, a, p) >= 0.0
            {
                return true;
            }
            other = self.next[other];
        }
        false
    }

    /// Takes a corner out of the ring.
    fn remove(&mut self, corner: usize) {
        let [previous, _, next] = self.triangle(corner);
        self.next[previous] = next;
        self.previous[next] = previous;
    }
}

/// Cuts off ears until a triangle is left. The triangles of corners at the same place as the one after them come first: they
/// have no area, and without such corners it is plain what lies inside an ear.
fn clip_ears(points: &[Point], mut emit: impl FnMut([usize; 3])) {
    let mut kept: Vec<usize> = Vec::with_capacity(points.len());
    let last = points.len() - 1;
    for corner in 0..=last {
        let next = if corner == last { 0 } else { corner + 1 };
        if points[corner] == points[next] && last - corner + kept.len() >= 3 {
            let before = kept.last().copied().unwrap_or(last);
            emit([before, corner, next]);
        } else {
            kept.push(corner);
        }
    }
    let kept_points: Vec<Point> = kept.iter().map(|&corner| points[corner]).collect();
    clip_distinct_ears(&kept_points, |ear| emit(ear.map(|i| kept[i])));
}

/// Cuts off ears until a triangle is left; no corner is where the one after it is.
fn clip_distinct_ears(points: &[Point], mut emit: impl FnMut([usize; 3])) {
    let count = points.len();
    let mut ring = Ring {
        points,
        previous: (0..count).map(|i| (i + count - 1) % count).collect(),
        next: (0..count).map(|i| (i + 1) % count).collect(),
        reflex: vec![false; count],
        ear: vec![false; count],
    };
    // Which corners turn right must be known of all before the first ear is sought.
    for _ in 0..2 {
        (0..count).for_each(|corner| ring.update(corner));
    }

    let mut corner = 0;
    for left in (4..=count).rev() {
        // A polygon that crosses itself may have no ear: then a corner that turns left is cut off, or any.
        let seek = |wanted: &dyn Fn(usize) -> bool| {
            let mut tried = corner;
            for _ in 0..left {
                if wanted(tried) {
                    return Some(tried);
                }
                tried = ring.next[tried];
            }
            None
        };
        let cut = seek(&|c| ring.ear[c]).or_else(|| seek(&|c| !ring.reflex[c])).unwrap_or(corner);
        emit(ring.triangle(cut));
        let [previous, _, next] = ring.triangle(cut);
        ring.remove(cut);
        ring.update(previous);
        ring.update(next);
        // Going on past the neighbour makes rounder triangles than a fan would have.
        corner = ring.next[next];
    }
    emit(ring.triangle(corner));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles of a polygon in the plane z = 0, and whether it was cut with care.
    fn cut(outline: &[[f32; 2]]) -> (Vec<[usize; 3]>, bool) {
        let position = |i: usize| Vec3::new(outline[i][0], outline[i][1], 0.0);
        let mut triangles = Vec::new();
        let careful = triangulate(outline.len(), position, |t| triangles.push(t));
        (triangles, careful)
    }

    /// Twice the area of an outline, and of triangles: the sum of what each covers, whichever way it runs.
    fn areas(outline: &[[f32; 2]], triangles: &[[usize; 3]]) -> (f64, f64) {
        let at = |i: usize| outline[i].map(f64::from);
        let whole = edges(outline)
            .map(|(p, q)| f64::from(p[0]) * f64::from(q[1]) - f64::from(p[1]) * f64::from(q[0]))
            .sum();
        let parts =
            triangles.iter().map(|t| doubled_area(at(t[0]), at(t[1]), at(t[2])).abs()).sum();
        (whole, parts)
    }

    #[test]
    fn concave_quad_is_cut_along_its_inner_diagonal() {
        // An arrow head, whose fan from corner 0 would cover ground outside.
        let outline = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.7, 1.0]];
        for turn in 0..4 {
            let mut turned = outline;
            turned.rotate_left(turn);
            let (triangles, careful) = cut(&turned);
            let (whole, parts) = areas(&turned, &triangles);
            assert!(careful && triangles.len() == 2, "{triangles:?}");
            assert!((whole - parts).abs() < 1e-6, "turned by {turn}: {whole} and {parts}");
        }
    }

    #[test]
    fn combs_and_spirals_are_covered_exactly() {
        // A comb with many teeth, as floor plans have.
        let mut comb = vec![[0.0, 0.0], [40.0, 0.0]];
        for tooth in (0..20).rev() {
            let x = 2.0 * tooth as f32;
            comb.extend([[x + 2.0, 9.0], [x + 1.5, 9.0], [x + 1.5, 1.0], [x + 0.5, 1.0], [x, 9.0]]);
        }
        let (triangles, _) = cut(&comb);
        let (whole, parts) = areas(&comb, &triangles);
        assert_eq!(triangles.len(), comb.len() - 2);
        assert!((whole - parts).abs() < 1e-4 * whole, "{whole} and {parts}");

        // The same run clockwise keeps its orientation.
        comb.reverse();
        let (triangles, _) = cut(&comb);
        let (whole, parts) = areas(&comb, &triangles);
        assert!(whole < 0.0 && (whole + parts).abs() < 1e-4 * parts, "{whole} and {parts}");
    }

    #[test]
    fn every_number_of_corners_gives_two_fewer_triangles() {
        for count in 0..40usize {
            // A star that crosses itself: no ear may be found, and still it ends.
            let star: Vec<[f32; 2]> = (0..count)
                .map(|i| {
                    let angle = i as f32 * 2.4;
                    [angle.cos(), angle.sin()]
                })
                .collect();
            assert_eq!(cut(&star).0.len(), count.saturating_sub(2));
            assert_eq!(cut(&vec![[1.0, 1.0]; count]).0.len(), count.saturating_sub(2));
        }
    }

    #[test]
    fn huge_concave_polygons_are_said_to_be_cut_roughly() {
        let spike = |i: usize| {
            let (angle, radius) = (i as f32 * std::f32::consts::TAU / 5000.0, 1.0 + (i % 2) as f32);
            [radius * angle.cos(), radius * angle.sin()]
        };
        let sun: Vec<[f32; 2]> = (0..5000).map(spike).collect();
        let (triangles, careful) = cut(&sun);
        assert!(!careful);
        assert_eq!(triangles.len(), 4998);
    }
}
