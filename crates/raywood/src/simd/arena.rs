//! Things of whole cache lines side by side in one piece of memory, found by the number of their first line: so that where a thing lies follows
//! from a number alone, whatever kind of thing it is.

use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Plain numbers that fill whole cache lines.
///
/// # Safety
///
/// The type is made of `u32` and `f32` without gaps, its size is a multiple of 64 bytes and its alignment at most that.
pub(crate) unsafe trait Lines: Copy {}

// SAFETY: numbers without gaps, as their files assert of the sizes.
unsafe impl Lines for crate::structures::WideNode {}
// SAFETY: as above.
unsafe impl Lines for crate::geometry::TriangleBlock {}

/// A cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct Line([u32; 16]);

/// Things of whole cache lines. What is found under a number is of the kind that is asked for, if only in bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Arena(Vec<Line>);

impl Arena {
    /// How many lines there are.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// So many lines, which `fill` fills, and what that returns; `None` if it [abandons](Part::abandon) any of them. Lines that it leaves alone are zeros. Memory is touched for the first time where it is filled,
    /// by the thread that does so: a page fault costs more than filling a page.
    pub(crate) fn filled<R>(lines: usize, fill: impl FnOnce(Part<'_>) -> R) -> Option<(Self, R)> {
        let mut all = Vec::with_capacity(lines);
        huge_pages::ask_for(all.spare_capacity_mut());
        let is_abandoned = AtomicBool::new(false);
        let room = &mut all.spare_capacity_mut()[..lines];
        let result = fill(Part { lines: room, first: 0, is_abandoned: &is_abandoned });
        if is_abandoned.into_inner() {
            return None;
        }
        // SAFETY: there is room for as many lines. Every line belonged to a part, and parts write all their lines, when asked to or when they are dropped, as none is
        // abandoned; whoever fills arenas forgets none.
        unsafe { all.set_len(lines) };
        Some((Self(all), result))
    }

    /// The thing whose first line has this number.
    ///
    /// # Panics
    ///
    /// If there are not as many lines.
    #[inline(always)]
    pub(crate) fn get<T: Lines>(&self, line: usize) -> &T {
        let lines = &self.0[line..line + size_of::<T>() / 64];
        // SAFETY: the lines are as large as the thing and as well aligned, and any bits are numbers.
        unsafe { &*lines.as_ptr().cast() }
    }

    /// The same, to be damaged by tests.
    #[cfg(test)]
    pub(crate) fn get_mut<T: Lines>(&mut self, line: usize) -> &mut T {
        let lines = &mut self.0[line..line + size_of::<T>() / 64];
        // SAFETY: as above.
        unsafe { &mut *lines.as_mut_ptr().cast() }
    }

    /// Adds lines of zeros that nothing refers to.
    #[cfg(test)]
    pub(crate) fn grow(&mut self, lines: usize) {
        self.0.resize(self.len() + lines, Line([0; 16]));
    }

    /// Where a line lies in memory, to be fetched; it need not exist.
    #[inline(always)]
    pub(crate) fn address(&self, line: usize) -> *const u8 {
        self.0.as_ptr().wrapping_add(line).cast()
    }
}

/// Some of the lines of an arena, side by side, to be filled: so that threads can each fill their own. What was not filled becomes zeros when it is dropped; so parts
/// must not be forgotten.
pub(crate) struct Part<'a> {
    lines: &'a mut [MaybeUninit<Line>],
    /// The number of the first of them.
    first: usize,
    /// Whether the whole arena is given up.
    is_abandoned: &'a AtomicBool,
}

