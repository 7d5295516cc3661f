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

    /// Adds a thing and returns the number of its first line.
    pub(crate) fn push<T: Lines>(&mut self, thing: T) -> usize {
        let line = self.len();
        self.0.resize(line + size_of::<T>() / 64, Line([0; 16]));
        *self.get_mut(line) = thing;
        line
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

    /// The same, to be changed.
    ///
    /// # Panics
    ///
    /// If there are not as many lines.
    pub(crate) fn get_mut<T: Lines>(&mut self, line: usize) -> &mut T {
        let lines = &mut self.0[line..line + size_of::<T>() / 64];
        // SAFETY: as above.
        unsafe { &mut *lines.as_mut_ptr().cast() }
    }

    /// Where a line lies in memory, to be fetched; it need not exist.
    #[inline(always)]
    pub(crate) fn address(&self, line: usize) -> *const u8 {
        self.0.as_ptr().wrapping_add(line).cast()
    }
}
