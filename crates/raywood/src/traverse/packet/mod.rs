//! Packets of rays in plain form: rays that walk through the binary tree together, after Wald, Slusallek, Benthin and Wagner,
//! "Interactive Rendering with Coherent Ray Tracing", Eurographics 2001.

mod interval;
mod travellers;
mod walk;

use super::Probe;
use super::nearest::blocks;
use crate::structures::Bvh2;
use crate::{Geometry, Hit, Ray};
use travellers::Travellers;
use walk::walk;

/// Packets: for rays that lie near each other, such as those through neighbouring pixels.
///
/// The rays of a packet visit a node together, so that it is fetched once, and mostly one ray answers for all of them: if the first of
/// them that hit the node's parent hits the node, all descend; if not, interval arithmetic over origins and directions often tells at once
/// that none can hit it; only if neither helps are the others asked. This is the traversal of Wald, Boulos and Shirley, "Ray Tracing
/// Deformable Scenes Using Dynamic Bounding Volume Hierarchies", TOG 2007, with the interval test of Reshetov, Soupikov and Hurley,
/// "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005, and with a last active ray beside the first: the ranged traversal of Overbeck,
/// Ramamoorthi and Mark, "Large Ray Packets for Real-time Whitted Ray Tracing", RT 2008.
///
/// Any rays may travel together, and the answers are those of the same rays one by one, to the bit; what the rays have in common decides only
/// how fast they come. A ray that is not [valid](Ray::is_valid) hits nothing and does not change what the others cost.
impl Bvh2 {
    /// As many rays as a packet may have: those of 16 x 16 pixels.
    pub const LARGEST_PACKET: usize = 256;

    /// The closest hits of rays that walk together, in packets of [`LARGEST_PACKET`](Self::LARGEST_PACKET) if there are more.
    ///
    /// Rays that lie beside each other should stand near each other in the slice. The probe is told of every node once, however many rays
    /// visit it, of every test of a box, be it against a ray or against the whole packet, and of every test of a primitive against a ray;
    /// [`Coherence`](crate::Coherence) is a probe for packets.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn intersect_packet<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        probe: &mut P,
    ) {
        assert_eq!(rays.len(), hits.len(), "as many hits as rays");
        let packets = rays.chunks(Self::LARGEST_PACKET);
        for (rays, hits) in packets.zip(hits.chunks_mut(Self::LARGEST_PACKET)) {
            let mut travellers = Travellers::new(rays);
            walk(self, &mut travellers, probe, |traveller, primitive| {
                traveller.nearest.test(geometry, &traveller.ray, primitive);
            });
            hits.fill(None);
            for traveller in travellers.into_iter() {
                hits[traveller.place] = traveller.nearest.into_hit();
            }
        }
    }

    /// Whether anything blocks each of the rays that walk together: as [`intersect_packet`](Self::intersect_packet). A blocked ray leaves its
    /// packet.
    ///
    /// # Panics
    ///
    /// If the two slices differ in length.
    pub fn occluded_packet<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        rays: &[Ray],
        occluded: &mut [bool],
        probe: &mut P,
    ) {
        assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
        let packets = rays.chunks(Self::LARGEST_PACKET);
        for (rays, occluded) in packets.zip(occluded.chunks_mut(Self::LARGEST_PACKET)) {
            let mut travellers = Travellers::new(rays);
            walk(self, &mut travellers, probe, |traveller, primitive| {
                if blocks(geometry, &traveller.ray, primitive) {
                    traveller.nearest.block();
                }
            });
            occluded.fill(false);
            for traveller in travellers.into_iter() {
                occluded[traveller.place] = traveller.nearest.is_blocked();
            }
        }
    }
}
