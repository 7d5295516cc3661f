//! Affine placements whose inverses are known and which round nothing: made of turns by right angles, powers of two and shears, so that what goes through them is the same as if it had stood there.

use raywood::{Ray64, Transform};

use crate::oracle::Point;

type Rows = [[f64; 4]; 3];

/// Where an object stands: the way into the scene's space, and the way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    forth: Rows,
    back: Rows,
}

const IDENTITY: Rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

fn vector(rows: &Rows, v: Point) -> Point {
    rows.map(|[a, b, c, _]| a * v[0] + b * v[1] + c * v[2])
}

fn point(rows: &Rows, p: Point) -> Point {
    let v = vector(rows, p);
    [0, 1, 2].map(|i| v[i] + rows[i][3])
}

/// One after the other.
fn product(first: &Rows, second: &Rows) -> Rows {
    let column = |j: usize| [0, 1, 2].map(|i| first[i][j]);
    let columns = [0, 1, 2].map(|j| vector(second, column(j)));
    let moved = point(second, column(3));
    [0, 1, 2].map(|i| [columns[0][i], columns[1][i], columns[2][i], moved[i]])
}

impl Placement {
    /// Where it is anyway.
    pub const IDENTITY: Self = Self { forth: IDENTITY, back: IDENTITY };

    /// This, and after it another.
    pub fn then(self, next: Self) -> Self {
        Self { forth: product(&self.forth, &next.forth), back: product(&next.back, &self.back) }
    }

    /// Moved by so much.
    pub fn moved(self, by: Point) -> Self {
        let mut step = Self::IDENTITY;
        for (axis, by) in by.into_iter().enumerate() {
            (step.forth[axis][3], step.back[axis][3]) = (by, -by);
        }
        self.then(step)
    }

    /// Scaled, or mirrored, along the axes by powers of two.
    pub fn scaled(self, by: Point) -> Self {
        let mut step = Self::IDENTITY;
        for (axis, by) in by.into_iter().enumerate() {
            (step.forth[axis][axis], step.back[axis][axis]) = (by, by.recip());
        }
        self.then(step)
    }

    /// The axes exchanged, two of them turned around.
    pub fn turned(self) -> Self {
        let forth = [[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0]];
        let back = [[0.0, 0.0, -1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
        self.then(Self { forth, back })
    }

    /// Sheared: along x by a share of y.
    pub fn sheared(self, by: f64) -> Self {
        let mut step = Self::IDENTITY;
        (step.forth[0][1], step.back[0][1]) = (by, -by);
        self.then(step)
    }

    /// The same for the library.
    pub fn transform(&self) -> Transform {
        Transform::from_rows(self.forth.map(|row| row.map(|x| x as f32)))
    }

    /// By how much it scales, if it does so by the same in all directions.
    pub fn similarity(&self) -> Option<f64> {
        let square = |row: &[f64; 4]| row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
        let dot = |a: &[f64; 4], b: &[f64; 4]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [x, y, z] = &self.forth;
        let is_square = dot(x, y) == 0.0 && dot(y, z) == 0.0 && dot(z, x) == 0.0;
        let is_even = square(x) == square(y) && square(y) == square(z);
        (is_square && is_even).then(|| square(x).sqrt())
    }

    /// Where a point of the object stands.
    pub fn point(&self, p: Point) -> Point {
        point(&self.forth, p)
    }

    /// Which point of the object stands there.
    pub fn point_back(&self, p: Point) -> Point {
        point(&self.back, p)
    }

    /// A ray of the scene as the object sees it, at the same distances.
    pub fn ray_back(&self, ray: &Ray64) -> Ray64 {
        let (origin, direction) = (self.point_back(ray.origin), vector(&self.back, ray.direction));
        Ray64 { origin, direction, ..*ray }
    }
}

#[cfg(test)]
mod tests {
    use super::Placement;

    #[test]
    fn the_way_back_undoes_the_way_there() {
        let place = Placement::IDENTITY
            .scaled([2.0, -0.5, 1.0])
            .turned()
            .sheared(0.75)
            .moved([1.0, -2.0, 0.25])
            .turned();
        for p in [[0.0; 3], [1.0, 0.5, -3.0], [0.125, -7.0, 2.0]] {
            assert_eq!(place.point_back(place.point(p)), p);
            let there = place.transform().point(p.map(|x| x as f32)).to_array().map(f64::from);
            assert_eq!(there, place.point(p));
        }
        assert_eq!(place.similarity(), None);
        assert_eq!(Placement::IDENTITY.turned().scaled([-2.0, 2.0, 2.0]).similarity(), Some(2.0));
    }
}
