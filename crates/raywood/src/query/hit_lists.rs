//! A list of hits for each of many rays.

use crate::{Hit, parallel};

/// The hits of many rays in one array, those of each ray together, and where they begin: the layout of compressed sparse rows.
///
/// | array     | length   | content                                                            |
/// | --------- | -------- | ------------------------------------------------------------------ |
/// | `hits`    | all hits | those of the first ray, then those of the second, ...              |
/// | `offsets` | rays + 1 | where the hits of each ray begin; last, how many there are in all  |
#[derive(Clone, Debug, PartialEq)]
pub struct HitLists<H = Hit> {
    hits: Vec<H>,
    offsets: Vec<usize>,
}

/// How many rays a task takes: always the same ones, and few enough that a few rays with many hits do not keep others waiting.
const PIECE: usize = 512;

impl<H> HitLists<H> {
    /// Has `append` put the hits of each ray behind those that are there, rays being shared out among threads.
    pub(crate) fn collect<R: Sync>(rays: &[R], append: impl Fn(&R, &mut Vec<H>) + Sync) -> Self
    where
        H: Send,
    {
        let pieces = parallel::map_pieces(rays, PIECE, |rays| {
            let (mut hits, mut ends) = (Vec::new(), Vec::with_capacity(rays.len()));
            for ray in rays {
                append(ray, &mut hits);
                ends.push(hits.len());
            }
            (hits, ends)
        });

        let mut hits = Vec::with_capacity(pieces.iter().map(|(hits, _)| hits.len()).sum());
        let mut offsets = Vec::with_capacity(rays.len() + 1);
        offsets.push(0);
        for (more, ends) in pieces {
            offsets.extend(ends.iter().map(|end| hits.len() + end));
            hits.extend(more);
        }
        Self { hits, offsets }
    }

    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The hits of a ray, by ascending `t`.
    ///
    /// # Panics
    ///
    /// If there is no ray of that number.
    pub fn of(&self, ray: usize) -> &[H] {
        &self.hits[self.offsets[ray]..self.offsets[ray + 1]]
    }

    /// The hits of each ray in turn.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[H]> {
        (0..self.len()).map(|ray| self.of(ray))
    }

    /// The hits of all rays.
    pub fn hits(&self) -> &[H] {
        &self.hits
    }

    /// Where the hits of each ray begin among all, and how many there are in all.
    pub fn offsets(&self) -> &[usize] {
        &self.offsets
    }

    /// The arrays of hits and of offsets.
    pub fn into_parts(self) -> (Vec<H>, Vec<usize>) {
        (self.hits, self.offsets)
    }
}
