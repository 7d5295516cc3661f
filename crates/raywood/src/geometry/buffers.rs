//! Vertices and indices in the forms in which programs have them in memory.

use std::sync::Arc;

use crate::Vec3;
use crate::simd::prefetch_item;

/// Vertices of a [`MeshView`](crate::MeshView), wherever they lie: slices, vectors and arrays of what turns into `[f32; 3]`, [`Strided`](crate::Strided) memory, references to these,
/// and what you implement it for.
///
/// They must not change as long as they are used: what was checked of them is not checked again.
pub trait Vertices: Sync {
    /// How many there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where a vertex lies. May panic if there is none of this number.
    fn position(&self, vertex: usize) -> Vec3;

    /// Asks for a vertex to be fetched from memory. The default does nothing.
    fn prefetch(&self, vertex: usize) {
        let _ = vertex;
    }
}

impl<P: Copy + Into<[f32; 3]> + Sync> Vertices for [P] {
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn position(&self, vertex: usize) -> Vec3 {
        Vec3::from(self[vertex].into())
    }

    #[inline(always)]
    fn prefetch(&self, vertex: usize) {
        prefetch_item(self, vertex);
    }
}

/// Indices of a [`MeshView`](crate::MeshView), three to a triangle: slices, vectors and arrays of `u8`, `u16` or `u32`, or of triples of these, references to such, and what
/// you implement it for.
///
/// They must not change as long as they are used: what was checked of them is not checked again.
pub trait Indices: Sync {
    /// How many indices there are, three times as many as triangles.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers of a triangle's corners. May panic if there is none of this number.
    fn triangle(&self, triangle: usize) -> [u32; 3];

    /// Asks for a triangle's indices to be fetched from memory. The default does nothing.
    fn prefetch(&self, triangle: usize) {
        let _ = triangle;
    }
}

/// A number as indices are made of.
pub trait IndexNumber: Copy + Into<u32> + Sync + sealed::Sealed {}

mod sealed {
    /// Nobody else's: else triples might be numbers too.
    pub trait Sealed {}
}

macro_rules! index_numbers {
    ($($number:ty),*) => {
        $(impl sealed::Sealed for $number {}
        impl IndexNumber for $number {})*
    };
}

index_numbers!(u8, u16, u32);

impl<N: IndexNumber> Indices for [N] {
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn triangle(&self, triangle: usize) -> [u32; 3] {
        let corners = &self[3 * triangle..3 * triangle + 3];
        [corners[0].into(), corners[1].into(), corners[2].into()]
    }

    #[inline(always)]
    fn prefetch(&self, triangle: usize) {
        prefetch_item(self, 3 * triangle);
    }
}

impl<N: IndexNumber> Indices for [[N; 3]] {
    fn len(&self) -> usize {
        3 * self.len()
    }

    #[inline(always)]
    fn triangle(&self, triangle: usize) -> [u32; 3] {
        let [a, b, c] = self[triangle];
        [a.into(), b.into(), c.into()]
    }

    #[inline(always)]
    fn prefetch(&self, triangle: usize) {
        prefetch_item(self, triangle);
    }
}

/// Has what holds others hand on every question to them.
macro_rules! hand_on {
    ($([$($generics:tt)*] $holder:ty => $items:ty),*) => {
        $(impl<$($generics)*> Vertices for $holder
        where
            $items: Vertices,
            Self: Sync,
        {
            fn len(&self) -> usize {
                let items: &$items = self;
                Vertices::len(items)
            }

            #[inline(always)]
            fn position(&self, vertex: usize) -> Vec3 {
                let items: &$items = self;
                items.position(vertex)
            }

            #[inline(always)]
            fn prefetch(&self, vertex: usize) {
                let items: &$items = self;
                Vertices::prefetch(items, vertex);
            }
        }

        impl<$($generics)*> Indices for $holder
        where
            $items: Indices,
            Self: Sync,
        {
            fn len(&self) -> usize {
                let items: &$items = self;
                Indices::len(items)
            }

            #[inline(always)]
            fn triangle(&self, triangle: usize) -> [u32; 3] {
                let items: &$items = self;
                items.triangle(triangle)
            }

            #[inline(always)]
            fn prefetch(&self, triangle: usize) {
                let items: &$items = self;
                Indices::prefetch(items, triangle);
            }
        })*
    };
}

hand_on! {
    [T: ?Sized] &T => T,
    [T: ?Sized] Box<T> => T,
    [T: ?Sized] Arc<T> => T,
    [T] Vec<T> => [T],
    [T, const N: usize] [T; N] => [T]
}
