//! Codes for all primitives: sixteen at a time, and what is around them is found on the way.

use super::driver::Around;
use super::morton::{FAR, KeyBits, Morton};
use super::{Cancelled, PackedAabb, Work};
use crate::simd::{Float, Kernel, Simd, dispatch_on};
use crate::{Geometry, SimdLevel, parallel};

/// By which share of its length along an axis the box in which centres are expected reaches further for what is near.
const NEAR: f32 = 0.5;

/// What is seen on the way while keys are made.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    pub(super) around: Around,
    /// How many centres lie outside of where they were expected.
    pub(super) outside: usize,
    /// How many of these lie far away.
    pub(super) far: usize,
    /// The first primitive whose bounds are none.
    pub(super) first_bad: Option<u32>,
}

impl Seen {
    const NOTHING: Self = Self { around: Around::NOTHING, outside: 0, far: 0, first_bad: None };

    /// Makes it what was seen of primitives before and of some behind them.
    fn add(&mut self, behind: &Self) {
        self.around.grow(&behind.around);
        self.outside += behind.outside;
        self.far += behind.far;
        self.first_bad = self.first_bad.or(behind.first_bad);
    }
}

/// What makes keys.
pub(super) struct Encoder<'a, G> {
    geometry: &'a G,
    morton: Morton,
    /// Where centres are expected.
    expected: PackedAabb,
    /// What is near to that.
    near: PackedAabb,
}

impl<'a, G: Geometry> Encoder<'a, G> {
    /// One whose codes count the cells of a box. What is outside but near falls into the cells at the sides; what is far is marked.
    pub(super) fn for_centers_in(expected: PackedAabb, geometry: &'a G, bits: KeyBits) -> Self {
        let morton = Morton::new(&expected, bits);
        Self { geometry, morton, expected, near: expected.stretched(NEAR) }
    }

    /// Writes the keys of all primitives, and tells what it sees on the way. O(n), in parallel, the same for any number of threads.
    pub(super) fn encode(&self, keys: &mut [u64], work: Work<'_>) -> Result<Seen, Cancelled> {
        let level = SimdLevel::active();
        let piece = |first: usize, keys: &mut [u64]| {
            dispatch_on(level, EncodePiece { encoder: self, first: first as u32, keys })
        };
        parallel::fill_pieces_and_fold(keys, work, Seen::NOTHING, piece, Seen::add)
    }
}

/// Writes the keys of some primitives, from the first of these on.
struct EncodePiece<'a, G> {
    encoder: &'a Encoder<'a, G>,
    first: u32,
    keys: &'a mut [u64],
}

impl<G: Geometry> Kernel for EncodePiece<'_, G> {
    type Output = Seen;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Seen {
        let Encoder { geometry, morton, expected, near } = self.encoder;
        let (half, infinity) = (simd.splat16(0.5), simd.splat16(f32::INFINITY));
        let mut bounds = Extent::nothing(simd);
        let mut centers = Extent::nothing(simd);
        let (mut outside, mut far, mut first_bad) = (0, 0, None);
        let mut rows = [[0.0; 8]; 16];
        for (keys, first) in self.keys.chunks_mut(16).zip((self.first..).step_by(16)) {
            for (row, number) in rows.iter_mut().zip(first..).take(keys.len()) {
                *row = PackedAabb::from(geometry.bounds(number)).row();
            }
            // Fewer than sixteen at the end: the last one once more.
            let last = rows[keys.len() - 1];
            rows[keys.len()..].fill(last);
            let some = u32::MAX >> (32 - keys.len());

            let [x, y, z, _, to_x, to_y, to_z, _] = simd.columns(&rows);
            let (min, max) = ([x, y, z], [to_x, to_y, to_z]);
            // Halves: neither a length nor a centre overflows.
            let (half_min, half_max) = (min.map(|min| min * half), max.map(|max| max * half));
            let mut sound = some;
            let mut center = half_min;
            for axis in 0..3 {
                let length = half_max[axis] - half_min[axis];
                sound &= min[axis].less_or_equal(max[axis]) & length.less(infinity);
                center[axis] = half_min[axis] + half_max[axis];
            }
            if sound != some {
                first_bad = first_bad.or(Some(first + sound.trailing_ones()));
            }
            bounds.include(&min, &max);
            centers.include(&center, &center);

            outside += (some & !inside(simd, expected, &center)).count_ones() as usize;
            let distant = some & !inside(simd, near, &center);
            keys.copy_from_slice(&morton.keys(simd, &center, first)[..keys.len()]);
            if distant != 0 {
                far += distant.count_ones() as usize;
                for (lane, key) in keys.iter_mut().enumerate() {
                    *key |= u64::from(distant >> lane & 1) * FAR;
                }
            }
        }
        let around = Around { bounds: bounds.of_all(), centers: centers.of_all() };
        Seen { around, outside, far, first_bad }
    }
}

/// Which of sixteen points lie in a box.
#[inline(always)]
fn inside<S: Simd>(simd: S, bounds: &PackedAabb, points: &[S::F16; 3]) -> u32 {
    let (min, max) = (bounds.min(), bounds.max());
    let mut inside = u32::MAX;
    for (axis, point) in points.iter().enumerate() {
        inside &= simd.splat16(min[axis]).less_or_equal(*point);
        inside &= point.less_or_equal(simd.splat16(max[axis]));
    }
    inside
}

/// The smallest boxes around what came along in each of sixteen lanes.
struct Extent<F> {
    min: [F; 3],
    max: [F; 3],
}

impl<F: Float<Array = [f32; 16]>> Extent<F> {
    #[inline(always)]
    fn nothing<S: Simd<F16 = F>>(simd: S) -> Self {
        Self { min: [simd.splat16(f32::INFINITY); 3], max: [simd.splat16(f32::NEG_INFINITY); 3] }
    }

    #[inline(always)]
    fn include(&mut self, min: &[F; 3], max: &[F; 3]) {
        for axis in 0..3 {
            self.min[axis] = min[axis].smaller(self.min[axis]);
            self.max[axis] = max[axis].larger(self.max[axis]);
        }
    }

    /// The box around all lanes, one after the other: which zero is the smaller one does not depend on the instructions.
    #[inline(always)]
    fn of_all(self) -> PackedAabb {
        let (min, max) = (self.min.map(F::to_array), self.max.map(F::to_array));
        let mut all = PackedAabb::EMPTY;
        for lane in 0..16 {
            all = all.including([min[0][lane], min[1][lane], min[2][lane], 0.0]);
            all = all.including([max[0][lane], max[1][lane], max[2][lane], 0.0]);
        }
        all
    }
}
