//! Why the program ends without success, and with which exit code: those of the command `raywood`.

use std::fmt;
use std::process::ExitCode;

/// What went wrong, as one line for the user.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line or the input is wrong: exit code 2.
    BadInput(String),
    /// Something failed that could have worked: exit code 1.
    WhileRunning(String),
}

impl Failure {
    /// A failure while running, said by an error.
    pub(crate) fn while_running(error: impl fmt::Display) -> Self {
        Self::WhileRunning(error.to_string())
    }

    /// The process's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::BadInput(_) => ExitCode::from(2),
            Self::WhileRunning(_) => ExitCode::from(1),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::BadInput(message) | Self::WhileRunning(message)) = self;
        f.write_str(message)
    }
}
