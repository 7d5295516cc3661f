//! From where a scene is seen and by what it is lit: the options that every command with a view shares.

use raywood::Vec3;
use raywood_render::{PreparedScene, View, choose_camera, choose_lights};
use raywood_scene::{Camera, Light, LightKind, Rgb, Scene, ambient};

use crate::failure::Failure;
use crate::parse::{Point, PointLight, field_of_view};

/// The options of a view.
#[derive(clap::Args)]
#[command(next_help_heading = "View and light")]
pub(crate) struct ViewArgs {
    /// Where the eye is
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    eye: Option<Point>,

    /// The point in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    target: Option<Point>,

    /// The direction that is up
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, hide_short_help = true)]
    up: Option<Point>,

    /// Field of view from bottom to top
    #[arg(long, value_name = "DEGREES", value_parser = field_of_view, hide_short_help = true)]
    fov: Option<f32>,

    /// The scene's camera to use
    ///
    /// By its number, from 1, or its name; `raywood info` lists them. Else it is the first.
    #[arg(long, value_name = "N|NAME", hide_short_help = true)]
    camera: Option<String>,

    /// Point light; may be repeated
    ///
    /// Takes the place of the scene's lights, with a little ambient light. The strength S is relative: 1, the default, fully lights a surface as far away as the middle of the picture.
    #[arg(long, value_name = "X,Y,Z[,S]", allow_hyphen_values = true)]
    light: Vec<PointLight>,

    /// Leave out the scene's lights, and choose none
    ///
    /// Then the scene is lit by surfaces that shine and by the surroundings alone: for integrator `path`.
    #[arg(long, conflicts_with = "light", hide_short_help = true)]
    no_lights: bool,
}

impl ViewArgs {
    /// Turns the scene the way that the options want it; before anything is made of it.
    pub(crate) fn orient(&self, scene: &mut Scene) {
        scene.up = self.up.map(|point| point.0).or(scene.up);
    }

    /// The camera and lights: those of the options, else the scene's, else chosen ones; lights for the camera that is used. `first_key` is the scene's camera to use if the options do not say. `others`
    /// take the place of the scene's lights. `aspect` is the picture's width over its height.
    ///
    /// # Errors
    ///
    /// The scene has no camera of that number or name.
    pub(crate) fn view(
        &self,
        prepared: &PreparedScene<'_>,
        aspect: f32,
        first_key: Option<&str>,
        others: Option<Vec<Light>>,
    ) -> Result<View, Failure> {
        let scene = prepared.scene();
        let mut camera = match (self.camera.as_deref().or(first_key), scene.cameras.first()) {
            (Some(wanted), _) => camera_called(wanted, scene)?,
            (None, Some(first)) => first.clone(),
            (None, None) => choose_camera(prepared, aspect),
        };
        let or_given = |value: Vec3, given: Option<Point>| given.map_or(value, |point| point.0);
        camera.eye = or_given(camera.eye, self.eye);
        camera.target = or_given(camera.target, self.target);
        camera.up = or_given(camera.up, self.up);
        camera.fov_y = self.fov.unwrap_or(camera.fov_y);

        let lights = if self.no_lights {
            Vec::new()
        } else if !self.light.is_empty() {
            let given = self.light.iter().map(|light| point_light(light, &camera));
            given.chain([ambient(0.15)]).collect()
        } else if let Some(others) = others {
            others
        } else if !scene.lights.is_empty() {
            scene.lights.clone()
        } else {
            choose_lights(prepared, &camera)
        };
        Ok(View { camera, lights })
    }
}

/// A light whose strength is told relative to what the camera looks at.
fn point_light(light: &PointLight, camera: &Camera) -> Light {
    let to_target = camera.target - light.position;
    Light {
        name: String::new(),
        kind: LightKind::Point { position: light.position },
        intensity: Rgb::splat(light.strength * to_target.dot(to_target)),
    }
}

/// The scene's camera of a number, from 1, or a name.
///
/// # Errors
///
/// It has none.
pub(crate) fn camera_called(wanted: &str, scene: &Scene) -> Result<Camera, Failure> {
    let number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    let by_number = number.and_then(|index| scene.cameras.get(index));
    let camera = by_number.or_else(|| scene.cameras.iter().find(|camera| camera.name == wanted));
    camera.cloned().ok_or_else(|| no_such_camera(wanted, scene))
}

fn no_such_camera(wanted: &str, scene: &Scene) -> Failure {
    let known: Vec<_> = (1..)
        .zip(&scene.cameras)
        .map(|(number, camera)| format!("{number} {}", camera.name))
        .collect();
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    Failure::BadInput(format!("{}: has no camera `{wanted}`; its cameras: {known}", scene.name))
}
