//! Where something stands: `translate`, `rotate` and `scale`, or `matrix`; and where it moves `to`.

use raywood::{Transform, Vec3};

use super::syntax::{Fields, Value};
use crate::error::LoadError;

/// The keys of a place.
pub(super) const KEYS: [&str; 4] = ["translate", "rotate", "scale", "matrix"];

/// The transform of a table: first scaled, then turned, then moved. A single angle turns around the direction that is up. What the table does not say is as in `own`, if that is given.
fn transform(
    fields: &Fields<'_>,
    own: Option<&Fields<'_>>,
    up: Vec3,
) -> Result<Transform, LoadError> {
    let other = KEYS[..3].iter().find_map(|key| fields.get(key));
    let transform = match (fields.get("matrix"), other) {
        (Some(_), Some(other)) => {
            let message = format!("`matrix` is given: `{}` has no place beside it", other.key);
            return Err(other.error(message));
        }
        (Some(matrix), None) => self::matrix(matrix)?,
        (None, other) => match (own.and_then(|own| own.get("matrix")), other) {
            (Some(_), Some(other)) => {
                let message =
                    format!("the place is a `matrix`: expected one here too, not `{}`", other.key);
                return Err(other.error(message));
            }
            (Some(matrix), None) => self::matrix(matrix)?,
            (None, _) => {
                let of = |key| fields.get(key).or_else(|| own?.get(key));
                let scaled = of("scale").map(scaling).transpose()?.unwrap_or_default();
                let turned = of("rotate").map(|value| rotation(value, up)).transpose()?;
                let moved = of("translate").map(Value::vector).transpose()?.unwrap_or(Vec3::ZERO);
                scaled.then(&turned.unwrap_or_default()).then(&Transform::translation(moved))
            }
        },
    };
    let check = transform.check().map_err(|error| fields.error(format!("the place {error}")));
    check.map(|()| transform)
}

/// The transform of a table, and that of what it moves `to`, if it moves.
pub(super) fn read(
    fields: &Fields<'_>,
    up: Vec3,
) -> Result<(Transform, Option<Transform>), LoadError> {
    let first = transform(fields, None, up)?;
    let Some(to) = fields.get("to") else { return Ok((first, None)) };
    let later = transform(&to.fields("`to`", &KEYS)?, Some(fields), up)?;
    first.check_motion(&later).map_err(|error| to.error(format!("the place {error}")))?;
    Ok((first, Some(later).filter(|later| *later != first)))
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
