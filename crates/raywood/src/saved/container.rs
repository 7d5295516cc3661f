//! The file around everything that is saved: a header, a table of named sections, and their bytes. `docs/format.md` specifies it.

use std::io::{self, Write};
use std::ops::Range;

use super::SavedTreeError;
use crate::checksum::checksum;
use crate::storage::Array;

/// The first bytes of every version. One is no ASCII, and line ends are among them: whatever takes the file for text damages them.
pub(super) const SIGNATURE: [u8; 8] = *b"\x89RWOOD\r\n";

/// The version of the format.
pub(super) const VERSION: u32 = 1;

/// Where sections begin is a multiple of this: a cache line.
const ALIGNMENT: usize = 64;

/// Bytes of the header.
const HEADER: usize = 64;

/// Bytes of a line of the table.
const LINE: usize = 40;

/// Bytes of a section's name.
const NAME: usize = 16;

/// The most sections that a file has.
pub(super) const MOST_SECTIONS: usize = 256;

/// A section to be written.
pub(super) struct NewSection<'a> {
    pub(super) name: &'a str,
    pub(super) bytes: &'a [u8],
}

/// A section of a file.
#[derive(Clone, Debug)]
struct Section {
    name: String,
    range: Range<usize>,
    checksum: u32,
}

/// A file whose header and table are known to be right. What its sections hold is not, not even that it is what was written.
#[derive(Clone, Debug)]
pub(super) struct Container {
    bytes: Array<u8>,
    sections: Vec<Section>,
}

/// Why a name cannot be that of a section.
pub(super) fn name_problem(name: &str) -> Option<&'static str> {
    let is_allowed = |byte: u8| matches!(byte, b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.');
    match name.len() {
        0 => Some("the name is empty"),
        len if len > NAME => Some("the name is longer than 16 bytes"),
        _ if !name.bytes().all(is_allowed) => {
            Some("the name has something else than a to z, 0 to 9, `-` and `.`")
        }
        _ => None,
    }
}

