//! What is around a scene: a panorama of a file, a sky by formula, or nothing.

use std::path::PathBuf;
use std::str::FromStr;

use raywood_scene::{Axes, Environment, Light, LightKind, Sky, load_environment};

use crate::failure::Failure;
use crate::parse::named;

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
        match text.split_once(':') {
            _ if text == "none" => Ok(Self::Nothing),
            _ if text == "sky" => Ok(Self::Sky(Sky::default())),
            Some(("sky", parts)) => sky(parts).map(Self::Sky),
            _ => Ok(Self::File(text.into())),
        }
    }
}

/// A sky of which some numbers are given, `NAME=NUMBER` between commas.
fn sky(parts: &str) -> Result<Sky, String> {
    let mut sky = Sky::default();
    for part in parts.split(',') {
        let (name, value) = part.split_once('=').unwrap_or((part, ""));
        let (name, value) = (name.trim(), value.trim());
        let number = match name {
            "elevation" => Some((&mut sky.elevation, Sky::ELEVATIONS)),
            "azimuth" => Some((&mut sky.azimuth, Sky::AZIMUTHS)),
            "turbidity" => Some((&mut sky.turbidity, Sky::TURBIDITIES)),
            _ => None,
        };
        let (number, range) = named(name, number, ["elevation", "azimuth", "turbidity"])
            .map_err(|said| format!("a sky has no `{name}`: {said}, as in sky:elevation=20"))?;
        let wanted = value.parse().ok().filter(|wanted| range.contains(wanted));
        *number = wanted.ok_or_else(|| {
            let (least, most) = range.into_inner();
            format!("`{value}` is no {name} of a sky: expected a number from {least} to {most}")
        })?;
    }
    Ok(sky)
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

    /// The lights that go with a panorama: of a sky the sun and, for methods that do not ask the surroundings, ambient light as bright as these are in the mean.
    pub(crate) fn lights(&self, panorama: &Environment, axes: &Axes) -> Option<Vec<Light>> {
        let Self::Sky(sky) = self else { return None };
        let from_all_sides = Light {
            name: "sky".to_owned(),
            kind: LightKind::Ambient,
            intensity: panorama.mean_light(),
        };
        Some(vec![sky.sun(axes), from_all_sides])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_surroundings() {
        let sky = |text: &str| match text.parse() {
            Ok(Surroundings::Sky(sky)) => sky,
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(sky("sky"), Sky::default());
        let evening = sky("sky:elevation=-2.5, turbidity=4");
        assert_eq!(evening, Sky { elevation: -2.5, turbidity: 4.0, ..Sky::default() });
        assert_eq!("none".parse(), Ok(Surroundings::Nothing));
        assert_eq!("skylight.hdr".parse(), Ok(Surroundings::File("skylight.hdr".into())));
        for (text, expected) in [
            ("sky:", "a sky has no ``: expected one of elevation, azimuth, turbidity"),
            ("sky:height=3", "a sky has no `height`: expected one of elevation, "),
            ("sky:elevaton=3", "a sky has no `elevaton`: did you mean elevation? expected"),
            ("sky:elevation=abc", "`abc` is no elevation of a sky: expected a number from -12"),
            ("sky:elevation=91", "`91` is no elevation of a sky: expected a number from -12 to 90"),
            ("sky:azimuth", "`` is no azimuth of a sky: expected a number"),
            ("sky:turbidity=NaN", "`NaN` is no turbidity of a sky: expected a number from 1 to 10"),
        ] {
            let error = text.parse::<Surroundings>().expect_err("it is refused");
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
