//! What a loader mended or left out, counted, so that a thousand faults make one line and not a thousand.

use std::path::{Path, PathBuf};

use crate::error::{LoadError, Place, one_line};

/// A kind of fault that can be mended, in words.
#[derive(Debug)]
pub(crate) struct Fault {
    /// What is wrong with one, after "1 ": "face has fewer than three vertices".
    pub(crate) one: &'static str,
    /// What is wrong with several, after their number: "faces have fewer than three vertices".
    pub(crate) many: &'static str,
    /// What was done about it: "left out".
    pub(crate) remedy: &'static str,
}

/// A vertex that is nowhere.
pub(crate) static NOT_FINITE: Fault = Fault {
    one: "vertex is NaN or infinite",
    many: "vertices are NaN or infinite",
    remedy: "the triangles that use them are left out",
};

/// The notes made while loading one file.
#[derive(Debug)]
pub(crate) struct Notes {
    file: PathBuf,
    strict: bool,
    counts: Vec<(&'static Fault, usize, Place)>,
    lines: Vec<String>,
    unsaid: usize,
}

impl Notes {
    /// No notes yet. With `strict` every fault is an error.
    pub(crate) fn new(file: &Path, strict: bool) -> Self {
        Self { file: file.to_owned(), strict, counts: Vec::new(), lines: Vec::new(), unsaid: 0 }
    }

    /// Counts a fault that the caller mends; the place is asked for only when it is going to be shown.
    #[cold]
    pub(crate) fn mend(
        &mut self,
        fault: &'static Fault,
        place: impl FnOnce() -> Place,
    ) -> Result<(), LoadError> {
        if self.strict {
            return Err(LoadError::new(&self.file, place(), fault.one));
        }
        self.leave_out(fault, place);
        Ok(())
    }

    /// Counts something that is not supported, which no strictness makes a fault of the file's.
    pub(crate) fn leave_out(&mut self, fault: &'static Fault, place: impl FnOnce() -> Place) {
        match self.counts.iter_mut().find(|(known, ..)| std::ptr::eq(*known, fault)) {
            Some((_, count, _)) => *count += 1,
            None => self.counts.push((fault, 1, place())),
        }
    }

    /// A fault in words, which the caller mends.
    pub(crate) fn mend_line(
        &mut self,
        place: Place,
        problem: &str,
        remedy: &str,
    ) -> Result<(), LoadError> {
        if self.strict {
            return Err(LoadError::new(&self.file, place, problem));
        }
        let at = if place == Place::File { String::new() } else { format!("{place}: ") };
        self.say(format!("{at}{problem}: {remedy}"));
        Ok(())
    }

    /// Says that something is left out or guessed; no fault of the file's. A line said before is not repeated.
    pub(crate) fn say(&mut self, line: impl Into<String>) {
        const MOST: usize = 24;
        let line = one_line(&line.into());
        if self.lines.contains(&line) {
            return;
        }
        if self.lines.len() < MOST {
            self.lines.push(line);
        } else {
            self.unsaid += 1;
        }
    }

    /// Takes over the warnings of another file's notes.
    pub(crate) fn append(&mut self, other: Notes, name: &str) {
        for line in other.into_warnings() {
            self.say(format!("{name}: {line}"));
        }
    }

    /// The notes as lines for the user.
    pub(crate) fn into_warnings(self) -> Vec<String> {
        let counted = self.counts.into_iter().map(|(fault, count, place)| {
            let (what, first) = match (count, place) {
                (1, Place::File) => (fault.one, String::new()),
                (1, place) => (fault.one, format!(" ({place})")),
                (_, Place::File) => (fault.many, String::new()),
                (_, place) => (fault.many, format!(" (the first: {place})")),
            };
            format!("{count} {what}{first}: {}", fault.remedy)
        });
        let mut warnings: Vec<String> = counted.collect();
        warnings.extend(self.lines);
        if self.unsaid > 0 {
            warnings.push(format!("{} more warnings of this kind are not shown", self.unsaid));
        }
        warnings
    }
}

/// A number and a noun: `1 texture`, `3 textures`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
