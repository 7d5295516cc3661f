//! The checksum of what is saved: CRC-32 as of Ethernet, zip and PNG, which every language has at hand. It is computed piece by piece, so that what else is asked of a piece can
//! be asked while it is in the cache.

use crate::parallel;
use crate::storage::{Plain, bytes_of};

/// Bytes that a thread takes at a time: fewer than its cache holds, and enough that putting the pieces together costs nothing in comparison.
const PIECE: usize = 1 << 19;

/// The checksum of bytes that are read one after the other.
#[derive(Clone, Default)]
pub(crate) struct Checksum(crc32fast::Hasher);

impl Checksum {
    /// Reads the next bytes.
    pub(crate) fn read(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The number of all that these have read, one after the other.
    pub(crate) fn of_all(parts: impl IntoIterator<Item = Self>) -> u32 {
        let mut parts = parts.into_iter();
        let Self(mut whole) = parts.next().unwrap_or_default();
        parts.for_each(|Self(part)| whole.combine(&part));
        whole.finalize()
    }
}

/// The checksum of some bytes, on all threads.
pub(crate) fn checksum(bytes: &[u8]) -> u32 {
    checksum_and(bytes, |_| true).0
}

/// The checksum of some items, on all threads, and whether every piece of them is good.
pub(crate) fn checksum_and<T: Plain>(
    items: &[T],
    is_good: impl Fn(&[T]) -> bool + Send + Sync,
) -> (u32, bool) {
    let pieces = parallel::map_pieces(items, PIECE / size_of::<T>(), |piece| {
        let mut sum = Checksum::default();
        sum.read(bytes_of(piece));
        (sum, is_good(piece))
    });
    let all_good = pieces.iter().all(|(_, is_good)| *is_good);
    (Checksum::of_all(pieces.into_iter().map(|(sum, _)| sum)), all_good)
}