/// Writes a file of such sections. The same bytes wherever it is written.
pub(super) fn write(sections: &[NewSection<'_>], mut writer: impl Write) -> io::Result<()> {
    let mut table = Vec::with_capacity(LINE * sections.len());
    let mut end = HEADER + LINE * sections.len();
    for section in sections {
        let start = end.next_multiple_of(ALIGNMENT);
        let mut name = [0; NAME];
        name[..section.name.len()].copy_from_slice(section.name.as_bytes());
        table.extend(name);
        table.extend((start as u64).to_le_bytes());
        table.extend((section.bytes.len() as u64).to_le_bytes());
        table.extend(checksum(section.bytes).to_le_bytes());
        table.extend([0; 4]);
        end = start + section.bytes.len();
    }

    let mut header = Vec::with_capacity(HEADER);
    header.extend(SIGNATURE);
    header.extend(VERSION.to_le_bytes());
    header.extend((sections.len() as u32).to_le_bytes());
    header.extend((end as u64).to_le_bytes());
    header.extend(checksum(&table).to_le_bytes());
    header.resize(HEADER - 4, 0);
    header.extend(checksum(&header).to_le_bytes());

    writer.write_all(&header)?;
    writer.write_all(&table)?;
    let mut written = HEADER + table.len();
    for section in sections {
        let start = written.next_multiple_of(ALIGNMENT);
        writer.write_all(&[0; ALIGNMENT][..start - written])?;
        writer.write_all(section.bytes)?;
        written = start + section.bytes.len();
    }
    writer.flush()
}

impl Container {
    /// Reads header and table, in no time.
    pub(super) fn open(bytes: Array<u8>) -> Result<Self, SavedTreeError> {
        let number = |at: usize| u32::from_le_bytes(array(&bytes, at));
        let large_number = |at: usize| u64::from_le_bytes(array(&bytes, at));
        let found = bytes.len() as u64;

        // What is the same in all versions comes first, so that others are told from damage.
        if bytes.len() < SIGNATURE.len() || bytes[..SIGNATURE.len()] != SIGNATURE {
            return Err(SavedTreeError::NotASavedTree);
        }
        if bytes.len() < HEADER {
            return Err(SavedTreeError::Length { expected: HEADER as u64, found });
        }
        if checksum(&bytes[..HEADER - 4]) != number(HEADER - 4) {
            // A header of another version may be of another kind, with its checksum elsewhere.
            return Err(match number(8) {
                VERSION => SavedTreeError::Damaged { section: "header".to_owned() },
                found => SavedTreeError::Version { found },
            });
        }
        if number(8) != VERSION {
            return Err(SavedTreeError::Version { found: number(8) });
        }
        if large_number(16) != found {
            return Err(SavedTreeError::Length { expected: large_number(16), found });
        }
        if let Some(byte) = (28..HEADER - 4).find(|&byte| bytes[byte] != 0) {
            return Err(invalid("header", byte, "expected zeros"));
        }

        let count = number(12) as usize;
        if count > MOST_SECTIONS {
            let problem = format!("{count} sections, expected at most {MOST_SECTIONS}");
            return Err(invalid("header", 12, problem));
        }
        let table_end = HEADER + LINE * count;
        if table_end > bytes.len() {
            return Err(invalid(
                "header",
                12,
                format!("{count} sections do not fit into the file"),
            ));
        }
        if checksum(&bytes[HEADER..table_end]) != number(24) {
            return Err(SavedTreeError::Damaged { section: "table".to_owned() });
        }

        // Every section begins at the next multiple of 64 after the one before, with zeros between: nothing overlaps, and no byte is unaccounted for.
        let mut sections: Vec<Section> = Vec::new();
        let mut end = table_end;
        for at in (HEADER..table_end).step_by(LINE) {
            let name: [u8; NAME] = array(&bytes, at);
            let name = std::str::from_utf8(&name).unwrap_or_default().trim_end_matches('\0');
            if let Some(problem) = name_problem(name) {
                return Err(invalid("table", at, problem));
            }
            if sections.iter().any(|section| section.name == name) {
                return Err(invalid("table", at, format!("there is a second section `{name}`")));
            }
            let start = end.next_multiple_of(ALIGNMENT);
            if large_number(at + 16) != start as u64 {
                let found = large_number(at + 16);
                let problem = format!("section `{name}` begins at byte {found}, expected {start}");
                return Err(invalid("table", at + 16, problem));
            }
            let length = usize::try_from(large_number(at + 24)).ok();
            let last = length.and_then(|length| start.checked_add(length));
            let Some(last) = last.filter(|&last| last <= bytes.len()) else {
                let problem = format!("section `{name}` ends beyond the end of the file");
                return Err(invalid("table", at + 24, problem));
            };
            if number(at + 36) != 0 {
                return Err(invalid("table", at + 36, "expected zeros"));
            }
            if let Some(byte) = (end..start).find(|&byte| bytes[byte] != 0) {
                return Err(invalid(name, byte, "expected zeros before the section"));
            }
            sections.push(Section {
                name: name.to_owned(),
                range: start..last,
                checksum: number(at + 32),
            });
            end = last;
        }
        if end != bytes.len() {
            return Err(SavedTreeError::Length { expected: end as u64, found });
        }
        Ok(Self { bytes, sections })
    }

    /// Whether every chosen section has the bytes that were written. O(their size), on all threads.
    pub(super) fn verify(&self, is_chosen: impl Fn(&str) -> bool) -> Result<(), SavedTreeError> {
        let chosen = self.sections.iter().filter(|section| is_chosen(&section.name));
        for Section { name, range, .. } in chosen {
            self.compare(name, checksum(&self.bytes[range.clone()]))?;
        }
        Ok(())
    }

    /// Whether a section has the bytes that were written, of which this is the checksum.
    pub(super) fn compare(&self, name: &str, found: u32) -> Result<(), SavedTreeError> {
        match self.sections.iter().find(|section| section.name == name) {
            Some(section) if section.checksum == found => Ok(()),
            _ => Err(SavedTreeError::Damaged { section: name.to_owned() }),
        }
    }

    /// All bytes.
    pub(super) fn bytes(&self) -> &Array<u8> {
        &self.bytes
    }

    /// Where a section lies.
    pub(super) fn range(&self, name: &str) -> Option<Range<usize>> {
        let section = self.sections.iter().find(|section| section.name == name)?;
        Some(section.range.clone())
    }

    /// The names and sizes of all sections.
    pub(super) fn sections(&self) -> impl Iterator<Item = (&str, usize)> {
        self.sections.iter().map(|section| (&*section.name, section.range.len()))
    }
}

/// Something wrong at a byte.
pub(super) fn invalid(section: &str, byte: usize, problem: impl Into<String>) -> SavedTreeError {
    SavedTreeError::Invalid {
        section: section.to_owned(),
        byte: byte as u64,
        problem: problem.into(),
    }
}

/// Some bytes.
///
/// # Panics
///
/// If there are not as many.
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&bytes[at..at + N]);
    array
}
