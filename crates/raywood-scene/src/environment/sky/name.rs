//! Skies by name, as people write them: `sky:elevation=20,turbidity=3`.

use std::fmt;
use std::ops::RangeInclusive;

use super::Sky;
use crate::closest_name;
use crate::error::quoted;

/// What the numbers of a sky are called.
const NAMES: [&str; 3] = ["elevation", "azimuth", "turbidity"];

/// Why the name of a sky was refused. Prints as one line that says what was expected.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SkyError {
    /// A sky has no number of this name.
    UnknownName {
        /// The name that was asked for.
        name: String,
        /// The name that was probably meant.
        suggestion: Option<&'static str>,
    },
    /// A value is not a number in its range.
    BadValue {
        /// Which number.
        name: &'static str,
        /// The value that was asked for.
        value: String,
        /// The values allowed.
        range: RangeInclusive<f32>,
    },
}

impl fmt::Display for SkyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownName { name, suggestion } => {
                write!(f, "a sky has no {}: ", quoted(name.as_bytes()))?;
                if let Some(suggestion) = suggestion {
                    write!(f, "did you mean {suggestion}? ")?;
                }
                write!(f, "expected one of {}, as in sky:elevation=20", NAMES.join(", "))
            }
            Self::BadValue { name, value, range } => {
                let (value, least, most) = (quoted(value.as_bytes()), range.start(), range.end());
                write!(f, "{value} is no {name} of a sky: expected a number from {least} to {most}")
            }
        }
    }
}

impl std::error::Error for SkyError {}

impl Sky {
    /// The sky that a text names: `sky`, or with some of its numbers `sky:elevation=20,azimuth=60,turbidity=3`; the others are those of the
    /// [default](Self::default). `None` if it is the name of something else.
    ///
    /// # Errors
    ///
    /// A number that a sky has not, or a value that is out of its range.
    pub fn from_name(text: &str) -> Option<Result<Self, SkyError>> {
        match text.split_once(':') {
            None if text == "sky" => Some(Ok(Self::default())),
            Some(("sky", numbers)) => Some(Self::of_numbers(numbers)),
            _ => None,
        }
    }

    /// A sky of which some numbers are given, `NAME=NUMBER` between commas.
    fn of_numbers(text: &str) -> Result<Self, SkyError> {
        let mut sky = Self::default();
        for part in text.split(',') {
            let (name, value) = part.split_once('=').unwrap_or((part, ""));
            let (name, value) = (name.trim(), value.trim());
            let Some(&name) = NAMES.iter().find(|known| **known == name) else {
                let (name, suggestion) = (name.to_owned(), closest_name(name, NAMES));
                return Err(SkyError::UnknownName { name, suggestion });
            };
            let (number, range) = match name {
                "elevation" => (&mut sky.elevation, Self::ELEVATIONS),
                "azimuth" => (&mut sky.azimuth, Self::AZIMUTHS),
                _ => (&mut sky.turbidity, Self::TURBIDITIES),
            };
            *number = match value.parse() {
                Ok(wanted) if range.contains(&wanted) => wanted,
                _ => return Err(SkyError::BadValue { name, value: value.to_owned(), range }),
            };
        }
        Ok(sky)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies_have_names() {
        let sky = |text| Sky::from_name(text).expect("it names a sky");
        assert_eq!(sky("sky"), Ok(Sky::default()));
        let evening = Sky { elevation: -2.5, turbidity: 4.0, ..Sky::default() };
        assert_eq!(sky("sky:elevation=-2.5, turbidity=4"), Ok(evening));
        assert_eq!(sky("sky:azimuth=-90").map(|sky| sky.azimuth), Ok(-90.0));
        for other in ["", "none", "skylight.hdr", "sky.hdr", "Sky", "c:sky"] {
            assert_eq!(Sky::from_name(other), None, "{other}");
        }
        for (text, expected) in [
            ("sky:", "a sky has no ``: expected one of elevation, azimuth, turbidity"),
            ("sky:height=3", "a sky has no `height`: expected one of elevation, "),
            ("sky:elevaton=3", "a sky has no `elevaton`: did you mean elevation? expected"),
            ("sky:elevation=abc", "`abc` is no elevation of a sky: expected a number from -12"),
            ("sky:elevation=91", "`91` is no elevation of a sky: expected a number from -12 to 90"),
            ("sky:azimuth", "`` is no azimuth of a sky: expected a number"),
            ("sky:turbidity=NaN", "`NaN` is no turbidity of a sky: expected a number from 1 to 10"),
        ] {
            let error = sky(text).expect_err("it is refused").to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
