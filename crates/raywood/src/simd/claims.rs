//! The things of an arena given out to be changed, each line to one only: so that threads can change what they find by numbers in things, whatever these numbers are.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::arena::{Line, Lines};
use super::prefetch_address;

/// Lines of an arena that nobody else has.
pub(crate) struct Claims<'a> {
    /// The first of them.
    lines: *mut Line,
    len: usize,
    /// A bit for each line that was given out.
    taken: Vec<AtomicU64>,
    borrowed: PhantomData<&'a mut [Line]>,
}

// SAFETY: it stands for a unique borrow of lines of numbers, and gives each of them to one thread only.
unsafe impl Sync for Claims<'_> {}

impl<'a> Claims<'a> {
    /// All these lines, of which none is given out yet.
    pub(super) fn of(lines: &'a mut [Line]) -> Self {
        let taken = (0..lines.len().div_ceil(64)).map(|_| AtomicU64::new(0)).collect();
        Self { lines: lines.as_mut_ptr(), len: lines.len(), taken, borrowed: PhantomData }
    }

    /// The thing whose first line has this number, unless a line of it was asked for before or does not exist.
    #[inline(always)]
    pub(crate) fn take<T: Lines>(&self, line: usize) -> Option<&'a mut T> {
        let end = line.checked_add(size_of::<T>() / 64).filter(|&end| end <= self.len)?;
        if !self.are_free(line..end) {
            return None;
        }
        // SAFETY: the lines exist, are as large as the thing and as well aligned, and any bits are numbers. They are borrowed for `'a`, in which each is given out once.
        Some(unsafe { &mut *self.lines.add(line).cast() })
    }

    /// Asks for the memory of a thing, which need not exist, to be fetched soon.
    #[inline(always)]
    pub(crate) fn prefetch<T: Lines>(&self, line: usize) {
        for line in line..line + size_of::<T>() / 64 {
            prefetch_address(self.lines.wrapping_add(line).cast());
        }
    }

    /// Whether nobody asked for any of some lines before, a few of which there are.
    #[inline(always)]
    fn are_free(&self, lines: Range<usize>) -> bool {
        let (first, last) = (lines.start / 64, (lines.end - 1) / 64);
        let bits = ((1 << lines.len()) - 1) << (lines.start % 64);
        let below = self.taken[first].fetch_or(bits, Relaxed) & bits;
        if first == last {
            return below == 0;
        }
        let bits = (1 << (lines.end % 64)) - 1;
        let above = self.taken[last].fetch_or(bits, Relaxed) & bits;
        below | above == 0
    }
}

#[cfg(test)]
mod tests {
    use crate::Vec3;
    use crate::geometry::TriangleBlock;
    use crate::simd::{Arena, Part};

    /// So many blocks of a number each.
    fn blocks(count: u32) -> Arena {
        let fill = |mut all: Part<'_>| {
            for number in 0..count {
                let mut block = TriangleBlock::default();
                block.set(0, number, [Vec3::ONE; 3]);
                all.put(block);
            }
        };
        Arena::filled(5 * count as usize, fill).expect("nothing is abandoned").0
    }

    #[test]
    fn every_line_is_given_out_once() {
        let mut arena = blocks(40);
        let claims = arena.claims().expect("nobody shares it");
        assert!(claims.take::<TriangleBlock>(196).is_none(), "there are 200 lines");
        assert!(claims.take::<TriangleBlock>(usize::MAX).is_none());
        // From one word of bits to the next, too.
        for number in 0..39 {
            let block: &mut TriangleBlock = claims.take(5 * number).expect("nobody has it");
            assert_eq!(block.primitives[0] as usize, number);
        }
        assert!((0..195).all(|line| claims.take::<TriangleBlock>(line).is_none()));
    }

    #[test]
    fn what_is_shared_is_not_given_out_but_its_copy() {
        // More than a piece.
        let mut arena = blocks(4000);
        let shared = arena.clone();
        assert!(arena.claims().is_none());
        arena = arena.copied();
        assert_eq!(arena, shared);
        let claims = arena.claims().expect("nobody shares the copy");
        claims.take::<TriangleBlock>(50).expect("nobody has it").primitives[0] = 77;
        assert_eq!(shared.get::<TriangleBlock>(50).primitives[0], 10);
        assert_eq!(arena.get::<TriangleBlock>(50).primitives[0], 77);
    }
}
