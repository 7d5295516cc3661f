//! Writing what a packet's rays found to where the answers go.

use super::kind::Kind;
use super::{ALL, GROUP, NONE, Packet};
use crate::Hit;
use crate::simd::{Float, Simd};
use crate::structures::wide::sink::{Sink, SixteenHits};
use crate::structures::wide::source::Source;

impl Packet {
    /// Writes what was found.
    #[inline(always)]
    pub(super) fn finish<S: Simd, R: Source, H: Sink, K: Kind>(
        &self,
        simd: S,
        rays: &R,
        hits: &mut H,
        rest: &mut Vec<usize>,
        first: usize,
    ) {
        let (zero, one) = (simd.splat16(0.0), simd.splat16(1.0));
        for group in 0..rays.len().div_ceil(GROUP) {
            let members = self.members[group];
            if members == 0 {
                continue;
            }
            let nearest = simd.load16(&self.nearest[group]);
            let depth = one / nearest;
            let from_start = match K::LATE {
                true => depth - simd.load16(&self.starts[group]),
                false => depth,
            };
            let found = SixteenHits {
                t: from_start * simd.load16(&self.scales[group]),
                u: depth * simd.load16(&self.weights[0][group]),
                v: depth * simd.load16(&self.weights[1][group]),
                primitives: self.primitives[group],
                hit: zero.less(nearest),
            };
            let is_sorted = self.sorted >> group & 1 == 1;
            if is_sorted || self.is_bounded || self.is_later && members != ALL {
                let numbers = [found.t.to_array(), found.u.to_array(), found.v.to_array()];
                self.finish_apart(rays, group, numbers, hits, (rest, first));
            } else {
                hits.set_sixteen(simd, group * GROUP, found);
            }
            if self.alone[group] != 0 {
                let alone = (0..GROUP).filter(|lane| self.alone[group] >> lane & 1 == 1);
                rest.extend(alone.map(|lane| first + usize::from(self.numbers[group][lane])));
            }
        }
    }

    /// Writes what the rays of a group found one by one: in their own order, and not what lies so near to a ray's end that only the exact test can tell.
    #[inline(never)]
    fn finish_apart<R: Source, H: Sink>(
        &self,
        rays: &R,
        group: usize,
        [t, u, v]: [[f32; GROUP]; 3],
        hits: &mut H,
        (rest, first): (&mut Vec<usize>, usize),
    ) {
        for lane in 0..GROUP {
            let number = usize::from(self.numbers[group][lane]);
            if self.members[group] >> lane & 1 == 0 {
                continue;
            }
            let primitive = self.primitives[group][lane].to_bits();
            let hit = Hit { t: t[lane], u: u[lane], v: v[lane], primitive, instance: 0 };
            let hit = (primitive != NONE).then_some(hit);
            hits.set(number, hit);
            if self.is_bounded && hit.is_some_and(|hit| hit.t > rays.ray(number).t_max * NEARLY) {
                rest.push(first + number);
            }
        }
    }

    /// Writes which rays are blocked.
    #[inline(always)]
    pub(super) fn finish_any<S: Simd>(
        &self,
        simd: S,
        occluded: &mut [bool],
        rest: &mut Vec<usize>,
        first: usize,
    ) {
        let blocked = simd.splat16(f32::INFINITY);
        for group in 0..occluded.len().div_ceil(GROUP) {
            let found = blocked.less_or_equal(simd.load16(&self.nearest[group]));
            let members = self.members[group];
            if members == 0 {
                continue;
            }
            let found = found & members;
            let is_apart = self.sorted >> group & 1 == 1 || self.is_later && members != ALL;
            let answers = occluded[group * GROUP..].first_chunk_mut::<GROUP>();
            if let (false, Some(answers)) = (is_apart, answers) {
                *answers = truths(found);
            } else {
                for (lane, number) in self.numbers[group].iter().enumerate() {
                    if members >> lane & 1 == 1 {
                        occluded[usize::from(*number)] = found >> lane & 1 == 1;
                    }
                }
            }
            let alone = self.alone[group] & !found;
            if alone != 0 {
                let alone = (0..GROUP).filter(|lane| alone >> lane & 1 == 1);
                rest.extend(alone.map(|lane| first + usize::from(self.numbers[group][lane])));
            }
        }
    }
}

/// Each of sixteen bits as a truth value.
#[inline(always)]
fn truths(bits: u32) -> [bool; GROUP] {
    let mut truths = [false; GROUP];
    for (half, truths) in truths.chunks_exact_mut(8).enumerate() {
        // The bits eight times, a byte each; of each byte the bit of its number; and that moved to the lowest place.
        let copies = u64::from(bits >> (8 * half) & 0xff) * 0x0101_0101_0101_0101;
        let single = copies & 0x8040_2010_0804_0201;
        let lowest = (single + 0x7f7f_7f7f_7f7f_7f7f) >> 7 & 0x0101_0101_0101_0101;
        for (truth, byte) in truths.iter_mut().zip(lowest.to_le_bytes()) {
            *truth = byte != 0;
        }
    }
    truths
}

/// From this share of a ray's length on a hit may lie beyond its end.
const NEARLY: f32 = 1.0 - 1.0 / 512.0;
