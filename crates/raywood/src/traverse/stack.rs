//! The stack of a depth-first traversal.

use crate::structures::MAX_DEPTH;

/// Items still to be visited. A depth-first traversal keeps at most one per level, and no tree has more than [`MAX_DEPTH`].
pub(crate) struct Stack<T> {
    items: [T; MAX_DEPTH],
    len: usize,
}

impl<T: Copy + Default> Stack<T> {
    #[inline]
    pub(crate) fn new() -> Self {
        Self { items: [T::default(); MAX_DEPTH], len: 0 }
    }

    #[inline]
    pub(crate) fn push(&mut self, item: T) {
        self.items[self.len] = item;
        self.len += 1;
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        Some(self.items[self.len])
    }
}
