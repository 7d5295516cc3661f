//! Why a built-in scene could not be made, in one line that says what exists instead.

use std::fmt;

/// Why the name and parameters of a built-in scene were refused.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BuiltinError {
    /// No built-in scene has this name.
    UnknownScene {
        /// The name that was asked for.
        name: String,
        /// The name that was probably meant.
        suggestion: Option<&'static str>,
        /// All names.
        known: Vec<&'static str>,
    },
    /// The scene has no such parameter.
    UnknownParameter {
        /// The scene.
        scene: &'static str,
        /// The parameter that was asked for.
        name: String,
        /// The parameter that was probably meant.
        suggestion: Option<&'static str>,
        /// All parameters of the scene.
        known: Vec<&'static str>,
    },
    /// A parameter is given more than once.
    RepeatedParameter {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        name: &'static str,
    },
    /// A parameter's value is not a whole number in its range.
    BadValue {
        /// The scene.
        scene: &'static str,
        /// The parameter.
        name: &'static str,
        /// The value that was asked for.
        value: String,
        /// The smallest value allowed.
        min: u64,
        /// The largest value allowed.
        max: u64,
    },
}

impl fmt::Display for BuiltinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownScene { name, suggestion, known } => {
                write!(f, "there is no built-in scene '{name}'")?;
                if let Some(suggestion) = suggestion {
                    write!(f, ", did you mean '{suggestion}'?")?;
                }
                write!(f, " (there are: {})", known.join(", "))
            }
            Self::UnknownParameter { scene, name, known, .. } if known.is_empty() => {
                write!(f, "the scene '{scene}' has no parameters, but '{name}' is given")
            }
            Self::UnknownParameter { scene, name, suggestion, known } => {
                write!(f, "the scene '{scene}' has no parameter '{name}'")?;
                if let Some(suggestion) = suggestion {
                    write!(f, ", did you mean '{suggestion}'?")?;
                }
                write!(f, " (there are: {})", known.join(", "))
            }
            Self::RepeatedParameter { scene, name } => {
                write!(f, "the parameter '{name}' of the scene '{scene}' is given more than once")
            }
            Self::BadValue { scene, name, value, min, max } => {
                write!(
                    f,
                    "the parameter '{name}' of the scene '{scene}' is '{value}', but must be a whole number from \
                     {min} to {max}"
                )
            }
        }
    }
}

impl std::error::Error for BuiltinError {}
