//! Affine transforms, and their inverses in double precision.

use std::fmt;

use crate::double::{Double3, cross, dot, double, single, sub};
use crate::{Aabb, Ray, Vec3};

/// The rows of a matrix of three by three.
pub(super) type Matrix = [Double3; 3];

/// An affine transform of space: a point `p` goes to `A p + t`, where `A` is any matrix of three by three (rotation, scaling, mirroring, shear) and `t` moves.
///
/// As three rows of four numbers, the last of which are `t`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Transform {
    rows: [[f32; 4]; 3],
}

/// Why a transform cannot place an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TransformError {
    /// A coefficient is NaN or infinite.
    NotFinite,
    /// It flattens space, or does so when its coefficients change by their last digits: there is no way back.
    Singular,
    /// On the way from it to a later one, blended linearly, there is one that flattens space, or nearly so: as on turns of half a circle.
    FlatBetween,
}

impl fmt::Display for TransformError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "has a coefficient that is NaN or infinite",
            Self::Singular => "flattens space, or nearly so: it cannot be inverted",
            Self::FlatBetween => {
                "flattens space on the way to the later one, or nearly so: as both are blended linearly, a turn between them must stay well below half a circle"
            }
        })
    }
}

impl std::error::Error for TransformError {}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// The one that leaves everything in its place.
    pub const IDENTITY: Self =
        Self::from_rows([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);

    /// That of three rows.
    pub const fn from_rows(rows: [[f32; 4]; 3]) -> Self {
        Self { rows }
    }

    /// The three rows.
    pub const fn rows(&self) -> &[[f32; 4]; 3] {
        &self.rows
    }

    /// Moves by a vector.
    pub fn translation(by: impl Into<[f32; 3]>) -> Self {
        let [x, y, z] = by.into();
        Self::from_rows([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])
    }

    /// Scales along the axes; mirrors where a factor is negative.
    pub fn scaling(by: impl Into<[f32; 3]>) -> Self {
        let [x, y, z] = by.into();
        Self::from_rows([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
    }

    /// Turns around an axis through the origin, counter-clockwise seen from its end, by an angle in degrees. Around an axis without length nothing turns.
    pub fn rotation(axis: impl Into<[f32; 3]>, degrees: f32) -> Self {
        let [x, y, z] = double(Vec3::from(axis.into()).normalize_or_zero());
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        if x == 0.0 && y == 0.0 && z == 0.0 {
            return Self::IDENTITY;
        }
        // Rodrigues' formula.
        let c = 1.0 - cos;
        let rows = [
            [cos + c * x * x, c * x * y - sin * z, c * x * z + sin * y],
            [c * x * y + sin * z, cos + c * y * y, c * y * z - sin * x],
            [c * x * z - sin * y, c * y * z + sin * x, cos + c * z * z],
        ];
        Self::from_rows(rows.map(|[a, b, c]| [a as f32, b as f32, c as f32, 0.0]))
    }

    /// This one, and after it another: computed in double precision and rounded once.
    pub fn then(&self, next: &Self) -> Self {
        let column = |j: usize| [0, 1, 2].map(|i| f64::from(self.rows[i][j]));
        let linear = [0, 1, 2].map(|j| next.vector_in_double(column(j)));
        let moved = next.point_in_double(column(3));
        Self::from_rows([0, 1, 2].map(|i| {
            [linear[0][i] as f32, linear[1][i] as f32, linear[2][i] as f32, moved[i] as f32]
        }))
    }

    /// Where a point goes: computed in double precision and rounded once.
    pub fn point(&self, point: impl Into<[f32; 3]>) -> Vec3 {
        single(self.point_in_double(double(Vec3::from(point.into()))))
    }

    /// What becomes of a vector between two points.
    pub fn vector(&self, vector: impl Into<[f32; 3]>) -> Vec3 {
        single(self.vector_in_double(double(Vec3::from(vector.into()))))
    }

    /// What turns normals of surfaces into those of transformed surfaces, up to their length: the inverse transposed matrix, so that normals that point outside still do, of mirrored
    /// surfaces too. Zero where the transform flattens space to a line.
    pub fn for_normals(&self) -> Self {
        let [a, b, c] = self.linear();
        let sign = if self.mirrors() { -1.0 } else { 1.0 };
        // Any length serves, so that of the largest coordinate is one and nothing overflows.
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let size = rows.iter().map(|row| largest(absolute(*row))).fold(0.0, f64::max);
        let factor = if size > 0.0 { sign / size } else { 0.0 };
        Self::from_rows(rows.map(|row| {
            let [x, y, z] = row.map(|number| (factor * number) as f32);
            [x, y, z, 0.0]
        }))
    }

    /// Whether it turns left hands into right hands, and so the order in which a triangle's corners are seen.
    pub fn mirrors(&self) -> bool {
        let [a, b, c] = self.linear();
        dot(a, cross(b, c)) < 0.0
    }

    pub(super) fn point_in_double(&self, p: Double3) -> Double3 {
        let [x, y, z] = self.vector_in_double(p);
        let [tx, ty, tz] = self.rows.map(|row| f64::from(row[3]));
        [x + tx, y + ty, z + tz]
    }

    fn vector_in_double(&self, v: Double3) -> Double3 {
        self.linear().map(|row| dot(row, v))
    }

    /// The rows of the matrix.
    #[inline(always)]
    pub(super) fn linear(&self) -> Matrix {
        // Neither here nor below `map`, which the compiler does not always inline: scenes in which everything moves ask for thousands of inverses a picture.
        let row = |row: usize| [self.entry(row, 0), self.entry(row, 1), self.entry(row, 2)];
        [row(0), row(1), row(2)]
    }

    /// A coefficient.
    #[inline(always)]
    fn entry(&self, row: usize, column: usize) -> f64 {
        f64::from(self.rows[row][column])
    }

    /// Whether it can place an instance.
    ///
    /// # Errors
    ///
    /// It is not finite, or there is no way back.
    pub fn check(&self) -> Result<(), TransformError> {
        self.inverse().map(|_| ())
    }

    /// The way back, if there is one.
    pub(super) fn inverse(&self) -> Result<Inverse, TransformError> {
        if !self.rows.as_flattened().iter().all(|number| number.is_finite()) {
            return Err(TransformError::NotFinite);
        }
        let mut inverse = self.way_back();
        inverse.condition = self.condition(&inverse);
        // NaN, too, is no condition.
        if inverse.condition <= WORST_CONDITION {
            Ok(inverse)
        } else {
            Err(TransformError::Singular)
        }
    }

    /// The way back of a transform that is known to have one; its condition is left at zero.
    #[inline(always)]
    pub(super) fn way_back(&self) -> Inverse {
        // The cofactors: differences of products that are exact, so each is right but for one rounding. The rows of the adjugate are the cofactors' columns.
        let linear = self.linear();
        let [a, b, c] = linear;
        let cofactors = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = dot(a, cofactors[0]);
        let column = |[x, y, z]: Double3| [x / determinant, y / determinant, z / determinant];
        let [a, b, c] = cofactors;
        let columns = [column(a), column(b), column(c)];
        let from = [self.entry(0, 3), self.entry(1, 3), self.entry(2, 3)];
        Inverse { columns, from, condition: 0.0 }
    }

    /// How much larger rounding errors may become on the way there and back: the greatest sum of a row of `|A| |A^-1|`. From 1 to 3 for rotations and any scaling
    /// along the axes.
    fn condition(&self, inverse: &Inverse) -> f64 {
        let sum_of = |row: Double3| {
            // Column k of the inverse, weighted by the row.
            let entry = |k: usize| dot(absolute(row), absolute(inverse.columns[k]));
            entry(0) + entry(1) + entry(2)
        };
        let [a, b, c] = self.linear();
        let sums = [sum_of(a), sum_of(b), sum_of(c)];
        if sums.iter().any(|sum| sum.is_nan()) { f64::NAN } else { largest(sums) }
    }

    /// The greatest sum of a row of `|A|`: how much longer a coordinate may become.
    pub(super) fn stretch(&self) -> f64 {
        let sum = |[x, y, z]: Double3| x.abs() + y.abs() + z.abs();
        let [a, b, c] = self.linear();
        largest([sum(a), sum(b), sum(c)])
    }

    /// A box around a transformed one: rounded outwards, and larger by what rounding of rays that are taken the other way moves points inside. Empty of an empty one.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() {
            return Aabb::EMPTY;
        }
        // By centre and half width, so that nothing depends on the signs of coefficients, which nobody can foresee.
        let (low, high) = (double(bounds.min), double(bounds.max));
        let side = |axis: usize| (0.5 * (low[axis] + high[axis]), 0.5 * (high[axis] - low[axis]));
        let [(x, dx), (y, dy), (z, dz)] = [side(0), side(1), side(2)];
        let (center, half) = ([x, y, z], [dx, dy, dz]);
        let largest = [x.abs() + dx, y.abs() + dy, z.abs() + dz];
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let row = [self.entry(axis, 0), self.entry(axis, 1), self.entry(axis, 2)];
            let factors = absolute(row);
            let middle = dot(row, center) + self.entry(axis, 3);
            let error = dot(factors, largest) * BOX_ERROR + f64::from(f32::MIN_POSITIVE);
            let reach = dot(factors, half) + error;
            min[axis] = ((middle - reach) as f32).next_down();
            max[axis] = ((middle + reach) as f32).next_up();
        }
        Aabb::new(min, max)
    }
}

