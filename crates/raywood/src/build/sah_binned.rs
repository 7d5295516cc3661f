//! The binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007.

use super::driver::{Around, LARGE_SET, Set, Split, Splitter, split_at_median};
use super::sah_small::{self, SMALL_SET};
use super::{PackedAabb, Primitive, Work};
use crate::{BuildOptions, parallel};

/// The most bins per axis.
pub(super) const MAX_BINS: usize = 32;

/// Sets up to this size are sorted into few bins: clearing and sweeping many would take longer than all the rest.
const MEDIUM_SET: usize = 32;

/// The bins of such a set.
const MEDIUM_SET_BINS: usize = 8;

/// Large sets are binned and divided in pieces of this size, whatever the number of threads.
const PIECE: usize = 8192;

/// Sorts centroids into equal bins along each axis and splits between the two bins where `N_l*A_l + N_r*A_r` is smallest.
/// Does not split where a leaf is cheaper (natural termination). Of a few primitives every split is tried.
pub(super) struct BinnedSah {
    options: BuildOptions,
}

impl BinnedSah {
    /// With options whose values are in range.
    pub(super) fn new(options: &BuildOptions) -> Self {
        Self { options: options.clamped() }
    }

    /// Divides a set at the best place between `bins` bins, at most `BINS`, a power of two.
    fn split_between<const BINS: usize>(&self, set: &mut Set<'_>, bins: usize) -> Option<Split> {
        let (count, work) = (set.primitives.len(), set.work);
        let binning = Binning::new(&set.around.centers, bins);
        let pieces = match set.spare {
            [] => vec![],
            _ => parallel::map_pieces(set.primitives, PIECE, |piece| match work.ask() {
                Ok(()) => Bins::<BINS>::of(&binning, piece),
                Err(_) => Bins::NOTHING,
            }),
        };
        work.check().ok()?;
        let bins = match pieces.split_first() {
            None => Bins::of(&binning, set.primitives),
            Some((first, rest)) => rest.iter().fold(first.clone(), Bins::merged),
        };
        let place = bins.best_place(&binning);

        // Natural termination: leave the set whole where testing all of it costs no more than the best split, as long
        // as it is small enough to be a leaf.
        let is_cheaper =
            |place: &Place| self.options.split_is_cheaper(count, &set.around.bounds, place.cost);
        if count <= self.options.max_leaf_size && !place.as_ref().is_some_and(is_cheaper) {
            return None;
        }

        // All centroids in one place, or too close to tell apart: any half is as good as another.
        let Some(place) = place else { return Some(split_at_median(set)) };
        let side = Side { binning: &binning, axis: place.axis, end: binning.value(place.bin) };
        let [left, right] = bins.bounds_around(&binning, &place);
        let (left_count, centers) = match set.spare {
            [] => side.partition(set.primitives),
            _ => {
                let counts = pieces.iter().map(|bins| bins.count_before(&place));
                side.copy(set.primitives, set.spare, counts, work)
            }
        };
        debug_assert_eq!(left_count, bins.count_before(&place));
        Some(Split {
            left_count,
            left: Around { bounds: left, centers: centers[0] },
            right: Around { bounds: right, centers: centers[1] },
            in_spare: !set.spare.is_empty(),
        })
    }
}

impl Splitter for BinnedSah {
    const USES_SPARE: bool = true;

    fn split(&self, set: &mut Set<'_>) -> Option<Split> {
        debug_assert!(set.spare.is_empty() || set.primitives.len() > LARGE_SET);
        match (set.primitives.len(), self.options.bins) {
            (..=SMALL_SET, _) => sah_small::split(set, &self.options),
            (..=MEDIUM_SET, bins) => {
                self.split_between::<MEDIUM_SET_BINS>(set, bins.min(MEDIUM_SET_BINS))
            }
            (_, bins @ ..=16) => self.split_between::<16>(set, bins),
            (_, bins) => self.split_between::<MAX_BINS>(set, bins),
        }
    }
}

/// Which bin a centroid belongs to, on each axis.
struct Binning {
    start: [f32; 4],
    scale: [f32; 4],
    last: f32,
}

/// 2^23: floats from here to its double are the whole numbers, and their low bits the numbers less this.
const WHOLE: f32 = 8_388_608.0;

impl Binning {
    /// `bins` equal bins over the box of all centroids.
    fn new(centers: &PackedAabb, bins: usize) -> Self {
        Self {
            start: centers.min(),
            scale: centers.extent().map(|e| bins as f32 / e),
            last: bins as f32 - 1.0,
        }
    }

    /// The number of the bin on one axis, as a float from [`WHOLE`] on, which takes no conversion. Not a number (no extent) is in the last one.
    #[inline(always)]
    fn along(&self, center: f32, axis: usize) -> f32 {
        let place = (center - self.start[axis]) * self.scale[axis] - 0.5;
        let place = if place < self.last { place } else { self.last };
        let place = if place > 0.0 { place } else { 0.0 };
        place + WHOLE
    }

    /// What [`along`](Self::along) gives for a bin.
    fn value(&self, bin: usize) -> f32 {
        bin as f32 + WHOLE
    }

    /// How many bins there are.
    fn bins(&self) -> usize {
        self.last as usize + 1
    }
}

