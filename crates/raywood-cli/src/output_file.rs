//! A file that is either written whole or not at all: written beside its place under another name, then renamed.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::interrupt::DeleteOnInterrupt;

/// A place where a file will be written later.
pub(crate) struct OutputFile {
    /// As the user called it.
    name: PathBuf,
    /// Where it will be: a link is followed, so that the file behind it is replaced and not the link.
    target: PathBuf,
    /// Where it is written first: in the same folder, because a rename cannot cross file systems.
    temporary: PathBuf,
}

impl OutputFile {
    /// Checks that a file can be written here, now rather than after long work.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let complain = |error: &dyn std::fmt::Display| {
            Failure::BadInput(format!("{}: cannot be written: {error}", path.display()))
        };
        if path.is_dir() {
            return Err(complain(&"it is a directory, expected the name of a file"));
        }
        if path.exists() && !path.is_file() {
            return Err(complain(&"something is there that is not a file"));
        }
        if path.is_symlink() && !path.exists() {
            return Err(complain(&"it is a link that leads nowhere"));
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let Some(file_name) = target.file_name() else {
            return Err(complain(&"it is not the name of a file"));
        };
        let folder = target
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
            .unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(complain(&format_args!("there is no folder {}", folder.display())));
        }

        let mut temporary_name = OsString::from(".");
        temporary_name.push(file_name);
        temporary_name.push(format!(".{}.tmp", std::process::id()));
        let temporary = folder.join(temporary_name);

        // The only sure test is to do it. Nothing stays behind: whatever ends the program during long work, no file is left.
        let read_only = fs::metadata(&target).is_ok_and(|m| m.permissions().readonly());
        if read_only {
            return Err(complain(&"the existing file is read-only"));
        }
        let guard = DeleteOnInterrupt::new(&temporary);
        File::create(&temporary)
            .and_then(|_| fs::remove_file(&temporary))
            .map_err(|error| complain(&error))?;
        drop(guard);
        Ok(Self { name: path.to_owned(), target, temporary })
    }

    /// Refuses to replace the file that the work begins with.
    pub(crate) fn apart_from(self, input: &Path) -> Result<Self, Failure> {
        match fs::canonicalize(input) {
            Ok(input) if input == self.target => Err(Failure::bad_input(format!(
                "{}: cannot be written: it is what is read, expected another file",
                self.name.display()
            ))),
            _ => Ok(self),
        }
    }

    /// Writes the file whole; what was there before stays until then, and stays if writing fails.
    pub(crate) fn write(
        &self,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.write_with(|writer| content(writer).map_err(|error| self.cannot_write(&error)))
    }

    /// As [`write`](Self::write), for content that may fail for other reasons, or that goes back in the file. It need not flush.
    pub(crate) fn write_with<T>(
        &self,
        content: impl FnOnce(&mut BufWriter<File>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let guard = DeleteOnInterrupt::new(&self.temporary);
        let create = || {
            let file = File::create(&self.temporary)?;
            // Who may read the old file may read the new one, and nobody else.
            if let Ok(old) = fs::metadata(&self.target) {
                file.set_permissions(old.permissions())?;
            }
            Ok(BufWriter::new(file))
        };
        let complain = |error| self.cannot_write(&error);
        let written = create().map_err(complain).and_then(|mut writer| {
            let result = content(&mut writer)?;
            let file = writer.into_inner().map_err(io::IntoInnerError::into_error);
            file.and_then(|file| file.sync_all()).map_err(complain)?;
            Ok(result)
        });
        let rename = || {
            let result = written?;
            fs::rename(&self.temporary, &self.target).map_err(complain)?;
            Ok(result)
        };
        guard.finish(rename).inspect_err(|_| {
            let _ = fs::remove_file(&self.temporary);
        })
    }

    /// Writing fails.
    pub(crate) fn cannot_write(&self, error: &io::Error) -> Failure {
        Failure::WhileRunning(format!("{}: could not be written: {error}", self.name.display()))
    }
}
