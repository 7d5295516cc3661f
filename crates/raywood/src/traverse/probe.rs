//! Watching a traversal: the source of test counts and heat maps.

/// Is told what a traversal does. The unit type `()` ignores it all and compiles to nothing.
pub trait Probe {
    /// Some boxes were tested against the ray.
    #[inline]
    fn boxes(&mut self, count: usize) {
        let _ = count;
    }

    /// Some primitives were tested against the ray.
    #[inline]
    fn primitives(&mut self, count: usize) {
        let _ = count;
    }
}

impl Probe for () {}

/// A probe that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Boxes tested.
    pub boxes: u64,
    /// Primitives tested.
    pub primitives: u64,
}

impl Probe for Counts {
    #[inline]
    fn boxes(&mut self, count: usize) {
        self.boxes += count as u64;
    }

    #[inline]
    fn primitives(&mut self, count: usize) {
        self.primitives += count as u64;
    }
}
