//! A box in the form that builders work with.

use crate::minmax::{larger, smaller};
use crate::{Aabb, Vec3};

/// A box as two groups of four numbers, the fourth of no meaning: the compiler turns a union into two vector instructions.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct PackedAabb {
    min: [f32; 4],
    max: [f32; 4],
}

/// Twice the bits of the smallest normal float, so that half of a tag is none of the denormal floats either.
const TAG_OFFSET: u32 = 2 << 23;

impl PackedAabb {
    pub(crate) const EMPTY: Self = Self { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    /// The box with a number in the lane that means nothing. Numbers are kept from looking like denormal floats, with which some processors are slow.
    #[inline(always)]
    pub(crate) fn with_tag(mut self, number: u32) -> Self {
        self.min[3] = f32::from_bits(number.wrapping_add(TAG_OFFSET));
        self
    }

    /// The number that was put into the lane that means nothing.
    #[inline(always)]
    pub(crate) fn tag(&self) -> u32 {
        self.min[3].to_bits().wrapping_sub(TAG_OFFSET)
    }

    /// The box with numbers in both lanes that mean nothing.
    #[inline(always)]
    pub(super) fn with_tags(self, [first, second]: [u32; 2]) -> Self {
        let mut tagged = self.with_tag(first);
        tagged.max[3] = f32::from_bits(second.wrapping_add(TAG_OFFSET));
        tagged
    }

    /// The numbers that were put into the lanes that mean nothing.
    #[inline(always)]
    pub(super) fn tags(&self) -> [u32; 2] {
        [self.tag(), self.max[3].to_bits().wrapping_sub(TAG_OFFSET)]
    }

    /// The smallest box around both. Neither has NaN.
    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self { min: lanes(self.min, other.min, smaller), max: lanes(self.max, other.max, larger) }
    }

    /// Makes this box the smallest one around both.
    #[inline(always)]
    pub(crate) fn grow(&mut self, other: &Self) {
        *self = self.union(*other);
    }

    /// The smallest box around this one and a point. Coordinates that are NaN change nothing.
    #[inline(always)]
    pub(crate) fn including(self, point: [f32; 4]) -> Self {
        // Of two numbers of which one is NaN these tell the second.
        Self { min: lanes(point, self.min, smaller), max: lanes(point, self.max, larger) }
    }

    /// The smallest box around this one and a point if the mask has all bits set; this one if it has none. Without a branch.
    #[inline(always)]
    pub(super) fn including_if(self, mask: u32, point: [f32; 4]) -> Self {
        let choose = |a: f32, b: f32| f32::from_bits(a.to_bits() & mask | b.to_bits() & !mask);
        let min = lanes(point, [f32::INFINITY; 4], choose);
        let max = lanes(point, [f32::NEG_INFINITY; 4], choose);
        self.union(Self { min, max })
    }

    /// Whether all coordinates are finite and the box is not empty: as [`Aabb::is_finite`] and [`Aabb::is_empty`] say, in fewer instructions.
    #[inline(always)]
    pub(super) fn is_sound(&self) -> bool {
        // Half of the length does not overflow; it is not a number, or infinite, where a coordinate is.
        let sound = |axis: usize| {
            let half = 0.5 * self.max[axis] - 0.5 * self.min[axis];
            (self.min[axis] <= self.max[axis]) & (half < f32::INFINITY)
        };
        sound(0) & sound(1) & sound(2) & sound(3)
    }

    /// Whether it holds no point: as [`Aabb::is_empty`].
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        Aabb::from(*self).is_empty()
    }

    /// The box, longer by a share of its length along each axis to either side.
    pub(super) fn stretched(&self, share: f32) -> Self {
        let beyond = self.extent().map(|length| share * length);
        Self {
            min: lanes(self.min, beyond, |min, beyond| min - beyond),
            max: lanes(self.max, beyond, |max, beyond| max + beyond),
        }
    }

    /// The centre. Does not overflow.
    #[inline(always)]
    pub(crate) fn center(&self) -> [f32; 4] {
        lanes(self.min, self.max, |a, b| 0.5 * a + 0.5 * b)
    }

    /// The smallest coordinates.
    #[inline(always)]
    pub(crate) fn min(&self) -> [f32; 4] {
        self.min
    }

    /// The largest coordinates.
    #[inline(always)]
    pub(crate) fn max(&self) -> [f32; 4] {
        self.max
    }

    /// The smallest coordinates and a number of no meaning, then the largest and another.
    #[inline(always)]
    pub(super) fn row(&self) -> [f32; 8] {
        let ([a, b, c, d], [e, f, g, h]) = (self.min, self.max);
        [a, b, c, d, e, f, g, h]
    }

    /// The lengths of the edges; may overflow to infinity.
    #[inline(always)]
    pub(crate) fn extent(&self) -> [f32; 4] {
        lanes(self.max, self.min, |a, b| a - b)
    }

    /// Half the surface area of a box that is not empty, in double precision, where no finite box overflows or vanishes.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f64 {
        // Not `map`, which the compiler does not always inline.
        let edge = |axis: usize| f64::from(self.max[axis]) - f64::from(self.min[axis]);
        let (x, y, z) = (edge(0), edge(1), edge(2));
        x * y + y * z + z * x
    }
}

impl From<Aabb> for PackedAabb {
    #[inline(always)]
    fn from(Aabb { min, max }: Aabb) -> Self {
        Self { min: [min.x, min.y, min.z, 0.0], max: [max.x, max.y, max.z, 0.0] }
    }
}

impl From<PackedAabb> for Aabb {
    #[inline(always)]
    fn from(PackedAabb { min, max }: PackedAabb) -> Self {
        Self { min: Vec3::new(min[0], min[1], min[2]), max: Vec3::new(max[0], max[1], max[2]) }
    }
}

/// `f` of each pair.
#[inline(always)]
fn lanes(a: [f32; 4], b: [f32; 4], f: impl Fn(f32, f32) -> f32) -> [f32; 4] {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])]
}
