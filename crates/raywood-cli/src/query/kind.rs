//! What can be asked of a scene, and which columns answer it.

use super::field::Field;

/// What rays or points are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// Where each ray first hits something
    Closest,
    /// Whether each ray hits anything
    Any,
    /// Everything that each ray hits, nearest first, each crossing of a surface once
    All,
    /// How many hits `all` would give
    Count,
    /// The point of a surface that is closest to each point
    ClosestPoint,
    /// Whether each point is inside of a solid
    Inside,
    /// How far each point is from the surface, negative inside
    SignedDistance,
}

/// What a question is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subject {
    /// Rows of origin and direction, perhaps with `t_min` and `t_max`.
    Rays,
    /// Rows of three coordinates.
    Points,
}

impl Subject {
    /// The word for many.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rays => "rays",
            Self::Points => "points",
        }
    }

    /// What is asked if nothing else is said.
    pub(crate) fn default_kind(self) -> Kind {
        match self {
            Self::Rays => Kind::Closest,
            Self::Points => Kind::ClosestPoint,
        }
    }
}

impl Kind {
    /// The name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Any => "any",
            Self::All => "all",
            Self::Count => "count",
            Self::ClosestPoint => "closest-point",
            Self::Inside => "inside",
            Self::SignedDistance => "signed-distance",
        }
    }

    /// What it is asked of.
    pub(crate) fn subject(self) -> Subject {
        match self {
            Self::Closest | Self::Any | Self::All | Self::Count => Subject::Rays,
            Self::ClosestPoint | Self::Inside | Self::SignedDistance => Subject::Points,
        }
    }

    /// Whether each row of the input has a list of answers.
    pub(crate) fn gives_lists(self) -> bool {
        self == Self::All
    }

    /// The columns that are written if none are named.
    pub(crate) fn usual_fields(self) -> &'static [Field] {
        use Field::*;
        match self {
            Self::Closest | Self::All => &[T, Primitive, U, V, Position, Normal],
            Self::Any => &[Hit],
            Self::Count => &[Count],
            Self::ClosestPoint => &[Distance, Primitive, U, V, Position],
            Self::Inside => &[Inside],
            Self::SignedDistance => &[SignedDistance],
        }
    }

    /// Columns that are written only if they are named.
    pub(crate) fn further_fields(self) -> &'static [Field] {
        match self {
            Self::Closest | Self::All | Self::ClosestPoint => &[Field::Material],
            Self::Inside => &[Field::WindingNumber],
            Self::Any | Self::Count | Self::SignedDistance => &[],
        }
    }

    /// What an answer says that is not a miss, for the summary.
    pub(crate) fn success(self) -> &'static str {
        match self {
            Self::Closest | Self::Any => "hit something",
            Self::All | Self::Count => "hits",
            Self::ClosestPoint | Self::SignedDistance => "found a surface",
            Self::Inside => "inside",
        }
    }
}