/// What falls into the bins of each axis.
#[derive(Clone)]
struct Bins<const BINS: usize> {
    bounds: [[PackedAabb; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

/// A place to split: between two bins of an axis.
struct Place {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    cost: f64,
}

impl<const BINS: usize> Bins<BINS> {
    const NOTHING: Self = Self { bounds: [[PackedAabb::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    fn of(binning: &Binning, primitives: &[Primitive]) -> Self {
        let mut all = Self::NOTHING;
        for primitive in primitives {
            let center = primitive.center();
            // Not `map`, which the compiler does not always inline.
            let along = |axis: usize| binning.along(center[axis], axis).to_bits() as usize % BINS;
            for (axis, bin) in [along(0), along(1), along(2)].into_iter().enumerate() {
                all.bounds[axis][bin].grow(primitive.bounds());
                all.counts[axis][bin] += 1;
            }
        }
        all
    }

    fn merged(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bounds[axis][bin].grow(&other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The cheapest of all places between two bins, if any separates the primitives.
    fn best_place(&self, binning: &Binning) -> Option<Place> {
        let bins = binning.bins();
        let mut best = Place { axis: 0, bin: 0, cost: f64::INFINITY };
        for axis in 0..3 {
            let (bounds, counts) = (&self.bounds[axis][..bins], &self.counts[axis][..bins]);
            // From the right: what lies at or beyond each bin costs.
            let mut costs = [0.0; BINS];
            let (mut right, mut count) = (PackedAabb::EMPTY, 0);
            for (bin, cost) in costs[..bins].iter_mut().enumerate().rev() {
                right.grow(&bounds[bin]);
                count += counts[bin];
                *cost = f64::from(count) * right.half_area();
            }

            // From the left: the cost of splitting before each bin. With nothing on one side it is not a number, nought times infinity.
            let (mut left, mut count) = (PackedAabb::EMPTY, 0);
            for (bin, right_cost) in costs[..bins].iter().enumerate().skip(1) {
                left.grow(&bounds[bin - 1]);
                count += counts[bin - 1];
                let cost = f64::from(count) * left.half_area() + right_cost;
                if cost < best.cost {
                    best = Place { axis, bin, cost };
                }
            }
        }
        (best.bin > 0).then_some(best)
    }

    /// The boxes around what lies on both sides of a place.
    fn bounds_around(&self, binning: &Binning, place: &Place) -> [PackedAabb; 2] {
        let (left, right) = self.bounds[place.axis][..binning.bins()].split_at(place.bin);
        [left, right].map(|bins| bins.iter().fold(PackedAabb::EMPTY, |all, bin| all.union(*bin)))
    }

    /// How many primitives lie to the left of a place.
    fn count_before(&self, place: &Place) -> usize {
        self.counts[place.axis][..place.bin].iter().sum::<u32>() as usize
    }
}

/// What lies to the left of a place.
struct Side<'a> {
    binning: &'a Binning,
    axis: usize,
    /// The first bin of the right side, as [`Binning::along`] gives it.
    end: f32,
}

impl Side<'_> {
    /// Whether a primitive goes left; and it is added to the box of centres on its side.
    #[inline(always)]
    fn take(&self, primitive: &Primitive, centers: &mut [PackedAabb; 2]) -> bool {
        let center = primitive.center();
        let goes_left = self.binning.along(center[self.axis], self.axis) < self.end;
        let mask = u32::from(goes_left).wrapping_neg();
        centers[0] = centers[0].including_if(mask, center);
        centers[1] = centers[1].including_if(!mask, center);
        goes_left
    }

    /// Moves what goes left to the front and tells how many they are, and the boxes around the centres of both sides.
    fn partition(&self, primitives: &mut [Primitive]) -> (usize, [PackedAabb; 2]) {
        let mut centers = [PackedAabb::EMPTY; 2];
        // Every primitive is swapped to the end of those that go left, which counts it among them or not: no branch to be foreseen.
        let mut left_count = 0;
        for place in 0..primitives.len() {
            let goes_left = self.take(&primitives[place], &mut centers);
            primitives.swap(place, left_count);
            left_count += usize::from(goes_left);
        }
        (left_count, centers)
    }

    /// Copies what goes left to the front of another place and the rest behind it, each in its order, and tells the same. So many go left of each piece.
    fn copy(
        &self,
        primitives: &[Primitive],
        copies: &mut [Primitive],
        left_counts: impl Iterator<Item = usize> + Clone,
        work: Work<'_>,
    ) -> (usize, [PackedAabb; 2]) {
        let left_count = left_counts.clone().sum();
        let (mut lefts, mut rights) = copies.split_at_mut(left_count);
        let mut tasks = Vec::new();
        for (piece, left_count) in primitives.chunks(PIECE).zip(left_counts) {
            let (left, other_lefts) = lefts.split_at_mut(left_count);
            let (right, other_rights) = rights.split_at_mut(piece.len() - left_count);
            (lefts, rights) = (other_lefts, other_rights);
            tasks.push((piece, left, right));
        }
        let centers = parallel::map_tasks(tasks, |(piece, left, right)| {
            let mut centers = [PackedAabb::EMPTY; 2];
            if work.ask().is_err() {
                return centers;
            }
            let mut sides = [right.iter_mut(), left.iter_mut()];
            for primitive in piece {
                let goes_left = self.take(primitive, &mut centers);
                if let Some(copy) = sides[usize::from(goes_left)].next() {
                    *copy = *primitive;
                }
            }
            centers
        });
        let both = centers.iter().fold([PackedAabb::EMPTY; 2], |all, piece| {
            [all[0].union(piece[0]), all[1].union(piece[1])]
        });
        (left_count, both)
    }
}
