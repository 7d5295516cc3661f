//! Why a command ends without success, and with which exit code.

use std::fmt;
use std::process::ExitCode;

use crate::interrupt::EXIT_CODE;

/// What went wrong, as one line for the user.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line or the input is wrong: exit code 2.
    BadInput(String),
    /// Something failed that could have worked: exit code 1.
    WhileRunning(String),
    /// Ctrl-C stopped it; what there was is kept: exit code 130.
    Interrupted(String),
}

impl Failure {
    /// Wrong input, said by an error.
    pub(crate) fn bad_input(error: impl fmt::Display) -> Self {
        Self::BadInput(error.to_string())
    }

    /// A failure while running, said by an error.
    pub(crate) fn while_running(error: impl fmt::Display) -> Self {
        Self::WhileRunning(error.to_string())
    }

    /// The process's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::BadInput(_) => ExitCode::from(2),
            Self::WhileRunning(_) => ExitCode::from(1),
            Self::Interrupted(_) => ExitCode::from(EXIT_CODE),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::BadInput(message) | Self::WhileRunning(message) | Self::Interrupted(message)) =
            self;
        f.write_str(message)
    }
}
