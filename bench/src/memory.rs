//! How much memory things take: an allocator that counts the bytes that this program's Rust code holds.
//!
//! Two relaxed additions an allocation are all that it costs; what is timed allocates rarely and in large pieces.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator with a count beside it.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The bytes held now, and the most since [`watch`] last began.
static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

fn add(bytes: usize) {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed) + bytes;
    // Nearly always only read.
    if held > MOST.load(Ordering::Relaxed) {
        MOST.fetch_max(held, Ordering::Relaxed);
    }
}

// SAFETY: everything is passed on to the system's allocator as it comes; counting allocates nothing and cannot unwind.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        let block = unsafe { System.alloc(layout) };
        if !block.is_null() {
            add(layout.size());
        }
        block
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promise.
        let block = unsafe { System.alloc_zeroed(layout) };
        if !block.is_null() {
            add(layout.size());
        }
        block
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise; the block comes from the system's allocator.
        unsafe { System.dealloc(block, layout) };
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's promise; the block comes from the system's allocator.
        let moved = unsafe { System.realloc(block, layout, size) };
        if !moved.is_null() {
            // Large blocks grow where they are or move by page tables: the old and the new one count as one.
            HELD.fetch_sub(layout.size(), Ordering::Relaxed);
            add(size);
        }
        moved
    }
}

/// What something took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Memory {
    /// The bytes of what is left.
    pub(crate) bytes: usize,
    /// The most bytes that were held at once, those of what is left counted.
    pub(crate) peak_bytes: usize,
}

/// The memory that `f` takes from Rust's allocator, and its result. Nothing else may be allocated meanwhile.
pub(crate) fn watch<T>(f: impl FnOnce() -> T) -> (Memory, T) {
    let before = HELD.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    let result = f();
    let since = |bytes: &AtomicUsize| bytes.load(Ordering::Relaxed).saturating_sub(before);
    (Memory { bytes: since(&HELD), peak_bytes: since(&MOST) }, result)
}

/// Hands memory that was freed back to the system, where that can be asked for: whoever builds next gets none at hand.
pub(crate) fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        unsafe extern "C" {
            /// The C library's: frees what it can at the end of the heap and between blocks.
            safe fn malloc_trim(pad: usize) -> std::ffi::c_int;
        }
        malloc_trim(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The other tests allocate too, little at a time.
    const SLACK: usize = 16 << 20;

    #[test]
    fn what_is_left_and_what_is_not_are_told_apart() {
        const MANY: usize = 256 << 20;
        let (memory, kept) = watch(|| {
            drop(std::hint::black_box(Vec::<u8>::with_capacity(2 * MANY)));
            let mut grown = Vec::<u8>::with_capacity(MANY / 2);
            grown.reserve_exact(MANY);
            grown
        });
        assert!(memory.bytes.abs_diff(kept.capacity()) < SLACK, "{memory:?}");
        assert!(memory.peak_bytes.abs_diff(2 * MANY) < SLACK, "{memory:?}");
        let (freed, ()) = watch(|| drop(kept));
        assert!(freed.bytes < SLACK, "{freed:?}");
    }
}
