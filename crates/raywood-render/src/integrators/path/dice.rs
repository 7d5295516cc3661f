//! The random numbers of the paths of a wave, in columns.

use super::walks::Walk;
use crate::path_samples::PathSamples;
use crate::wave::WAVE;
use crate::wave::columns::{Column, whole_vectors};

/// The decisions of a path where it meets a surface, each with random numbers of its own.
#[derive(Clone, Copy)]
pub(super) enum Decision {
    /// Whether it goes straight on, and whether it ends.
    Straight,
    /// Which part of the surface scatters it, and which light without extent is asked.
    Part,
    Direction,
    /// Which shining surface and which part of the surroundings is asked.
    Light,
    LightPoint,
    Surroundings,
    /// Which colour is followed through glass that parts them.
    Color,
    /// Which part of a round light far away is asked.
    Disc,
}

/// A pair of random numbers for each path.
pub(super) type Pairs = [Column; 2];

/// The pair of one path.
#[inline(always)]
pub(super) fn pair_of(pairs: &Pairs, number: usize) -> [f32; 2] {
    [pairs[0][number], pairs[1][number]]
}

#[inline(always)]
fn set_pair(pairs: &mut Pairs, number: usize, pair: [f32; 2]) {
    [pairs[0][number], pairs[1][number]] = pair;
}

/// The random numbers of paths where they meet surfaces.
pub(super) struct Dice {
    /// Where in the picture they begin: columns and rows.
    places: [[u32; WAVE]; 2],
    /// Which samples of their pixels they are.
    samples: [u32; WAVE],
    /// The number of the first decision.
    firsts: [u32; WAVE],
    seed: u32,
}

impl Default for Dice {
    fn default() -> Self {
        Self { places: [[0; WAVE]; 2], samples: [0; WAVE], firsts: [0; WAVE], seed: 0 }
    }
}

impl Dice {
    /// Has them be those of pictures of a seed.
    pub(super) fn set_seed(&mut self, seed: u32) {
        self.seed = seed;
    }

    /// Has number `number` be a path that began at a place in the picture.
    #[inline(always)]
    pub(super) fn set(&mut self, number: usize, place: [u32; 2], walk: &Walk) {
        [self.places[0][number], self.places[1][number]] = place;
        self.samples[number] = walk.sample;
        self.firsts[number] = (u32::from(walk.depth) << 16) | (u32::from(walk.holes) << 4);
    }

    /// The numbers of one path for a decision.
    #[inline(always)]
    pub(super) fn pair(&self, number: usize, decision: Decision) -> [f32; 2] {
        let place = [self.places[0][number], self.places[1][number]];
        let path = PathSamples::seeded(place, self.samples[number], self.seed);
        path.pair(self.firsts[number] + decision as u32)
    }

    /// The numbers of the first `count` paths for a decision.
    #[inline(always)]
    pub(super) fn roll(&self, decision: Decision, count: usize, pairs: &mut Pairs) {
        for number in 0..whole_vectors(count) {
            set_pair(pairs, number, self.pair(number, decision));
        }
    }
}
