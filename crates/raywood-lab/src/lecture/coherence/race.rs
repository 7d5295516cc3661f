//! Packets against single rays on the same binary tree: what they share, what they visit, what they take, and whether they agree.

use std::hint::black_box;

use raywood::{
    AccelerationStructure, BuildOptions, Bvh2, Coherence, Counts, Geometry, Hit, Probe, Ray,
};
use raywood_render::{PreparedScene, default_view};

use crate::lecture::LectureError;
use crate::lecture::lab::Subject;
use crate::lecture::measure::nanoseconds;
use crate::ray_sets::{PixelOrder, RayKind, RaySet, ray_sets_in};
use crate::timing::{Timing, seconds, take_turns};

/// The edges of the packets in pixels.
pub(super) const EDGES: [usize; 3] = [4, 8, 16];

/// The rays of the largest packets.
const BLOCK: usize = Bvh2::LARGEST_PACKET;

/// Rays of one kind on one scene.
#[derive(Clone, Debug)]
pub(super) struct Race {
    pub(super) scene: String,
    pub(super) kind: RayKind,
    /// How many rays there are.
    pub(super) rays: usize,
    /// One ray after the other.
    pub(super) single: Cost,
    /// Packets of every edge in [`EDGES`].
    pub(super) packets: [Packets; EDGES.len()],
    /// How many answers of packets differ from those of single rays.
    pub(super) wrong: usize,
    /// All times that were taken.
    pub(super) timings: Vec<Timing>,
}

/// What a ray costs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    /// Nodes that are visited for it: of a packet's visit, its part.
    pub(super) nodes: f64,
    pub(super) nanoseconds: f64,
}

/// Packets of one size.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Packets {
    pub(super) coherence: Coherence,
    pub(super) cost: Cost,
}

impl Race {
    /// How many times faster packets of a size are than single rays.
    pub(super) fn speed_up(&self, packets: &Packets) -> f64 {
        self.single.nanoseconds / packets.cost.nanoseconds
    }

    /// The same for the fastest packets.
    pub(super) fn best_speed_up(&self) -> f64 {
        self.packets.iter().map(|packets| self.speed_up(packets)).fold(f64::NAN, f64::max)
    }
}

/// Races every kind of ray of a scene; none of a kind of which there are not enough for a packet.
pub(super) fn races(
    subject: &Subject<'_>,
    quick: bool,
    rounds: usize,
) -> Result<Vec<Race>, LectureError> {
    let surfaces = PreparedScene::surfaces(subject.scene);
    let tree = Bvh2::build(&surfaces, &BuildOptions::default())?;
    let sets = blocks(&subject.prepared()?.scene, quick)?;
    let sets = sets.iter().filter(|set| !set.rays.is_empty());
    Ok(sets.map(|set| race(subject.name(), &tree, &surfaces, set, rounds)).collect())
}

/// Rays of a picture of 1280 x 800 pixels in whole blocks of 16 x 16, spread evenly over it.
fn blocks(scene: &PreparedScene<'_>, quick: bool) -> Result<Vec<RaySet>, LectureError> {
    let (aspect, pixels, blocks) = if quick { (1.6, 320 * 200, 8) } else { (1.6, 1280 * 800, 128) };
    let view = default_view(scene, aspect);
    let mut sets = ray_sets_in(PixelOrder::Morton, scene, &view, aspect, pixels)?;
    for set in &mut sets {
        set.keep_runs(blocks, BLOCK);
    }
    Ok(sets)
}

