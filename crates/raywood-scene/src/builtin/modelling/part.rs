//! The part: a piece of surface with shading normals, to be placed in a scene.

use raywood::Vec3;

use super::Placement;

/// A piece of surface in its own coordinates: vertices with normals, and triangles whose front is where they are
/// counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The vertex positions.
    pub positions: Vec<Vec3>,
    /// A unit normal per vertex, on the front.
    pub normals: Vec<Vec3>,
    /// Three vertices per triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// How a grid is divided in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// How many cells.
    pub count: usize,
    /// Whether the last cell joins the first.
    pub closed: bool,
}

impl Cells {
    /// Cells in a row, with two ends.
    pub const fn open(count: usize) -> Self {
        Self { count, closed: false }
    }

    /// Cells in a ring.
    pub const fn closed(count: usize) -> Self {
        Self { count, closed: true }
    }

    /// How many lattice points bound the cells.
    pub const fn points(self) -> usize {
        if self.closed { self.count } else { self.count + 1 }
    }
}

impl Part {
    /// Adds a smooth surface over a grid of `u` by `v` cells, from the position of each lattice point. Its front is
    /// the side to which `du x dv` points. Where lattice points coincide (a pole) no triangles are wasted.
    pub fn add_grid(&mut self, u: Cells, v: Cells, position: impl Fn(usize, usize) -> Vec3) {
        // Compute the lattice once.
        let first = self.positions.len() as u32;
        let (columns, rows) = (u.points(), v.points());
        let mut grid = Self::default();
        for j in 0..rows {
            for i in 0..columns {
                grid.positions.push(position(i, j));
            }
        }

        // Cut each cell in two, along the shorter diagonal: on a twisted cell it is the one that lies in the surface.
        let index = |i: usize, j: usize| ((j % rows) * columns + i % columns) as u32;
        for j in 0..v.count {
            for i in 0..u.count {
                let [a, b, c, d] =
                    [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
                let length = |p: u32, q: u32| {
                    (grid.positions[p as usize] - grid.positions[q as usize]).length()
                };
                // The margin keeps the choice from hanging on rounding where both diagonals are of equal length.
                let halves = if length(a, c) <= 1.0001 * length(b, d) {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                for triangle in halves {
                    let [p, q, r] = triangle.map(|k| grid.positions[k as usize]);
                    if p != q && q != r && r != p {
                        grid.triangles.push(triangle);
                    }
                }
            }
        }

        // Average the normals of the faces around each vertex, by area; rows that shrink to a point share one.
        grid.normals = face_normal_sums(&grid);
        for j in [0, rows - 1] {
            let row = j * columns..(j + 1) * columns;
            let pole = grid.positions[row.start];
            if columns > 1 && grid.positions[row.clone()].iter().all(|&p| p == pole) {
                let sum = grid.normals[row.clone()].iter().fold(Vec3::ZERO, |s, &n| s + n);
                grid.normals[row].fill(sum);
            }
        }
        for normal in &mut grid.normals {
            *normal = normal.normalize_or_zero();
        }

        self.positions.append(&mut grid.positions);
        self.normals.append(&mut grid.normals);
        self.triangles.extend(grid.triangles.iter().map(|t| t.map(|i| i + first)));
    }

    /// Adds a flat, convex polygon, corners counter-clockwise seen from its front.
    pub fn add_polygon(&mut self, corners: &[Vec3]) {
        let first = self.positions.len() as u32;
        // Newell's sum gives the normal even where some corners lie on a line.
        let around = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let normal = around.fold(Vec3::ZERO, |sum, (a, b)| sum + (a - corners[0]).cross(b - a));
        self.positions.extend_from_slice(corners);
        self.normals.extend(corners.iter().map(|_| normal.normalize_or_zero()));
        let last = corners.len() as u32 - 1;
        self.triangles.extend((1..last).map(|i| [first, first + i, first + i + 1]));
    }

    /// A copy in its place.
    #[must_use]
    pub fn placed(&self, placement: &Placement) -> Self {
        Self {
            positions: self.positions.iter().map(|&p| placement.point(p)).collect(),
            normals: self.normals.iter().map(|&n| placement.direction(n)).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// Adds a copy of another part.
    pub fn add_part(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.normals.extend_from_slice(&other.normals);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
    }
}

/// At each vertex the sum of its faces' normals, each as long as twice the face's area.
fn face_normal_sums(part: &Part) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; part.positions.len()];
    for &triangle in &part.triangles {
        let [p, q, r] = triangle.map(|i| part.positions[i as usize]);
        let normal = (q - p).cross(r - p);
        for i in triangle {
            sums[i as usize] += normal;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_grid_faces_up_and_has_two_triangles_a_cell() {
        let mut part = Part::default();
        // u along x, v along -z: u x v points up.
        part.add_grid(Cells::open(3), Cells::open(2), |i, j| Vec3::new(i as f32, 0.0, -(j as f32)));
        assert_eq!((part.positions.len(), part.triangles.len()), (12, 12));
        assert!(part.normals.iter().all(|&n| n == Vec3::Y));
    }

    #[test]
    fn a_polygon_faces_the_side_from_which_it_is_counter_clockwise() {
        let mut part = Part::default();
        part.add_polygon(&[Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]);
        assert_eq!(part.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(part.normals.iter().all(|&n| n == Vec3::Z));
    }
}
