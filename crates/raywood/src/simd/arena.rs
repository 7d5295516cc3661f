//! Things of whole cache lines side by side in one piece of memory, found by the number of their first line: so that where a thing lies follows
//! from a number alone, whatever kind of thing it is.

use std::mem::MaybeUninit;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use super::claims::Claims;
use super::huge_pages;
use crate::parallel;
use crate::storage::{Array, Plain, bytes_of};

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
pub(super) struct Line([u32; 16]);

// SAFETY: sixteen numbers, as large as a cache line.
unsafe impl Plain for Line {}

// SAFETY: sixteen numbers, as large as a cache line.
unsafe impl Lines for Line {}

/// So many lines a thread copies at a time.
const PIECE: usize = 1 << 14;

/// Things of whole cache lines. What is found under a number is of the kind that is asked for, if only in bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Arena(Array<Line>);

impl Arena {
    /// How many lines there are.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// So many lines, which `fill` fills, and what that returns; `None` if it [abandons](Part::abandon) any of them. Lines that it leaves alone are zeros. Memory is touched for the first time where it is filled,
    /// by the thread that does so: a page fault costs more than filling a page.
    pub(crate) fn filled<R>(lines: usize, fill: impl FnOnce(Part<'_>) -> R) -> Option<(Self, R)> {
        let (all, result) = ArenaInMaking::with_room_for(lines).extended(lines, fill)?;
        Some((all.finish(), result))
    }

    /// The lines in some bytes of memory that something else holds, where they are if they lie well. Of a number of bytes that is no multiple of 64 the rest is left out.
    pub(crate) fn within(bytes: &Array<u8>, range: Range<usize>) -> Self {
        Self(bytes.within(range))
    }

    /// All lines, as the bytes that they are in memory.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }

    /// Some lines, as the bytes that they are in memory.
    ///
    /// # Panics
    ///
    /// If there are not as many.
    pub(crate) fn bytes_of(&self, lines: Range<usize>) -> &[u8] {
        bytes_of(&self.0[lines])
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

    /// Whether the lines were made here and nobody shares them, so that they can be changed.
    pub(crate) fn is_alone(&mut self) -> bool {
        self.0.get_mut().is_some()
    }

    /// All lines, to be changed, if they were made here and nobody shares them; else none.
    pub(crate) fn claims(&mut self) -> Option<Claims<'_>> {
        self.0.get_mut().map(Claims::of)
    }

    /// A copy that nobody shares, made in parallel.
    pub(crate) fn copied(&self) -> Self {
        let filled = Self::filled(self.len(), |mut all| {
            let pieces = self.0.chunks(PIECE);
            let tasks = pieces.map(|lines| (all.take(lines.len()), lines)).collect();
            parallel::map_tasks(tasks, |(mut part, lines): (Part<'_>, &[Line])| {
                lines.iter().for_each(|&line| part.put(line));
            });
        });
        filled.map_or_else(Self::default, |(copy, _)| copy)
    }

    /// The same, to be damaged by tests.
    #[cfg(test)]
    pub(crate) fn get_mut<T: Lines>(&mut self, line: usize) -> &mut T {
        let lines = &mut self.0.to_mut()[line..line + size_of::<T>() / 64];
        // SAFETY: as above.
        unsafe { &mut *lines.as_mut_ptr().cast() }
    }

    /// Adds lines of zeros that nothing refers to.
    #[cfg(test)]
    pub(crate) fn grow(&mut self, lines: usize) {
        let mut all = self.0.to_vec();
        all.resize(self.len() + lines, Line([0; 16]));
        self.0 = all.into();
    }

    /// Where a line lies in memory, to be fetched; it need not exist.
    #[inline(always)]
    pub(crate) fn address(&self, line: usize) -> *const u8 {
        self.0.as_ptr().wrapping_add(line).cast()
    }
}

/// An arena to which lines are still added.
pub(crate) struct ArenaInMaking(Vec<Line>);

impl ArenaInMaking {
    /// No lines yet, with room for so many.
    pub(crate) fn with_room_for(lines: usize) -> Self {
        Self(huge_pages::vec_for(lines))
    }

    /// So many lines more, filled as [`Arena::filled`] says. If there is no room for them, everything moves to where there is.
    pub(crate) fn extended<R>(
        self,
        lines: usize,
        fill: impl FnOnce(Part<'_>) -> R,
    ) -> Option<(Self, R)> {
        let Self(mut all) = self;
        all.reserve_exact(lines);
        let first = all.len();
        let is_abandoned = AtomicBool::new(false);
        let room = &mut all.spare_capacity_mut()[..lines];
        let result = fill(Part { lines: room, first, is_abandoned: &is_abandoned });
        if is_abandoned.into_inner() {
            return None;
        }
        // SAFETY: there is room for as many lines. Every line belonged to a part, and parts write all their lines, when asked to or when they are dropped, as none is
        // abandoned; whoever fills arenas forgets none.
        unsafe { all.set_len(first + lines) };
        Some((Self(all), result))
    }

    /// The arena as it is.
    pub(crate) fn finish(self) -> Arena {
        Arena(self.0.into())
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

impl<'a> Part<'a> {
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

    /// The same of a thing that is still to be written to.
    ///
    /// # Panics
    ///
    /// As [`put`](Self::put).
    #[inline(always)]
    pub(crate) fn put_default<T: Lines + Default>(&mut self) -> &'a mut T {
        let mut part = self.take(size_of::<T>() / 64);
        let lines = std::mem::take(&mut part.lines);
        let thing = lines.as_mut_ptr().cast::<T>();
        // SAFETY: the lines are as large as the thing and as well aligned; they are borrowed from the arena, whose lines no other part has.
        unsafe {
            thing.write(T::default());
            &mut *thing
        }
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
    fn lines_are_added_with_room_for_them_or_without() {
        for room in [0, 5, 20] {
            let (arena, ()) = ArenaInMaking::with_room_for(room)
                .extended(5, |mut all| *all.put_default() = block_of(1))
                .and_then(|(arena, ())| {
                    arena.extended(5, |mut more| more.put(block_of(more.first() as u32)))
                })
                .expect("nothing is abandoned");
            let arena = arena.finish();
            assert_eq!(arena.len(), 10);
            assert_eq!(*arena.get::<TriangleBlock>(0), block_of(1));
            assert_eq!(*arena.get::<TriangleBlock>(5), block_of(5));
        }
    }

    fn block_of(primitive: u32) -> TriangleBlock {
        let mut block = TriangleBlock::default();
        block.set(0, primitive, [crate::Vec3::ONE; 3]);
        block
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
