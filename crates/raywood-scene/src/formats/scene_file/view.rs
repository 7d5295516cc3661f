//! What lights a scene and from where it is seen: `[[light]]`, `[[camera]]`, `background`.

use raywood::Vec3;

use super::syntax::Value;
use crate::error::LoadError;
use crate::framing::FOV_Y;
use crate::{Background, Camera, Light, LightKind};

/// A table of a light.
pub(super) fn light(value: Value<'_>) -> Result<Light, LoadError> {
    const POINT: &[&str] = &["name", "kind", "intensity", "position"];
    const SPOT: &[&str] = &[
        "name",
        "kind",
        "intensity",
        "position",
        "direction",
        "target",
        "inner_angle",
        "outer_angle",
    ];
    const DIRECTIONAL: &[&str] = &["name", "kind", "intensity", "direction", "angular_radius"];
    const AMBIENT: &[&str] = &["name", "kind", "intensity"];

    let kinds = ["point", "spot", "directional", "ambient"];
    let all = [SPOT, &["angular_radius"]].concat();
    let kind = value.fields("[[light]]", &all)?.require("kind")?.word(&kinds)?;
    let (what, keys) = match kind {
        "point" => ("a point light", POINT),
        "spot" => ("a spot light", SPOT),
        "directional" => ("a directional light", DIRECTIONAL),
        _ => ("ambient light", AMBIENT),
    };
    let fields = value.fields(what, keys)?;
    let position = || fields.require("position")?.vector();
    let kind = match kind {
        "point" => LightKind::Point { position: position()? },
        "spot" => {
            let position = position()?;
            let direction = match (fields.get("target"), fields.get("direction")) {
                (Some(target), None) => {
                    let to = (target.vector()? - position).normalize_or_zero();
                    let found = Some(to).filter(|to| *to != Vec3::ZERO);
                    found.ok_or_else(|| target.expected("a point other than `position`"))?
                }
                (None, Some(direction)) => direction.direction()?,
                (Some(_), Some(direction)) => {
                    let message = "`direction` has no place beside `target`, which gives it";
                    return Err(direction.error(message));
                }
                (None, None) => {
                    return Err(fields.error("a spot light needs `target` or `direction`"));
                }
            };
            let outer = fields.read("outer_angle", |v| v.number_in(0.1..=90.0))?.unwrap_or(45.0);
            let inner = fields.get("inner_angle");
            let inner = match inner {
                Some(value) => value.number_in(0.0..=outer)?,
                None => 0.0,
            };
            LightKind::Spot {
                position,
                direction,
                // The inner one is less, by what cosines can tell.
                cos_inner: inner.to_radians().cos().max(outer.to_radians().cos().next_up()),
                cos_outer: outer.to_radians().cos(),
            }
        }
        "directional" => {
            let angle = fields.read("angular_radius", |value| value.number_in(0.0..=90.0))?;
            LightKind::Directional {
                direction: fields.require("direction")?.direction()?,
                angular_radius: angle.unwrap_or(0.0).to_radians(),
            }
        }
        _ => LightKind::Ambient,
    };
    let name = fields.read("name", Value::text)?.unwrap_or_default().to_owned();
    Ok(Light { name, kind, intensity: fields.require("intensity")?.color(f32::MAX)? })
}

/// A table of a camera. Its picture stands upright where `up` is up, unless it says otherwise.
pub(super) fn camera(value: Value<'_>, up: Vec3) -> Result<Camera, LoadError> {
    let fields = value.fields("[[camera]]", &["name", "eye", "target", "up", "fov"])?;
    let eye = fields.require("eye")?.vector()?;
    let target_value = fields.require("target")?;
    let target = target_value.vector()?;
    let sight = (target - eye).normalize_or_zero();
    if sight == Vec3::ZERO {
        return Err(target_value.expected("a point other than `eye`"));
    }
    let up = fields.read("up", Value::direction)?.unwrap_or(up);
    if sight.cross(up).length() < 1e-6 {
        let message =
            "the camera looks straight up or down: its key `up` must say what is up in the picture";
        return Err(fields
            .get("up")
            .map_or_else(|| fields.error(message), |value| value.error(message)));
    }
    let fov = |value: Value<'_>| {
        let degrees = value.as_number().filter(|fov| *fov > 0.0 && *fov < 180.0);
        degrees.ok_or_else(|| value.expected("degrees from bottom to top, above 0 and below 180"))
    };
    Ok(Camera {
        name: fields.read("name", Value::text)?.unwrap_or_default().to_owned(),
        eye,
        target,
        up,
        fov_y: fields.read("fov", fov)?.unwrap_or(FOV_Y),
    })
}

/// One colour all around, or three that blend.
pub(super) fn background(value: Value<'_>) -> Result<Background, LoadError> {
    if !value.is_table() {
        let color = value.color(f32::MAX)?;
        return Ok(Background { zenith: color, horizon: color, nadir: color });
    }
    let fields = value.fields("`background`", &["zenith", "horizon", "nadir"])?;
    let color = |key| fields.require(key)?.color(f32::MAX);
    Ok(Background { zenith: color("zenith")?, horizon: color("horizon")?, nadir: color("nadir")? })
}
