//! Where answers are written: a file, in which one can go back, or standard output, where one cannot.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Stdout, Write};

/// A place to write to.
pub(crate) enum Sink<'a> {
    File(&'a mut BufWriter<File>),
    Pipe(BufWriter<Stdout>),
}

impl Sink<'_> {
    /// Whether [`rewrite_start`](Self::rewrite_start) works.
    pub(crate) fn is_file(&self) -> bool {
        matches!(self, Self::File(_))
    }

    /// Writes over the first bytes of a file.
    pub(crate) fn rewrite_start(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::File(file) => {
                file.seek(SeekFrom::Start(0))?;
                file.write_all(bytes)
            }
            Self::Pipe(_) => Err(io::ErrorKind::NotSeekable.into()),
        }
    }
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Pipe(pipe) => pipe.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Pipe(pipe) => pipe.flush(),
        }
    }
}
