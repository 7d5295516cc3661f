//! Vertices a fixed number of bytes or numbers apart, with whatever else between them.

use std::fmt;
use std::marker::PhantomData;

use super::Vertices;
use crate::Vec3;
use crate::simd::prefetch_item;

/// Vertices at a fixed distance from each other in memory, as interleaved buffers have them: three `f32` in a row each.
///
/// `B` is what holds the memory, borrowed or owned: a slice, a `Vec`, an `Arc<[u8]>`, a mapped file. There are as many vertices as fit, or fewer if [told so](Self::take).
/// Every read is checked against the memory's length; bytes need not be aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strided<B, T> {
    memory: B,
    /// In items of the memory, as the stride.
    offset: usize,
    stride: usize,
    len: usize,
    item: PhantomData<fn() -> T>,
}

/// Why memory cannot be read as strided vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StridedError {
    /// Vertices would overlap.
    ShortStride {
        /// From one vertex to the next, in bytes or numbers.
        stride: usize,
        /// What one takes.
        least: usize,
    },
    /// There are fewer vertices than asked for.
    TooFew {
        /// How many were asked for.
        wanted: usize,
        /// How many there are.
        vertices: usize,
    },
}

impl fmt::Display for StridedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ShortStride { stride, least } => {
                let unit = if *least == 3 { "numbers" } else { "bytes" };
                write!(f, "a stride of {stride} {unit}, but a vertex takes {least}")
            }
            Self::TooFew { wanted, vertices } => {
                write!(f, "{wanted} vertices were asked for, but the memory has {vertices}")
            }
        }
    }
}

impl std::error::Error for StridedError {}

impl<B: AsRef<[u8]>> Strided<B, u8> {
    /// Vertices in bytes, in the byte order of the machine: the first `offset` bytes from the beginning, each of the others `stride` bytes after the one before.
    ///
    /// # Errors
    ///
    /// A stride of less than 12 bytes.
    pub fn of_bytes(memory: B, offset: usize, stride: usize) -> Result<Self, StridedError> {
        let items = memory.as_ref().len();
        Self::new(memory, items, offset, stride, 12)
    }
}

impl<B: AsRef<[f32]>> Strided<B, f32> {
    /// Vertices among numbers: the first `offset` numbers from the beginning, each of the others `stride` numbers after the one before.
    ///
    /// # Errors
    ///
    /// A stride of less than 3 numbers.
    pub fn of_floats(memory: B, offset: usize, stride: usize) -> Result<Self, StridedError> {
        let items = memory.as_ref().len();
        Self::new(memory, items, offset, stride, 3)
    }
}

impl<B, T> Strided<B, T> {
    /// Vertices of `least` items each in a memory of so many items.
    fn new(
        memory: B,
        items: usize,
        offset: usize,
        stride: usize,
        least: usize,
    ) -> Result<Self, StridedError> {
        if stride < least {
            return Err(StridedError::ShortStride { stride, least });
        }
        // The last one needs no room behind it.
        let room = items.saturating_sub(offset);
        let len = if room < least { 0 } else { (room - least) / stride + 1 };
        Ok(Self { memory, offset, stride, len, item: PhantomData })
    }

    /// The first so many of them, where the memory goes on with something else.
    ///
    /// # Errors
    ///
    /// There are fewer.
    pub fn take(self, vertices: usize) -> Result<Self, StridedError> {
        if vertices > self.len {
            return Err(StridedError::TooFew { wanted: vertices, vertices: self.len });
        }
        Ok(Self { len: vertices, ..self })
    }
}

impl<B: AsRef<[u8]> + Sync> Vertices for Strided<B, u8> {
    fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    fn position(&self, vertex: usize) -> Vec3 {
        let start = self.offset + vertex * self.stride;
        let bytes = &self.memory.as_ref()[start..start + 12];
        let number = |at: usize| {
            f32::from_ne_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        Vec3::new(number(0), number(4), number(8))
    }

    #[inline(always)]
    fn prefetch(&self, vertex: usize) {
        prefetch_item(self.memory.as_ref(), self.offset + vertex * self.stride);
    }
}

impl<B: AsRef<[f32]> + Sync> Vertices for Strided<B, f32> {
    fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    fn position(&self, vertex: usize) -> Vec3 {
        let start = self.offset + vertex * self.stride;
        let numbers = &self.memory.as_ref()[start..start + 3];
        Vec3::new(numbers[0], numbers[1], numbers[2])
    }

    #[inline(always)]
    fn prefetch(&self, vertex: usize) {
        prefetch_item(self.memory.as_ref(), self.offset + vertex * self.stride);
    }
}
