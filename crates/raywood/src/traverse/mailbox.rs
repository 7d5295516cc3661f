//! Which primitives a ray has tested lately.

/// How many primitives are remembered.
const SLOTS: usize = 32;

/// A small table of the primitives that a ray has tested, so that one which lies in several cells is seldom tested again: mailboxing
/// (Arnaldi, Priol and Bouatouch, "A new space subdivision method for ray tracing CSG modelled scenes", The Visual Computer 1987), but kept
/// with the ray instead of with the primitives, so that threads share nothing.
///
/// Each primitive has one place by its number; who comes later takes it. A primitive met again in the next cells is nearly always
/// still there; a forgotten one is tested again, which changes no answer.
pub(crate) struct Mailbox([u32; SLOTS]);

impl Mailbox {
    /// Nothing tested yet.
    #[inline]
    pub(crate) fn new() -> Self {
        Self([u32::MAX; SLOTS])
    }

    /// Whether the primitive is not known to have been tested; from now on it is.
    #[inline]
    pub(crate) fn is_new(&mut self, primitive: u32) -> bool {
        std::mem::replace(&mut self.0[primitive as usize % SLOTS], primitive) != primitive
    }
}
