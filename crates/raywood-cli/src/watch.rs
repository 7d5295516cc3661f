//! Waiting until a file changes. The times of the few files of a scene are looked at again and again: that works on every system and network drive, and needs nothing of either.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use raywood_scene::FileStamp;

/// How long after each look.
const INTERVAL: Duration = Duration::from_millis(200);

/// Waits until one of some files is another than it was, and then until all stay as they are for a while, as whoever saves a file may do so in several steps.
pub(crate) fn wait_for_change(files: &[(PathBuf, FileStamp)]) {
    let look = || files.iter().map(|(path, _)| FileStamp::of(path)).collect::<Vec<_>>();
    let is_as_before = |now: &[FileStamp]| files.iter().zip(now).all(|((_, old), new)| old == new);
    let mut now = look();
    let mut is_still = true;
    while is_as_before(&now) || !is_still {
        thread::sleep(INTERVAL);
        let next = look();
        is_still = next == now;
        now = next;
    }
}
