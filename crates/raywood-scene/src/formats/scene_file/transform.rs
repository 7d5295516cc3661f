//! Where something stands: `translate`, `rotate` and `scale`, or `matrix`.

use raywood::{Transform, Vec3};

use super::syntax::{Fields, Value};
use crate::error::LoadError;

/// The keys of a place.
pub(super) const KEYS: [&str; 4] = ["translate", "rotate", "scale", "matrix"];

/// The transform of a table: first scaled, then turned, then moved. A single angle turns around the direction that is up.
pub(super) fn read(fields: &Fields<'_>, up: Vec3) -> Result<Transform, LoadError> {
    let transform = match fields.get("matrix") {
        Some(matrix) => {
            if let Some(other) = KEYS[..3].iter().find_map(|key| fields.get(key)) {
                let message = format!("`matrix` is given: `{}` has no place beside it", other.key);
                return Err(other.error(message));
            }
            self::matrix(matrix)?
        }
        None => {
            let scaled = fields.read("scale", scaling)?.unwrap_or_default();
            let turned = fields.read("rotate", |value| rotation(value, up))?.unwrap_or_default();
            let moved = fields.read("translate", Value::vector)?.unwrap_or(Vec3::ZERO);
            scaled.then(&turned).then(&Transform::translation(moved))
        }
    };
    let check = transform.check().map_err(|error| fields.error(format!("the place {error}")));
    check.map(|()| transform)
}

fn scaling(value: Value<'_>) -> Result<Transform, LoadError> {
    let factors = value.as_number().map(Vec3::splat).or_else(|| value.as_numbers().map(Vec3::from));
    let factors = factors.filter(|v| v.to_array().iter().all(|factor| *factor != 0.0));
    factors
        .map(Transform::scaling)
        .ok_or_else(|| value.expected("a number other than 0, or three, as in [1, 2, 1]"))
}

fn rotation(value: Value<'_>, up: Vec3) -> Result<Transform, LoadError> {
    if let Some(degrees) = value.as_number() {
        return Ok(Transform::rotation(up, degrees));
    }
    if let Some([x, y, z]) = value.as_numbers() {
        let [x, y, z] = [(Vec3::X, x), (Vec3::Y, y), (Vec3::Z, z)]
            .map(|(axis, degrees)| Transform::rotation(axis, degrees));
        return Ok(x.then(&y).then(&z));
    }
    if value.is_table() {
        let fields = value.fields("`rotate`", &["axis", "degrees"])?;
        let axis = fields.require("axis")?.direction()?;
        return Ok(Transform::rotation(axis, fields.require("degrees")?.number()?));
    }
    Err(value.expected(
        "degrees around the direction that is up, around x, y and z, as in [0, 90, 0], or { axis = [0, 1, 0], degrees = 90 }",
    ))
}

fn matrix(value: Value<'_>) -> Result<Transform, LoadError> {
    let rows = value.as_values::<3>().and_then(|rows| {
        let [a, b, c] = rows.map(|row| row.as_numbers::<4>());
        Some([a?, b?, c?])
    });
    rows.map(Transform::from_rows).ok_or_else(|| {
        value.expected(
            "three rows of four numbers, as in [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0]]",
        )
    })
}