/// Races rays of one kind.
fn race<G: Geometry>(scene: &str, tree: &Bvh2, geometry: &G, set: &RaySet, rounds: usize) -> Race {
    let count = set.rays.len();
    // How many rays go together: first each alone.
    let contestants = [1, EDGES[0], EDGES[1], EDGES[2]].map(|edge| edge * edge);
    let mut answers = Answers::new(set);

    // What they say and visit; single rays say what is right.
    let mut nodes = Vec::new();
    let mut wrong = 0;
    let mut right = None;
    for size in contestants {
        let mut counts = Counts::default();
        answers.trace(tree, geometry, size, &mut counts);
        nodes.push(counts.nodes as f64 / count as f64);
        wrong += right.get_or_insert_with(|| answers.clone()).differing(&answers);
    }

    // What they take.
    let run = |contestant: usize| {
        let trace = || answers.trace(tree, geometry, contestants[contestant], &mut ());
        let taken = seconds(trace).0;
        black_box(&answers);
        Some(taken)
    };
    let timings = take_turns(contestants.len(), rounds, run).unwrap_or_default();

    let cost = |contestant: usize| Cost {
        nodes: nodes[contestant],
        nanoseconds: nanoseconds(&timings[contestant], count),
    };
    let packets = [0, 1, 2].map(|number| {
        let mut coherence = Coherence::default();
        Answers::new(set).trace(tree, geometry, contestants[number + 1], &mut coherence);
        Packets { coherence, cost: cost(number + 1) }
    });
    let (scene, kind, single) = (scene.to_owned(), set.kind, cost(0));
    Race { scene, kind, rays: count, single, packets, wrong, timings }
}

/// Rays and what is said of them.
#[derive(Clone)]
struct Answers<'a> {
    any_hit: bool,
    rays: &'a [Ray],
    hits: Vec<Option<Hit>>,
    blocked: Vec<bool>,
}

impl<'a> Answers<'a> {
    fn new(set: &'a RaySet) -> Self {
        let (rays, any_hit) = (&set.rays, set.kind.any_hit());
        Self { any_hit, rays, hits: vec![None; rays.len()], blocked: vec![false; rays.len()] }
    }

    /// Traces all rays in packets of so many, or one by one, by the traversal for single rays.
    fn trace<G: Geometry, P: Probe>(
        &mut self,
        tree: &Bvh2,
        geometry: &G,
        size: usize,
        probe: &mut P,
    ) {
        let Self { any_hit, rays, hits, blocked } = self;
        match (any_hit, size) {
            (true, 1) => {
                for (ray, blocked) in rays.iter().zip(blocked) {
                    *blocked = tree.occluded(geometry, ray, probe);
                }
            }
            (false, 1) => {
                for (ray, hit) in rays.iter().zip(hits) {
                    *hit = tree.intersect(geometry, ray, probe);
                }
            }
            (true, _) => {
                for (rays, blocked) in rays.chunks(size).zip(blocked.chunks_mut(size)) {
                    tree.occluded_packet(geometry, rays, blocked, probe);
                }
            }
            (false, _) => {
                for (rays, hits) in rays.chunks(size).zip(hits.chunks_mut(size)) {
                    tree.intersect_packet(geometry, rays, hits, probe);
                }
            }
        }
    }

    /// How many answers differ.
    fn differing(&self, other: &Self) -> usize {
        let hits = self.hits.iter().zip(&other.hits).filter(|(a, b)| a != b).count();
        hits + self.blocked.iter().zip(&other.blocked).filter(|(a, b)| a != b).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lecture::{Lab, default_scenes};

    #[test]
    fn primary_rays_share_more_than_diffuse_ones_and_all_answers_agree() {
        let scenes = default_scenes(true);
        let lab = Lab::new(&scenes, true, 1).expect("scenes");
        for subject in lab.subjects() {
            let races = races(subject, true, 1).expect("races");
            assert_eq!(races.len(), RayKind::ALL.len());
            for race in &races {
                assert_eq!(race.wrong, 0, "{race:?}");
                for (packets, edge) in race.packets.iter().zip(EDGES) {
                    let (rays, coherence) = ((edge * edge) as f64, packets.coherence.coherence());
                    assert!((1.0..=rays).contains(&coherence), "{race:?}");
                    assert!(packets.cost.nodes < race.single.nodes, "{race:?}");
                }
            }
            let shared = |race: &Race| race.packets[1].coherence.rays_per_node();
            assert!(shared(&races[0]) > shared(&races[3]), "{}", subject.name());
        }
    }
}
