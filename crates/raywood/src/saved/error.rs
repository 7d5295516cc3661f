//! Why bytes are not a saved tree that can be used.

use std::fmt;

use super::container::VERSION;

/// Why a saved tree cannot be loaded. Prints as one line that names the place in the file, and what was found there and expected instead.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SavedTreeError {
    /// The bytes do not begin as those of a saved tree: they are something else, or were damaged on their way.
    NotASavedTree,
    /// It has a version of the format that this version of the library does not read. None but its own.
    Version {
        /// Its version.
        found: u32,
    },
    /// This machine keeps numbers with their highest byte first. Saved trees are used as they lie in memory, lowest byte first.
    BigEndian,
    /// There are fewer bytes than there should be, or more.
    Length {
        /// How many there should be.
        expected: u64,
        /// How many there are.
        found: u64,
    },
    /// The checksum of a section is not that of its bytes: they were damaged.
    Damaged {
        /// The section; `header` and `table` are checked in the same way.
        section: String,
    },
    /// Something that is in no saved tree, although the checksums are right.
    Invalid {
        /// The section; or `header` or `table`.
        section: String,
        /// The byte of the file at which it begins.
        byte: u64,
        /// What was found there, and what was expected.
        problem: String,
    },
    /// A section is missing without which the tree cannot be used.
    Missing {
        /// The section.
        section: String,
    },
    /// The tree is over another kind of geometry than was asked for, or over another number of primitives.
    OtherGeometry {
        /// What was asked for.
        expected: String,
        /// What the tree is over.
        found: String,
    },
}

impl fmt::Display for SavedTreeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotASavedTree => f.write_str("is no saved tree: it begins with other bytes"),
            Self::Version { found } => {
                let age = if *found < VERSION { "an older" } else { "a newer" };
                write!(
                    f,
                    "is a saved tree of version {found} of the format, {age} one; expected version {VERSION}; save it again from its model"
                )
            }
            Self::BigEndian => f.write_str(
                "cannot be used on a big-endian machine: saved trees are used as they lie in memory, which is little-endian",
            ),
            Self::Length { expected, found } => {
                let state = if found < expected { "is cut off" } else { "has bytes at its end that do not belong to it" };
                write!(f, "{state}: {found} bytes, expected {expected}")
            }
            Self::Damaged { section } => {
                write!(f, "is damaged: the checksum of section `{section}` is wrong")
            }
            Self::Invalid { section, byte, problem } => {
                write!(f, "section `{section}`, byte {byte}: {problem}")
            }
            Self::Missing { section } => write!(f, "there is no section `{section}`"),
            Self::OtherGeometry { expected, found } => {
                write!(f, "the tree is over {found}, expected {expected}")
            }
        }
    }
}

impl std::error::Error for SavedTreeError {}
