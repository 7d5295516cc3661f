//! Choosing one of many in proportion to their weights, in constant time: Walker's alias method, made by Vose, "A Linear Algorithm for Generating Random Numbers
//! with a Given Distribution", 1991.

/// Entries with weights.
#[derive(Clone, Debug)]
pub(crate) struct AliasTable {
    bins: Vec<Bin>,
    total: f64,
}

/// As likely as any other bin; stands for its own entry, and for another one.
#[derive(Clone, Copy, Debug)]
struct Bin {
    /// The share of the bin that is its own entry.
    own: f32,
    other: u32,
}

impl AliasTable {
    /// A table of entries of these weights, at most 2^32 - 1; what is not a number above zero counts as zero. `None` if all are. O(n).
    pub(crate) fn new(weights: &[f64]) -> Option<Self> {
        let weight = |w: f64| if w.is_finite() && w > 0.0 { w } else { 0.0 };
        let total: f64 = weights.iter().map(|&w| weight(w)).sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }

        // How much of a bin each entry fills. What is too much for its own fills up those of others.
        let scale = weights.len() as f64 / total;
        let mut fills: Vec<f64> = weights.iter().map(|&w| scale * weight(w)).collect();
        let (mut small, mut large): (Vec<u32>, Vec<u32>) =
            (0..weights.len() as u32).partition(|&entry| fills[entry as usize] < 1.0);
        let mut bins: Vec<Bin> =
            (0..weights.len() as u32).map(|other| Bin { own: 1.0, other }).collect();
        while let (Some(less), Some(&more)) = (small.pop(), large.last()) {
            let fill = fills[less as usize];
            bins[less as usize] = Bin { own: fill as f32, other: more };
            fills[more as usize] -= 1.0 - fill;
            if fills[more as usize] < 1.0 {
                large.pop();
                small.push(more);
            }
        }
        Some(Self { bins, total })
    }

    /// The sum of the weights: an entry of weight `w` is chosen with probability `w / total`.
    pub(crate) fn total(&self) -> f64 {
        self.total
    }

    /// Chooses an entry by a number of at least 0 and below 1.
    #[inline]
    pub(crate) fn choose(&self, u: f32) -> usize {
        // In double precision, which has digits left within a bin.
        let place = f64::from(u) * self.bins.len() as f64;
        let bin = (place as usize).min(self.bins.len() - 1);
        let Bin { own, other } = self.bins[bin];
        if (place - bin as f64) < f64::from(own) { bin } else { other as usize }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_chosen_by_their_weights() {
        for weights in [vec![1.0], vec![1.0, 0.0, 3.0, 4.0, 0.5], vec![1e-9, 1e9, 2e9, 0.0, 7.0]] {
            let table = AliasTable::new(&weights).expect("a table");
            let (count, mut chosen) = (1 << 16, vec![0u32; weights.len()]);
            for i in 0..count {
                chosen[table.choose(i as f32 / count as f32)] += 1;
            }
            for (weight, chosen) in weights.iter().zip(&chosen) {
                let (share, expected) =
                    (f64::from(*chosen) / f64::from(count), weight / table.total());
                assert!((share - expected).abs() < 1e-3, "{weights:?}: {share} for {expected}");
                assert!(*weight > 0.0 || *chosen == 0, "what weighs nothing is never chosen");
            }
        }
    }

    #[test]
    fn nothing_to_choose_from_is_no_table() {
        assert!(AliasTable::new(&[]).is_none());
        assert!(AliasTable::new(&[0.0, -1.0, f64::NAN, f64::INFINITY]).is_none());
    }
}
