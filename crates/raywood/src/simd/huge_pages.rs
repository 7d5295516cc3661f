//! Pages of 2 MiB for large lists: fewer faults while they are filled, which threads would wait for each other to handle, and fewer misses while they are read.

use std::mem::MaybeUninit;

/// Smaller lists may not hold a huge page, wherever it begins.
const LEAST: usize = 2 * HUGE_PAGE;

/// How large such a page is.
const HUGE_PAGE: usize = 2 << 20;

/// A list with room for so many items, which nobody has touched yet: a page is taken where it is first written to.
pub(crate) fn vec_for<T>(capacity: usize) -> Vec<T> {
    let mut list = Vec::with_capacity(capacity);
    ask_for(list.spare_capacity_mut());
    list
}

/// So many zeros, which nobody has touched yet.
pub(crate) fn zeros(count: usize) -> Vec<u64> {
    let mut list = vec![0; count];
    // As what may not be initialized, which asks for less.
    let (start, length) = (list.as_mut_ptr(), list.len());
    // SAFETY: the numbers are borrowed as long as this slice is, and nothing is written to it.
    ask_for(unsafe { std::slice::from_raw_parts_mut(start.cast::<MaybeUninit<u64>>(), length) });
    list
}

/// Asks the system to use huge pages for the memory, which may be in use or not, as far as it can.
#[cfg(target_os = "linux")]
fn ask_for<T>(memory: &mut [MaybeUninit<T>]) {
    use std::ffi::{c_int, c_void};

    unsafe extern "C" {
        fn madvise(start: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    const MADV_HUGEPAGE: c_int = 14;

    if size_of_val(memory) < LEAST {
        return;
    }
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
fn ask_for<T>(_: &mut [MaybeUninit<T>]) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_lists_are_as_any_others() {
        for count in [0, 1, 1000, 1 << 20] {
            assert!(zeros(count).iter().all(|&number| number == 0));
            let mut list = vec_for(count);
            assert!(list.is_empty() && list.capacity() >= count);
            list.extend(0..count);
            assert!(list.into_iter().eq(0..count));
        }
    }
}
