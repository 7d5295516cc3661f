//! Files mapped into memory, so that a saved tree is used where the system keeps the file.
//!
//! Unsafe for a measured need: reading a saved tree takes several times as long as mapping and checking it (decision 17).

#![allow(unsafe_code)]

use std::fs::File;
use std::io;
use std::path::Path;

use memmap2::Mmap;

/// Maps a file for reading.
///
/// Nobody may write into the file as long as it is mapped: what was read of it could become something else, and if it was cut off the program would be ended by the system.
/// Replacing the file by another one, as this program does and most others do, changes nothing. No program that maps files can rule this out, and `raywood` says so in its help.
pub(crate) fn map(path: &Path) -> io::Result<Mmap> {
    let file = File::open(path)?;
    // SAFETY: that nobody writes into the file is what is asked of the user.
    unsafe { Mmap::map(&file) }
}
