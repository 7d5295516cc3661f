//! Ctrl-C, and what else asks a program to end (the signals TERM and HUP): clean up and end at once, with exit code 130; or, where something can be kept, ask for an end first.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::failure::Failure;
use crate::print;

/// The exit code of a program that Ctrl-C stopped, by convention 128 plus the signal's number.
pub(crate) const EXIT_CODE: u8 = 130;

/// The unfinished file to delete, if one is being written.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

fn unfinished() -> MutexGuard<'static, Option<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on Ctrl-C ends the program, whatever it is doing.
pub(crate) fn install() {
    let installed = ctrlc::set_handler(|| {
        if let Some(ask) = asked().take() {
            ask();
            return;
        }
        // Holding the lock until the end keeps the file from being finished meanwhile.
        let unfinished = unfinished();
        if let Some(path) = unfinished.as_deref() {
            let _ = std::fs::remove_file(path);
        }
        print::failure(&Failure::Interrupted("at once; nothing more is written".to_owned()));
        std::process::exit(EXIT_CODE.into());
    });
    // Without a handler Ctrl-C still ends the program, only less tidily.
    drop(installed);
}

/// What asks for an end, if anything does.
type Ask = Box<dyn FnOnce() + Send>;

static ASK: Mutex<Option<Ask>> = Mutex::new(None);

fn asked() -> MutexGuard<'static, Option<Ask>> {
    ASK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While this lives, the first Ctrl-C asks work to end early and to keep what it has; the next one ends the program.
pub(crate) struct AskOnInterrupt(());

impl AskOnInterrupt {
    /// Says how the work is asked.
    pub(crate) fn new(ask: impl FnOnce() + Send + 'static) -> Self {
        *asked() = Some(Box::new(ask));
        Self(())
    }
}

impl Drop for AskOnInterrupt {
    fn drop(&mut self) {
        *asked() = None;
    }
}

/// While this lives, Ctrl-C deletes a file.
pub(crate) struct DeleteOnInterrupt(());

impl DeleteOnInterrupt {
    /// Names the file, before it is made.
    pub(crate) fn new(path: &Path) -> Self {
        *unfinished() = Some(path.to_owned());
        Self(())
    }

    /// Runs the step that makes the file whole, undisturbed by Ctrl-C; after it nothing is deleted any more.
    pub(crate) fn finish<T>(self, step: impl FnOnce() -> T) -> T {
        let mut unfinished = unfinished();
        let result = step();
        *unfinished = None;
        result
    }
}

impl Drop for DeleteOnInterrupt {
    fn drop(&mut self) {
        *unfinished() = None;
    }
}
