//! What is around a scene: a panorama of a file, a sky by formula, or nothing.

use std::path::PathBuf;
use std::str::FromStr;

use raywood_scene::{Axes, Environment, Light, Sky, load_environment};

use crate::failure::Failure;

/// What `--environment` names.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Surroundings {
    /// Nothing: black.
    Nothing,
    /// A clear sky and its sun.
    Sky(Sky),
    /// A picture.
    File(PathBuf),
}

impl FromStr for Surroundings {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match Sky::from_name(text) {
            _ if text == "none" => Ok(Self::Nothing),
            Some(sky) => sky.map(Self::Sky).map_err(|error| error.to_string()),
            None => Ok(Self::File(text.into())),
        }
    }
}

impl Surroundings {
    /// The panorama to put around a scene.
    ///
    /// # Errors
    ///
    /// A file that is no panorama.
    pub(crate) fn panorama(&self) -> Result<Environment, Failure> {
        match self {
            Self::Nothing => Ok(Environment::black()),
            Self::Sky(sky) => sky
                .panorama()
                .ok_or_else(|| Failure::BadInput("a sky of absurd numbers".to_owned())),
            Self::File(path) => load_environment(path).map_err(Failure::bad_input),
        }
    }

    /// The lights that go with a panorama, those of a sky.
    pub(crate) fn lights(&self, panorama: &Environment, axes: &Axes) -> Option<Vec<Light>> {
        let Self::Sky(sky) = self else { return None };
        Some(sky.lights(panorama, axes).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_surroundings() {
        assert_eq!("none".parse(), Ok(Surroundings::Nothing));
        assert_eq!("skylight.hdr".parse(), Ok(Surroundings::File("skylight.hdr".into())));
        let evening = Sky { elevation: -2.5, turbidity: 4.0, ..Sky::default() };
        assert_eq!("sky:elevation=-2.5,turbidity=4".parse(), Ok(Surroundings::Sky(evening)));
        let error = "sky:height=3".parse::<Surroundings>().expect_err("it is refused");
        assert!(error.starts_with("a sky has no `height`: expected one of elevation, "), "{error}");
    }
}
