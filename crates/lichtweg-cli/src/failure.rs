//! Why the command did not do what it was asked for.

use std::process::ExitCode;

use crate::console::tell;

/// A failure, and the exit code it ends with.
#[derive(Debug)]
pub enum Failure {
    /// The command makes no sense (2).
    Usage(String),
    /// The scene, a file or the machine stood in the way (1).
    Failed(String),
    /// As the number says; the user has been told already.
    Quiet(u8),
}

impl Failure {
    /// Tells the user, and returns the exit code.
    pub fn report(self) -> ExitCode {
        match self {
            Self::Usage(message) => {
                tell(format_args!("error: {message}\n\nFor more information, try '--help'."));
                ExitCode::from(2)
            }
            Self::Failed(message) => {
                tell(format_args!("error: {message}"));
                ExitCode::FAILURE
            }
            Self::Quiet(code) => ExitCode::from(code),
        }
    }
}
