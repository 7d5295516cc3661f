//! The kinds of packets, with code of its own for each.

/// What is known of a packet before it is made.
pub(super) trait Kind {
    /// Whether any hit between a ray's start and the common point will do.
    const ANY: bool;
    /// Whether the rays are parallel, instead of meeting in a point.
    const PARALLEL: bool;
    /// Whether rays start somewhere behind the point that their lines meet in.
    const LATE: bool;
}

/// Closest hits of rays that start at one point.
pub(super) struct Closest;

/// Closest hits of rays whose lines meet in a point before their starts.
pub(super) struct Reflected;

/// Any hits of rays that start at one point, or go to one.
pub(super) struct Blocked;

/// Any hits of parallel rays.
pub(super) struct BlockedParallel;

impl Kind for Closest {
    const ANY: bool = false;
    const PARALLEL: bool = false;
    const LATE: bool = false;
}

impl Kind for Reflected {
    const ANY: bool = false;
    const PARALLEL: bool = false;
    const LATE: bool = true;
}

impl Kind for Blocked {
    const ANY: bool = true;
    const PARALLEL: bool = false;
    const LATE: bool = false;
}

impl Kind for BlockedParallel {
    const ANY: bool = true;
    const PARALLEL: bool = true;
    const LATE: bool = false;
}
