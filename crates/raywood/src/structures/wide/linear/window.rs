//! The corners of primitives side by side on the curve, read before anything is made of them: they lie all over the memory, and the processor waits for many at a time.

use std::ops::Range;

use crate::Geometry;
use crate::build::KeyBits;

/// So many primitives ahead memory is asked for.
const AHEAD: usize = 24;

/// The corners of some primitives side by side.
#[derive(Default)]
pub(super) struct Window {
    first: usize,
    /// Of each, with a fourth number of no meaning: so they are copied in whole vectors, not in pieces that the processor would have to put together again. Not a
    /// number where a primitive is no triangle.
    corners: Vec<[[f32; 4]; 3]>,
}

impl Window {
    /// Reads the corners of the primitives of a span.
    #[inline(never)]
    pub(super) fn read<G: Geometry>(
        &mut self,
        geometry: &G,
        keys: &[u64],
        bits: KeyBits,
        span: Range<usize>,
    ) {
        self.first = span.start;
        self.corners.resize(span.len(), NO_TRIANGLE);
        for (corners, place) in self.corners.iter_mut().zip(span) {
            if let Some(&key) = keys.get(place + AHEAD) {
                geometry.prefetch(bits.number(key));
            }
            match geometry.triangle(bits.number(keys[place])) {
                Some([a, b, c]) => {
                    corners[0] = [a.x, a.y, a.z, 0.0];
                    corners[1] = [b.x, b.y, b.z, 0.0];
                    corners[2] = [c.x, c.y, c.z, 0.0];
                }
                None => *corners = NO_TRIANGLE,
            }
        }
    }

    /// The corners of the primitives of a span within that which was read.
    #[inline(always)]
    pub(super) fn corners(&self, span: Range<usize>) -> &[[[f32; 4]; 3]] {
        &self.corners[span.start - self.first..span.end - self.first]
    }
}

/// Whether these are the corners of a triangle.
#[inline(always)]
pub(super) fn is_triangle(corners: &[[f32; 4]; 3]) -> bool {
    !corners[0][0].is_nan()
}

/// What stands for the corners of a primitive that is no triangle.
const NO_TRIANGLE: [[f32; 4]; 3] = [[f32::NAN; 4]; 3];
