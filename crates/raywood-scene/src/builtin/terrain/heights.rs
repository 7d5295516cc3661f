//! The shape of the island: ridged, eroded fractal noise inside a coastline.

use crate::noise::gradient2;

/// The extent of the heightfield along x and z, in metres.
pub(super) const SIZE: f32 = 12_000.0;

/// The depth of the sea floor far from the coast.
const SEA_FLOOR: f32 = 260.0;

/// The height of the land as a function of place.
pub(super) struct Heights {
    seed: u32,
}

impl Heights {
    pub(super) fn new(seed: u32) -> Self {
        Self { seed: seed.wrapping_mul(64) }
    }

    /// The height above the sea at a place, in metres.
    pub(super) fn at(&self, x: f32, z: f32) -> f32 {
        let (px, pz) = (x / 3000.0, z / 3000.0);

        // Bend space a little, so that ridges wind.
        let bend = |seed| gradient2(0.9 * px, 0.9 * pz, self.seed + seed).0;
        let (wx, wz) = (px + 0.35 * bend(40), pz + 0.35 * bend(41));

        let coast = 1.0 - smoothstep(0.55, 1.0, self.distance_from_middle(px, pz));
        let mountains = smoothstep(0.95, 0.0, self.distance_from_middle(1.2 * px, 1.2 * pz));
        let hills = 0.5 + 0.5 * self.eroded(wx, wz);
        let ridges = self.ridged(wx, wz);
        let land = 40.0 + 640.0 * hills * hills + 2150.0 * ridges.powf(1.35) * mountains;
        coast * land - SEA_FLOOR * (1.0 - coast)
    }

    /// The distance from the island's middle, about 1 at its shore, frayed by noise.
    fn distance_from_middle(&self, px: f32, pz: f32) -> f32 {
        let fray = gradient2(1.1 * px, 1.1 * pz, self.seed + 50).0
            + 0.5 * gradient2(2.7 * px, 2.7 * pz, self.seed + 51).0
            + 0.2 * gradient2(7.3 * px, 7.3 * pz, self.seed + 52).0;
        let half = 0.5 * SIZE / 3000.0;
        (px * px + pz * pz).sqrt() / half + 0.22 * fray
    }

    /// Fractal noise about -1 to 1 whose octaves fade where the slope of those before is steep: valleys and ridges
    /// stay sharp, slopes are smooth, as erosion leaves them.
    fn eroded(&self, x: f32, z: f32) -> f32 {
        let (mut px, mut pz, mut height) = (x, z, 0.5);
        let (mut sum, mut slope) = (0.0, [0.0f32; 2]);
        for octave in 0..9 {
            let (value, [dx, dz]) = gradient2(px, pz, self.seed + octave);
            slope[0] += 0.35 * dx;
            slope[1] += 0.35 * dz;
            sum += height * value / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]);
            (px, pz) = turn(px, pz);
            height *= 0.5;
        }
        2.0 * sum
    }

    /// Ridged fractal noise, 0 to about 1: sharp crests where each octave crosses zero, rough near crests and
    /// smooth in valleys (Musgrave 1994).
    fn ridged(&self, x: f32, z: f32) -> f32 {
        let (mut px, mut pz, mut height) = (1.3 * x, 1.3 * z, 0.5);
        let (mut sum, mut weight) = (0.0, 1.0f32);
        for octave in 0..11 {
            let (value, _) = gradient2(px, pz, self.seed + 20 + octave);
            let crest = 1.0 - value.abs();
            let crest = crest * crest;
            sum += height * crest * weight;
            weight = (1.6 * crest).clamp(0.0, 1.0);
            (px, pz) = turn(px, pz);
            height *= 0.46;
        }
        sum
    }
}

/// The next octave's coordinates: twice as fine, turned, and moved so that no lattice point is common to all octaves.
fn turn(x: f32, z: f32) -> (f32, f32) {
    (1.6 * x - 1.2 * z + 17.3, 1.2 * x + 1.6 * z - 9.1)
}

/// 0 below `from`, 1 above `to`, smooth between; with `from` above `to` the other way round.
pub(super) fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