impl Part<'_> {
    /// The number of its first line.
    pub(crate) fn first(&self) -> usize {
        self.first
    }

    /// How many lines there are.
    pub(crate) fn len(&self) -> usize {
        self.lines.len()
    }

    /// Takes so many lines from its front.
    ///
    /// # Panics
    ///
    /// If there are not as many.
    pub(crate) fn take(&mut self, lines: usize) -> Self {
        let (front, rest) = std::mem::take(&mut self.lines).split_at_mut(lines);
        let part = Self { lines: front, first: self.first, is_abandoned: self.is_abandoned };
        (self.lines, self.first) = (rest, self.first + lines);
        part
    }

    /// Puts a thing into its first lines, which it has no more then.
    ///
    /// # Panics
    ///
    /// If there are not as many as the thing has.
    #[inline(always)]
    pub(crate) fn put<T: Lines>(&mut self, thing: T) {
        let mut part = self.take(size_of::<T>() / 64);
        let lines = std::mem::take(&mut part.lines);
        // SAFETY: the lines are as large as the thing and as well aligned, and any bits are numbers.
        unsafe { lines.as_mut_ptr().cast::<T>().write(thing) }
    }

    /// Gives up the whole arena: nothing more need be written.
    pub(crate) fn abandon(self) {
        self.is_abandoned.store(true, Relaxed);
    }
}

impl Drop for Part<'_> {
    fn drop(&mut self) {
        if self.lines.is_empty() || self.is_abandoned.load(Relaxed) {
            return;
        }
        for line in &mut *self.lines {
            line.write(Line([0; 16]));
        }
    }
}

/// Pages of 2 MiB for large arenas: fewer faults while they are filled, fewer misses while they are traced.
mod huge_pages {
    use std::mem::MaybeUninit;

    /// Asks the system to use huge pages for the memory, which may be in use or not, as far as it can.
    #[cfg(target_os = "linux")]
    pub(super) fn ask_for<T>(memory: &mut [MaybeUninit<T>]) {
        use std::ffi::{c_int, c_void};

        unsafe extern "C" {
            fn madvise(start: *mut c_void, length: usize, advice: c_int) -> c_int;
        }
        const MADV_HUGEPAGE: c_int = 14;
        const HUGE_PAGE: usize = 2 << 20;

        let start = memory.as_mut_ptr().cast::<u8>();
        let before = start.align_offset(HUGE_PAGE);
        let length = size_of_val(memory).saturating_sub(before) & !(HUGE_PAGE - 1);
        if length > 0 {
            // SAFETY: the pages lie within the memory, and the advice changes nothing but how fast they are. Where the system knows no such pages it answers with an
            // error, which nobody needs.
            unsafe { madvise(start.wrapping_add(before).cast(), length, MADV_HUGEPAGE) };
        }
    }

    #[cfg(not(target_os = "linux"))]
    pub(super) fn ask_for<T>(_: &mut [MaybeUninit<T>]) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriangleBlock;

    #[test]
    fn what_is_not_filled_becomes_zeros() {
        let mut block = TriangleBlock::default();
        block.set(3, 7, [crate::Vec3::ONE; 3]);
        // Of more than a huge page.
        let lines = 5 * 10_000;
        let (arena, first) = Arena::filled(lines, |mut all| {
            drop(all.take(10));
            let mut part = all.take(20);
            part.put(block);
            assert_eq!((part.first(), part.len()), (15, 15));
            all.first()
        })
        .expect("nothing is abandoned");
        assert_eq!((arena.len(), first), (lines, 30));
        for line in (0..lines).step_by(5) {
            let expected = if line == 10 { block } else { TriangleBlock::default() };
            assert_eq!(*arena.get::<TriangleBlock>(line), expected, "line {line}");
        }
    }

    #[test]
    fn an_abandoned_arena_is_none() {
        let filled = Arena::filled(10, |mut all| {
            all.take(3).abandon();
            all.put(TriangleBlock::default());
        });
        assert!(filled.is_none());
    }

    #[test]
    #[should_panic(expected = "mid > len")]
    fn there_is_no_more_room_than_there_is() {
        Arena::filled(4, |mut all| all.put(TriangleBlock::default()));
    }
}
