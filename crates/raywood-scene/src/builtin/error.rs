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

/// The candidate that a mistyped name probably meant: at most a third of its letters wrong.
pub(super) fn closest<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|candidate| (edit_distance(&name.to_lowercase(), candidate), candidate))
        .filter(|&(distance, candidate)| 3 * distance <= candidate.len().max(3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// How many letters must be changed, added or removed to get from one word to the other (Levenshtein 1966).
fn edit_distance(a: &str, b: &str) -> usize {
    // One row of the table at a time: row[j] is the distance between what was read of `a` and the first j letters
    // of `b`.
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_misses_find_what_was_meant() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(closest("whited", ["hall", "whitted"]), Some("whitted"));
        assert_eq!(closest("Hal", ["hall", "whitted"]), Some("hall"));
        assert_eq!(closest("teapot", ["hall", "whitted"]), None);
    }
}
