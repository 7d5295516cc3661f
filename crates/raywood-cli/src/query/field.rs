//! The columns of answers: their names, types and shapes.
//!
//! | name            | type    | shape  | content                                                        | where nothing is hit or found |
//! | --------------- | ------- | ------ | -------------------------------------------------------------- | ----------------------------- |
//! | `t`             | float32 | (N,)   | distance in units of the direction's length                    | infinity                      |
//! | `distance`      | float32 | (N,)   | distance of the closest point                                  | infinity                      |
//! | `primitive`     | int32   | (N,)   | which triangle, in the order of the file, then which sphere    | -1                            |
//! | `u`, `v`        | float32 | (N,)   | `position = (1-u-v) p0 + u p1 + v p2`                          | NaN                           |
//! | `position`      | float32 | (N, 3) | the point on the surface                                       | NaN                           |
//! | `normal`        | float32 | (N, 3) | `(p1-p0) x (p2-p0)` at unit length; 0 on triangles without area | NaN                           |
//! | `material`      | int32   | (N,)   | which material, in the order of `raywood info`                 | -1                            |
//! | `hit`           | bool    | (N,)   | whether anything is hit                                        | false                         |
//! | `count`         | int32   | (N,)   | how many hits                                                  | 0                             |
//! | `inside`        | bool    | (N,)   | whether the point is inside                                    | false                         |
//! | `winding_number` | float32 | (N,)  | how often the surface goes around the point                    | 0                             |
//! | `signed_distance` | float32 | (N,) | distance from the surface, negative inside                     | NaN                           |
//!
//! Text has `inf` and `NaN` in CSV; JSON has neither, and `null` where nothing is hit or found.

/// A column of answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    T,
    Distance,
    Primitive,
    U,
    V,
    Position,
    Normal,
    Material,
    Hit,
    Count,
    Inside,
    WindingNumber,
    SignedDistance,
}

/// The type of a column's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    F32,
    I32,
    Bool,
}

impl Field {
    /// The name in every format.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::T => "t",
            Self::Distance => "distance",
            Self::Primitive => "primitive",
            Self::U => "u",
            Self::V => "v",
            Self::Position => "position",
            Self::Normal => "normal",
            Self::Material => "material",
            Self::Hit => "hit",
            Self::Count => "count",
            Self::Inside => "inside",
            Self::WindingNumber => "winding_number",
            Self::SignedDistance => "signed_distance",
        }
    }

    /// The type of its numbers.
    pub(crate) fn element(self) -> Element {
        match self {
            Self::Primitive | Self::Material | Self::Count => Element::I32,
            Self::Hit | Self::Inside => Element::Bool,
            _ => Element::F32,
        }
    }

    /// How many numbers a row has: 1, or 3 of points and directions.
    pub(crate) fn width(self) -> usize {
        if matches!(self, Self::Position | Self::Normal) { 3 } else { 1 }
    }
}
