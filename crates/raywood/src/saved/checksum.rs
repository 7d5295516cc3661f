//! The checksum of sections: CRC-32 as of Ethernet, zip and PNG, which every language has at hand.

use crate::parallel;

/// Bytes that a thread takes at a time.
const PIECE: usize = 1 << 20;

/// The checksum of some bytes, on all threads.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut pieces = parallel::map_pieces(bytes, PIECE, |piece| {
        let mut sum = crc32fast::Hasher::new();
        sum.update(piece);
        sum
    })
    .into_iter();
    let mut whole = pieces.next().unwrap_or_default();
    pieces.for_each(|piece| whole.combine(&piece));
    whole.finalize()
}
