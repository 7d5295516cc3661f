//! Which files scenes were loaded from, and how they were then: for whoever looks whether they change.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// What of a file tells that it was changed: its time and its length, if it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileStamp(Option<(Option<SystemTime>, u64)>);

impl FileStamp {
    /// How a file is now.
    pub fn of(path: &Path) -> Self {
        Self(fs::metadata(path).ok().as_ref().map(time_and_length))
    }
}

fn time_and_length(metadata: &Metadata) -> (Option<SystemTime>, u64) {
    (metadata.modified().ok(), metadata.len())
}

/// Loading reads files on many threads and in many places, so what they read is written down in one.
static READ: Mutex<Option<BTreeMap<PathBuf, FileStamp>>> = Mutex::new(None);

fn read() -> MutexGuard<'static, Option<BTreeMap<PathBuf, FileStamp>>> {
    READ.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does something, and tells which files were read meanwhile to load scenes and panoramas, by all threads of the program, or were sought and are not there; each as it was when it was first read. One
/// at a time: who asks while another does has the other's answer cut short.
pub fn files_read<T>(work: impl FnOnce() -> T) -> (T, Vec<(PathBuf, FileStamp)>) {
    *read() = Some(BTreeMap::new());
    let result = work();
    let files = read().take().unwrap_or_default();
    (result, files.into_iter().collect())
}

/// Notes a file that is about to be read.
pub(crate) fn note(path: &Path) {
    if let Some(files) = &mut *read() {
        files.entry(path.to_owned()).or_insert_with(|| FileStamp::of(path));
    }
}
