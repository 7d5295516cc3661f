//! The axes of the matrix that are lists of names: queries and options. A new query is a line here, and then nothing compiles until every structure answers it or says why not.

use raywood::{Face, QueryOptions};
use raywood_testkit::reference::{Entry, Rule};

/// Defines an axis: its values in order and what tables call them.
macro_rules! axis {
    ($(#[$doc:meta])* $axis:ident { $($value:ident = $name:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum $axis { $($value,)* }

        impl $axis {
            pub(crate) const ALL: &[Self] = &[$(Self::$value,)*];

            pub(crate) fn name(self) -> &'static str {
                match self { $(Self::$value => $name,)* }
            }
        }
    };
}

axis! {
    /// What can be asked.
    Query {
        Closest = "closest hit",
        ClosestBatch = "closest hits, batch",
        ClosestFrom = "closest hits from a point",
        Any = "any hit",
        AnyBatch = "any hit, batch",
        AnyTowards = "any hit towards a point",
        AllHits = "all hits",
        AllHitsBatch = "all hits, batch",
        ForEachHit = "for each hit, with early exit",
        Crossings = "crossings",
        NearestHits = "nearest k hits",
        NearestHitsBatch = "nearest k hits, batch",
        ClosestPoint = "closest point",
        ClosestPointBatch = "closest points, batch",
        Inside = "inside",
        SignedDistance = "signed distances, batch",
        BoxOverlap = "overlap with a box",
        BallOverlap = "overlap with a ball",
        FrustumOverlap = "overlap with a frustum",
        TriangleOverlap = "overlap with a triangle",
        OverlapBatch = "overlap, batch",
        TreeOverlap = "overlap with another tree",
        SphereCast = "moving sphere",
        SphereCastBatch = "moving spheres, batch",
        Visit = "a walk of one's own",
    }
}

axis! {
    /// Which hits count.
    Choice {
        Plain = "",
        Nothing = "options: none",
        CullFront = "cull front",
        CullBack = "cull back",
        Mask = "mask",
        Skip = "skip",
        Filter = "filter",
        Together = "all options",
    }
}

impl Query {
    /// For a batch the same query of each by itself, where that is asked the same.
    pub(crate) fn of_one(self) -> Self {
        match self {
            Self::ClosestBatch => Self::Closest,
            Self::AnyBatch => Self::Any,
            Self::AllHitsBatch => Self::AllHits,
            other => other,
        }
    }

    /// The options that make sense for it.
    pub(crate) fn choices(self) -> &'static [Choice] {
        use Query::*;
        match self {
            Closest | ClosestBatch | Any | AnyBatch | AllHits | AllHitsBatch | ForEachHit
            | NearestHits | NearestHitsBatch => Choice::ALL,
            ClosestPoint | ClosestPointBatch | BoxOverlap | BallOverlap => {
                &[Choice::Plain, Choice::Mask]
            }
            ClosestFrom | AnyTowards | Crossings | Inside | SignedDistance | FrustumOverlap
            | TriangleOverlap | OverlapBatch | TreeOverlap | SphereCast | SphereCastBatch
            | Visit => &[Choice::Plain],
        }
    }
}

/// The groups that queries with a mask see.
pub(crate) const MASK: u32 = 0b010;

/// Whether a filter lets hits of a primitive count.
pub(crate) fn keeps(primitive: u32) -> bool {
    primitive % 3 != 1
}

impl Choice {
    fn culled(self) -> Option<Face> {
        match self {
            Self::CullFront => Some(Face::Front),
            Self::CullBack | Self::Together => Some(Face::Back),
            _ => None,
        }
    }

    pub(crate) fn masks(self) -> bool {
        matches!(self, Self::Mask | Self::Together)
    }

    fn skips(self) -> bool {
        matches!(self, Self::Skip | Self::Together)
    }

    pub(crate) fn filters(self) -> bool {
        matches!(self, Self::Filter | Self::Together)
    }

    /// As the library takes it, but for the filter; `skip` names an instance and a primitive.
    pub(crate) fn options(self, skip: (u32, u32)) -> QueryOptions {
        let mut options = QueryOptions::new();
        if let Some(face) = self.culled() {
            options = options.cull(face);
        }
        if self.masks() {
            options = options.mask(MASK);
        }
        if self.skips() { options.skip_in(skip.0, skip.1) } else { options }
    }

    /// Whether hits of an entry count.
    pub(crate) fn counts(self, skip: (u32, u32), entry: &Entry) -> bool {
        (!self.masks() || entry.masks.iter().all(|mask| mask & MASK != 0))
            && !(self.skips() && (entry.instance, entry.primitive) == skip)
            && (!self.filters() || keeps(entry.primitive))
    }

    /// As the reference takes it.
    pub(crate) fn rule<'a>(self, counts: &'a dyn Fn(&Entry) -> bool) -> Rule<'a> {
        Rule { counts, culled: self.culled() }
    }
}