/// Beyond this condition the last digits of the coefficients decide whether there is an inverse at all.
const WORST_CONDITION: f64 = (1 << 22) as f64;

/// How far a point on a ray, seen from the world, may lie beside the box that the ray meets in the object's space, in terms of the box's largest coordinates: one rounding, and
/// one to spare (`docs/numerics.md`, "Instances").
const BOX_ERROR: f64 = f32::EPSILON as f64;

/// The same in terms of the distance between the ray's origin and the instance's, times the transform's [condition](Transform::condition): two roundings, and one to spare.
pub(super) const RAY_ERROR: f64 = 1.5 * f32::EPSILON as f64;

/// The magnitudes.
#[inline(always)]
fn absolute([x, y, z]: Double3) -> Double3 {
    [x.abs(), y.abs(), z.abs()]
}

/// The largest of three numbers, none of which is NaN.
pub(super) fn largest(v: Double3) -> f64 {
    v[0].max(v[1]).max(v[2])
}

/// The way from the world into an object's space, in double precision: `A^-1 (p - t)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse {
    /// The columns of `A^-1`.
    columns: [Double3; 3],
    /// Where the object's origin lies.
    from: Double3,
    /// The [condition](Transform::condition) of the transform.
    pub(super) condition: f64,
}

/// A ray in an object's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectRay {
    /// The ray.
    pub(super) ray: Ray,
    /// How much farther distances are in the world: 1 but for directions that would be too long or too short, then a power of two.
    pub(super) unit: f32,
}

