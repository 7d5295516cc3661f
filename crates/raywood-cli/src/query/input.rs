//! Where rows are read from: a file or standard input.

use std::fmt::Display;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use raywood_scene::quoted;

use crate::failure::Failure;
use crate::print;

/// What stands for standard input and output.
pub(crate) const STANDARD: &str = "-";

/// Nobody reads more warnings of a kind.
pub(crate) const MOST_WARNINGS: usize = 16;

/// A file, or standard input.
#[derive(Clone, Debug)]
pub(crate) enum Input {
    File(PathBuf),
    Standard,
}

/// Bytes that are read in order.
pub(crate) type Stream = Box<dyn Read + Send>;

impl Input {
    /// The input of a name on the command line.
    pub(crate) fn new(path: &Path) -> Self {
        if path.as_os_str() == STANDARD { Self::Standard } else { Self::File(path.to_owned()) }
    }

    /// The name for messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Standard => "standard input".to_owned(),
        }
    }

    /// The input is wrong.
    pub(crate) fn complain(&self, message: impl Display) -> Failure {
        Failure::BadInput(format!("{}: {message}", self.name()))
    }

    /// A line of the input is wrong; the first is 1.
    pub(crate) fn complain_at(&self, line: u64, message: impl Display) -> Failure {
        Failure::BadInput(format!("{}:{line}: {message}", self.name()))
    }

    /// The input cannot be read: it ends early or is broken, or the system refuses.
    pub(crate) fn cannot_read(&self, error: &io::Error) -> Failure {
        match error.kind() {
            io::ErrorKind::NotFound => self.complain("no such file"),
            io::ErrorKind::IsADirectory => {
                self.complain("it is a directory, expected the name of a file")
            }
            io::ErrorKind::InvalidData
            | io::ErrorKind::InvalidInput
            | io::ErrorKind::UnexpectedEof
            | io::ErrorKind::PermissionDenied => self.complain(error),
            _ => Failure::WhileRunning(format!("{}: cannot be read: {error}", self.name())),
        }
    }

    /// Tells of columns or arrays that nothing is done with; only of the first, where there are very many.
    pub(crate) fn warn_of_unused<'a>(&self, thing: &str, names: impl Iterator<Item = &'a str>) {
        let mut names = names.fuse();
        for name in names.by_ref().take(MOST_WARNINGS) {
            let name = quoted(name.as_bytes());
            print::warning(format_args!("{}: {thing} {name} is not used", self.name()));
        }
        let more = names.count();
        if more > 0 {
            let name = self.name();
            print::warning(format_args!("{name}: further {thing}s that are not used: {more}"));
        }
    }

    /// The bytes from the first on. Standard input can be read once.
    pub(crate) fn stream(&self) -> Result<Stream, Failure> {
        match self {
            Self::File(path) => {
                let file = File::open(path).map_err(|error| self.cannot_read(&error))?;
                if path.is_dir() {
                    return Err(self.cannot_read(&io::ErrorKind::IsADirectory.into()));
                }
                Ok(Box::new(file))
            }
            Self::Standard => Ok(Box::new(io::stdin())),
        }
    }

    /// The bytes from any on, as often as one likes; what is no file is read into memory.
    pub(crate) fn bytes(&self) -> Result<Bytes, Failure> {
        match self {
            Self::File(path) if path.is_file() => {
                drop(self.stream()?);
                Ok(Bytes::File(path.clone()))
            }
            _ => Bytes::in_memory(&mut self.stream()?).map_err(|error| self.cannot_read(&error)),
        }
    }
}

/// Bytes that can be read from any on.
#[derive(Clone, Debug)]
pub(crate) enum Bytes {
    File(PathBuf),
    Memory(Arc<[u8]>),
}

/// What reads and seeks.
pub(crate) trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

impl Bytes {
    /// All that is left of a stream.
    pub(crate) fn in_memory(stream: &mut dyn Read) -> io::Result<Self> {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes)?;
        Ok(Self::Memory(bytes.into()))
    }

    /// From a byte on.
    pub(crate) fn open(&self, offset: u64) -> io::Result<Box<dyn ReadSeek>> {
        let mut reader: Box<dyn ReadSeek> = match self {
            Self::File(path) => Box::new(File::open(path)?),
            Self::Memory(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
        };
        reader.seek(SeekFrom::Start(offset))?;
        Ok(reader)
    }
}
