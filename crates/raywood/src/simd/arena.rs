//! Things of whole cache lines side by side in one piece of memory, found by the number of their first line: so that where a thing lies follows
//! from a number alone, whatever kind of thing it is.

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

    /// So many lines of zeros.
    pub(crate) fn new(lines: usize) -> Self {
        Self(crate::parallel::map(lines, |_| Line([0; 16])))
    }

    /// All lines, to be filled.
    pub(crate) fn all(&mut self) -> Part<'_> {
        Part { lines: &mut self.0, first: 0 }
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

/// Some of the lines of an arena, side by side, to be filled: so that threads can each fill their own.
pub(crate) struct Part<'a> {
    lines: &'a mut [Line],
    /// The number of the first of them.
    first: usize,
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
        let part = Self { lines: front, first: self.first };
        (self.lines, self.first) = (rest, self.first + lines);
        part
    }

    /// Puts a thing into its first lines.
    ///
    /// # Panics
    ///
    /// If there are not as many as the thing has.
    pub(crate) fn put<T: Lines>(&mut self, thing: T) {
        let lines = &mut self.lines[..size_of::<T>() / 64];
        // SAFETY: the lines are as large as the thing and as well aligned, and any bits are numbers.
        unsafe { lines.as_mut_ptr().cast::<T>().write(thing) }
    }
}