impl ObjectRay {
    /// A distance beyond which, in the object's space, all distances lie beyond `limit` in the world.
    #[inline(always)]
    pub(super) fn limit(&self, limit: f32) -> f32 {
        if self.unit == 1.0 { limit } else { first_from(limit.next_up(), self.unit) }
    }
}

/// Directions whose largest coordinate lies between these are taken over as they are.
pub(super) const USUAL_LENGTHS: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

impl Inverse {
    /// In place of one that does not exist.
    pub(super) const NONE: Self = Self { columns: [[0.0; 3]; 3], from: [0.0; 3], condition: 0.0 };

    /// A valid ray as the object sees it. Its origin and direction are rounded once.
    #[inline(always)]
    pub(super) fn ray(&self, ray: &Ray) -> ObjectRay {
        let origin = self.vector(sub(double(ray.origin), self.from));
        let direction = self.vector(double(ray.direction));
        let usual = USUAL_LENGTHS.contains(&largest(direction.map(f64::abs)));
        let seen = Ray { origin: single(origin), direction: single(direction), ..*ray };
        if usual { ObjectRay { ray: seen, unit: 1.0 } } else { rescaled(seen, direction) }
    }

    /// Where a point lies in the object's space.
    pub(super) fn point(&self, p: Double3) -> Double3 {
        self.vector(sub(p, self.from))
    }

    /// What becomes of a vector.
    #[inline(always)]
    pub(super) fn vector(&self, v: Double3) -> Double3 {
        let [a, b, c] = &self.columns;
        [0, 1, 2].map(|i| v[0] * a[i] + v[1] * b[i] + v[2] * c[i])
    }

    /// The world's normal of a surface that has this one in the object's space, of the length by which heights above the surface are larger in the object's space.
    pub(super) fn normal(&self, normal: Double3) -> Double3 {
        self.columns.map(|column| dot(column, normal))
    }

    /// The greatest sum of a row of `|A^-1|`.
    pub(super) fn stretch(&self) -> f64 {
        let [a, b, c] = &self.columns;
        let sum = |i: usize| a[i].abs() + b[i].abs() + c[i].abs();
        largest([sum(0), sum(1), sum(2)])
    }

    /// The largest coordinate of the place of the object's origin.
    pub(super) fn distance(&self) -> f64 {
        largest(absolute(self.from))
    }
}

/// A ray in a unit in which its direction is neither too long nor too short.
#[cold]
#[inline(never)]
fn rescaled(seen: Ray, direction: Double3) -> ObjectRay {
    let length = largest(direction.map(f64::abs));
    let exponent = if length > 0.0 { length.log2().round().clamp(-120.0, 120.0) } else { 0.0 };
    let unit = (-exponent).exp2();
    let direction = single(direction.map(|coordinate| coordinate * unit));
    let unit = unit as f32;
    // Exactly the distances that lie in the ray's interval once they are those of the world. Nothing behind the origin may round its way in.
    let t_min = if seen.t_min == 0.0 { 0.0 } else { first_from(seen.t_min, unit) };
    let ray = Ray { direction, t_min, t_max: first_from(seen.t_max, unit), ..seen };
    ObjectRay { ray, unit }
}

/// The least number that times `unit`, rounded, is at least `t`, which is not NaN. Dividing does not find it where numbers end: there many numbers have the same product.
fn first_from(t: f32, unit: f32) -> f32 {
    // Numbers of one sign are ordered as their bits are.
    let largest = f32::INFINITY.to_bits();
    let first_where = |holds: &dyn Fn(f32) -> bool| {
        let (mut low, mut high) = (0, largest + 1);
        while low < high {
            let middle = (low + high) / 2;
            if holds(f32::from_bits(middle)) { high = middle } else { low = middle + 1 }
        }
        low
    };
    if t > 0.0 {
        f32::from_bits(first_where(&|number| number * unit >= t))
    } else {
        // Zero never lies beyond, so there is one before the first that does.
        -f32::from_bits(first_where(&|number| number * unit > -t) - 1)
    }
}
