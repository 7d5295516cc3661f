//! Parallel locally-ordered clustering: primitives along a space-filling curve, neighbours merged from the bottom up. Meister and Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 2018; Benthin et al., "PLOC++", PACM CGIT 2022.

mod clusters;
mod layout;
mod merges;
mod nearest;

use super::curve::{Precision, SortedKeys, sorted_keys};
use super::{Cancelled, Work};
use crate::structures::Bvh2;
use crate::{BuildError, BuildOptions, Geometry, SimdLevel, parallel};
use clusters::{Cluster, clusters_of_primitives};
use layout::Layout;
use merges::{Merges, merge};
use nearest::{find_nearest, pair_up};

/// A round that leaves more than this share of the clusters is followed by one that pairs them along the curve.
const SLOW: f64 = 0.97;

/// Builds the tree. The same for any number of threads, and for all levels of instructions. O(N) but for primitives in one place, where it is O(N log N).
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<Bvh2, BuildError> {
    let [ordering, reading, clustering, laying_out] = work.shares([5.0, 1.0, 5.0, 4.0]);
    let options = options.clamped();
    let sorted = sorted_keys(geometry, Precision::Full, ordering)?;
    let SortedKeys { keys, bits, around } = sorted;
    if keys.is_empty() {
        return Ok(Bvh2::from_parts(Vec::new(), Vec::new()));
    }
    let number = |place: usize| bits.number(keys[place]);
    let order = parallel::map_watched(keys.len(), work.without_progress(), number)?;
    drop(keys);

    let clusters = clusters_of_primitives(geometry, &order, reading)?;
    let is_measurable = around.bounds.extent()[..3].iter().all(|edge| edge.is_finite());
    let merges = merge_all(clusters, is_measurable, clustering)?;
    Ok(Layout { geometry, order: &order, merges: &merges, options: &options }.tree(laying_out)?)
}

/// Merges neighbours in rounds until one cluster is left. Areas of boxes that are too large to be measured are not asked for.
fn merge_all(
    mut clusters: Vec<Cluster>,
    is_measurable: bool,
    work: Work<'_>,
) -> Result<Merges, Cancelled> {
    let level = SimdLevel::active();
    let primitives = clusters.len();
    let mut merges = Merges::with_room(primitives, work.without_progress())?;
    let mut merged = work.without_progress().copies(Cluster::NONE, primitives)?;
    let mut neighbours = vec![0i8; primitives];
    let mut was_slow = !is_measurable;
    let mut count = primitives;
    while count > 1 {
        let (some, neighbours) = (&clusters[..count], &mut neighbours[..count]);
        match was_slow {
            true => pair_up(neighbours),
            false => find_nearest(some, neighbours, level, work)?,
        }
        let left = merge(some, neighbours, &mut merged, &mut merges, work)?;
        std::mem::swap(&mut clusters, &mut merged);
        // Where ties make a ring, nobody may be the nearest of its nearest.
        was_slow = !is_measurable || left as f64 > SLOW * count as f64;
        work.part(count - left, primitives).done()?;
        count = left;
    }
    Ok(merges)
}
