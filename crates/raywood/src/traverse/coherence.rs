//! What the rays of packets have in common: the lecture's measure of coherence.

use super::Probe;

/// A probe that counts, over as many packets as it is handed to, what their rays share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coherence {
    /// Nodes that packets visited, each of which at least one ray hits, and hits before what it has hit so far.
    pub nodes: u64,
    /// The valid rays of the visiting packet, summed over these nodes.
    pub rays: u64,
    /// Those of them that hit the node, summed likewise.
    pub hitting: u64,
}

impl Coherence {
    /// How many rays of a packet hit a node that it visits, on average: for so many visits of single rays one visit of the packet stands. The
    /// bound of what packets can save. NaN if nothing was visited.
    pub fn rays_per_node(&self) -> f64 {
        self.hitting as f64 / self.nodes as f64
    }

    /// The rays in a packet over the average number of them that hit a visited node: 1 if all visit the same nodes, as much as there are rays if
    /// each goes its own way. NaN if nothing was visited.
    pub fn coherence(&self) -> f64 {
        self.rays as f64 / self.hitting as f64
    }
}

impl Probe for Coherence {
    #[inline]
    fn packet_node(&mut self, rays: usize, hitting: impl FnOnce() -> usize) {
        self.nodes += 1;
        self.rays += rays as u64;
        self.hitting += hitting() as u64;
    }
}
