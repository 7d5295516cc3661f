//! Arrays of plain numbers that are owned, or lie in memory that something else holds, such as a file that was mapped: so that a saved tree need not be copied.
//!
//! Unsafe for a measured need: copying what a tree of a million triangles is made of takes longer than all that is checked of it (decision 17).

#![allow(unsafe_code)]

use std::any::Any;
use std::fmt;
use std::ops::{Deref, Range};
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::ptr::NonNull;
use std::sync::Arc;

use crate::Vec3;

/// Plain numbers.
///
/// # Safety
///
/// The type is made of numbers without gaps: any bits are a value, and every byte of a value is known.
pub(crate) unsafe trait Plain: Copy + Send + Sync + 'static {}

// SAFETY: numbers without gaps.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}
// SAFETY: as above.
unsafe impl Plain for u64 {}
// SAFETY: as above.
unsafe impl Plain for [u32; 3] {}
// SAFETY: three numbers in the order of their declaration, as its layout is that of C.
unsafe impl Plain for Vec3 {}

/// Items as the bytes that they are in memory.
pub(crate) fn bytes_of<T: Plain>(items: &[T]) -> &[u8] {
    // SAFETY: the items lie there, and every byte of them is known.
    unsafe { std::slice::from_raw_parts(items.as_ptr().cast(), size_of_val(items)) }
}

/// An array that never changes while it is shared. Clones share it.
pub(crate) struct Array<T> {
    /// In the memory that `owner` holds.
    items: NonNull<[T]>,
    owner: Arc<dyn Any + Send + Sync>,
}

// SAFETY: what is reached through the pointer is changed by nobody but who has it alone, as of an `Arc<[T]>`.
unsafe impl<T: Plain> Send for Array<T> {}
// SAFETY: as above.
unsafe impl<T: Plain> Sync for Array<T> {}

// The owner is never looked at, and the items do not change while anybody looks: numbers, of which any are values.
impl<T> UnwindSafe for Array<T> {}
impl<T> RefUnwindSafe for Array<T> {}

impl Array<u8> {
    /// The bytes that the owner gives, for as long as it is held.
    pub(crate) fn held_by(owner: impl AsRef<[u8]> + Send + Sync + 'static) -> Self {
        let owner = Arc::new(owner);
        let items = NonNull::from((*owner).as_ref());
        Self { items, owner }
    }

    /// The items in some of the bytes: where they are if they are aligned there, else copied. A rest that is no whole item is left out.
    ///
    /// # Panics
    ///
    /// If there are not as many bytes.
    pub(crate) fn within<T: Plain>(&self, range: Range<usize>) -> Array<T> {
        let bytes = &self[range];
        let len = bytes.len() / size_of::<T>();
        let start = bytes.as_ptr().cast::<T>();
        if start.is_aligned() {
            let start = NonNull::from(bytes).cast::<T>();
            let items = NonNull::slice_from_raw_parts(start, len);
            return Array { items, owner: Arc::clone(&self.owner) };
        }
        // SAFETY: so many items lie within the bytes, any bits are values, and they are read without regard to alignment.
        let read = |number: usize| unsafe { start.add(number).read_unaligned() };
        let owner: Arc<Box<[T]>> = Arc::new((0..len).map(read).collect());
        // No vector: what comes from outside counts as the memory of others, wherever it lies.
        Array { items: NonNull::from(&owner[..]), owner }
    }
}

impl<T: Plain> Array<T> {
    /// The items as the bytes that they are in memory.
    pub(crate) fn as_bytes(&self) -> &[u8] {
        bytes_of(self)
    }

    /// The items, to be changed, if they were made here and nobody shares them.
    pub(crate) fn get_mut(&mut self) -> Option<&mut [T]> {
        let owned = Arc::get_mut(&mut self.owner)?.downcast_mut::<Vec<T>>()?;
        let items = NonNull::from(&mut owned[..]);
        // What lies within other items is no array of its own.
        if !std::ptr::eq(items.as_ptr(), self.items.as_ptr()) {
            return None;
        }
        self.items = items;
        // SAFETY: nobody else has the items, and this array is borrowed for as long as they are.
        Some(unsafe { self.items.as_mut() })
    }

    /// The items, to be damaged by tests: a copy of them from now on.
    #[cfg(test)]
    pub(crate) fn to_mut(&mut self) -> &mut [T] {
        *self = self.to_vec().into();
        self.get_mut().expect("nobody shares the copy")
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        // SAFETY: the items lie in memory that the owner holds, which is neither moved, as it has a place of its own, nor changed but through
        // an array that has it alone and is borrowed meanwhile.
        unsafe { self.items.as_ref() }
    }
}

impl<T: Plain> From<Vec<T>> for Array<T> {
    fn from(items: Vec<T>) -> Self {
        let owner = Arc::new(items);
        Self { items: NonNull::from(&owner[..]), owner }
    }
}

impl<T: Plain> Default for Array<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> Clone for Array<T> {
    fn clone(&self) -> Self {
        Self { items: self.items, owner: Arc::clone(&self.owner) }
    }
}

impl<T: fmt::Debug> fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_aligned_is_not_copied() {
        let bytes = Array::held_by((0..40).collect::<Vec<u8>>());
        let first = bytes.as_ptr().align_offset(4);
        let aligned: Array<u32> = bytes.within(first..first + 30);
        assert_eq!(aligned.as_ptr().cast(), bytes[first..].as_ptr());
        assert_eq!(aligned.len(), 7);

        let odd: Array<u32> = bytes.within(first + 1..first + 29);
        let start = first as u8 + 1;
        let numbers = [start, start + 1, start + 2, start + 3];
        assert_eq!((odd.len(), odd[0]), (7, u32::from_ne_bytes(numbers)));
        assert_eq!(odd.as_bytes(), &bytes[first + 1..first + 29]);
    }

    #[test]
    fn only_what_is_owned_alone_is_changed() {
        let mut numbers: Array<u32> = vec![1, 2, 3].into();
        numbers.get_mut().expect("it is owned")[1] = 7;
        assert_eq!(numbers[..], [1, 7, 3]);
        let clone = numbers.clone();
        assert!(numbers.get_mut().is_none());
        drop(clone);
        assert!(numbers.get_mut().is_some());

        // Not what comes from outside, copied because it is not aligned or not.
        let bytes = Array::held_by((0..40).collect::<Vec<u8>>());
        let first = bytes.as_ptr().align_offset(4);
        let mut parts: [Array<u32>; 2] =
            [first, first + 1].map(|first| bytes.within(first..first + 8));
        drop(bytes);
        assert!(parts.iter_mut().all(|part| part.get_mut().is_none()));
    }

    #[test]
    fn the_owner_lives_as_long_as_any_array() {
        struct Held(Arc<()>, [u8; 8]);
        impl AsRef<[u8]> for Held {
            fn as_ref(&self) -> &[u8] {
                let _ = &self.0;
                &self.1
            }
        }
        let life = Arc::new(());
        let bytes = Array::held_by(Held(Arc::clone(&life), [7; 8]));
        let numbers: Array<u8> = bytes.within(2..6);
        let clone = numbers.clone();
        drop((bytes, numbers));
        assert_eq!((&clone[..], Arc::strong_count(&life)), (&[7; 4][..], 2));
        drop(clone);
        assert_eq!(Arc::strong_count(&life), 1);
    }
}
